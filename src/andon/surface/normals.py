"""Normals from a depth image, by a plane fitted to each pixel's own side of every edge.

The same plane says where the surface is, where a depth camera scatters: see `planes_of_depth`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, rotate

__all__ = ["normals_from_depth", "planes_of_depth"]

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
# over 4 px, and by 0.7 % at 8 m, alike over 8, of which 7×7 pixels make waves of 10° and of 60°.
# Where depth is rough, windows of the same shape and of two to 16 times the size are taken, one
# after another, so that beside a crease a pixel's own side grows, and not the mean of both. Each
# is a pass; depth that is smooth has none of them.
STRIDES = (2, 4, 4, 8, 16)
# What is rough, RMS of 1/depth around the first plane, relative: above rounding and stored
# millimetres, below any camera's scatter.
ROUGH = 2e-4
# Noise of the whole picture by `_level`: what smooth balls of 7 px radius have, and what structured
# light at its best. Below the first, what is rough in a picture is relief.
CLEAN, NOISY = 4e-4, 5.5e-4
# From where the planes say better than the pixels how deep it is: at the first (0.15 % RMS) they
# round creases by as much as noise moves pixels.
ROUNDED, SCATTERED = 1e-3, 2e-3
LAG_PX = 2
# A window of twice the size sees about as much noise, four times the curvature, and more of an
# edge. Between the two ratios the normals pass over.
NOISE_RATIO, RELIEF_RATIO = 2.5, 3.5
# The same of the first two windows before anything is set aside: 1 to 1.6 of cameras' noise, 2.5
# of a ball of 12 px in noise of 0.3 %, 3 at a crease.
FLAT_RATIO, CURVED_RATIO = 2.0, 2.4
# The slope's own error, as that of noise that is alike over 6 px: below the first (radians, of a
# surface that faces the camera) a window is wide enough, from the second on a wider one is taken.
ALIKE_PX, ENOUGH, TOO_MUCH = 6.0, 0.04, 0.08
# Pixels off the last window's plane by so many times its scatter count 0.6 in the next.
TOLERANCE = 4.0


def normals_from_depth(depth: Float, view: View, /, *, max_jump: float = 0.05) -> Float:
    """Unit normals (H, W, 3) in the world, turned to the camera; NaN in holes.

    Parameters as of `planes_of_depth`.
    """
    return planes_of_depth(depth, view, max_jump=max_jump)[0]


def planes_of_depth(depth: Float, view: View, /, *, max_jump: float = 0.05) -> tuple[Float, Float]:
    """Unit normals (H, W, 3) in the world, turned to the camera, and depth (H, W) without noise.

    Over a plane with normal n, 1/depth = q·ray with q ∝ n, which is affine in the place where the
    ray meets an image plane. An affine function is fitted to 1/depth in a 7×7 window, weighted by
    distance; pixels across a jump do not count; a second pass takes weight from those off the
    first plane, so that creases stay sharp and noise is averaged. Where depth stays rough, as that
    of depth cameras is, windows are wider.

    The depth of a picture with much noise is that of the planes of 7×7 pixels: one that scatters
    behind its neighbours would lie in their shadow. Else it stays as it is. Holes: NaN in both.

    Parameters
    ----------
    depth : (H, W) metres along `view.rays_planar()`, NaN in holes.
    max_jump : neighbours whose depth differs by more than this share lie on another surface.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        inverse = np.where(depth > 0, 1 / depth, 0.0)
    image = _Pixels(view) if view.projection == "pinhole" else _TangentPlanes(view)
    affine, bent = _fit(inverse, max_jump, None, image)
    affine, scatter = _fit(inverse, max_jump, affine, image)
    level, near = _level(inverse), affine[..., 0]
    if level > CLEAN:
        share = _share_of_noise(inverse, max_jump, bent, scatter, image)
        share *= _between(CLEAN, NOISY, level)
        affine = _widened(inverse, max_jump, affine, scatter, share, image)
    plane = image.plane(affine)
    plane *= np.sign(np.einsum("...i,...i->...", plane, view.rays_planar()))[..., None]
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = -plane / np.linalg.norm(plane, axis=-1, keepdims=True)
        smooth = depth + _between(ROUNDED, SCATTERED, level) * (1 / near - depth)
    normals[~np.isfinite(depth)] = np.nan
    on_it = np.abs(smooth - depth) <= max_jump * depth
    return rotate(view.world_from_camera, normals), np.where(on_it, smooth, depth)


def _between(low: float, high: float, value: float) -> float:
    """0 up to `low`, 1 from `high` on."""
    return min(max((value - low) / (high - low), 0.0), 1.0)


def _level(inverse: Float) -> float:
    """Median of |second difference along both axes|/6 of 1/depth, relative; 0 where none is whole.

    Planes and curved surfaces vanish in it (Immerkær 1996); taken over steps of `LAG_PX`, since
    neighbours err alike.
    """
    import cv2

    side = 2 * LAG_PX + 1
    line = np.zeros(side)
    line[[0, LAG_PX, -1]] = 1.0, -2.0, 1.0
    found = np.abs(cv2.sepFilter2D(inverse, -1, line, line, borderType=cv2.BORDER_REFLECT))
    whole = cv2.erode((inverse > 0).astype(np.uint8), np.ones((side, side))) > 0
    whole[:LAG_PX], whole[-LAG_PX:], whole[:, :LAG_PX], whole[:, -LAG_PX:] = (False,) * 4
    if not whole.any():
        return 0.0
    return float(np.median(np.asarray(found)[whole] / inverse[whole])) / 6


def _share_of_noise(
    inverse: Float, max_jump: float, bent: Float, scatter: Float, image: _Pixels | _TangentPlanes
) -> Float:
    """(H, W) 0…1: 1 where depth is rough by noise, 0 where it is smooth or curved.

    `bent` is the scatter around planes from which nothing was set aside, in which curvature shows.
    """
    _, wide = _fit(inverse, max_jump, None, image, stride=2)
    seen = inverse > 0
    ratio = wide / np.maximum(_noise(bent, seen), ROUGH)
    share = np.clip((CURVED_RATIO - ratio) / (CURVED_RATIO - FLAT_RATIO), 0, 1)
    return share * np.clip(_noise(scatter, seen) / ROUGH - 1, 0, 1) * seen


def _widened(
    inverse: Float,
    max_jump: float,
    affine: Float,
    scatter: Float,
    going_on: Float,
    image: _Pixels | _TangentPlanes,
) -> Float:
    """Value and slopes: of the narrowest window that is wide enough for the noise it sees."""
    wide, before, last = affine, np.maximum(scatter, _noise(scatter, inverse > 0)), 1
    for stride in STRIDES:
        tolerance = np.maximum(RESIDUAL, TOLERANCE * before)
        wide, around = _fit(inverse, max_jump, wide, image, stride=stride, tolerance=tolerance)
        ratio = around / np.maximum(before, ROUGH)
        going_on = going_on * np.clip((RELIEF_RATIO - ratio) / (RELIEF_RATIO - NOISE_RATIO), 0, 1)
        error = before * image.per_radian * ALIKE_PX / (SIGMA_PX * last) ** 2
        going_on *= np.clip((error - ENOUGH) / (TOO_MUCH - ENOUGH), 0, 1)
        affine = affine + going_on[..., None] * (wide - affine)
        before, last = around, stride
        if not going_on.any():
            break
    return affine


def _noise(scatter: Float, seen: NDArray[np.bool_]) -> Float:
    """(H, W) scatter without that of lines, and without gaps in it: what a whole place has.

    An opening of the window's size takes away creases, whose scatter is a line as wide as the
    window. A closing of three times the size fills the treads of quantised depth, which have none.
    """
    side = 2 * RADIUS_PX + 1
    opened = _most(_least(scatter, seen, side), seen, side)
    return _least(_most(opened, seen, 3 * side), seen, 3 * side)


def _least(values: Float, seen: NDArray[np.bool_], side: int) -> Float:
    import cv2

    return np.asarray(cv2.erode(np.where(seen, values, 1.0), np.ones((side, side))), np.float64)


def _most(values: Float, seen: NDArray[np.bool_], side: int) -> Float:
    import cv2

    return np.asarray(cv2.dilate(np.where(seen, values, 0.0), np.ones((side, side))), np.float64)


class _Pixels:
    """The image plane of a pinhole: places are pixels, the same for all."""

    def __init__(self, view: View) -> None:
        self.view, self.per_radian = view, max(view.fx, view.fy)

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
        # A pixel of the tangent plane is a pixel's angle wide.
        self.per_radian = 1.0 / np.sqrt(np.maximum(view.solid_angles(), 1e-12))

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
            if abs(dy) >= height or abs(dx) >= width:
                continue
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
