"""Lamps of few tiles: the flux of all, where it is, to where it shines."""

import numpy as np
import pytest

from andon.lamps import MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.transport.baked.radiance.emitters import Tiles, tiles_of
from andon.transport.baked.radiance.few import thinned
from worlds import block

LIGHT = np.array([900.0, 700.0, 300.0])
BOX = block((0.3, 0.4, 0.3), (1, 1, 0))
FACETS = np.linspace(50, 900, len(BOX.triangles))[:, None] * np.array([1.0, 0.8, 0.5])
LAMPS = [
    SphereLamp("ball", LIGHT, np.array([0.0, 2, 0]), 0.2),
    TubeLamp("tube", LIGHT, np.array([[0.0, 2, 0], [1.2, 2, 0]]), 0.03),
    PolygonLamp("panel", LIGHT, np.array([[0.0, 2, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]])),
    MeshLamp("shade", LIGHT, BOX.positions, BOX.triangles, facet_luminance_cd_m2=FACETS),
]


def area_and_normal(corners):
    crossed = np.cross(corners[:, 1:-1] - corners[:, :1], corners[:, 2:] - corners[:, :1]).sum(1)
    area = np.linalg.norm(crossed, axis=1)
    return area / 2, crossed / area[:, None]


def sums(parts):
    """Flux, its middle, and the vector that tells to where it shines."""
    flux, place, way = np.zeros(3), np.zeros(3), np.zeros(3)
    for part in parts:
        area, normal = area_and_normal(part.corners)
        own = area * part.luminance_cd_m2.sum()
        flux += area.sum() * part.luminance_cd_m2
        place += own @ part.corners.mean(axis=1)
        way += own @ normal
    return flux, place / flux.sum(), way / flux.sum()


@pytest.mark.parametrize("lamp", LAMPS, ids=lambda lamp: lamp.name)
@pytest.mark.parametrize("most", [6, 12])
def test_flux_is_kept(lamp, most):
    every = tiles_of(lamp, 64)
    few = thinned(every, most)
    assert sum(len(part.corners) for part in few) <= most
    (flux, place, way), (few_flux, few_place, few_way) = sums(every), sums(few)
    assert np.allclose(few_flux, flux, rtol=1e-9)
    size = max(np.ptp(np.concatenate([p.corners.reshape(-1, 3) for p in every]), axis=0))
    assert np.linalg.norm(few_place - place) < 0.9 * size / most
    assert np.linalg.norm(few_way - way) < 0.25


def test_few_enough_stay_as_they_are():
    every = tiles_of(LAMPS[2], 4)
    assert thinned(every, 4) == every


def test_tiles_without_an_area_are_left_out():
    flat = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 0, 0]], [[0.0, 0, 0], [1, 0, 0], [1, 1, 0]]])
    (only,) = thinned([Tiles(flat, LIGHT)], 1)
    assert np.allclose(only.luminance_cd_m2, LIGHT)
    assert np.array_equal(only.corners[0], flat[1])


def test_the_same_tiles_give_the_same_few():
    few = [thinned(tiles_of(LAMPS[0], 64), 7) for _ in range(2)]
    assert all(np.array_equal(a.corners, b.corners) for a, b in zip(*few, strict=True))
