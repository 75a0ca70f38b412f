"""Normals from a depth image, by a plane fitted to each pixel's own side of every edge."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, rotate

__all__ = ["normals_from_depth"]

Float = NDArray[np.float64]

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

    Over a plane with normal n, 1/depth = q·ray with q ∝ n, which for a pinhole is affine in the
    pixel. An affine function is fitted to 1/depth in a 7×7 window, weighted by distance; pixels
    across a jump do not count; a second pass takes weight from those off the first plane, so that
    creases stay sharp and noise is averaged.

    Parameters
    ----------
    depth : (H, W) metres along `view.rays_planar()`, NaN in holes.
    max_jump : neighbours whose depth differs by more than this share lie on another surface.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        inverse = np.where(depth > 0, 1 / depth, 0.0)
    affine = _fit(inverse, max_jump, None)
    affine = _fit(inverse, max_jump, affine)
    plane = _plane_from_affine(affine, view)
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = -plane / np.linalg.norm(plane, axis=-1, keepdims=True)
    normals[~np.isfinite(depth)] = np.nan
    return rotate(view.world_from_camera, normals)


def _fit(inverse: Float, max_jump: float, previous: Float | None) -> Float:
    """(H, W, 3): value and slopes per column and row of 1/depth around each pixel."""
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
            if previous is not None:
                value, slope_x, slope_y = np.moveaxis(previous[centre], -1, 0)
                predicted = value + slope_x * dx + slope_y * dy
                residual = (predicted - o) / (RESIDUAL * np.maximum(c, 1e-12))
                weight = weight * np.exp(-0.5 * np.minimum(residual**2, 60.0))
            terms = (1, dx, dy, dx * dx, dx * dy, dy * dy)
            for index, term in enumerate(terms):
                if term:
                    sums[(index, *centre)] += term * weight
            for index, term in enumerate((1, dx, dy)):
                if term:
                    sums[(6 + index, *centre)] += term * weight * o
    return _solve(sums)


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


def _plane_from_affine(affine: Float, view: View) -> Float:
    """q (H, W, 3) in the camera frame with q·ray = value and q·∂ray = slopes."""
    rays = view.rays_planar()
    along_x = np.gradient(rays, axis=1) if view.width > 1 else np.zeros_like(rays)
    along_y = np.gradient(rays, axis=0) if view.height > 1 else np.zeros_like(rays)
    # Cramer's rule: the rows are ray, ∂ray/∂column, ∂ray/∂row; the common determinant only scales
    # q, and its sign is that of 1/depth = q·ray > 0.
    q = (
        affine[..., :1] * np.cross(along_x, along_y)
        + affine[..., 1:2] * np.cross(along_y, rays)
        + affine[..., 2:] * np.cross(rays, along_x)
    )
    return q * np.sign(np.einsum("...i,...i->...", q, rays))[..., None]
