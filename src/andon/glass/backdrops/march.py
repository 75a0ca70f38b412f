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

Then the ray is cut with the plane of the pixel it was at last, or else the interval is halved. It
is a hit where a plane is met within its own pixel, from the front, or where the interval is less
than a pixel. Unless the depths there differ by more than 5 %: then the ray has passed behind the
nearer surface, and goes on until it is in front again. Holes are passed. Planes are met exactly,
up to the pixel's normal.

What the eye does not see is not there: the back of things and what they hide cannot be hit. What
is thinner in the picture than a step may be passed through.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.model import MAX_JUMP
from andon.glass.backdrops.trails import Trail, apart, make_trail
from andon.quantities import Surface

__all__ = ["LOOKS", "NEAR_PX", "STEPS", "march"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# Coarse steps along the whole way, and looks at the G-buffer in all.
STEPS, LOOKS = 16, 40
# A plane that is met within this many pixels from where it was looked up is the pixel's own: half
# a pixel's diagonal, and some. Intervals shorter than a pixel are not divided.
NEAR_PX = 0.75


@dataclass
class _State:
    """Of n rays: an interval of s, what was at its ends, and what was found.

    `closed`: the ray is in front at `low` and behind at `high`; else only `low` counts.
    """

    s: Float
    step: Float
    low: Float
    high: Float
    low_depth: Float
    low_pixel: Float
    high_pixel: Float
    high_depth: Float
    front: Bool
    closed: Bool
    distance: Float
    normal: Float
    planes: Float
    plane_normal: Float

    @classmethod
    def start(cls, trail: Trail) -> _State:
        n = len(trail.tau)
        ends = [trail.at(s)[0] for s in (trail.first, np.maximum(trail.last, trail.first))]
        length = np.full(n, float(STEPS))
        if trail.view.projection == "pinhole":
            length = np.clip(apart(trail.view, *ends), 1, STEPS)
        nan, no = np.full(n, np.nan), np.zeros(n, np.bool_)
        return cls(
            *(
                trail.first.copy(),
                (trail.last - trail.first) / length,
                trail.first.copy(),
                nan.copy(),
            ),
            *(nan.copy(), ends[0].copy(), ends[0].copy(), nan.copy(), no.copy(), no.copy()),
            *(np.full(n, np.inf), np.full((n, 3), np.nan), nan.copy(), np.full((n, 3), np.nan)),
        )


@dataclass(frozen=True)
class _Look:
    """The pixels that n rays are at.

    `plane` (n,) metres along the ray to the pixel's plane, NaN where it is not met from its front
    or the pixel is a hole; `own` it is met within the pixel.
    """

    pixel: Float
    depth: Float
    normal: Float
    in_front: Bool
    plane: Float
    own: Bool


def march(surface: Surface, origins: Float, directions: Float, /) -> tuple[Float, Float]:
    """First hits: (n,) metres along unit `directions` (n, 3) from `origins` (n, 3), inf where
    there is none; and (n, 3) normals, NaN where there is none.
    """
    trail = make_trail(surface.view, origins, directions)
    distance, normals = np.full(len(origins), np.inf), np.full((len(origins), 3), np.nan)
    rows = np.flatnonzero(trail.last >= trail.first)
    trail, state = trail.part(rows), _State.start(trail.part(rows))
    world = origins[rows], directions[rows]
    for number in range(LOOKS):
        if len(rows) == 0:
            break
        look = _look(surface, trail, state.s, *world)
        going = _advance(state, trail, look, number)
        found = ~going & np.isfinite(state.distance)
        distance[rows[found]], normals[rows[found]] = state.distance[found], state.normal[found]
        rows, trail, world = rows[going], trail.part(going), (world[0][going], world[1][going])
        for name, values in vars(state).items():
            setattr(state, name, values[going])
    return distance, normals


def _look(surface: Surface, trail: Trail, s: Float, origins: Float, directions: Float) -> _Look:
    view = surface.view
    pixel, reached = trail.at(s)
    with np.errstate(invalid="ignore"):
        nearest = np.rint(pixel)
        if view.projection == "latlong":
            nearest[:, 0] %= view.width
        limit = np.array([view.width - 1, view.height - 1])
        inside = (np.abs(pixel - limit / 2) <= limit / 2 + 0.501).all(axis=1)
        column, row = np.nan_to_num(np.clip(nearest, 0, limit)).astype(np.int64).T
        inside &= surface.valid[row, column]
        depth = np.where(inside, surface.depth[row, column], np.nan)
        normal = surface.normal[row, column]
        facing = np.einsum("ni,ni->n", normal, directions)
        height = np.einsum("ni,ni->n", normal, surface.position[row, column] - origins)
        plane = np.where(inside & (facing < 0) & (height < 0), height / facing, np.nan)
        met = trail.at(trail.s_of(plane))[0]
        own = apart(view, pixel, met) <= NEAR_PX
        return _Look(pixel, depth, normal, ~(depth <= reached), plane, own)


def _advance(state: _State, trail: Trail, look: _Look, number: int) -> Bool:
    """Moves the rays on by what was looked at; (n,) those that are not done."""
    state.distance[look.own], state.normal[look.own] = look.plane[look.own], look.normal[look.own]
    going = ~look.own
    seen = np.isfinite(look.depth)
    opens = going & ~state.closed & state.front & ~look.in_front
    behind, before = (
        opens | (state.closed & ~look.in_front),
        ~opens & ~(state.closed & ~look.in_front),
    )
    state.high[behind], state.high_pixel[behind] = state.s[behind], look.pixel[behind]
    state.high_depth[behind] = look.depth[behind]
    state.planes[behind], state.plane_normal[behind] = look.plane[behind], look.normal[behind]
    state.low[before], state.low_pixel[before] = state.s[before], look.pixel[before]
    known = before & seen
    state.low_depth[known] = look.depth[known]
    moved = ~state.closed & ~opens
    state.front[moved] = look.in_front[moved]
    state.closed |= opens
    going &= ~_settle(state, trail, going)
    ended = ~state.closed & (state.low >= trail.last)
    state.s = _next(state, trail, look, number)
    return going & ~ended


def _settle(state: _State, trail: Trail, going: Bool) -> Bool:
    """Ends intervals shorter than a pixel; (n,) where that is a hit."""
    narrow = state.closed & going
    narrow &= apart(trail.view, state.low_pixel, state.high_pixel) < 1
    with np.errstate(invalid="ignore"):
        nearer = np.minimum(state.low_depth, state.high_depth)
        joined = np.abs(state.low_depth - state.high_depth) <= MAX_JUMP * nearer
    hit, past = narrow & joined, narrow & ~joined
    ends = trail.distance(state.low), trail.distance(state.high)
    plane = np.where(np.isfinite(state.planes), state.planes, 0.5 * (ends[0] + ends[1]))
    state.distance[hit] = np.clip(plane, *ends)[hit]
    state.normal[hit] = state.plane_normal[hit]
    state.closed[past], state.front[past] = False, False
    state.low[past], state.low_pixel[past] = state.high[past], state.high_pixel[past]
    return hit


def _next(state: _State, trail: Trail, look: _Look, number: int) -> Float:
    """(n,) where to look next."""
    middle = 0.5 * (state.low + state.high)
    cut = trail.s_of(look.plane)
    with np.errstate(invalid="ignore"):
        # Every third time in the middle: cuts with one side alone may creep.
        within = (cut > state.low) & (cut < state.high) & (number % 3 != 2)
    inside = np.where(within, cut, middle)
    return np.where(state.closed, inside, np.minimum(state.low + state.step, trail.last))
