"""A depth image as triangles, cut at jumps: what casts shadows where there is no mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.spaces import View, transform_points

__all__ = ["thickened", "triangulate_depth"]

Float = NDArray[np.float64]


def triangulate_depth(
    depth: Float,
    view: View,
    /,
    *,
    max_jump: float = 0.05,
    normals: Float | None = None,
) -> Geometry:
    """Geometry in the world from depth (H, W): two triangles per 2×2 pixels, none across a jump.

    ::

        a───b      a triangle stands where its three pixels have a depth and the farthest is at
        │ ╲ │      most (1 + max_jump) times the nearest; triangles face the camera
        c───d

    A latlong picture goes all around: its last column is joined to its first.

    Parameters
    ----------
    normals : (H, W, 3) unit, world, finite where depth is: kept at the corners of a sheet, so
        that another eye sees the same slopes; without them triangles are flat.
    """
    height, width = depth.shape
    index = np.arange(height * width, dtype=np.int64).reshape(height, width)
    if view.projection == "latlong" and width > 2:  # of two columns both sides are joined anyway
        index = np.concatenate([index, index[:, :1]], axis=1)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    corners = np.concatenate(
        [np.stack([a, c, d], axis=-1).reshape(-1, 3), np.stack([a, d, b], axis=-1).reshape(-1, 3)]
    )
    z = depth.ravel()[corners]
    with np.errstate(invalid="ignore"):
        kept = z.max(axis=1) <= (1 + max_jump) * z.min(axis=1)  # False where a depth is NaN
    triangles = corners[kept]
    used, triangles = np.unique(triangles, return_inverse=True)
    rays = view.rays_planar().reshape(-1, 3)[used]
    points = rays * depth.ravel()[used, None]
    triangles = triangles.reshape(-1, 3)
    corner_normals = None if normals is None else normals.reshape(-1, 3)[used]
    world = transform_points(view.world_from_camera, points)
    return Geometry(world, triangles.astype(np.int32), corner_normals)


def thickened(sheet: Geometry, eye: Float, thickness_m: float, /) -> Geometry:
    """The sheet doubled `thickness_m` behind itself as seen from `eye` (3,), rims closed.

    Light from behind then does not slip through cuts. A wall stands along every edge that has one
    triangle only.
    """
    points, triangles = sheet.positions, sheet.triangles.astype(np.int64)
    count, rays = len(points), points - eye
    unit = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    key = np.sort(edges, axis=1) @ np.array([count, 1])
    _, first, times = np.unique(key, return_index=True, return_counts=True)
    rim = edges[first[times == 1]]
    back = rim + count
    walls = np.concatenate(
        [
            np.stack([rim[:, 1], rim[:, 0], back[:, 0]], axis=1),
            np.stack([rim[:, 1], back[:, 0], back[:, 1]], axis=1),
        ]
    )
    both = np.concatenate([triangles, triangles[:, ::-1] + count, walls])
    return Geometry(np.concatenate([points, points + unit * thickness_m]), both.astype(np.int32))
