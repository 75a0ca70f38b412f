"""Where glass is on the screen: nothing outside that rectangle is traced."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Ball, LensShape, Slab, Solid
from andon.spaces import View, rotate, transform_points

__all__ = ["Rectangle", "rectangle_of"]

Float = NDArray[np.float64]
# x, y, width, height in pixels
Rectangle = tuple[int, int, int, int]

# Smooth outlines reach half a pixel further; the rest is for rounding.
MARGIN_PX = 1.0
# What reaches nearer to the plane of the eye than this may be anywhere in a pinhole picture.
NEAREST_M = 1e-3


def rectangle_of(solids: Sequence[Solid], view: View, /) -> Rectangle | None:
    """The pixels that may see `solids`; None for none.

    Of pinhole views the rectangle around each outline; other projections count as covered.
    """
    whole = (0, 0, view.width, view.height)
    if view.projection != "pinhole":
        return whole if solids else None
    bounds = [_bounds(solid, view) for solid in solids]
    low = np.min([low for low, _ in bounds], axis=0, initial=np.inf) - MARGIN_PX
    high = np.max([high for _, high in bounds], axis=0, initial=-np.inf) + MARGIN_PX
    if len(bounds) == 0:
        return None
    # Pixel centres are at integers.
    x0, y0 = np.clip(np.floor(low + 0.5), 0, whole[2:]).astype(int)
    x1, y1 = np.clip(np.ceil(high + 0.5), 0, whole[2:]).astype(int)
    return (int(x0), int(y0), int(x1 - x0), int(y1 - y0)) if x1 > x0 and y1 > y0 else None


def _bounds(solid: Solid, view: View) -> tuple[Float, Float]:
    """(2,) lowest and highest pixel coordinates, infinite where there is no telling."""
    nowhere, everywhere = np.full(2, np.inf), np.full(2, np.inf)
    if isinstance(solid.shape, Ball):
        low, high = _of_sphere(solid, view)
    else:
        corners = transform_points(view.camera_from_world @ solid.world_from_glass, _corners(solid))
        if corners[:, 2].max() <= 0:
            return nowhere, -nowhere
        if corners[:, 2].min() < NEAREST_M:
            return -everywhere, everywhere
        places = corners[:, :2] / corners[:, 2:]
        low, high = places.min(axis=0), places.max(axis=0)
    focal, centre = np.array([view.fx, view.fy]), np.array([view.cx, view.cy])
    return focal * low + centre, focal * high + centre


def _of_sphere(solid: Solid, view: View) -> tuple[Float, Float]:
    """(2,) tangents of the planes through the eye that touch a ball, across and down."""
    assert isinstance(solid.shape, Ball)
    to_middle = solid.world_from_glass[:3, 3] - view.position
    middle = rotate(view.camera_from_world, to_middle)
    if middle[2] <= -solid.shape.radius_m:
        return np.full(2, np.inf), np.full(2, -np.inf)
    reach = np.hypot(middle[:2], middle[2])
    with np.errstate(invalid="ignore"):
        half = np.where(
            reach > solid.shape.radius_m,
            np.arcsin(np.minimum(solid.shape.radius_m / reach, 1)),
            np.pi,
        )
    angle = np.arctan2(middle[:2], middle[2])
    low, high = angle - half, angle + half
    limit = np.pi / 2 - 1e-6
    return (
        np.where(low > -limit, np.tan(np.clip(low, -limit, limit)), -np.inf),
        np.where(high < limit, np.tan(np.clip(high, -limit, limit)), np.inf),
    )


def _corners(solid: Solid) -> Float:
    """(8, 3) of the box around a body in its own frame."""
    match solid.shape:
        case Ball(radius):
            low, high = np.full(3, -radius), np.full(3, radius)
        case Slab(half):
            low, high = -half, half
        case LensShape(radius, curvature, thickness):
            low, high = _lens_box(radius, curvature, thickness)
        case shape:
            positions = shape.geometry.positions
            low, high = positions.min(axis=0), positions.max(axis=0)
    steps = np.stack(np.meshgrid(*[[0, 1]] * 3, indexing="ij"), axis=-1).reshape(8, 3)
    return low + steps * (high - low)


def _lens_box(
    radius: float, curvature: tuple[float, float], thickness: float
) -> tuple[Float, Float]:
    """Corners (3,) of the box around a lens; hollow caps stand out at the rim."""
    ends = [
        max(thickness / 2, thickness / 2 - bend + np.copysign(np.sqrt(bend**2 - radius**2), bend))
        for bend in curvature
    ]
    return np.array([-radius, -radius, -ends[1]]), np.array([radius, radius, ends[0]])
