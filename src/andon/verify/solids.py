"""Closed triangle meshes for the test room: every edge is shared by exactly two triangles.

All solids are centred on the origin (the lathe stands on its profile's own heights), in metres,
counter-clockwise from outside, with shared vertices. Sizes are > 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.lamps.solids import quads
from andon.lamps.triangles import area_vectors

__all__ = ["Solid", "box", "facet_normals", "icosphere", "lathe", "panel", "torus", "wedge", "weld"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

# Vertices closer than this are one vertex: far below any size here, far above rounding.
WELD_M = 1e-9


@dataclass(frozen=True)
class Solid:
    """A closed mesh, or one panel of the room's shell.

    Attributes
    ----------
    positions : (n, 3) float64 metres.
    triangles : (m, 3) int32, counter-clockwise from outside.
    curved : bool, the surface is smooth and may carry interpolated normals.
    """

    positions: Float
    triangles: Int
    curved: bool = False

    def moved(
        self,
        at: ArrayLike,
        *,
        yaw_degrees: float = 0.0,
        pitch_degrees: float = 0.0,
        roll_degrees: float = 0.0,
    ) -> Solid:
        """Turned about z (roll), then x (pitch), then y (yaw), then moved to `at` (3,)."""
        turn = _rotation(1, yaw_degrees) @ _rotation(0, pitch_degrees) @ _rotation(2, roll_degrees)
        return replace(self, positions=self.positions @ turn.T + np.asarray(at, np.float64))


def _rotation(axis: int, degrees: float) -> Float:
    sine, cosine = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[first, first] = turn[second, second] = cosine
    turn[first, second], turn[second, first] = -sine, sine
    return turn


def facet_normals(positions: Float, triangles: Int, /) -> Float:
    """(m, 3) normals whose length is the triangle's area in m²."""
    return area_vectors(positions[triangles])


def weld(positions: Float, triangles: Int, /) -> tuple[Float, Int]:
    """The same triangles with coincident vertices made one; collapsed triangles are dropped."""
    keys = np.round(positions / WELD_M).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    joined = inverse.reshape(-1)[triangles].astype(np.int32)
    a, b, c = joined.T
    return positions[first], joined[(a != b) & (b != c) & (c != a)]


def panel(
    origin: ArrayLike, along: ArrayLike, across: ArrayLike, divisions: tuple[int, int]
) -> Solid:
    """A subdivided parallelogram that faces along × across; (3,) each, in metres."""
    count_along, count_across = divisions
    s = np.linspace(0, 1, count_along + 1)[None, :, None]
    t = np.linspace(0, 1, count_across + 1)[:, None, None]
    grid = (
        np.asarray(origin, np.float64)
        + s * np.asarray(along, np.float64)
        + t * np.asarray(across, np.float64)
    )
    return Solid(grid.reshape(-1, 3), quads(count_across, count_along))


def box(size: ArrayLike, divisions: tuple[int, int, int] = (1, 1, 1)) -> Solid:
    """A box of `size` (3,) metres with its faces cut into `divisions` along x, y and z."""
    extent = np.asarray(size, np.float64)
    parts: list[Float] = []
    faces: list[Int] = []
    count = 0
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        along, across = np.eye(3)[first] * extent, np.eye(3)[second] * extent
        for sign in (1, -1):
            centre = np.eye(3)[axis] * extent[axis] * sign / 2
            face = panel(
                centre - (along + across) / 2,
                along,
                across,
                (divisions[first], divisions[second]),
            )
            faces.append(face.triangles[:, ::sign] + np.int32(count))
            parts.append(face.positions)
            count += len(face.positions)
    return Solid(*weld(np.concatenate(parts), np.concatenate(faces)))


def wedge(size: ArrayLike) -> Solid:
    """A ramp in a box of `size` (3,): full height at −x, none at +x."""
    x, y, z = np.asarray(size, np.float64) / 2
    corners = [(-x, -y, -z), (-x, -y, z), (x, -y, z), (x, -y, -z), (-x, y, -z), (-x, y, z)]
    triangles = [
        *((0, 2, 1), (0, 3, 2)),  # below
        *((0, 1, 5), (0, 5, 4)),  # upright
        *((4, 5, 2), (4, 2, 3)),  # ramp
        *((1, 2, 5), (0, 4, 3)),  # ends
    ]
    return Solid(np.array(corners), np.array(triangles, np.int32))


def icosphere(radius: float, frequency: int) -> Solid:
    """A geodesic sphere of 20·frequency² triangles whose vertices lie on `radius` metres."""
    golden = (1 + np.sqrt(5)) / 2
    ring = np.array([(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0)])
    corners = np.concatenate([np.roll(ring, shift, axis=1) for shift in range(3)])
    edge = 2.0  # the icosahedron of these coordinates has edges of 2
    near = np.abs(np.linalg.norm(corners[:, None] - corners, axis=-1) - edge) < 1e-6
    faces = [
        (a, b, c)
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if near[a, b] and near[b, c] and near[c, a]
    ]
    steps = np.array([(i, j) for i in range(frequency + 1) for j in range(frequency + 1 - i)])
    index = {(int(i), int(j)): k for k, (i, j) in enumerate(steps)}
    pattern = [
        triangle
        for i, j in index
        if i + j < frequency
        for triangle in _geodesic_cell(index, i, j, frequency)
    ]
    parts: list[Float] = []
    triangles: list[Int] = []
    for number, (a, b, c) in enumerate(faces):
        if np.dot(np.cross(corners[b] - corners[a], corners[c] - corners[a]), corners[a]) < 0:
            b, c = c, b
        i, j = steps[:, :1] / frequency, steps[:, 1:] / frequency
        parts.append(corners[a] * (1 - i - j) + corners[b] * i + corners[c] * j)
        triangles.append(np.array(pattern, np.int32) + np.int32(number * len(steps)))
    points = np.concatenate(parts)
    points *= radius / np.linalg.norm(points, axis=1, keepdims=True)
    return Solid(*weld(points, np.concatenate(triangles)), curved=True)


def _geodesic_cell(
    index: dict[tuple[int, int], int], i: int, j: int, frequency: int
) -> list[tuple[int, int, int]]:
    upright = (index[i, j], index[i + 1, j], index[i, j + 1])
    if i + j + 2 > frequency:
        return [upright]
    return [upright, (index[i + 1, j], index[i + 1, j + 1], index[i, j + 1])]


def torus(ring_radius: float, tube_radius: float, divisions: tuple[int, int]) -> Solid:
    """A torus about the y axis with `divisions` around the ring and around the tube."""
    around, through = divisions
    u = np.linspace(0, 2 * np.pi, around + 1)[:, None]
    v = np.linspace(0, 2 * np.pi, through + 1)[None, :]
    out = ring_radius + tube_radius * np.cos(v)
    grid = np.stack([out * np.cos(u), tube_radius * np.sin(v) + 0 * u, -out * np.sin(u)], axis=-1)
    triangles = quads(around, through)[:, ::-1]
    return Solid(*weld(grid.reshape(-1, 3), triangles), curved=True)


def lathe(radii: ArrayLike, heights: ArrayLike, segments: int) -> Solid:
    """A profile turned about the y axis: `radii` and rising `heights` (k,), ends closed in poles.

    The first and last radius must be 0: the surface then is closed and smooth all over.
    """
    out = np.asarray(radii, np.float64)[None, :, None]
    turn = np.linspace(0, 2 * np.pi, segments + 1)[:, None, None]
    up = np.broadcast_to(
        np.asarray(heights, np.float64)[None, :, None], (segments + 1, out.size, 1)
    )
    grid = np.concatenate([out * np.cos(turn), up, -out * np.sin(turn)], axis=-1)
    triangles = quads(segments, out.size - 1)[:, ::-1]
    return Solid(*weld(grid.reshape(-1, 3), triangles), curved=True)
