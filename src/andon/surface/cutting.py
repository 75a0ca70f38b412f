"""Triangles of a real surface, parted into those that are a lamp's own shade and all others.

A lamp stands inside its shade, and a measured shade is a sheet like any other: it would hide all of
the lamp. So triangles that are inside the shell, or nearer to it than its margin, are set apart as
a caster group that the shell's own lamp shines through. Skirts that noise and triangulation draw
from its rims to a wall behind it are cut: large triangles are first quartered to the margin's size,
so that nothing else is lost.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.lamps.bodies import Body
from andon.lamps.shells.beams import solid_angles
from andon.lamps.solids import quarters
from andon.quantities import Geometry
from andon.surface.nearest import nearest_distance

__all__ = ["parted", "within"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# A triangle of a metre is quartered to a centimetre in seven steps; more pieces than this are not
# made, and a piece is then judged as large as it is.
MOST_CUTS, MOST_PIECES = 7, 100_000
# Points and triangles that are compared at once.
CHUNK = 1 << 21


def within(body: Body, margin_m: float, points: Float, /) -> Bool:
    """(n,) whether `points` (n, 3) are inside a shell, or nearer to it than `margin_m`."""
    found = nearest_distance(points, body.geometry) < margin_m
    corners = body.geometry.positions[body.geometry.triangles]
    closed = np.concatenate([corners, body.covers])
    rest = np.flatnonzero(~found)
    step = max(1, CHUNK // len(closed))
    for start in range(0, len(rest), step):
        some = rest[start : start + step]
        seen = solid_angles(closed[None] - points[some, None, None]).sum(axis=1)
        found[some] = np.abs(seen) > 2 * np.pi
    return found


def parted(
    geometry: Geometry, bodies: Sequence[Body], margins_m: Sequence[float], /
) -> tuple[Geometry, dict[frozenset[str], Geometry]]:
    """What of `geometry` belongs to no shell, and what to which: names of bodies → triangles.

    Without normals and materials: for shadows.
    """
    corners = geometry.positions[geometry.triangles]
    near = np.zeros(len(corners), bool)
    for body, margin_m in zip(bodies, margins_m, strict=True):
        near |= _touches(corners, body, margin_m)
    pieces = corners[near]
    for body, margin_m in zip(bodies, margins_m, strict=True):
        pieces = _cut(pieces, body, margin_m)
    owners = np.zeros(len(pieces), np.int64)
    for number, (body, margin_m) in enumerate(zip(bodies, margins_m, strict=True)):
        asked = np.flatnonzero(_touches(pieces, body, margin_m))
        places = np.concatenate([pieces[asked], pieces[asked].mean(axis=1, keepdims=True)], axis=1)
        inside = within(body, margin_m, places.reshape(-1, 3)).reshape(-1, 4)
        owners[asked] |= inside.any(axis=1).astype(np.int64) << number
    rest = Geometry(geometry.positions, geometry.triangles[~near])
    free = pieces[owners == 0]
    groups = {
        frozenset(body.name for n, body in enumerate(bodies) if code >> n & 1): _loose(
            pieces[owners == code]
        )
        for code in np.unique(owners[owners > 0]).tolist()
    }
    return _joined(rest, free), groups


def _touches(corners: Float, body: Body, margin_m: float) -> Bool:
    """(n,) triangles whose box meets that of the shell and its margin."""
    points = body.geometry.positions
    low, high = points.min(axis=0) - margin_m, points.max(axis=0) + margin_m
    return ((corners.max(axis=1) > low) & (corners.min(axis=1) < high)).all(axis=-1)


def _cut(corners: Float, body: Body, margin_m: float) -> Float:
    """The same triangles, none near the shell with an edge longer than its margin."""
    for _ in range(MOST_CUTS):
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        large = (edges > margin_m) & _touches(corners, body, margin_m)
        if not large.any() or len(corners) + 3 * np.count_nonzero(large) > MOST_PIECES:
            break
        corners = np.concatenate([corners[~large], quarters(corners[large])])
    return corners


def _loose(corners: Float) -> Geometry:
    count = len(corners)
    return Geometry(corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3))


def _joined(geometry: Geometry, corners: Float) -> Geometry:
    if not len(corners):
        return geometry
    more = _loose(corners)
    triangles = np.concatenate([geometry.triangles, more.triangles + len(geometry.positions)])
    positions = np.concatenate([geometry.positions, more.positions])
    return Geometry(positions, triangles.astype(np.int32))
