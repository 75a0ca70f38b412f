"""Rays against the G-buffer: the scene's geometry as one eye sees it, as a field of depths.

Each pixel holds a piece of plane (depth and normal). A ray is followed in the picture, from where
it leaves the glass to where it leaves the picture or is infinitely far away:

::

      eye ·──────────────── the picture's rows ───────────────▷ s
       depth      o  o                     o: the ray at STEPS equal steps of s
         │          o   o
         │   ━━━━━━━━━┓    o               ━: depth of the pixels
         │            ┃      o  ✗          in front at one step, behind at the next: in between
         ▽            ┗━━━━━━━━━━━━        it hit, or passed behind an edge

Then the ray is cut with the plane of the pixel that it is behind; where the cut is, the next pixel
is looked at, or in the middle of the interval. It is a hit where a plane is met within its own
pixel, from the front, or where the interval is less than a pixel. Unless the depths there differ by
more than 5 %: then the ray has passed behind the nearer surface, and goes on until it is in front
again. A hole tells nothing: over it a ray stays in front, or behind. Planes are met exactly, up to
the pixel's normal.

What the eye does not see is not there: the back of things and what they hide cannot be hit. A ray
that ends behind something went out of sight at the last edge that it passed; what the eye sees
there is nearest to what it would find. What is thinner in the picture than a step may be passed
through.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.model import MAX_JUMP
from andon.glass.backdrops.trails import Trail, apart, make_trail
from andon.quantities import Surface

__all__ = ["LOOKS", "NEAR_PX", "ROUNDS", "STEPS", "Met", "march"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]


# Equal steps along the whole way; looks at one interval; intervals that may be edges.
STEPS, LOOKS, ROUNDS = 128, 12, 8
# A plane that is met within this many pixels from where it was looked up is the pixel's own: half
# a pixel's diagonal, and some. Intervals shorter than a pixel are not divided.
NEAR_PX = 0.75


@dataclass
class _State:
    """Of n rays.

    Attributes
    ----------
    step : of s.
    low, high : (n,) the ray goes behind something in between, once `closed`; else it is at low.
    front : (n,) it is in front at `low`.
    depth : (n,) what was last in front of it, NaN for nothing yet.
    edge : (n,) s of the last edge that it passed behind, NaN for none.
    """

    step: Float
    low: Float
    high: Float
    front: Bool
    depth: Float
    edge: Float

    def part(self, rows: NDArray[Any]) -> _State:
        return _State(*(np.array(values[rows]) for values in vars(self).values()))

    def put(self, rows: NDArray[Any], other: _State) -> None:
        for name, values in vars(other).items():
            getattr(self, name)[rows] = values


@dataclass(frozen=True)
class Met:
    """What n rays meet.

    Attributes
    ----------
    distance_m : (n,) metres to the hit, or to where a ray went out of sight; inf where neither is.
    normal : (n, 3) of what was hit; against the ray where it went out of sight; else NaN.
    hidden : (n,) bool: out of sight.
    """

    distance_m: Float
    normal: Float
    hidden: Bool


@dataclass(frozen=True)
class _Rays:
    """n rays of the world, and what they draw in the picture."""

    surface: Surface
    trail: Trail
    origins: Float
    directions: Float

    def part(self, rows: NDArray[Any]) -> _Rays:
        return _Rays(self.surface, self.trail.part(rows), self.origins[rows], self.directions[rows])

    def pixels(self, s: Float) -> tuple[Float, NDArray[np.int64], Float, Float]:
        """Where the rays are at `s` (n,): place in the picture, (2, n) row and column of the
        pixel, its depth (NaN for holes and beside the picture) and the ray's.
        """
        view = self.surface.view
        place, reached = self.trail.at(s)
        with np.errstate(invalid="ignore"):
            limit = np.array([view.width - 1, view.height - 1])
            inside = (np.abs(place - limit / 2) <= limit / 2 + 0.501).all(axis=1)
            nearest = np.rint(place)
        if view.projection == "latlong":
            nearest[:, 0] %= view.width
        column, row = np.nan_to_num(np.clip(nearest, 0, limit)).astype(np.int64).T
        inside &= self.surface.valid[row, column]
        depth = np.where(inside, self.surface.depth[row, column], np.nan)
        return place, np.stack([row, column]), depth, reached


def march(surface: Surface, origins: Float, directions: Float, /) -> Met:
    """First hits of rays from `origins` (n, 3) along unit `directions` (n, 3)."""
    distance, normals = np.full(len(origins), np.inf), np.full((len(origins), 3), np.nan)
    edge, in_front = np.full(len(origins), np.nan), np.ones(len(origins), np.bool_)
    trail = make_trail(surface.view, origins, directions)
    rows = np.flatnonzero(trail.last >= trail.first)
    rays = _Rays(surface, trail.part(rows), origins[rows], directions[rows])
    state = _started(rays)
    for _ in range(ROUNDS):
        behind = _stepped(rays, state)
        edge[rows], in_front[rows] = state.edge, state.front
        rows, rays, state = rows[behind], rays.part(behind), state.part(behind)
        found, normal = _narrowed(rays, state)
        hit = np.isfinite(found)
        distance[rows[hit]], normals[rows[hit]] = found[hit], normal[hit]
        rows, rays, state = rows[~hit], rays.part(~hit), state.part(~hit)
    edge[rows], in_front[rows] = state.edge, state.front
    hidden = ~np.isfinite(distance) & ~in_front & np.isfinite(edge)
    distance[hidden] = trail.part(hidden).distance(edge[hidden])
    normals[hidden] = -directions[hidden]
    return Met(distance, normals, hidden)


def _started(rays: _Rays) -> _State:
    trail = rays.trail
    steps = np.full(len(trail.tau), float(STEPS))
    if trail.view.projection == "pinhole":
        length = apart(trail.view, trail.at(trail.first)[0], trail.at(trail.last)[0])
        steps = np.clip(length, 1, STEPS)
    _, _, depth, reached = rays.pixels(trail.first)
    step = (trail.last - trail.first) / steps
    first, edge = trail.first, np.full(len(steps), np.nan)
    return _State(step, first.copy(), first.copy(), ~(depth <= reached), depth, edge)


def _stepped(rays: _Rays, state: _State) -> NDArray[np.int64]:
    """Moves rays on until they go behind something, whose numbers are returned, or end."""
    going = np.arange(len(state.low))
    behind: list[NDArray[np.int64]] = []
    # One more than there are steps: their sum may end a rounding error before the last place.
    for _ in range(STEPS + 1):
        going = going[state.low[going] < rays.trail.last[going]]
        part, old = rays.part(going), state.part(going)
        s = np.minimum(old.low + old.step, part.trail.last)
        _, _, depth, reached = part.pixels(s)
        front = np.where(np.isfinite(depth), depth > reached, old.front)
        gone = old.front & ~front
        state.high[going[gone]] = s[gone]
        behind.append(going[gone])
        kept = ~gone
        going = going[kept]
        state.low[going], state.front[going] = s[kept], front[kept]
        state.depth[going] = np.where(np.isfinite(depth), depth, old.depth)[kept]
    return np.concatenate(behind)


def _narrowed(rays: _Rays, state: _State) -> tuple[Float, Float]:
    """Metres (n,) to hits between `low` and `high` and their normals; inf for edges, which the rays
    have then passed.
    """
    n = len(state.low)
    inner = state.part(np.arange(n))
    distance, normals, going = np.full(n, np.inf), np.full((n, 3), np.nan), np.arange(n)
    ends = [rays.trail.at(s)[0] for s in (state.low, state.high)]
    s = state.high.copy()
    for number in range(LOOKS):
        part, now = rays.part(going), inner.part(going)
        place, pixel, depth, reached = part.pixels(s)
        plane, normal = _plane(part, pixel, depth)
        own = apart(part.trail.view, place, part.trail.at(part.trail.s_of(plane))[0]) <= NEAR_PX
        front = ~(depth <= reached)
        moves = [(s > now.low) & (s <= now.high) & side for side in (front, ~front)]
        now.low, now.high = np.where(moves[0], s, now.low), np.where(moves[1], s, now.high)
        for end, move in zip(ends, moves, strict=True):
            end[move] = place[move]
        joined = np.abs(now.depth - depth) <= MAX_JUMP * np.minimum(now.depth, depth)
        now.depth = np.where(moves[0] & np.isfinite(depth), depth, now.depth)
        narrow = apart(part.trail.view, *ends) < 1
        touched = narrow & ~front & joined & ~own
        between = _between(part.trail, now, plane)
        hit = own | touched
        distance[going[hit]] = np.where(own, plane, between)[hit]
        normals[going[hit]] = normal[hit]
        inner.put(going, now)
        cut, middle = part.trail.s_of(plane), 0.5 * (now.low + now.high)
        # Where a ray grazes, depths of whole pixels cross it beside its true place: the first cut
        # may lie outside. Every third time in the middle: cuts with one side alone may creep.
        beyond = now.step if number == 0 else 0.0
        within = (cut > now.low - beyond) & (cut < now.high + beyond) & (number % 3 != 2)
        s = np.where(within, cut, middle)
        # Where the nearer end was looked at last, the farther one says once more what is there.
        s = np.where(narrow & front, now.high, s)
        kept = ~hit & ~(narrow & ~front)
        going, s, ends = going[kept], s[kept], [end[kept] for end in ends]
    edge = ~np.isfinite(distance)
    # Where nothing was in front before, the ray began out of sight.
    passed = edge & np.isfinite(inner.depth) & (inner.low > 0)
    state.edge[passed] = inner.low[passed]
    state.low[edge], state.front[edge] = state.high[edge], False
    return distance, normals


def _between(trail: Trail, state: _State, plane: Float) -> Float:
    """Metres (n,) to hits in an interval of less than a pixel: to the plane, if it is near."""
    width = state.high - state.low
    low, high = (trail.distance(s) for s in (state.low - width, state.high + width))
    middle = trail.distance(state.low + 0.5 * width)
    return np.where(np.isfinite(plane), np.clip(plane, np.maximum(low, 0), high), middle)


def _plane(rays: _Rays, pixel: NDArray[np.int64], depth: Float) -> tuple[Float, Float]:
    """Metres (n,) along the rays to the planes of pixels, NaN where they are not met from their
    front or there is none; and their normals.
    """
    normal = rays.surface.normal[pixel[0], pixel[1]]
    reach = rays.surface.position[pixel[0], pixel[1]] - rays.origins
    with np.errstate(invalid="ignore", divide="ignore"):
        facing = np.einsum("ni,ni->n", normal, rays.directions)
        height = np.einsum("ni,ni->n", normal, reach)
        met = np.isfinite(depth) & (facing < 0) & (height < 0)
        return np.where(met, height / facing, np.nan), normal
