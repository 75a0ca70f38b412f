"""Light of some points smoothed to all: exact where it should be, sharp where it must be."""

import numpy as np
import pytest

from andon.errors import MachineError
from andon.transport.baked.radiance import smoothing
from andon.transport.baked.radiance.smoothing import chosen_points, lonely_points, smoothed

UP = np.array([0.0, 1.0, 0.0])


def plane(count, seed=0):
    """Random points on a square of 2 m that faces up."""
    place = np.random.default_rng(seed).uniform(-1, 1, (count, 3)) * [1, 0, 1]
    return place, np.tile(UP, (count, 1))


def test_points_are_chosen_evenly():
    """Every one of 10 × 10 squares has about as many of them."""
    place, normal = plane(20_000)
    chosen = chosen_points(place, normal, 1000)
    assert len(chosen) == 1000
    assert (np.diff(chosen) > 0).all()
    edges = np.linspace(-1, 1, 11)
    count, *_ = np.histogram2d(place[chosen, 0], place[chosen, 2], [edges, edges])
    assert count.min() >= 5  # of 10; chance gives 10 ± 3.2, and 0.7 on the mean as the least of 100
    assert count.std() < 2


@pytest.mark.parametrize("count", [1, 2, 3, 7, 63, 64, 65, 499, 500, 900])
def test_as_many_are_chosen_as_asked(count):
    chosen = chosen_points(*plane(500), count)
    assert len(chosen) == min(count, 500)


def test_points_that_lie_in_one_place_are_chosen_once():
    place, normal = np.zeros((50, 3)), np.tile(UP, (50, 1))
    chosen = chosen_points(place, normal, 20)
    assert len(np.unique(chosen)) == len(chosen) == 20


def test_a_linear_change_stays():
    """Inside and at the border, where a mean would be off by a third of the neighbours' reach."""
    place, normal = plane(5000)
    lux = np.stack([5 + place[:, 0], 7 - 2 * place[:, 2], np.full(5000, 3.0)], axis=1)
    chosen = chosen_points(place, normal, 500)
    found = smoothed(place, normal, chosen, lux[chosen], neighbours=16)
    np.testing.assert_allclose(found, lux, atol=0.13)
    assert np.median(np.abs(found - lux)) < 5e-3


def test_noise_goes_and_light_stays():
    place, normal = plane(5000)
    chosen = chosen_points(place, normal, 1000)
    noise = np.random.default_rng(1).normal(size=(len(chosen), 3))
    found = smoothed(place, normal, chosen, 10 + noise, neighbours=24)
    assert found.std() < 0.45
    assert abs(found.mean() - 10) < 0.05


def test_edges_between_surfaces_stay():
    """A bright floor meets a dark wall."""
    floor, up = plane(3000)
    wall = np.stack([np.full(3000, -1.0), floor[:, 0] + 1, floor[:, 2]], axis=1)
    place = np.concatenate([floor, wall])
    normal = np.concatenate([up, np.tile([1.0, 0, 0], (3000, 1))])
    lux = np.repeat([[100.0] * 3, [1.0] * 3], 3000, axis=0)
    chosen = chosen_points(place, normal, 600)
    found = smoothed(place, normal, chosen, lux[chosen], neighbours=12)
    np.testing.assert_allclose(found, lux, rtol=1e-6)


def test_no_light_is_made():
    """Slopes end at what neighbours have, so nothing is negative."""
    place, normal = plane(3000)
    lux = np.where(place[:, :1] > 0, 1e3, 0.0) * np.ones(3)
    chosen = chosen_points(place, normal, 300)
    found = smoothed(place, normal, chosen, lux[chosen], neighbours=12)
    assert found.min() >= 0
    assert found.max() <= 1e3


def test_the_order_of_points_is_no_matter():
    """Unlike that of rtrace's own interpolation, which makes streaks."""
    place, normal = plane(3000)
    chosen = chosen_points(place, normal, 300)
    order = np.random.default_rng(3).permutation(3000)
    again = chosen_points(place[order], normal[order], 300)
    assert set(order[again]) == set(chosen)
    lux = np.random.default_rng(4).uniform(size=(3000, 3))
    found = smoothed(place, normal, chosen, lux[chosen], neighbours=12)
    other = smoothed(place[order], normal[order], again, lux[order][again], neighbours=12)
    np.testing.assert_allclose(other, found[order], rtol=1e-9)


def test_fewer_points_than_neighbours():
    place, normal = plane(5)
    lux = np.ones((5, 3))
    found = smoothed(place, normal, np.arange(5), lux, neighbours=24)
    np.testing.assert_allclose(found, 1, rtol=1e-12)


def test_one_point():
    found = smoothed(np.zeros((1, 3)), UP[None], np.array([0]), np.full((1, 3), 7.0), neighbours=9)
    np.testing.assert_allclose(found, 7)


def test_without_scipy(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(smoothing, "import_module", missing)
    with pytest.raises(MachineError, match=r"SciPy is missing; .*andon\[radiance\]"):
        smoothed(*plane(5), np.arange(5), np.ones((5, 3)), neighbours=3)


def test_a_panel_behind_its_frame_keeps_its_light():
    """Both face alike, 3 cm apart: nearer than the next point of the same surface."""
    front, up = plane(4000)
    behind, _ = plane(4000, seed=9)
    place = np.concatenate([front, behind - 0.03 * UP])
    normal = np.concatenate([up, up])
    lux = np.repeat([[10.0] * 3, [1.0] * 3], 4000, axis=0)
    chosen = chosen_points(place, normal, 800)
    found = smoothed(place, normal, chosen, lux[chosen], neighbours=48)[:, 0]
    assert np.median(found[4000:]) < 1.7  # 5.5 by distance alone
    assert np.median(found[:4000]) > 9.3


def test_bars_before_a_sheet_are_lonely():
    """Thin bars 1 cm before a sheet get more points; at most as many as asked, none twice."""
    sheet, up = plane(20_000)
    bars, _ = plane(400, seed=5)
    place = np.concatenate([sheet, bars * [1, 1, 0.01] + 0.01 * UP])
    normal = np.concatenate([up, up[:400]])
    chosen = chosen_points(place, normal, 500)
    more = lonely_points(place, normal, chosen, neighbours=24, most=60)
    assert len(np.unique(more)) == len(more) == 60
    assert not np.isin(more, chosen).any()
    assert (more >= 20_000).mean() > 0.9
    assert len(lonely_points(sheet, up, chosen_points(sheet, up, 500), neighbours=24, most=9)) == 0
