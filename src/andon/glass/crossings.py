"""One boundary of a path: which body's is the next, which media it parts, what it does to a ray."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Solid
from andon.glass.pencils import mirrored_pencil, refracted_pencil, transferred
from andon.glass.refraction import against, dot, fresnel, refracted
from andon.glass.shapes import NEAR, boundary, hit, scale_of
from andon.spaces import invert_rigid, rotate, transform_points

__all__ = ["Behind", "Crossing", "behind", "medium_of", "next_crossing"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]


@dataclass(frozen=True)
class Crossing:
    """The next boundaries of k rays, world coordinates.

    Attributes
    ----------
    solid : (k,) whose boundary, −1 if there is none.
    distance : (k,) metres.
    normal, facet : (k, 3) unit, outward: what light is refracted at, and of the geometry.
    turning : (k, 3, 3) dN = turning @ dP.
    uv : (k, 2), local_point : (k, 3), see `Traced`; uv_slope : (k, 2, 3), duv = uv_slope @ dP.
    before, after : (k, solids) bool: what the ray is inside of on both sides.
    """

    solid: Int
    distance: Float
    normal: Float
    facet: Float
    turning: Float
    uv: Float
    uv_slope: Float
    local_point: Float
    before: Bool
    after: Bool

    def taken(self, which: Bool, /) -> Crossing:
        """Those of some of the rays, (k,) bool."""
        return Crossing(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    @property
    def medium_before(self) -> Int:
        """(k,) whose medium the ray comes through, −1: air."""
        return medium_of(self.before)

    def indices(self, solids: Sequence[Solid], channel: int, /) -> tuple[Float, Float]:
        """Refractive indices (k,) before and behind."""
        table = np.array([*(solid.index[channel] for solid in solids), 1.0])  # −1 is air
        return table[self.medium_before], table[medium_of(self.after)]

    def reflectance(self, solids: Sequence[Solid], directions: Float, channel: int, /) -> Float:
        """(k,) Fresnel's share of what is mirrored."""
        cosine = np.abs(dot(directions, self.normal))
        return fresnel(cosine, *self.indices(solids, channel))

    def facing(self, directions: Float, /) -> tuple[Float, Float]:
        """Normals (k, 3) turned against `directions` (k, 3), and their turning (k, 3, 3)."""
        sign = np.where(dot(directions, self.normal) > 0, -1.0, 1.0)
        return sign[:, None] * self.normal, sign[:, None, None] * self.turning

    def pencil_there(self, pencil: Float, directions: Float, /) -> Float:
        """(k, 4, 2, 3): the pencil on the boundary."""
        return transferred(pencil, self.distance, directions, self.facet)


def medium_of(inside: Bool, /) -> Int:
    """(k,) the last body that a ray is `inside` (k, solids) of, −1 for none."""
    last = inside.shape[1] - 1 - inside[:, ::-1].argmax(axis=1)
    return np.where(inside.any(axis=1), last, -1)


def next_crossing(
    solids: Sequence[Solid], points: Float, directions: Float, inside: Bool, alive: Int, /
) -> Crossing:
    """The next boundaries of the rays `alive` (k,) of all `points`, `directions`, `inside`.

    Boundaries of several bodies at one place (touching ones) are crossed together: no film of air
    is between them.
    """
    o, d, before = points[alive], directions[alive], inside[alive]
    count, bodies = before.shape
    t, part = np.full((count, bodies), np.inf), np.full((count, bodies), -1, np.int64)
    weights = np.zeros((count, bodies, 3))
    local = [invert_rigid(solid.world_from_glass) for solid in solids]
    for place, solid in enumerate(solids):
        found = hit(
            solid.shape,
            transform_points(local[place], o),
            rotate(local[place], d),
            before[:, place],
        )
        t[:, place], part[:, place], weights[:, place] = found
    nearest = t.min(axis=1, initial=np.inf)
    solid = np.where(np.isfinite(nearest), t.argmin(axis=1) if bodies else 0, -1)
    near = NEAR * max((scale_of(each.shape) for each in solids), default=1.0)
    with np.errstate(invalid="ignore"):
        crossed = np.isfinite(t) & (t <= nearest[:, None] + near)
    facts = _facts(solids, local, (o, d, nearest), solid, (part, weights))
    return Crossing(solid, nearest, *facts, before, before ^ crossed)


def _facts(
    solids: Sequence[Solid],
    local: list[Float],
    rays: tuple[Float, Float, Float],
    chosen: Int,
    places: tuple[Int, Float],
) -> tuple[Float, Float, Float, Float, Float, Float]:
    """Normal, facet, turning, uv, its slope and local point of the `chosen` boundaries."""
    o, d, t = rays
    count = len(o)
    normal, facet, own = np.zeros((3, count, 3))
    turning, uv = np.zeros((count, 3, 3)), np.full((count, 2), np.nan)
    slope = np.zeros((count, 2, 3))
    for place, solid in enumerate(solids):
        here = np.flatnonzero(chosen == place)
        there = transform_points(local[place], o[here] + t[here, None] * d[here])
        found = boundary(solid.shape, there, places[0][here, place], places[1][here, place])
        turn = solid.world_from_glass[:3, :3]
        normal[here], facet[here] = found.normal @ turn.T, found.facet @ turn.T
        turning[here] = turn @ found.turning @ turn.T
        uv[here], own[here], slope[here] = found.uv, there, found.uv_slope @ turn.T
    return normal, facet, turning, uv, slope, own


class Behind(NamedTuple):
    """Rays behind a boundary: see `behind`."""

    point: Float
    direction: Float
    pencil: Float
    inside: Bool
    transmitted: Float


def behind(
    solids: Sequence[Solid],
    crossing: Crossing,
    points: Float,
    directions: Float,
    pencil: Float,
    channel: int,
    /,
) -> Behind:
    """Rays (k) on the far side of their boundaries, or mirrored where reflection is total.

    Points (k, 3), directions (k, 3), pencils (k, 4, 2, 3), what they are inside of (k, solids),
    and the share (k,) of light that comes through. Where the interpolated normal would send a ray
    to the wrong side of its triangle, the triangle's own normal holds.
    """
    there = points + crossing.distance[:, None] * directions
    on = crossing.pencil_there(pencil, directions)
    n1, n2 = crossing.indices(solids, channel)
    facing, turned = crossing.facing(directions)
    onward, total = refracted(directions, facing, n1, n2)
    crosses = dot(onward, crossing.facet) * dot(directions, crossing.facet) > 0
    wrong = crosses == total
    if wrong.any():
        facing = np.where(wrong[:, None], against(directions, crossing.facet), facing)
        turned = np.where(wrong[:, None, None], 0.0, turned)
        onward, total = refracted(directions, facing, n1, n2)
    refracts = refracted_pencil(on, directions, facing, turned, n1 / n2)
    mirrors = mirrored_pencil(on, directions, facing, turned)
    share = np.where(total, 1.0, 1 - fresnel(-dot(directions, facing), n1, n2))
    keeps = total[:, None, None, None]
    inside = np.where(total[:, None], crossing.before, crossing.after)
    return Behind(there, onward, np.where(keeps, mirrors, refracts), inside, share)
