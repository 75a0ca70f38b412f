"""Where glass is on the screen: nothing outside its outline is traced."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import MAX_SOLIDS, Ball, LensShape, Slab, Solid
from andon.spaces import View, perpendicular, rotate, transform_points

__all__ = [
    "MOST_CORNERS",
    "Rectangle",
    "middle_pixels_per_radian",
    "outline_of",
    "pixels_per_radian",
    "rectangle_of",
]

Float = NDArray[np.float64]
# x, y, width, height in pixels
Rectangle = tuple[int, int, int, int]

# Smooth outlines reach half a pixel further; the rest is for rounding.
MARGIN_PX = 1.0
# What reaches nearer to the plane of the eye than this may be anywhere in a pinhole picture.
NEAREST_M = 1e-3
# Corners of the polygon around a ball: 0.6 % more than its disc.
BALL_CORNERS = 24
MOST_CORNERS = BALL_CORNERS * MAX_SOLIDS


def pixels_per_radian(view: View, /) -> float:
    """Of the smallest pixel: angles times this are no fewer pixels anywhere."""
    return 1 / float(np.sqrt(view.solid_angles().min()))


def middle_pixels_per_radian(view: View, /) -> float:
    """Of the largest pixel, which is that of the axis: the focal length in pixels."""
    return 1 / float(np.sqrt(view.solid_angles().max()))


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


def outline_of(solids: Sequence[Solid], view: View, /) -> Float:
    """(n ≤ MOST_CORNERS, 2) a convex polygon in pixels around all of `solids`, centres at integers.

    It may reach out of the picture, and is all of it where there is no telling.
    """
    right, low = view.width - 0.5, view.height - 0.5
    whole = np.array([[-0.5, -0.5], [right, -0.5], [right, low], [-0.5, low]])
    if view.projection != "pinhole":
        return whole
    points = np.concatenate([_around(solid, view) for solid in solids])
    if points[:, 2].min() < NEAREST_M:
        return whole
    focal, centre = np.array([view.fx, view.fy]), np.array([view.cx, view.cy])
    return _hull(focal * points[:, :2] / points[:, 2:] + centre)


def _around(solid: Solid, view: View) -> Float:
    """(n, 3) points in the camera's frame, the hull of which hides a body from the eye."""
    if not isinstance(solid.shape, Ball):
        corners = _corners(solid)
        middle = corners.mean(axis=0)
        # A hair larger: pixels on the very edge are glass.
        grown = middle + 1.001 * (corners - middle)
        return transform_points(view.camera_from_world @ solid.world_from_glass, grown)
    middle = transform_points(view.camera_from_world, solid.world_from_glass[:3, 3])
    distance = float(np.linalg.norm(middle))
    if distance <= solid.shape.radius_m:
        return np.zeros((1, 3))
    half = np.arcsin(solid.shape.radius_m / distance) + MARGIN_PX / min(view.fx, view.fy)
    if half >= np.pi / 2:
        return np.zeros((1, 3))
    across, down = perpendicular(middle / distance)
    turn = 2 * np.pi * np.arange(BALL_CORNERS)[:, None] / BALL_CORNERS
    around = np.cos(turn) * across + np.sin(turn) * down
    return middle + distance * np.tan(half) / np.cos(np.pi / BALL_CORNERS) * around


def _hull(points: Float) -> Float:
    """(n, 2) corners of the convex hull in order (Andrew 1979)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    halves: list[list[tuple[float, float]]] = []
    for row in (ordered, ordered[::-1]):
        half: list[tuple[float, float]] = []
        for x, y in row:
            while len(half) > 1 and _turns_right(half[-2], half[-1], (x, y)):
                half.pop()
            half.append((x, y))
        halves.append(half[:-1])
    return np.array(halves[0] + halves[1])


def _turns_right(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    return (b[0] - a[0]) * (c[1] - a[1]) <= (b[1] - a[1]) * (c[0] - a[0])


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
