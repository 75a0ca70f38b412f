"""A lamp as few tiles, for the light that surfaces reflect.

Each ray of a hemisphere that meets a surface asks all tiles there, so that hundreds of them cost
hundreds of times. What is reflected does not show them: the hard shadows of a dozen tiles melt in
a mean over half of all directions. What a lamp gives directly keeps all of its tiles.

::

    tiles ──split where they differ most, in place and direction──▶ groups ──▶ one tile of each,
                                                                              with the flux of all
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.transport.baked.radiance.emitters import Tiles

__all__ = ["thinned"]

Float = NDArray[np.float64]

# What a turn by a right angle counts for, in sizes of the lamp.
TURN = 0.7


def thinned(parts: Sequence[Tiles], most: int, /) -> list[Tiles]:
    """At most `most` of the tiles, with the flux of all of them, channel by channel."""
    every = [(corners, part.luminance_cd_m2) for part in parts for corners in part.corners]
    if len(every) <= most:
        return list(parts)
    # Radiance leaves out polygons without an area as well.
    tiles = [tile for tile in every if _area(tile[0]) > 0]
    area = np.array([_area(corners) for corners, _ in tiles])
    flux = area[:, None] * np.array([luminance for _, luminance in tiles])
    features = _features([corners for corners, _ in tiles])
    weight = flux.sum(axis=1)
    found: list[Tiles] = []
    for group in _groups(features, weight, most):
        own = weight[group]
        if not own.sum() > 0:
            continue
        off = features[group] - (own @ features[group]) / own.sum()
        chosen = int(group[np.argmin((off**2).sum(axis=1))])
        found.append(Tiles(tiles[chosen][0][None], flux[group].sum(axis=0) / area[chosen]))
    return found


def _area(corners: Float) -> float:
    """Of a flat, convex polygon (k, 3), m²."""
    spokes = corners[1:] - corners[0]
    return float(np.linalg.norm(np.cross(spokes[:-1], spokes[1:]).sum(axis=0)) / 2)


def _features(tiles: Sequence[Float]) -> Float:
    """(n, 6) place in sizes of the lamp, and direction."""
    middles = np.array([corners.mean(axis=0) for corners in tiles])
    normals = np.array([np.cross(c[1] - c[0], c[2] - c[0]) for c in tiles])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    size = float(np.ptp(middles, axis=0).max())
    return np.concatenate([middles / (size or 1.0), TURN * normals], axis=1)


def _groups(features: Float, weight: Float, most: int) -> list[NDArray[np.int64]]:
    """At most `most` groups: the one that spreads most is split, until there are so many."""
    groups = [np.arange(len(features))]
    spreads = [_spread(features, weight, groups[0])]
    while len(groups) < most and max(spreads)[0] > 0:
        widest = max(range(len(groups)), key=lambda number: spreads[number][0])
        group, (_, axis, middle) = groups[widest], spreads[widest]
        low = features[group, axis] < middle
        halves = [group[low], group[~low]]
        groups[widest : widest + 1] = halves
        spreads[widest : widest + 1] = [_spread(features, weight, half) for half in halves]
    return groups


def _spread(features: Float, weight: Float, group: NDArray[np.int64]) -> tuple[float, int, float]:
    """Flux times variance of a group along the axis where that is most; the axis, and its middle.

    0 where the group is one tile, or all of it is in one place.
    """
    own, places = weight[group], features[group]
    if len(group) < 2 or not own.sum() > 0:
        return 0.0, 0, 0.0
    middle = own @ places / own.sum()
    variance = own @ (places - middle) ** 2
    axis = int(np.argmax(variance))
    low = places[:, axis] < middle[axis]
    return (float(variance[axis]), axis, float(middle[axis])) if low.any() else (0.0, 0, 0.0)
