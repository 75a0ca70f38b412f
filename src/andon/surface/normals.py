"""Normals from a depth image, by a plane fitted to each pixel's own side of every edge."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, rotate

__all__ = ["normals_from_depth"]

Float = NDArray[np.float64]
Window = tuple[slice, slice]

RADIUS_PX = 3
# Spatial weight: σ = half the radius, so that the middle of the window's rim counts 0.14.
SIGMA_PX = 1.5
# Second pass: a neighbour off the first plane by this share of its depth counts 0.6. Structured
# light and stereo at a few metres scatter by 0.1–0.5 %.
RESIDUAL = 0.003
# Where the window holds fewer than three pixels in a row and in a column, the slope that is not
# measured is drawn to zero (in 1/depth) with this weight of one pixel.
PRIOR = 1e-6


def normals_from_depth(depth: Float, view: View, /, *, max_jump: float = 0.05) -> Float:
    """Unit normals (H, W, 3) in the world, turned to the camera; NaN in holes.

    Over a plane with normal n, 1/depth = q·ray with q ∝ n, which is affine in the place where the
    ray meets an image plane. An affine function is fitted to 1/depth in a 7×7 window, weighted by
    distance; pixels across a jump do not count; a second pass takes weight from those off the
    first plane, so that creases stay sharp and noise is averaged.

    Parameters
    ----------
    depth : (H, W) metres along `view.rays_planar()`, NaN in holes.
    max_jump : neighbours whose depth differs by more than this share lie on another surface.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        inverse = np.where(depth > 0, 1 / depth, 0.0)
    image = _Pixels(view) if view.projection == "pinhole" else _TangentPlanes(view)
    affine = _fit(inverse, max_jump, None, image)
    affine = _fit(inverse, max_jump, affine, image)
    plane = image.plane(affine)
    plane *= np.sign(np.einsum("...i,...i->...", plane, view.rays_planar()))[..., None]
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = -plane / np.linalg.norm(plane, axis=-1, keepdims=True)
    normals[~np.isfinite(depth)] = np.nan
    return rotate(view.world_from_camera, normals)


class _Pixels:
    """The image plane of a pinhole: places are pixels, the same for all."""

    def __init__(self, view: View) -> None:
        self.view = view

    def place(self, centre: Window, other: Window, dx: int, dy: int) -> tuple[Any, Any, Any]:
        """Offset of `other` from `centre`, and what 1/depth is divided by to be affine in it."""
        return dx, dy, 1.0

    def plane(self, affine: Float) -> Float:
        """q (H, W, 3) in the camera frame, from value and slopes of q·ray."""
        view = self.view
        rays = view.rays_planar()
        x, y = affine[..., 1] * view.fx, affine[..., 2] * view.fy
        return np.stack([x, y, affine[..., 0] - x * rays[..., 0] - y * rays[..., 1]], axis=-1)


class _TangentPlanes:
    """Fisheye and latlong: each pixel has its own image plane, where the sphere is touched by it.

    Over a plane, q·ray is affine in the pixel only for a pinhole; in these it is everywhere.
    """

    def __init__(self, view: View) -> None:
        self.rays = view.directions()
        # Any two directions across the ray, in units of a pixel's angle as pinhole's are pixels.
        aside = np.where(np.abs(self.rays[..., 1:2]) < 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
        right = np.cross(self.rays, aside)
        right /= np.linalg.norm(right, axis=-1, keepdims=True)
        per_pixel = 1 / np.sqrt(np.maximum(view.solid_angles(), 1e-12))[..., None]
        self.right, self.down = right * per_pixel, np.cross(self.rays, right) * per_pixel

    def place(self, centre: Window, other: Window, dx: int, dy: int) -> tuple[Any, Any, Any]:
        """Offset of `other` from `centre`, and what 1/depth is divided by to be affine in it."""
        ray = self.rays[other]
        along = np.maximum(np.einsum("...i,...i->...", ray, self.rays[centre]), 1e-3)
        u = np.einsum("...i,...i->...", ray, self.right[centre]) / along
        return u, np.einsum("...i,...i->...", ray, self.down[centre]) / along, along

    def plane(self, affine: Float) -> Float:
        """q (H, W, 3) in the camera frame, from value and slopes of q·ray."""
        value, u, v = (affine[..., i, None] for i in range(3))
        return value * self.rays + u * self.right + v * self.down


def _fit(
    inverse: Float, max_jump: float, previous: Float | None, image: _Pixels | _TangentPlanes
) -> Float:
    """(H, W, 3): value and slopes of 1/depth around each pixel, in the places of `image`."""
    height, width = inverse.shape
    sums = np.zeros((9, height, width))
    offsets = range(-RADIUS_PX, RADIUS_PX + 1)
    for dy in offsets:
        for dx in offsets:
            rows, columns = _overlap(height, dy), _overlap(width, dx)
            centre, other = (rows[0], columns[0]), (rows[1], columns[1])
            c, o = inverse[centre], inverse[other]
            near = np.abs(o - c) <= max_jump * np.maximum(o, c)
            weight = np.exp(-(dx * dx + dy * dy) / (2 * SIGMA_PX**2)) * (near & (c > 0) & (o > 0))
            u, v, along = image.place(centre, other, dx, dy)
            value = o / along
            if previous is not None:
                at, slope_u, slope_v = np.moveaxis(previous[centre], -1, 0)
                residual = (at + slope_u * u + slope_v * v - value) / (
                    RESIDUAL * np.maximum(c, 1e-12)
                )
                weight = weight * np.exp(-0.5 * np.minimum(residual**2, 60.0))
            _add(sums, centre, weight, (1, u, v, u * u, u * v, v * v))
            _add(sums[6:], centre, weight * value, (1, u, v))
    return _solve(sums)


def _add(sums: Float, centre: Window, weight: Float, terms: tuple[Any, ...]) -> None:
    for index, term in enumerate(terms):
        if np.any(term):
            sums[(index, *centre)] += term * weight


def _overlap(size: int, shift: int) -> tuple[slice, slice]:
    """Slices of a pixel and of its neighbour `shift` away, both inside the picture."""
    return slice(max(0, -shift), size - max(0, shift)), slice(max(0, shift), size + min(0, shift))


def _solve(sums: Float) -> Float:
    """The 3×3 normal equations, means removed first so that two unknowns remain."""
    w, wx, wy, wxx, wxy, wyy, t, tx, ty = sums
    with np.errstate(invalid="ignore", divide="ignore"):
        mx, my, mt = wx / w, wy / w, t / w
    xx, xy, yy = wxx - w * mx * mx + PRIOR, wxy - w * mx * my, wyy - w * my * my + PRIOR
    xt, yt = tx - w * mx * mt, ty - w * my * mt
    determinant = xx * yy - xy * xy
    slope_x = (xt * yy - yt * xy) / determinant
    slope_y = (yt * xx - xt * xy) / determinant
    return np.nan_to_num(np.stack([mt - slope_x * mx - slope_y * my, slope_x, slope_y], axis=-1))
