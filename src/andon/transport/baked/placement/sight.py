"""Which sides of the surface an eye sees, and how large a texel of its picture is there.

A texel that takes the angle α is at most d·α/cos θ long on a surface at the distance d that is
seen under the angle θ off its normal; of a pinhole with focal length f, at most z/(f·cos θ) at the
planar depth z. What is seen *well* has no longer texels than a limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.rays import RayScene
from andon.spaces import View, transform_points
from andon.transport.baked.placement.samples import Samples

__all__ = ["Sight", "in_picture", "seen_from_point", "texels_m"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# Below this cosine (87°) a surface is edge-on: it counts as not seen at all.
EDGE_ON = 0.05
# Rays start this share of the scene's size above the surface: 200 steps of Embree's float32.
LIFT = 1e-5
# A map mixes four texels: the outermost pixel has no neighbours beyond it.
BORDER_PX = 1.0


@dataclass(frozen=True, eq=False)
class Sight:
    """What an eye sees when it looks all around.

    Attributes
    ----------
    sides : (m,) numbers of the sides (`Samples`), increasing within fronts and backs.
    points : (m, 3) metres.
    cosine : (m,) of the angle between the normal and the way to the eye.
    """

    sides: NDArray[np.int64]
    points: Float
    cosine: Float


def seen_from_point(
    eye: Float, samples: Samples, rays: RayScene, size_m: float, /, *, fronts_only: bool = False
) -> Sight:
    """What `eye` (3,) sees of a surface of `size_m` metres."""
    to_eye = eye - samples.points
    distance = np.sqrt((to_eye * to_eye).sum(axis=1))
    height = (to_eye * samples.normals).sum(axis=1)
    cosine = np.abs(height) / np.maximum(distance, 1e-300)
    faces = cosine > EDGE_ON
    if fronts_only:
        faces &= height > 0
    chosen = np.flatnonzero(faces)
    sign = np.where(height[chosen] > 0, 1.0, -1.0)
    starts = samples.points[chosen] + (LIFT * size_m) * sign[:, None] * samples.normals[chosen]
    seen = rays.is_visible(starts, eye)
    chosen, sign = chosen[seen], sign[seen]
    sides = np.where(sign > 0, chosen, chosen + len(samples.points))
    return Sight(sides, samples.points[chosen], cosine[chosen])


def in_picture(view: View, points: Float, /) -> Bool:
    """(m,) a view's picture shows `points` (m, 3), its outermost pixels aside."""
    pixels = view.project(transform_points(view.camera_from_world, points))
    if view.projection == "latlong":
        return np.ones(len(points), bool)
    last = np.array([view.width - 1, view.height - 1], float)
    with np.errstate(invalid="ignore"):
        x, y = ((pixels >= BORDER_PX) & (pixels <= last - BORDER_PX)).T
    return x & y


def texels_m(view: View, points: Float, cosine: Float, /) -> Float:
    """(m,) metres that a texel of the view is at most long on the surface at `points` (m, 3)."""
    local = transform_points(view.camera_from_world, points)
    if view.projection == "pinhole":
        along = np.maximum(local[:, 2], 0) / min(view.fx, view.fy)
    else:
        along = np.sqrt((local * local).sum(axis=1))
        along = along * _texel_angle(view)
    return along / np.maximum(cosine, EDGE_ON)


def _texel_angle(view: View) -> float:
    """Radians that a texel of a fisheye or latlong takes at most."""
    if view.projection == "latlong":
        return max(2 * np.pi / view.width, np.pi / view.height)
    return 1 / min(view.fx, view.fy)
