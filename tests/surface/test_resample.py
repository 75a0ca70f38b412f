"""Depth of other resolutions, and relative depth that a scene scales and shifts."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.scene import scene_from_dict
from andon.spaces import View
from andon.surface.depth import DepthEncoding, depth_from_raw
from andon.surface.load import load_surface
from andon.surface.resample import resampled, same_aspect
from comparison import assert_agree

VIEW = View("pinhole", 120, 90, 100.0, 100.0, 59.5, 44.5)
NORMAL, DISTANCE = np.array([0.3, -0.5, 0.8]), 2.0


def plane_depth(view, normal=NORMAL, distance=DISTANCE):
    return distance / (view.rays_planar() @ normal)


def loaded(folder, **depth):
    scene = scene_from_dict({"surface": {"depth": {"file": "d.npy", **depth}}}, folder=folder)
    return load_surface(scene, {"mono": VIEW})


@pytest.mark.parametrize("size", [(24, 18), (37, 28), (120, 90), (200, 150)])
def test_a_plane_stays_the_plane(size):
    small = VIEW.resized(*size)
    found = resampled(plane_depth(small), VIEW.shape, max_jump=0.2)
    assert_agree(found, plane_depth(VIEW), rtol=1e-12)


def test_an_edge_is_not_smeared_and_stays_where_it_was():
    small = np.full((9, 12), 3.0)
    small[:, 5:] = 1.0
    expected = np.repeat(np.repeat(small, 10, axis=0), 10, axis=1)
    assert_agree(resampled(small, (90, 120)), expected, rtol=1e-14)


def test_a_hole_keeps_its_size():
    small = np.full((9, 12), 2.0)
    small[4, 6] = np.nan
    found = resampled(small, (90, 120))
    rows, columns = np.nonzero(np.isnan(found))
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (40, 49, 60, 69)
    assert np.ptp(found[np.isfinite(found)]) < 1e-14


def test_the_same_sides_but_for_rounding():
    assert same_aspect((192, 256), (1440, 1920))
    assert same_aspect((384, 512), (500, 667))
    assert not same_aspect((480, 640), (640, 480))
    assert not same_aspect((480, 640), (720, 1280))


@pytest.mark.parametrize("kind", ["z", "distance", "disparity"])
def test_a_scene_reads_depth_of_a_quarter_of_its_pixels(tmp_path, kind):
    small = VIEW.resized(30, 22)  # 22.5 rows do not exist
    z = plane_depth(small)
    raw = {
        "z": z,
        "distance": z / small.directions()[..., 2],
        "disparity": 0.2 * small.fx / z - 1.5,
    }[kind]
    np.save(tmp_path / "d.npy", raw)
    table = {"baseline_m": 0.2, "doffs_px": 1.5} if kind == "disparity" else {}
    model = loaded(tmp_path, kind=kind, max_jump=0.2, **table)
    assert_agree(model.depth["mono"], plane_depth(VIEW), rtol=1e-9)
    # The slope, too: no steps.
    world = VIEW.world_from_camera[:3, :3] @ (-NORMAL / np.linalg.norm(NORMAL))
    assert_agree(model.normals["mono"], np.broadcast_to(world, (90, 120, 3)), atol=1e-4)
    assert model.notes == ("d.npy has 30×22 px for a picture of 120×90: resampled, edges kept",)


def test_depth_of_another_picture_is_refused(tmp_path):
    np.save(tmp_path / "d.npy", np.ones((90, 160)))
    with pytest.raises(InputError, match=r"is 160×90 px but the camera is 120×90.*the same sides"):
        loaded(tmp_path)


# ── relative depth ────────────────────────────────────────────────────────────────────────────


def test_shift_is_metres_after_the_scale(tmp_path):
    z = plane_depth(VIEW)
    np.save(tmp_path / "d.npy", (z - 0.75) / 0.5)
    model = loaded(tmp_path, scale_to_m=0.5, shift_m=0.75)
    assert_agree(model.depth["mono"], z, rtol=1e-12)


def test_shift_of_distances_is_along_the_ray():
    length = plane_depth(VIEW) / VIEW.directions()[..., 2]
    depth = depth_from_raw(length + 2, VIEW, DepthEncoding("distance", shift_m=-2.0))
    assert_agree(depth, plane_depth(VIEW), rtol=1e-12)


def test_with_a_shift_zero_is_a_number_and_what_ends_behind_the_camera_a_hole():
    raw = np.full(VIEW.shape, 1.0)
    raw[0, 0], raw[0, 1], raw[0, 2] = 0.0, -3.0, -2.0
    depth = depth_from_raw(raw, VIEW, DepthEncoding(shift_m=2.0))
    assert depth[0, 0] == 2.0
    assert np.isnan(depth[0, 1:3]).all()
    stated = depth_from_raw(raw, VIEW, DepthEncoding(shift_m=2.0, invalid=(0.0,)))
    assert np.isnan(stated[0, :3]).all()
