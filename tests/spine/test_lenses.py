"""Lens distortion, held against OpenCV's own two models."""

import cv2
import numpy as np
import pytest

from andon.lenses import distorted_pixels, undistort
from andon.spaces import View
from comparison import assert_agree

PINHOLE = View("pinhole", 80, 60, 70.0, 72.0, 38.5, 30.5, distortion=(-0.2, 0.05, 0.002, -0.001))
RATIONAL = View(
    "pinhole", 80, 60, 70.0, 72.0, 38.5, 30.5,
    distortion=(-0.2, 0.05, 0.002, -0.001, 0.01, 0.02, -0.01, 0.003),
)  # fmt: skip
FISHEYE = View("fisheye", 80, 60, 30.0, 31.0, 39.0, 29.0, distortion=(0.03, -0.01, 0.004, -0.001))
VIEWS = [PINHOLE, RATIONAL, FISHEYE]
IDS = ["pinhole", "rational", "fisheye"]


def matrix(view):
    return np.array([[view.fx, 0, view.cx], [0, view.fy, view.cy], [0, 0, 1.0]])


def smooth(view):
    x, y = np.moveaxis(view.pixel_grid(), -1, 0)
    return np.stack([np.sin(x / 9) * np.cos(y / 7), x / 80, y / 60], axis=-1).astype(np.float32)


@pytest.mark.parametrize("view", [PINHOLE, RATIONAL], ids=IDS[:2])
def test_pinhole_is_opencvs_undistort(view):
    k, d = matrix(view), np.array(view.distortion)
    map_x, map_y = cv2.initUndistortRectifyMap(k, d, None, k, (80, 60), cv2.CV_32FC1)
    assert_agree(distorted_pixels(view), np.dstack([map_x, map_y]), atol=1e-4)
    inside = np.s_[8:-8, 8:-8]
    expected = cv2.undistort(smooth(view), k, d)
    # OpenCV rounds source pixels to 1/32; the picture's slope is at most 1/7 a pixel.
    assert_agree(undistort(smooth(view), view)[inside], expected[inside], atol=1 / 32 / 7)


def test_fisheye_is_opencvs_equidistant_polynomial():
    """OpenCV's own undistortion ends in a pinhole; ours in an ideal fisheye. The model is one."""
    k, d = matrix(FISHEYE), np.array(FISHEYE.distortion)
    seen = FISHEYE.directions()[..., 2] > 0.05  # OpenCV takes points on a plane before the lens
    rays = FISHEYE.directions()[seen]
    flat = (rays[:, :2] / rays[:, 2:])[:, None]
    expected = cv2.fisheye.distortPoints(flat, k, d)[:, 0]
    assert_agree(distorted_pixels(FISHEYE)[seen], expected, atol=1e-6)


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
def test_undistorting_a_distorted_pixel_gives_it_back(view):
    k, d = matrix(view), np.array(view.distortion)
    pixels = distorted_pixels(view)[10:-10, 10:-10].reshape(-1, 1, 2)
    grid = view.pixel_grid()[10:-10, 10:-10].reshape(-1, 2)
    if view.projection == "pinhole":
        stop = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-12)
        back = cv2.undistortPoints(pixels, k, d, R=np.eye(3), P=k, criteria=stop)[:, 0]
    else:
        flat = cv2.fisheye.undistortPoints(pixels, k, d)[:, 0]
        back = view.project(np.column_stack([flat, np.ones(len(flat))]))
    assert_agree(back, grid, atol=1e-4)


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
def test_the_principal_point_stays(view):
    near = np.rint([view.cy, view.cx]).astype(int)
    shift = distorted_pixels(view)[tuple(near)] - near[::-1]
    assert np.abs(shift).max() < 1e-3


def test_no_distortion_is_no_work():
    view = PINHOLE.undistorted()
    picture = smooth(view)
    assert undistort(picture, view) is picture
    assert (distorted_pixels(view) == view.pixel_grid()).all()


def test_what_the_lens_did_not_see_is_a_hole():
    """A pincushion lens: the corners of the ideal picture lie outside the captured one."""
    view = View("pinhole", 80, 60, 70.0, 70.0, 39.5, 29.5, distortion=(0.5, 0, 0, 0))
    outside = ~((distorted_pixels(view) > 0) & (distorted_pixels(view) < (79, 59))).all(axis=-1)
    assert outside[0, 0]
    assert not outside[30, 40]
    ones = np.ones(view.shape)
    assert (np.isnan(undistort(ones, view)) == outside).mean() > 0.99
    assert undistort((ones * 200).astype(np.uint8), view)[0, 0] == 0


def test_nearest_mixes_no_two_depths():
    columns = np.arange(80) // 4 % 2
    depth = np.where(columns == 0, 1.0, 5.0) * np.ones((60, 1))
    nearest = undistort(depth, PINHOLE, method="nearest")
    assert set(np.unique(nearest[np.isfinite(nearest)]).tolist()) == {1.0, 5.0}
    linear = undistort(depth, PINHOLE)
    assert ((linear > 1.1) & (linear < 4.9)).any()
