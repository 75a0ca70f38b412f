"""The rows of the spread functions hold, and break when a model is wrong."""

import pytest

from andon.observer.spread import cie135, spencer
from andon.verify.registry import NotShown
from andon.verify.rows import glare_models
from requirements import missing

ROWS = {row.name.removeprefix("glare.models."): row for row in glare_models.ROWS}


@pytest.mark.parametrize("name", ROWS)
def test_it_holds(name):
    try:
        figure = ROWS[name].measure()
    except NotShown as reason:
        missing(str(reason))
    assert 0 < figure < 1e-3


@pytest.mark.parametrize("name", ["values", "ages", "integrals"])
def test_without_the_denominator_it_does_not_hold(name, monkeypatch):
    right = cie135.cie135

    def wrong(theta, age, pigment, wide):
        return right(theta, age, pigment, wide) * (1 + pigment * (0.0417 + 0.055 * (age / 70) ** 4))

    monkeypatch.setattr(cie135, "cie135", wrong)
    assert ROWS[name].measure() > 5e-3


def test_a_term_of_other_weight_does_not_hold(monkeypatch):
    right = spencer.wide_skirt
    monkeypatch.setattr(spencer, "wide_skirt", lambda theta: 1.005 * right(theta))
    assert ROWS["integrals"].measure() > 4e-3


def test_no_data_is_no_figure(monkeypatch, tmp_path):
    monkeypatch.delenv("ANDON_DATA", raising=False)
    with pytest.raises(NotShown, match="glare_references"):
        ROWS["tables"].measure()
    monkeypatch.setenv("ANDON_DATA", str(tmp_path))
    with pytest.raises(NotShown, match="is missing"):
        ROWS["tables"].measure()
