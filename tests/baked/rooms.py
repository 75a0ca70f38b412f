"""Rooms as plans, and an independent count of what cameras see."""

import numpy as np

from andon.quantities import Geometry, merged
from andon.rays import RayScene, face_normals
from worlds import points_on

__all__ = ["L_SHAPE", "TWO_ROOMS", "finer_coverage", "plan_area", "plan_room", "random_sides"]

HEIGHT = 2.5
# A plan: its outline (x, z), and the rectangles (x, x, z, z) that fill it.
L_SHAPE = (
    [(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)],
    [(0, 6, 0, 2), (0, 2, 2, 6)],
)
TWO_ROOMS = (
    [(0, 0), (4, 0), (4, 1.5), (4.2, 1.5), (4.2, 0), (8, 0),
     (8, 4), (4.2, 4), (4.2, 2.4), (4, 2.4), (4, 4), (0, 4)],
    [(0, 4, 0, 4), (4, 4.2, 1.5, 2.4), (4.2, 8, 0, 4)],
)  # fmt: skip


def _quad(a, b, c, d, inside):
    """Two triangles that face a point."""
    positions = np.array([a, b, c, d], float)
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    quad = Geometry(positions, triangles)
    if face_normals(quad)[0] @ (np.asarray(inside) - positions.mean(axis=0)) < 0:
        quad = Geometry(positions, triangles[:, ::-1].copy())
    return quad


def plan_room(plan):
    """A closed room over a plan, all of whose sides face inwards."""
    outline, rectangles = plan
    parts = []
    for (ax, az), (bx, bz) in zip(outline, outline[1:] + outline[:1], strict=True):
        # The outline runs with the room on its left as seen from below: towards (−dz, dx).
        middle = np.array([(ax + bx) / 2, HEIGHT / 2, (az + bz) / 2])
        inside = middle + 1e-3 * np.array([-(bz - az), 0, bx - ax])
        parts.append(_quad((ax, 0, az), (bx, 0, bz), (bx, HEIGHT, bz), (ax, HEIGHT, az), inside))
    for low, high, near, far in rectangles:
        for y in (0, HEIGHT):
            corners = [(low, y, near), (high, y, near), (high, y, far), (low, y, far)]
            parts.append(_quad(*corners, (low, HEIGHT / 2, near)))
    return merged(*parts)


def plan_area(plan):
    """Square metres of all inner sides."""
    outline, rectangles = plan
    ends = np.array(outline, float)
    around = np.linalg.norm(ends - np.roll(ends, 1, axis=0), axis=1).sum()
    return around * HEIGHT + 2 * sum((b - a) * (d - c) for a, b, c, d in rectangles)


def random_sides(geometry, count, seed):
    """Points and normals of both sides, by chance with the area; not stratified."""
    points, normals = points_on(geometry, count, seed)
    return np.concatenate([points, points]), np.concatenate([normals, -normals])


def _sees(rays, eye, points, normals):
    facing = np.einsum("ij,ij->i", eye - points, normals) > 0
    seen = np.zeros(len(points), bool)
    seen[facing] = rays.is_visible(points[facing] + 1e-4 * normals[facing], eye)
    return seen


def _longest_texel(view, points, normals):
    """Metres on the tangent plane between the rays through a point and half a pixel beside it."""
    local = (points - view.position) @ view.world_from_camera[:3, :3]
    pixels = view.project(local)
    across = local / np.linalg.norm(local, axis=1, keepdims=True)
    plane = normals @ view.world_from_camera[:3, :3]
    height = np.einsum("ij,ij->i", local, plane)
    longest = np.zeros(len(points))
    for step in ([0.01, 0.0], [0.0, 0.01]):
        ways = view.directions_at(pixels + step)
        # Distances along both rays to the plane: at the point itself, and beside it.
        beside = ways * (height / np.einsum("ij,ij->i", ways, plane))[:, None]
        here = across * (height / np.einsum("ij,ij->i", across, plane))[:, None]
        longest = np.maximum(longest, np.linalg.norm(beside - here, axis=1) / 0.01)
    return longest


def finer_coverage(geometry, suggested, limit_m, *, count=12000, seed=99):
    """Share of what any place sees that a view shows in texels up to `limit_m`, recounted."""
    rays = RayScene(geometry)
    points, normals = random_sides(geometry, count, seed)
    shown = np.zeros(len(points), bool)
    for view in suggested.views:
        pixels = view.project((points - view.position) @ view.world_from_camera[:3, :3])
        with np.errstate(invalid="ignore"):
            inside = ((pixels >= -0.5) & (pixels <= [view.width - 0.5, view.height - 0.5])).all(1)
        seen = inside & _sees(rays, view.position, points, normals)
        seen[seen] = _longest_texel(view, points[seen], normals[seen]) <= limit_m
        shown |= seen
    reachable = shown.copy()
    for place in suggested.candidates:
        rest = np.flatnonzero(~reachable)
        reachable[rest] = _sees(rays, place, points[rest], normals[rest])
    return shown.sum() / reachable.sum()
