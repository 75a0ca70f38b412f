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
# Depth cameras scatter over several pixels at once: a Kinect by 0.3 % of its depth at 1.4 m, alike
# over 4 px, of which 7×7 pixels make waves of some 10°. Where depth is rough, a window of the same
# shape and four times the size is taken: radius 12 px. It takes three passes more; depth that is
# smooth has none of them. Steps of quantised depth that are as wide as the window stay: a Kinect's
# beyond some 4 m.
WIDE = 4
# What is rough, RMS of 1/depth around the first plane, relative: above rounding and stored
# millimetres, below any camera's scatter. Noise is all over a place, a crease is a line: the least
# of a window counts.
ROUGH = 2e-4
# Of noise the wide window sees no more than up to this many times what the narrow one does; of
# curvature 16 times as much, and of an edge more. Between the two the normals pass over.
NOISE_RATIO, RELIEF_RATIO = 2.5, 5.0


def normals_from_depth(depth: Float, view: View, /, *, max_jump: float = 0.05) -> Float:
    """Unit normals (H, W, 3) in the world, turned to the camera; NaN in holes.

    Over a plane with normal n, 1/depth = q·ray with q ∝ n, which is affine in the place where the
    ray meets an image plane. An affine function is fitted to 1/depth in a 7×7 window, weighted by
    distance; pixels across a jump do not count; a second pass takes weight from those off the
    first plane, so that creases stay sharp and noise is averaged. Where depth stays rough, as that
    of depth cameras is, the window is four times as large.

    Parameters
    ----------
    depth : (H, W) metres along `view.rays_planar()`, NaN in holes.
    max_jump : neighbours whose depth differs by more than this share lie on another surface.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        inverse = np.where(depth > 0, 1 / depth, 0.0)
    image = _Pixels(view) if view.projection == "pinhole" else _TangentPlanes(view)
    affine, _ = _fit(inverse, max_jump, None, image)
    affine, scatter = _fit(inverse, max_jump, affine, image)
    if (scatter > ROUGH).any():
        affine = _where_rough(inverse, max_jump, affine, scatter, image)
    plane = image.plane(affine)
    plane *= np.sign(np.einsum("...i,...i->...", plane, view.rays_planar()))[..., None]
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = -plane / np.linalg.norm(plane, axis=-1, keepdims=True)
    normals[~np.isfinite(depth)] = np.nan
    return rotate(view.world_from_camera, normals)


def _where_rough(
    inverse: Float, max_jump: float, narrow: Float, scatter: Float, image: _Pixels | _TangentPlanes
) -> Float:
    """Value and slopes: of the wide window where its scatter is that of noise."""
    import cv2

    tolerance = np.maximum(RESIDUAL, 4 * scatter)
    wide, around = narrow, scatter
    # In steps, so that beside a crease a pixel's own side grows, and not the mean of both.
    for stride in (WIDE // 2, WIDE, WIDE):
        wide, around = _fit(inverse, max_jump, wide, image, stride=stride, tolerance=tolerance)
    ratio = around / np.maximum(scatter, ROUGH)
    share = np.clip((RELIEF_RATIO - ratio) / (RELIEF_RATIO - NOISE_RATIO), 0, 1)
    side = np.ones((2 * RADIUS_PX + 1, 2 * RADIUS_PX + 1), np.uint8)
    least = np.asarray(cv2.erode(np.where(inverse > 0, scatter, 1.0), side), np.float64)
    share *= np.clip(least / ROUGH - 1, 0, 1)
    return narrow + share[..., None] * (wide - narrow)


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
    inverse: Float,
    max_jump: float,
    previous: Float | None,
    image: _Pixels | _TangentPlanes,
    *,
    stride: int = 1,
    tolerance: Any = RESIDUAL,
) -> tuple[Float, Float]:
    """Value and slopes (H, W, 3) of 1/depth around each pixel, in the places of `image`.

    And their relative RMS scatter (H, W). Of a window of `stride` times the size every stride-th
    pixel counts.
    """
    height, width = inverse.shape
    sums = np.zeros((10, height, width))
    tolerance = np.broadcast_to(tolerance, inverse.shape)
    offsets = range(-RADIUS_PX * stride, RADIUS_PX * stride + 1, stride)
    sigma_px = SIGMA_PX * stride

    def at_plane(centre: Window, u: Any, v: Any) -> Float:
        assert previous is not None
        at, slope_u, slope_v = np.moveaxis(previous[centre], -1, 0)
        return at + slope_u * u + slope_v * v

    for dy in offsets:
        for dx in offsets:
            rows, columns = _overlap(height, dy), _overlap(width, dx)
            centre, other = (rows[0], columns[0]), (rows[1], columns[1])
            c, o = inverse[centre], inverse[other]
            weight = np.exp(-(dx * dx + dy * dy) / (2 * sigma_px**2)) * ((c > 0) & (o > 0))
            u, v, along = image.place(centre, other, dx, dy)
            value = o / along
            # A step from the pixel itself; of a slope over a wide window, from its plane.
            from_here = c if previous is None or stride == 1 else at_plane(centre, u, v) * along
            weight *= np.abs(o - from_here) <= max_jump * np.maximum(o, from_here)
            if previous is not None:
                residual = (at_plane(centre, u, v) - value) / (
                    tolerance[centre] * np.maximum(c, 1e-12)
                )
                weight *= np.exp(-0.5 * np.minimum(residual**2, 60.0))
            _add(sums, centre, weight, (1, u, v, u * u, u * v, v * v))
            _add(sums[6:], centre, weight * value, (1, u, v, value))
    affine = _solve(sums[:9])
    return affine, _scatter(affine, sums, inverse)


def _scatter(affine: Float, sums: Float, inverse: Float) -> Float:
    """(H, W) RMS of the residuals over 1/depth: Σw·(value − plane)²/Σw, 0 in holes."""
    # Rows of the normal equations hold at the solution, so one of the two products is left.
    square = sums[9] - np.einsum("hwi,ihw->hw", affine, sums[6:9])
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.sqrt(np.maximum(square, 0) / sums[0]) / inverse
    return np.nan_to_num(share, nan=0.0, posinf=0.0)


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
