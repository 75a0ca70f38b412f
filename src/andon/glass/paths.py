"""Paths of view rays through all glass of a scene, with the pencils around them.

::

    inside: ∅      {ball}        {ball, bubble}     {ball}        ∅
    ────────────▶│────────────▶│─────────────────▶│────────────▶│─────────▶ exit
       air       ball's index   bubble's index     ball's index  air

A ray is inside a *set* of bodies, and the medium is that of the last of them: bodies are sorted
outermost first, so what lies in another displaces it (nested dielectrics, Schmidt and Budge 2002,
with a fixed order as their priorities). At each boundary the ray is refracted or, where it must
be, mirrored; Fresnel's other share is only followed where it is seen at once, as the reflection
of the first boundary. A boundary between equal media is none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glass.crossings import Crossing, behind, next_crossing
from andon.glass.model import Solid
from andon.glass.pencils import frames_of, mirrored_pencil, start_pencil
from andon.glass.refraction import mirrored
from andon.glass.shapes import contains
from andon.spaces import invert_rigid, transform_points

__all__ = ["LOST", "MAX_EVENTS", "THROUGH", "Traced", "insides", "trace"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]

# Boundaries on one path. A ball has 2; light that is mirrored inside a prism or a facetted stone
# leaves after a few, and what is left after 16 is seen by few pixels.
MAX_EVENTS = 16
THROUGH, LOST = 0, 1


@dataclass(frozen=True)
class Traced:
    """What n view rays meet, world coordinates, metres.

    Where a ray meets no glass: `solid` is −1, `distance_m` inf, the exit is the eye itself.

    Attributes
    ----------
    solid : (n,) the first body met, −1 if none.
    distance_m : (n,) to it.
    point : (n, 3) where; the origin if there is none.
    normal : (n, 3) unit, outward, what light is refracted at; 0 if there is none.
    local_point : (n, 3) the point in the body's own frame; 0 if there is none.
    uv : (n, 2) sticker coordinates there, v down; NaN where nothing sticks.
    uv_steps : (n, 2, 2), [:, k]: how uv moves if the direction turns along e1, e2, per radian.
    reflectance : (n,) Fresnel's of the first boundary; 0 if there is none.
    mirrored : (n, 3) unit, the reflection's direction there; else the ray's own.
    mirrored_pencil : (n, 4, 2, 3) of it, at `point`.
    exit_point, exit_direction : (n, 3) of the last boundary, and the unit direction behind it.
    transmitted : (n,) Π(1 − F) of all boundaries; 0 of a path that is lost.
    path_m : (n, solids) metres within the medium of each body.
    status : (n,) `THROUGH`, or `LOST`: mirrored inside more than `MAX_EVENTS` times.
    events : (n,) boundaries met.
    pencil : (n, 4, 2, 3) at `exit_point`: derivatives dP, dD by the origin's move along e1, e2
        and the direction's turn along e1, e2.
    """

    solid: Int
    distance_m: Float
    point: Float
    normal: Float
    local_point: Float
    uv: Float
    uv_steps: Float
    reflectance: Float
    mirrored: Float
    mirrored_pencil: Float
    exit_point: Float
    exit_direction: Float
    transmitted: Float
    path_m: Float
    status: Int
    events: Int
    pencil: Float


def insides(solids: Sequence[Solid], points: Float, /) -> NDArray[np.bool_]:
    """(n, solids) bool: which bodies the `points` (n, 3) are inside of."""
    found = np.zeros((len(points), len(solids)), np.bool_)
    for place, solid in enumerate(solids):
        local = transform_points(invert_rigid(solid.world_from_glass), points)
        found[:, place] = contains(solid.shape, local)
    return found


def trace(
    solids: Sequence[Solid],
    origins: Float,
    directions: Float,
    /,
    *,
    channel: int = 1,
    frame: tuple[Float, Float] | None = None,
) -> Traced:
    """Follow view rays through `solids` until they are out of them.

    A body of one interface, where it is met first, is only entered: behind its first boundary the
    ray goes straight on, without exit and absorption, as in the paper. A ray that starts inside
    glass meets its boundary from there.

    Parameters
    ----------
    solids : outermost first, see `load.solids_of`.
    origins, directions : (n, 3), directions of unit length.
    channel : 0, 1 or 2: whose index of refraction.
    frame : e1, e2, (n, 3) each: unit, across the ray and one another; `pencils.frames_of` if None.
    """
    origins = np.ascontiguousarray(np.broadcast_to(origins, directions.shape), np.float64)
    rays = _Rays(solids, origins, np.array(directions, np.float64), frame)
    for event in range(MAX_EVENTS + 1):
        crossing = next_crossing(solids, rays.point, rays.direction, rays.inside, rays.alive)
        rays.end(crossing.solid < 0)
        crossing = crossing.taken(crossing.solid >= 0)
        if not len(rays.alive) or event == MAX_EVENTS:
            break
        if event == 0:
            rays.meet(crossing, channel)
        rays.cross(crossing, channel)
        if event == 0:
            one = np.array([solid.interfaces == 1 for solid in solids], np.bool_)
            rays.alive = rays.alive[~one[crossing.solid]]
    return rays.traced()


class _Rays:
    """The state of n rays while they are followed; `alive` are the places of those that go on."""

    def __init__(
        self,
        solids: Sequence[Solid],
        origins: Float,
        directions: Float,
        frame: tuple[Float, Float] | None,
    ) -> None:
        count = len(origins)
        self.solids = solids
        self.point, self.direction = origins.copy(), directions
        self.pencil = start_pencil(*(frames_of(directions) if frame is None else frame))
        self.inside = insides(solids, origins)
        self.alive: Int = np.arange(count)
        self.lost = np.zeros(count, np.bool_)
        self.events = np.zeros(count, np.int64)
        self.transmitted = np.ones(count)
        self.path_m = np.zeros((count, len(solids)))
        self.solid = np.full(count, -1, np.int64)
        self.distance_m = np.full(count, np.inf)
        self.first_point, self.mirrored = origins.copy(), directions.copy()
        self.normal, self.local_point = np.zeros((2, count, 3))
        self.uv, self.uv_steps = np.full((count, 2), np.nan), np.zeros((count, 2, 2))
        self.reflectance = np.zeros(count)
        self.mirrored_pencil = self.pencil.copy()

    def end(self, out: NDArray[np.bool_]) -> None:
        """Rays (of those alive) that meet nothing more; lost if there should have been a way."""
        ended = self.alive[out]
        self.lost[ended] = self.inside[ended].any(axis=-1)
        self.alive = self.alive[~out]

    def meet(self, crossing: Crossing, channel: int) -> None:
        """What is seen at the first boundary."""
        at, incoming = self.alive, self.direction[self.alive]
        facing, turning = crossing.facing(incoming)
        self.solid[at], self.distance_m[at] = crossing.solid, crossing.distance
        self.first_point[at] = self.point[at] + crossing.distance[:, None] * incoming
        self.normal[at], self.uv[at] = crossing.normal, crossing.uv
        self.local_point[at] = crossing.local_point
        self.reflectance[at] = crossing.reflectance(self.solids, incoming, channel)
        self.mirrored[at] = mirrored(incoming, facing)
        there = crossing.pencil_there(self.pencil[at], incoming)
        self.uv_steps[at] = np.einsum("nui,nki->nku", crossing.uv_slope, there[:, 2:, 0])
        self.mirrored_pencil[at] = mirrored_pencil(
            there,
            incoming,
            facing,
            turning,
        )

    def cross(self, crossing: Crossing, channel: int) -> None:
        """Go to the boundary and behind it."""
        at = self.alive
        medium = crossing.medium_before
        within = medium >= 0
        self.path_m[at[within], medium[within]] += crossing.distance[within]
        after = behind(
            self.solids, crossing, self.point[at], self.direction[at], self.pencil[at], channel
        )
        self.point[at], self.direction[at] = after.point, after.direction
        self.pencil[at], self.inside[at] = after.pencil, after.inside
        self.transmitted[at] *= after.transmitted
        self.events[at] += 1

    def traced(self) -> Traced:
        """What became of them; those still alive are lost."""
        self.lost[self.alive] = True
        return Traced(
            self.solid,
            self.distance_m,
            self.first_point,
            self.normal,
            self.local_point,
            self.uv,
            self.uv_steps,
            self.reflectance,
            self.mirrored,
            self.mirrored_pencil,
            self.point,
            self.direction,
            np.where(self.lost, 0.0, self.transmitted),
            self.path_m,
            np.where(self.lost, LOST, THROUGH),
            self.events,
            self.pencil,
        )
