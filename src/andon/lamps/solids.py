"""Triangles of simple solids, outside counter-clockwise, with smooth normals."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.lamps.triangles import triangle_areas
from andon.quantities import Geometry
from andon.spaces import perpendicular

__all__ = ["capsule", "disk", "grid", "icosphere", "quads", "quarters"]

Float = NDArray[np.float64]


def quarters(corners: Float, /) -> Float:
    """(4n, 3, 3) triangles through the middles of the sides of (n, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    pieces = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.stack([np.stack(piece, axis=1) for piece in pieces], axis=1).reshape(
        -1, *corners.shape[1:]
    )


@lru_cache(maxsize=8)
def icosphere(cuts: int, /) -> Geometry:
    """The unit sphere as 20·4^cuts triangles: 1 cut 80, 4 cuts 5120. Not to be written to."""
    golden = (1 + np.sqrt(5)) / 2
    # Corners of an icosahedron: three golden rectangles, one in each coordinate plane.
    flat = np.array([[s, t * golden, 0] for s in (-1, 1) for t in (-1, 1)])
    points = np.concatenate([np.roll(flat, k, axis=1) for k in range(3)])
    near = np.abs(np.linalg.norm(points[:, None] - points[None], axis=2) - 2) < 1e-9
    faces = [
        (i, j, k)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    corners: Float = points[np.array(faces)]
    corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    inwards = np.linalg.det(corners) < 0
    corners[inwards] = corners[inwards][:, ::-1]
    for _ in range(cuts):
        corners = quarters(corners)
        corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    # Middles of a side come out the same from both triangles, up to the sign of zero.
    rounded = np.asarray(np.round(corners, 12), np.float64).reshape(-1, 3)
    found, index = np.unique(rounded, axis=0, return_inverse=True)
    unit = found / np.linalg.norm(found, axis=1, keepdims=True)
    return Geometry(unit, index.reshape(-1, 3).astype(np.int32), unit)


def disk(centre: Float, normal: Float, radius_m: float, /, *, corners: int = 96) -> Geometry:
    """A disk of the area π·r² as a fan of `corners` triangles, flat."""
    # An inscribed polygon would be smaller than its circle.
    reach = radius_m * np.sqrt(2 * np.pi / corners / np.sin(2 * np.pi / corners))
    u, v = perpendicular(normal)
    angle = 2 * np.pi * np.arange(corners)[:, None] / corners
    rim = centre + reach * (np.cos(angle) * u + np.sin(angle) * v)
    first = np.arange(corners)
    triangles = np.stack([first, (first + 1) % corners, np.full(corners, corners)], axis=1)
    points = np.vstack([rim, centre])
    normals = np.broadcast_to(normal, points.shape).copy()
    return Geometry(points, triangles.astype(np.int32), normals)


def grid(origin: Float, across: Float, along: Float, columns: int, rows: int, /) -> Geometry:
    """A parallelogram from `origin`; vertex (row, column) is number row·(columns + 1) + column."""
    s = np.linspace(0, 1, columns + 1)
    t = np.linspace(0, 1, rows + 1)
    points = origin + t[:, None, None] * along + s[None, :, None] * across
    normal = np.cross(across, along)
    normal /= np.linalg.norm(normal)
    return Geometry(
        points.reshape(-1, 3),
        quads(rows, columns),
        np.broadcast_to(normal, (points.size // 3, 3)).copy(),
    )


def quads(rows: int, columns: int, /) -> NDArray[np.int32]:
    """(2·rows·columns, 3) indices into a (rows + 1, columns + 1) grid of vertices."""
    index = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    pairs = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], axis=2)
    return pairs.reshape(-1, 3).astype(np.int32)


def capsule(ends: Float, radius_m: float, /, *, around: int = 48, caps: int = 16) -> Geometry:
    """All points within `radius_m` of a line `ends` (2, 3); `caps` rings on each round end."""
    axis = ends[1] - ends[0]
    axis = axis / np.linalg.norm(axis)
    u, v = perpendicular(axis)
    rise = np.linspace(-np.pi / 2, np.pi / 2, 2 * caps + 2)
    rise[: caps + 1] = np.linspace(-np.pi / 2, 0, caps + 1)
    rise[caps + 1 :] = np.linspace(0, np.pi / 2, caps + 1)
    end = np.repeat([0, 1], caps + 1)
    turn = np.linspace(0, 2 * np.pi, around + 1)
    out = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    normals = np.cos(rise)[:, None, None] * out + np.sin(rise)[:, None, None] * axis
    points = ends[end][:, None] + radius_m * normals
    triangles = quads(2 * caps + 1, around)
    flat = points.reshape(-1, 3)
    area = triangle_areas(flat[triangles])
    return Geometry(flat, triangles[area > 1e-12 * area.max()], normals.reshape(-1, 3))
