"""Charts: the identities of the stereographic projection, and what they cover."""

import numpy as np
import pytest

from andon.glare.whole_picture.charts import (
    MARGIN,
    block_directions,
    block_shape,
    charts_of,
    pixel_angles,
)
from andon.spaces import View, pinhole_view
from comparison import assert_agree

FISHEYE = View("fisheye", 90, 90, 30.0, 30.0, 44.5, 44.5)
VIEWS = [
    pinhole_view(97, 60, 300.0),
    pinhole_view(96, 61, 28.0),
    View("fisheye", 90, 80, 40.0, 38.0, 45.0, 39.0),
    View("latlong", 64, 32),
]
NAMES = ["narrow", "very wide", "fisheye", "latlong"]


def unit(count, seed=1):
    made = np.random.default_rng(seed).normal(size=(count, 3))
    return made / np.linalg.norm(made, axis=1, keepdims=True)


@pytest.mark.parametrize("view", VIEWS, ids=NAMES)
def test_places_and_directions_are_inverse(view):
    for chart in charts_of(view):
        directions = unit(200)
        directions = directions[chart.scale(directions) > 0.05]
        back = chart.direction_from_place(chart.place_from_direction(directions))
        assert_agree(back, directions, atol=1e-12)


@pytest.mark.parametrize("view", VIEWS, ids=NAMES)
def test_chords_are_distances_by_both_scales(view):
    for chart in charts_of(view):
        first, second = unit(200), unit(200, 2)
        kept = np.minimum(chart.scale(first), chart.scale(second)) > 0.05
        first, second = first[kept], second[kept]
        step = chart.place_from_direction(first) - chart.place_from_direction(second)
        scales = np.sqrt(chart.scale(first) * chart.scale(second))
        chord = np.linalg.norm(first - second, axis=1)
        assert_agree(np.linalg.norm(step, axis=1) * chart.cell * scales, chord, rtol=1e-10)


@pytest.mark.parametrize("view", VIEWS, ids=NAMES)
def test_shares_sum_to_one(view):
    charts = charts_of(view)
    directions = view.directions()
    shares = [c.share(directions, pair=len(charts) == 2) for c in charts]
    assert_agree(np.sum(shares, 0), np.ones(view.shape), atol=1e-12)
    assert np.min(shares) >= 0


@pytest.mark.parametrize("view", VIEWS, ids=NAMES)
def test_blocks_of_the_picture_lie_within_the_lattice(view):
    directions = block_directions(view)
    assert directions.shape == (*block_shape(view), 3)
    charts = charts_of(view)
    for chart in charts:
        place = chart.place_from_direction(directions)
        shown = chart.share(directions, pair=len(charts) == 2) > 0
        assert ((place > -1e-9) & (place < np.array(chart.size[::-1]) + 1e-9))[shown].all()


@pytest.mark.parametrize("view", VIEWS, ids=NAMES)
def test_blocks_are_between_their_pixels(view):
    middle = view.directions_at(np.array([4.5, 6.5]))
    assert_agree(block_directions(view)[3 + 1, 2 + 1], middle, atol=1e-12)


def test_cells_of_a_level_lie_in_the_middle_of_four_of_the_one_below():
    chart = charts_of(VIEWS[0])[0]
    fine, coarse = chart.cell_directions(1), chart.cell_directions(2)
    four = [
        chart.place_from_direction(fine[MARGIN + 2 + y, MARGIN + 4 + x])
        for y in (0, 1)
        for x in (0, 1)
    ]
    place = chart.place_from_direction(coarse[MARGIN + 1, MARGIN + 2])
    assert_agree(np.mean(four, 0), place, atol=1e-9)


@pytest.mark.parametrize(
    "view", [VIEWS[1], FISHEYE, VIEWS[3]], ids=["pinhole", "fisheye", "latlong"]
)
def test_pixel_angles_are_the_root_of_solid_angles(view):
    directions, chart = view.directions(), charts_of(view)[0]
    seen = chart.scale(directions) > 0.5
    angles = pixel_angles(view, chart.scale(directions)[seen])
    assert_agree(angles, np.sqrt(view.solid_angles()[seen]), rtol=0.02, share=0.02)


def test_only_what_sees_backwards_needs_two_charts():
    assert [len(charts_of(view)) for view in VIEWS] == [1, 1, 1, 2]
    whole = View("fisheye", 60, 60, 60 / (2 * np.pi), 60 / (2 * np.pi), 29.5, 29.5)
    assert len(charts_of(whole)) == 2
