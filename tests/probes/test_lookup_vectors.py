"""The published vectors are what the lookup answers, from the published cells."""

import json
from pathlib import Path

import numpy as np
import pytest

from andon.files.volumes import plain_volume
from andon.files.volumes.model import Cells, Zone
from andon.harmonics import irradiance
from andon.transport.probes.space import ProbeSpace
from andon.transport.probes.vectors import publish
from requirements import required

required("scipy")

DOCS = Path(__file__).parents[2] / "docs"
REMEDY = (
    'run: python -c "from pathlib import Path; from andon.transport.probes.vectors import publish; '
    "[p.write_text(t, encoding='utf-8') for p, t in publish(Path('docs')).items()]\""
)
VOLUMES = json.loads((DOCS / "vectors" / "probes-lookup.json").read_text("utf-8"))["volumes"]


def assert_close(one, two):
    """Equal, numbers within 1e-8; of cells only how many: Qhull may join others another time."""
    assert type(one) is type(two), REMEDY
    if isinstance(one, dict):
        assert one.keys() == two.keys(), REMEDY
        for key in one:
            if key == "cells":
                assert {k: len(v) for k, v in one[key].items()} == {
                    k: len(v) for k, v in two[key].items()
                }, REMEDY
            else:
                assert_close(one[key], two[key])
    elif isinstance(one, list):
        assert len(one) == len(two), REMEDY
        for a, b in zip(one, two, strict=True):
            assert_close(a, b)
    elif isinstance(one, float):
        assert one == pytest.approx(two, abs=1e-8), REMEDY
    else:
        assert one == two, REMEDY


def test_the_vectors_are_fresh():
    for path, text in publish(DOCS).items():
        assert_close(json.loads(path.read_text("utf-8")), json.loads(text))


@pytest.mark.parametrize("entry", VOLUMES, ids=lambda entry: entry["name"])
@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_a_reader_of_the_file_gets_what_it_says(entry, engine):
    required(engine)
    positions = np.array(entry["positions"])
    light = np.array(entry["coefficients"])
    zones = tuple(
        Zone(
            zone["name"],
            np.array(zone["probes"], np.int32),
            None if zone["boxes"] is None else np.array(zone["boxes"]),
        )
        for zone in entry["zones"]
    )
    shapes = {"corners": (-1, 4), "neighbours": (-1, 4)}
    cells = Cells(
        **{
            key: np.array(value, np.int32).reshape(shapes.get(key, np.shape(value)))
            for key, value in entry["cells"].items()
        }
    )
    volume = plain_volume(positions, light, zones=zones, cells=cells)
    queries = entry["queries"]
    points = np.array([query["point"] for query in queries])
    mixed = ProbeSpace(volume).lookup(points, light, engine=engine)
    assert mixed == pytest.approx(np.array([q["coefficients"] for q in queries]), abs=1e-8)
    lux = irradiance(mixed, np.array([q["normal"] for q in queries]))
    assert lux == pytest.approx(np.array([q["irradiance"] for q in queries]), abs=1e-8)


def test_points_are_floats_of_single_precision_and_some_are_outside():
    for entry in VOLUMES:
        points = np.array([query["point"] for query in entry["queries"]])
        assert np.array_equal(points.astype(np.float32), points)
    inside = [query["inside"] for entry in VOLUMES for query in entry["queries"]]
    assert 0.1 < np.mean(inside) < 0.9
