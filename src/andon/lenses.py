"""Lens distortion: which pixel of the picture as captured an undistorted pixel comes from."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View

__all__ = ["captured_rays", "distorted_pixels", "undistort"]

Float = NDArray[np.float64]

INVERSION_STEPS = 50


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
    return _projected(view.rays_planar(), view) * (view.fx, view.fy) + (view.cx, view.cy)


def captured_rays(view: View, /) -> Float:
    """(H, W, 3) camera-frame rays with z = 1 of a pinhole's pixels as captured, lens and all.

    Inverted by fixed-point steps to 1e-12 of the focal length, or 50 of them: beyond the edge of
    a strong lens's model there is no ray, and what is given there means nothing.
    """
    rays = view.rays_planar()
    target = rays[..., :2].copy()
    for _ in range(INVERSION_STEPS if view.distortion else 0):
        error = _projected(rays, view) - target
        rays[..., :2] -= error
        if np.abs(error).max() < 1e-12:
            break
    return rays


def _projected(rays: Float, view: View) -> Float:
    """(H, W, 2) image of rays (H, W, 3) with z = 1 behind a pinhole's lens, in focal lengths."""
    import cv2

    still = np.zeros(3)
    points, _ = cv2.projectPoints(
        rays.reshape(-1, 1, 3), still, still, np.eye(3), np.array(view.distortion)
    )
    return np.asarray(points, np.float64).reshape(*rays.shape[:2], 2)


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
