"""Bundles that are made when they are read."""

import pickle

import pytest

from andon.bake.maps.bundles import Bundles
from andon.bake.tasks import bundle_digest


class Made:
    """Gives a bundle, and counts how often."""

    def __init__(self, name, size=10):
        self.files, self.count = {"a.txt": name.encode() * size}, 0

    def __call__(self):
        self.count += 1
        return self.files


def test_names_are_those_of_the_contents():
    bundles, made = Bundles(), Made("x")
    name = bundles.add("source", made)
    assert name == bundle_digest(made.files)
    assert (list(bundles), len(bundles)) == ([name], 1)
    assert dict(bundles[name]) == made.files
    assert made.count == 1, "what was made to be named is kept"


def test_the_same_source_is_made_once():
    bundles, made = Bundles(), Made("x")
    assert bundles.add("one", made) == bundles.add("one", Made("never asked"))
    assert made.count == 1


def test_other_sources_of_the_same_contents_are_one_bundle():
    bundles = Bundles()
    assert bundles.add("one", Made("x")) == bundles.add("two", Made("x"))
    assert len(bundles) == 1


def test_what_was_dropped_is_made_again():
    bundles = Bundles(kept_bytes=15)
    first, second = Made("x"), Made("y")
    names = [bundles.add(made.files["a.txt"].decode(), made) for made in (first, second)]
    assert (first.count, second.count) == (1, 1)
    assert dict(bundles[names[1]]) == second.files
    assert (first.count, second.count) == (1, 1)
    assert dict(bundles[names[0]]) == first.files
    assert (first.count, second.count) == (2, 1)


def test_nothing_is_made_before_it_is_read():
    bundles = Bundles(kept_bytes=0)
    made = Made("x")
    name = bundles.add("x", made)
    bundles.add("y", Made("y"))
    later = bundles[name]
    assert made.count == 1
    assert later["a.txt"] == made.files["a.txt"]
    assert made.count == 2


def test_bundles_travel_as_what_they_hold():
    bundles, made = Bundles(), Made("x")
    arrived = pickle.loads(pickle.dumps(bundles[bundles.add("x", made)]))
    assert type(arrived) is dict
    assert arrived == made.files


def test_a_bundle_that_was_never_added():
    with pytest.raises(KeyError):
        Bundles()["0" * 64]
