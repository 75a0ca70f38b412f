"""A ray as the curve that it draws in a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, rotate, transform_points

__all__ = ["Trail", "apart", "make_trail"]

Float = NDArray[np.float64]

# Directions that run along a pinhole's picture are tilted by this into it.
ALONG = 1e-5
# Rays that come back end this near to a pinhole, in metres.
NEAREST_M = 0.01
TINY = 1e-12


@dataclass(frozen=True)
class Trail:
    """n rays in the camera's frame as P(s) = w·origin + s·τ·direction with w = 1 − s·fade.

    P/w is the point of the ray; s = 1 is infinitely far, or at a pinhole's near plane. A pinhole
    sees all P(s) at one depth, so their pixels are linear in s.

    Attributes
    ----------
    origin, direction : (n, 3)
    tau, fade : (n,)
    first, last : (n,) s where the picture is entered and left; nothing of it where last < first.
    """

    view: View
    origin: Float
    direction: Float
    tau: Float
    fade: Float
    first: Float
    last: Float

    def part(self, rows: NDArray[Any], /) -> Trail:
        """Some of the rays."""
        fields = (self.origin, self.direction, self.tau, self.fade, self.first, self.last)
        return Trail(self.view, *(field[rows] for field in fields))

    def at(self, s: Float, /) -> tuple[Float, Float]:
        """Pixels (n, 2) at `s` (n,), and depths (n,) as the view measures them."""
        w = 1 - s * self.fade
        point = w[:, None] * self.origin + (s * self.tau)[:, None] * self.direction
        measure = point[:, 2]
        if self.view.projection != "pinhole":
            measure = np.linalg.norm(point, axis=1)
        return self.view.project(point), measure / np.maximum(w, TINY)

    def s_of(self, distance: Float, /) -> Float:
        """s (n,) of what is `distance` (n,) metres along the rays."""
        return distance / np.maximum(self.tau + distance * self.fade, TINY)

    def distance(self, s: Float, /) -> Float:
        """Metres (n,) along the rays at `s` (n,)."""
        return s * self.tau / np.maximum(1 - s * self.fade, TINY)


def make_trail(view: View, origins: Float, directions: Float, /) -> Trail:
    """Paths of rays in the world from `origins` (n, 3) along unit `directions` (n, 3)."""
    turned = view.camera_from_world
    origin, direction = transform_points(turned, origins), rotate(turned, directions)
    count = len(origin)
    if view.projection != "pinhole":
        ones = np.ones(count)
        radius = np.linalg.norm(origin, axis=1)
        return Trail(view, origin, direction, radius, ones, np.zeros(count), ones)
    depth, slope = origin[:, 2], direction[:, 2]
    slope = np.where(np.abs(slope) < ALONG, ALONG, slope)
    direction = np.concatenate([direction[:, :2], slope[:, None]], axis=1)
    away, grown = slope > 0, depth / NEAREST_M
    tau = np.where(away, depth / slope, grown * (NEAREST_M - depth) / slope)
    trail = Trail(
        view,
        origin,
        direction,
        tau,
        np.where(away, 1.0, 1 - grown),
        np.zeros(count),
        np.ones(count),
    )
    return _clipped(trail)


def _clipped(trail: Trail) -> Trail:
    start, end = trail.at(trail.first)[0], trail.at(trail.last)[0]
    low, high = np.array([-0.5, -0.5]), np.array([trail.view.width, trail.view.height]) - 0.5
    run = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        run = np.where(np.abs(run) < TINY, TINY, run)
        sides = np.sort(np.stack([(low - start) / run, (high - start) / run]), axis=0)
        first = np.maximum(sides[0].max(axis=1), 0)
        last = np.minimum(sides[1].min(axis=1), 1)
    seen = trail.origin[:, 2] > NEAREST_M
    last = np.where(seen & (last >= first), last, -1.0)
    return Trail(trail.view, trail.origin, trail.direction, trail.tau, trail.fade, first, last)


def apart(view: View, a: Float, b: Float, /) -> Float:
    """Pixels (n,) from `a` (n, 2) to `b` (n, 2); the shorter way around a latlong picture."""
    run = b - a
    if view.projection == "latlong":
        run[:, 0] -= view.width * np.rint(run[:, 0] / view.width)
    return np.linalg.norm(run, axis=1)
