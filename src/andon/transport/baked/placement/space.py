"""Free space: where cameras can stand.

A place is free where no surface is near, where it is not inside a wall or a closed thing, and
where there is a way of straight lines from the frame's own cameras through other free places: what
lies outside of the room is not.

Rooms are rarely tight, and walls are often sheets: through a gap the way leads behind them. Who
stands there sees backs and sky, more of both than the frame's camera. A street has sky everywhere,
and a file that winds its triangles carelessly shows backs to the frame's camera, too: only what is
more than there tells. Without a frame the median of all places stands for its camera, and the
parts of space are taken that see little sky.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.transport.probes.placement.clearance import nearest_within
from andon.transport.probes.placement.walls import AROUND, Walls

__all__ = ["free_places", "spacing_of"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# Boxes into which the scene's box is divided; one place is tried in each.
BOXES = 1600
# Of the free places no more are looked from.
MOST_PLACES = 400
# From surfaces, as a share of the distance between places; metres are no measure for a model of
# a house on a table.
CLEARANCE = 0.2
# In front of a surface that has one side only, some backs are seen through its gaps.
BACKS_IN_FRONT = 0.05
# Outside is what sees backs and sky in more than this share of the directions, and in so much more
# than the frame's cameras.
MISSING, MORE_MISSING = 0.4, 0.2
# Space that sees more sky than this on average is outside of what has an inside.
MOST_SKY = 0.4


def spacing_of(geometry: Geometry, /) -> float:
    """Metres between places that are tried."""
    size = np.ptp(geometry.positions[geometry.triangles.ravel()], axis=0)
    size = np.maximum(size, size.max() / 8)
    return float((size.prod() / BOXES) ** (1 / 3))


def free_places(
    geometry: Geometry, walls: Walls, starts: Float, seed: int, /, *, one_sided: bool = False
) -> Float:
    """(p, 3) free places, metres; none where there are none.

    Parameters
    ----------
    starts : (s, 3) metres, of the frame's cameras; may be none.
    one_sided : backs of the surface are the unknown (a photograph's depth).
    """
    spacing = spacing_of(geometry)
    places = _jittered(geometry, spacing, seed)
    near = nearest_within(places, geometry, CLEARANCE * spacing)
    places = places[~np.isfinite(near.distance_m)]
    sight = walls.sight(places)
    missing = sight.backs + _sky(walls, places)
    if one_sided:
        free = sight.backs <= BACKS_IN_FRONT
    else:
        free = missing <= _most_missing(walls, starts, missing)
        if len(starts) == 0 or not walls.sight(starts).buried.any():
            free &= ~sight.buried
    places = places[free]
    if len(starts) == 0:
        inside = _most_enclosed(walls, places)
    else:
        inside = _connected(walls, starts, places, straight=one_sided)
    return places[inside][:MOST_PLACES]


def _most_missing(walls: Walls, starts: Float, missing: Float) -> float:
    """Share of directions without fronts that a place inside of the scene may have."""
    if len(starts):
        usual = float((walls.sight(starts).backs + _sky(walls, starts)).max())
    else:
        usual = float(np.median(missing)) if len(missing) else 0.0
    return max(MISSING, usual + MORE_MISSING)


def _jittered(geometry: Geometry, spacing: float, seed: int) -> Float:
    """A place anywhere in each box of a grid, shuffled, in round numbers."""
    corners = geometry.positions[geometry.triangles.ravel()]
    low: Float = corners.min(axis=0)
    size: Float = corners.max(axis=0) - low
    # A flat scene has space before it.
    thin, most = size < spacing, float(size.max())
    low, size = np.where(thin, low - most / 4, low), np.where(thin, most / 2, size)
    counts = np.maximum(np.round(size / spacing), 1).astype(np.int64)
    random = np.random.default_rng([seed, 1])
    index = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    places = low + (index + random.random(index.shape)) * (size / counts)
    decimals = int(np.ceil(2 - np.log10(spacing)))
    return np.round(places[random.permutation(len(places))], decimals)


def _connected(walls: Walls, starts: Float, places: Float, *, straight: bool = False) -> Bool:
    """(p,) there is a way from a start, in straight lines from place to place.

    `straight` : of one line. A photograph knows to be free what its camera sees through.
    """
    reached = np.zeros(len(places), bool)
    waiting = list(starts)
    while waiting and not reached.all():
        here = waiting.pop(0)
        others = np.flatnonzero(~reached)
        seen = others[walls.rays.is_visible(places[others], here)]
        reached[seen] = True
        if not straight:
            waiting += list(places[seen])
    return reached


def _most_enclosed(walls: Walls, places: Float) -> Bool:
    """(p,) places of the parts of space that see little sky, or all where all see much."""
    part = np.full(len(places), -1)
    while (part < 0).any():
        own = np.flatnonzero(part < 0)
        first = int(own[0])
        part[own[_connected(walls, places[own[:1]], places[own])]] = first
        part[first] = first
    _, part = np.unique(part, return_inverse=True)
    sky = np.bincount(part, _sky(walls, places)) / np.bincount(part)
    enclosed = (sky < MOST_SKY)[part]
    return enclosed if enclosed.any() else np.ones(len(places), bool)


def _sky(walls: Walls, places: Float) -> Float:
    """(p,) share of the directions in which there is nothing."""
    origins = np.repeat(places, len(AROUND), axis=0)
    hits = walls.rays.first_hits(origins, np.tile(AROUND, (len(places), 1)))
    return (hits.triangle < 0).reshape(len(places), -1).mean(axis=1)
