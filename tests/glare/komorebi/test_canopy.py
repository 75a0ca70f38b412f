"""Gaps of masks and pictures: which, where, how large, and how they close."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare.calibration import projected
from andon.glare.komorebi import canopy_of_list, canopy_of_mask, canopy_of_picture

VIEW = projected("pinhole", 40.0, 160, 100)


def mask_of(*boxes):
    mask = np.zeros(VIEW.shape, bool)
    for x, y, width, height in boxes:
        mask[y : y + height, x : x + width] = True
    return mask


def test_gaps_have_the_directions_and_sizes_of_their_pixels():
    canopy = canopy_of_mask(mask_of((10, 12, 8, 6), (100, 70, 3, 3)), VIEW)
    assert len(canopy) == 2
    solid = VIEW.solid_angles()
    assert np.isclose(canopy.solid_angles_sr[0], solid[12:18, 10:18].sum())
    assert np.isclose(canopy.solid_angles_sr[1], solid[70:73, 100:103].sum())
    assert np.allclose(canopy.directions[1], VIEW.directions()[71, 101], atol=2e-5)
    first = VIEW.directions()[12:18, 10:18].mean(axis=(0, 1))
    assert np.allclose(canopy.directions[0], first / np.linalg.norm(first), atol=2e-4)


def test_covers_sum_to_the_open_share_of_each_gap():
    canopy = canopy_of_mask(mask_of((10, 12, 9, 7), (60, 40, 1, 1), (100, 70, 5, 20)), VIEW)
    solid = VIEW.solid_angles().ravel()[canopy.pixels]
    for shares in ([0.0, 1.0, 0.5], [0.013, 0.4, 0.999], [1.0, 0.0, 0.25]):
        covers = canopy.covers(np.array(shares))
        assert covers.min() >= 0
        assert covers.max() <= 1
        area = np.bincount(canopy.gap, covers * solid)
        assert np.allclose(area, shares * canopy.solid_angles_sr, rtol=1e-9, atol=1e-18)


def test_a_gap_closes_from_its_outline_inwards():
    canopy = canopy_of_mask(mask_of((40, 30, 11, 11)), VIEW)
    light = np.array([1e6, 1e6, 1e6])
    half = canopy.picture(np.array([0.3]), light)[..., 1] > 5e5
    inside = np.argwhere(half)
    assert half[35, 45]
    assert np.ptp(inside[:, 0]) < 8
    assert np.ptp(inside[:, 1]) < 8
    smaller = canopy.covers(np.array([0.2]))
    assert (smaller <= canopy.covers(np.array([0.3]))).all()


def test_closed_gaps_show_leaves_and_open_ones_the_sun():
    canopy = canopy_of_mask(mask_of((40, 30, 4, 4)), VIEW)
    light = np.array([3e6, 2e6, 1e6])
    assert np.array_equal(canopy.picture(np.zeros(1), light), canopy.leaves_cd_m2)
    assert np.allclose(canopy.picture(np.ones(1), light)[30:34, 40:44], light)
    assert (canopy.leaves_cd_m2 > 0).all()
    green = canopy.leaves_cd_m2
    assert (green[..., 1] > green[..., 0]).all()
    assert (green[..., 1] > green[..., 2]).all()


def test_the_largest_gaps_of_a_mask_are_kept_in_their_order():
    mask = mask_of((10, 10, 2, 2), (60, 10, 6, 6), (10, 60, 4, 4), (60, 60, 1, 1))
    canopy = canopy_of_mask(mask, VIEW, most=2)
    kept = mask_of((60, 10, 6, 6), (10, 60, 4, 4))
    assert np.array_equal(np.sort(canopy.pixels), np.flatnonzero(kept))
    assert canopy.pixels[0] // 160 in range(10, 16)


def leaves_and_sky():
    """Dark leaves with small holes in their left half, and open sky on the right."""
    light = np.full((*VIEW.shape, 3), 100.0)
    light[:, 110:] = 6000.0
    holes = [(8 + 14 * i, 12 + 18 * j) for i in range(6) for j in range(4)]
    for x, y in holes:
        light[y : y + 2, x : x + 2] = 6000.0
    return light, holes


def test_gaps_of_a_picture_are_small_and_among_leaves():
    light, holes = leaves_and_sky()
    canopy = canopy_of_picture(light, VIEW, most=100)
    expected = {y * 160 + x for hx, hy in holes for x in (hx, hx + 1) for y in (hy, hy + 1)}
    assert set(canopy.pixels.tolist()) == expected
    assert (canopy.leaves_cd_m2[:, 110:] == 6000).all()


def test_closed_gaps_of_a_picture_look_like_what_is_around():
    light, _ = leaves_and_sky()
    canopy = canopy_of_picture(light, VIEW, most=100)
    assert np.allclose(canopy.leaves_cd_m2[:, :100], 100, rtol=1e-6)


def test_gaps_nearest_to_the_sun_are_taken():
    light, holes = leaves_and_sky()
    for x, y in ((8, 12), (78, 66)):
        canopy = canopy_of_picture(light, VIEW, most=3, sun=VIEW.directions()[y, x])
        middles = VIEW.directions()[y, x] @ canopy.directions.T
        others = [VIEW.directions()[b, a] @ VIEW.directions()[y, x] for a, b in holes]
        assert middles.min() >= np.sort(others)[-4] - 1e-3


def test_gaps_do_not_blur_into_one_another():
    light, _ = leaves_and_sky()
    light[40:42, 30:32] = 6000.0
    light[40:42, 34:36] = 6000.0  # 1° apart
    canopy = canopy_of_picture(light, VIEW, most=100)
    cosines = canopy.directions @ canopy.directions.T - 2 * np.eye(len(canopy))
    assert np.degrees(np.arccos(cosines.max())) >= 0.8


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda: canopy_of_mask(np.zeros(VIEW.shape, bool), VIEW), "no gap"),
        (lambda: canopy_of_mask(np.ones((3, 4), bool), VIEW), "as the view"),
        (lambda: canopy_of_mask(mask_of((1, 1, 2, 2)), VIEW, most=0), "≥ 1"),
        (lambda: canopy_of_picture(np.zeros((*VIEW.shape, 3)), VIEW), "black"),
        (lambda: canopy_of_picture(np.ones((*VIEW.shape, 3)), VIEW), "no bright spots"),
        (lambda: canopy_of_picture(leaves_and_sky()[0], VIEW, most=0), "≥ 1"),
    ],
)
def test_what_has_no_gaps_is_refused(make, rule):
    with pytest.raises(InputError, match=rule):
        make()


def test_a_list_of_gaps():
    canopy = canopy_of_list(np.array([[5.0, 3.0, 1.5], [-8.0, -6.0, 0.01]]), VIEW)
    assert len(canopy) == 2
    level = np.cos(np.radians(3))
    right, up = level * np.sin(np.radians(5)), np.sin(np.radians(3))
    assert np.allclose(canopy.directions[0], [right, -up, level * np.cos(np.radians(5))], atol=2e-3)
    assert np.isclose(canopy.solid_angles_sr[0], np.pi * np.radians(0.75) ** 2, rtol=0.15)
    assert canopy.solid_angles_sr[1] == VIEW.solid_angles().ravel()[canopy.pixels[-1]]
    with pytest.raises(InputError, match="no gap"):
        canopy_of_list(np.array([[120.0, 0.0, 1.0]]), VIEW)
