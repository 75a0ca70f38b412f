"""Maps from the frame's own cameras, a little wider than its pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.rays import RayScene
from andon.spaces import View

__all__ = ["map_view", "shown_points"]

Float = NDArray[np.float64]

# Of the tangents of the frame's angles (of a fisheye: the angles): its borders are inside then.
WIDER = 1.1
# Pixels along the longer side of the sparse picture that tells what a view shows.
SPARSE_PX = 48


def map_view(view: View, map_size_px: int, /) -> View:
    """The map that is seen from where `view` is, its longer side `map_size_px`."""
    factor = map_size_px / max(view.width, view.height)
    size = [max(1, round(side * factor)) for side in (view.width, view.height)]
    small = view.undistorted().resized(*size)
    if view.projection == "latlong" or _goes_round(small):
        return small
    return replace(small, fx=small.fx / WIDER, fy=small.fy / WIDER)


def _goes_round(view: View) -> bool:
    """A wider fisheye would see some directions twice."""
    if view.projection != "fisheye":
        return False
    corners = np.array([[0, 0], [view.width - 1, 0], [0, view.height - 1], view.shape[::-1]])
    angles = np.hypot(*((corners - (view.cx, view.cy)) / (view.fx, view.fy)).T)
    return bool(angles.max() * WIDER > np.pi)


def shown_points(view: View, rays: RayScene, /) -> tuple[Float, Float]:
    """(m, 3) metres and (m, 3) unit normals towards the view of what a sparse grid of pixels sees.

    None where the view sees nothing.
    """
    factor = min(1.0, SPARSE_PX / max(view.width, view.height))
    sparse = view.undistorted().resized(
        max(1, round(view.width * factor)), max(1, round(view.height * factor))
    )
    origin, directions = sparse.rays_world()
    directions = directions.reshape(-1, 3)
    hits = rays.first_hits(np.broadcast_to(origin, directions.shape), directions)
    hit = hits.triangle >= 0
    directions = directions[hit]
    points = origin + directions * hits.distance[hit, None]
    a, b, c = np.moveaxis(
        rays.geometry.positions[rays.geometry.triangles[hits.triangle[hit]]], 1, 0
    )
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, length, out=-directions, where=length > 0)
    away = (normals * directions).sum(axis=1) > 0
    normals[away] *= -1
    return points, normals
