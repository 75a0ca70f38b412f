"""Lens distortion: which pixel of the picture as captured an undistorted pixel comes from."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View

__all__ = ["captured_rays", "distorted_pixels", "undistort"]

Float = NDArray[np.float64]


def distorted_pixels(view: View, /) -> Float:
    """(H, W, 2) pixel coordinates (column, row) in the captured picture of each undistorted pixel.

    Pinhole: OpenCV's rational, tangential, thin-prism and tilt model. Fisheye: its equidistant
    polynomial θ_d = θ·(1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) (Kannala & Brandt 2006).
    """
    if not view.distortion:
        return view.pixel_grid()
    if view.projection == "fisheye":
        x = (view.pixel_grid() - (view.cx, view.cy)) / (view.fx, view.fy)
        square = np.einsum("...i,...i->...", x, x)
        k1, k2, k3, k4 = view.distortion
        factor = 1 + square * (k1 + square * (k2 + square * (k3 + square * k4)))
        return x * factor[..., None] * (view.fx, view.fy) + (view.cx, view.cy)
    import cv2

    matrix = np.array([[view.fx, 0, view.cx], [0, view.fy, view.cy], [0, 0, 1.0]])
    points = view.rays_planar().reshape(-1, 1, 3)
    still = np.zeros(3)
    pixels, _ = cv2.projectPoints(points, still, still, matrix, np.array(view.distortion))
    return np.asarray(pixels, np.float64).reshape(*view.shape, 2)


def captured_rays(view: View, /) -> Float:
    """(H, W, 3) camera-frame rays with z = 1 of a pinhole's pixels as captured, lens and all.

    OpenCV inverts the lens by fixed-point steps: 100 of them, or 1e-12 of the focal length.
    """
    if not view.distortion:
        return view.rays_planar()
    import cv2

    matrix = np.array([[view.fx, 0, view.cx], [0, view.fy, view.cy], [0, 0, 1.0]])
    until = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-12)
    pixels = view.pixel_grid().reshape(-1, 1, 2)
    points = cv2.undistortPointsIter(
        pixels, matrix, np.array(view.distortion), np.eye(3), np.eye(3), until
    )
    rays = np.ones((*view.shape, 3))
    rays[..., :2] = np.asarray(points).reshape(*view.shape, 2)
    return rays


def undistort(
    picture: NDArray[Any], view: View, /, *, method: Literal["linear", "nearest"] = "linear"
) -> NDArray[Any]:
    """The picture (H, W[, C]) of `view.undistorted()`; NaN (or 0) where the lens saw nothing.

    Use ``nearest`` for depth: a mean of two depths is the depth of nothing.
    """
    if not view.distortion:
        return picture
    import cv2

    source = distorted_pixels(view).astype(np.float32)
    border = float("nan") if np.issubdtype(picture.dtype, np.floating) else 0
    return cv2.remap(
        picture,
        source[..., 0],
        source[..., 1],
        cv2.INTER_LINEAR if method == "linear" else cv2.INTER_NEAREST,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=(border,) * 4,
    )
