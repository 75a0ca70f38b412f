"""Rays that the tests of glass shoot, and what their pencils are compared with."""

import numpy as np

from andon.glass.model import Ball, Closed, LensShape, Slab, Solid
from andon.glass.paths import THROUGH, trace
from andon.glass.pencils import frames_of
from andon.quantities import Geometry

__all__ = [
    "BALL",
    "EYE",
    "SHAPES",
    "angles_between",
    "icosphere",
    "neighbours",
    "rays_from",
    "slant",
    "smooth_ball",
    "unit",
]

# The paper's scene: Ø 150 mm, the observer at 0.4 m from its centre.
BALL = Solid("ball", Ball(0.075))
EYE = np.array([0.0, 0.0, 0.4])

SHAPES = {
    "ball": Ball(0.075),
    "slab": Slab(np.array([0.2, 0.15, 0.02])),
    "biconvex": LensShape(0.06, (0.12, 0.2), 0.05),
    "biconcave": LensShape(0.06, (-0.15, -0.1), 0.01),
    "meniscus": LensShape(0.06, (0.1, -0.14), 0.03),
    "hemisphere": LensShape(0.06, (0.06, 1e6), 0.06),
}


def unit(vectors):
    """Vectors (..., 3) of length 1."""
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def slant(degrees):
    """(n, 3) directions down −z, turned towards +x by `degrees` (n,)."""
    angle = np.radians(np.atleast_1d(degrees))
    return np.stack([np.sin(angle), np.zeros_like(angle), -np.cos(angle)], axis=-1)


def rays_from(eye, spread, count, seed=0):
    """(n, 3) directions from `eye` towards the origin's surroundings, within ±`spread` metres."""
    random = np.random.default_rng(seed)
    return unit(random.uniform(-spread, spread, (count, 3)) - eye)


def angles_between(a, b):
    """(n,) radians between unit vectors."""
    return 2 * np.arcsin(np.linalg.norm(a - b, axis=-1) / 2)


def neighbours(solids, eye, directions, ahead_m, step=1e-5):
    """How paths behind glass move if the eye or the direction does, by differences of 4th order.

    Returns the points' moves on the plane across the last direction, `ahead_m` behind the last
    boundary, and the directions' turns, (n, 4, 3) each, in the order of a pencil; and which rays
    (n,) are through, with neighbours that meet the same boundaries.
    """
    frame = frames_of(directions)
    middle = trace(solids, eye, directions)
    plane = middle.exit_point + ahead_m * middle.exit_direction
    good = middle.status == THROUGH
    moves, turns = [], []
    for place in range(4):
        points, ways = [], []
        for steps in (1, -1, 2, -2):
            axis = steps * step * frame[place % 2]
            origins = eye + (axis if place < 2 else 0 * axis)
            found = trace(solids, origins, unit(directions + (0 * axis if place < 2 else axis)))
            good = good & (found.events == middle.events) & (found.status == THROUGH)
            gap = ((plane - found.exit_point) * middle.exit_direction).sum(-1)
            cosine = (found.exit_direction * middle.exit_direction).sum(-1)
            points.append(found.exit_point + (gap / cosine)[:, None] * found.exit_direction)
            ways.append(found.exit_direction)
        for found, all_of in ((points, moves), (ways, turns)):
            all_of.append((8 * (found[0] - found[1]) - (found[2] - found[3])) / (12 * step))
    return np.stack(moves, 1), np.stack(turns, 1), good


def icosphere(radius, levels):
    """Positions and triangles of an icosahedron, each triangle split into four `levels` times."""
    golden = (1 + 5**0.5) / 2
    points = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0)]
    points = np.array([np.roll(p, shift) for shift in (0, 1, 2) for p in points])
    points = unit(points)
    near = np.linalg.norm(points[:, None] - points, axis=-1) < 1.1
    faces = [
        (a, b, c)
        for a in range(12)
        for b in range(a)
        for c in range(b)
        if near[a, b] and near[b, c] and near[a, c]
    ]
    corners = points[np.array(faces)]
    for _ in range(levels):
        a, b, c = np.moveaxis(corners, 1, 0)
        ab, bc, ca = unit(a + b), unit(b + c), unit(c + a)
        parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        corners = np.concatenate([np.stack(part, axis=1) for part in parts])
    volume = np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    corners[volume < 0] = corners[volume < 0][:, ::-1]
    positions, index = np.unique(corners.reshape(-1, 3).round(12), axis=0, return_inverse=True)
    return radius * unit(positions), index.reshape(-1, 3).astype(np.int32)


def smooth_ball(radius, levels):
    """An icosphere with the sphere's normals, as glass."""
    positions, triangles = icosphere(radius, levels)
    return Closed(Geometry(positions, triangles, normals=positions / radius))
