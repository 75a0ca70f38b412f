"""Narrow gaps of depth images: closed as far as is stated, and no farther."""

import numpy as np
import pytest

from andon.spaces import View
from andon.surface.filling import filled, hidden_behind
from andon.surface.load import surface_of_depth

VIEW = View("pinhole", 48, 36, 40.0, 40.0, 23.5, 17.5, world_from_camera=np.eye(4))
JUMP = 0.05


def plane(normal=(0.2, -0.3, -1.0), distance=2.0):
    """Depth of a slanted plane: 1/z is linear over the picture."""
    rays = VIEW.rays_planar()
    return -distance / (rays @ np.asarray(normal))


def test_a_hole_in_a_plane_gets_the_plane():
    depth = plane()
    holed = depth.copy()
    holed[10:15, 20:26] = np.nan
    holed[30, 3] = np.nan
    np.testing.assert_allclose(filled(holed, 6, max_jump=JUMP), depth, rtol=1e-12)


def test_a_surface_goes_on_to_the_border():
    depth = plane()
    holed = depth.copy()
    rows, columns = np.indices(holed.shape)
    holed[rows + columns < 7] = np.nan
    holed[:, -2:] = np.nan
    np.testing.assert_allclose(filled(holed, 7, max_jump=JUMP), depth, rtol=1e-9)


def test_wide_holes_stay():
    holed = plane()
    holed[10:18, 20:28] = np.nan
    holed[:, -8:] = np.nan
    holed[30] = np.nan
    whole = filled(holed, 7, max_jump=JUMP)
    expected = np.isnan(holed)
    expected[30, :-8] = False
    np.testing.assert_array_equal(np.isnan(whole), expected)


def test_a_hole_in_a_floor_that_is_seen_at_a_slant_gets_the_floor():
    """Over the hole it gets farther by a sixth, and over the pixels that tell its slope by more."""
    depth = plane((0, -1.0, -0.6))
    holed = depth.copy()
    holed[26:31, 10:34] = np.nan
    assert depth[25, 20] > 1.15 * depth[31, 20]
    np.testing.assert_allclose(filled(holed, 6, max_jump=JUMP), depth, rtol=1e-9)


def test_between_two_surfaces_the_farther_goes_on():
    far, near = plane(), np.full(VIEW.shape, 1.0)
    depth = np.where(np.arange(48) < 24, far, near)
    holed = depth.copy()
    holed[:, 21:27] = np.nan
    whole = filled(holed, 6, max_jump=JUMP)
    np.testing.assert_allclose(whole[:, 21:27], far[:, 21:27], rtol=1e-9)
    np.testing.assert_array_equal(whole[:, 27:], depth[:, 27:])


def test_nothing_measured_changes_and_zero_fills_nothing():
    holed = plane()
    holed[5:8, 5:8] = np.nan
    for widest in (0, 8):
        whole = filled(holed, widest, max_jump=JUMP)
        known = np.isfinite(holed)
        np.testing.assert_array_equal(whole[known], holed[known])
    assert np.isnan(filled(holed, 0, max_jump=JUMP)).sum() == 9


def test_a_plane_goes_on_behind_a_narrow_thing():
    depth, behind = plane(), plane()
    depth[5:30, 22:26] = 1.0
    layer = hidden_behind(depth, VIEW, 6, max_jump=JUMP)
    assert len(layer.triangles) > 2 * 25 * 4
    z, pixels = layer.positions[:, 2], np.rint(VIEW.project(layer.positions)).astype(int)
    expected = behind[pixels[:, 1], pixels[:, 0]]
    # One side goes on level over the gap: half a gap's slope at most.
    np.testing.assert_allclose(z, expected, rtol=0.025)
    across = pixels[:, 0][(pixels[:, 1] == 15)]
    assert {22, 23, 24, 25} <= set(across.tolist())


def test_nothing_is_hidden_by_wide_things_and_by_noise():
    depth = plane() + np.random.default_rng(1).normal(0, 0.004, VIEW.shape)
    assert len(hidden_behind(depth, VIEW, 8, max_jump=JUMP).triangles) == 0
    depth[5:30, 10:30] = 1.0
    assert len(hidden_behind(depth, VIEW, 8, max_jump=JUMP).triangles) == 0


def test_the_surface_says_what_was_filled():
    holed = plane()
    holed[10:12, 20:23] = np.nan
    model = surface_of_depth(holed, VIEW, fill_px=4)
    (guessed,) = model.filled.values()
    assert guessed.sum() == 6
    assert model.notes == (
        "6 of 6 hole pixels have the depth of what is beside them: surface.depth.fill_px = 4",
    )
    plain = surface_of_depth(holed, VIEW)
    assert not plain.filled
    assert not plain.notes


def test_light_does_not_pass_beneath_a_post():
    """Rays from above a floor, past a post before it, end on the floor that the post hides."""
    from andon.rays import RayScene

    depth, behind = plane((0, -1.0, -0.8)), plane((0, -1.0, -0.8))
    depth[4:34, 22:25] = 0.8 * depth[4:34, 22:25]
    point = VIEW.rays_planar()[20, 23] * behind[20, 23]
    lamp = point + np.array([0.0, -0.6, 0.4])
    ends = [
        RayScene(surface_of_depth(depth, VIEW, fill_px=px).occluder.geometry)
        .first_hits(lamp[None], ((point - lamp) / np.linalg.norm(point - lamp))[None])
        .distance[0]
        for px in (0, 6)
    ]
    reach = np.linalg.norm(point - lamp)
    assert not ends[0] < 1.05 * reach
    assert ends[1] == pytest.approx(reach, rel=0.03)
