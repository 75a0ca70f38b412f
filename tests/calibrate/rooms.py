"""A room of three planes, and estimators' depth of it."""

import numpy as np

from andon.calibrate.depth import Length, Plane, relative_depth
from andon.spaces import View

__all__ = ["HEIGHT_M", "PARTS", "POINTS", "VIEW", "Z", "affine", "length", "room"]

# A level floor 1.4 m below, a wall 4 m ahead, one 1.8 m to the right.
HEIGHT_M = 1.4
VIEW = View("pinhole", 160, 120, 140.0, 140.0, 79.5, 59.5)


def room(view):
    """Depth z (H, W) and which of (floor, back, right) each pixel shows."""
    x, y, _ = np.moveaxis(view.rays_planar(), -1, 0)
    with np.errstate(divide="ignore"):
        floor = np.where(y > 0, HEIGHT_M / y, np.inf)
        right = np.where(x > 0, 1.8 / x, np.inf)
    depths = np.stack([floor, np.full(view.shape, 4.0), right])
    return depths.min(axis=0), depths.argmin(axis=0)


Z, _PART = room(VIEW)
POINTS = VIEW.rays_planar() * Z[..., None]
PARTS = {
    name: Plane(np.equal(_PART, part), name) for part, name in enumerate(("floor", "back", "right"))
}

# a and b of each kind: the unit of r is nobody's.
AFFINE = {"inverse": (0.013, 0.05), "depth": (0.7, -0.4)}


def affine(kind, noise=0.0, seed=0, z=Z, view=VIEW):
    """(relative depth, a, b); the noise is white, in shares of r's standard deviation."""
    a, b = AFFINE[kind]
    r = ((1 / z if kind == "inverse" else z) - b) / a
    r = r + noise * r.std() * np.random.default_rng(seed).standard_normal(r.shape)
    return relative_depth(r, view, kind), a, b


def length(first, second, error=0.0):
    """The true distance between two pixels (column, row), `error` of it too long."""
    metres = np.linalg.norm(POINTS[first[1], first[0]] - POINTS[second[1], second[0]])
    return Length(first, second, float(metres) * (1 + error))
