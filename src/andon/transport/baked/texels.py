"""What both engines ask a map's texels: their tangent planes, and how far to trust them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from andon.spaces import rotate
from andon.transport.baked.model import IlluminanceMap

__all__ = [
    "BORDER_TEXELS",
    "LEAST_WEIGHT",
    "MOST_DENSITY",
    "NORMAL_COSINES",
    "VALID_LEAST",
    "Texels",
    "kept_texels",
    "texels_of",
]

Float = NDArray[np.float64]

# Cosines: two normals 60° apart are two surfaces, up to 30° apart one; linear between.
NORMAL_COSINES = (0.5, 0.8660254037844387)
# A map that sees less than this share of the texels around a point does not see the point.
VALID_LEAST = 1e-3
# Weights fall to 0 over so many texels at a map's border (or a quarter of a small map) …
BORDER_TEXELS = 24.0
# … and so many at the edges of what it sees.
EDGE_TEXELS = 12
# Texels per m², at most: nearer than that to a camera, more mean nothing.
MOST_DENSITY = 1e10
# What is left of a weight at a border: it counts where nothing else does.
LEAST_WEIGHT = 1e-8


@dataclass(frozen=True, eq=False)
class Texels:
    """A map's surface, texel by texel (rows first).

    Attributes
    ----------
    valid : (t,) there is a surface, and its light is known.
    normal : (t, 3) unit, world; 0 where not valid.
    reach : (t, 3) m, world axes, from the map's camera to the surface; 0 where not valid.
    trust : (t,) 0…1 in steps of 1/13, rising from the edges of what the map sees inwards; 0 where
        not valid.
    """

    valid: NDArray[np.bool_]
    normal: NDArray[np.float32]
    reach: NDArray[np.float32]
    trust: Float


_kept: WeakKeyDictionary[IlluminanceMap, dict[float, Texels]] = WeakKeyDictionary()


def kept_texels(seen: IlluminanceMap, depth_tolerance_m: float, /) -> Texels:
    """`texels_of`, kept as long as the map is: the frames of a session ask for the same ones again.

    Not the last few of any: whoever asks for more maps than that in turn would find none.
    """
    own = _kept.setdefault(seen, {})
    if depth_tolerance_m not in own:
        own[depth_tolerance_m] = texels_of(seen, depth_tolerance_m)
    return own[depth_tolerance_m]


def texels_of(seen: IlluminanceMap, depth_tolerance_m: float, /) -> Texels:
    """A map's texels; neighbours that are farther off each other's planes are two surfaces."""
    view = seen.view
    known = np.isfinite(seen.depth_m) & (seen.depth_m > 0) & np.isfinite(seen.normal).all(axis=-1)
    for lux in seen.lux.values():
        known &= np.isfinite(lux).all(axis=-1)
    reach = rotate(view.world_from_camera, view.rays_planar())
    reach = reach * np.where(known, seen.depth_m, 0.0)[..., None]
    normal = np.where(known[..., None], seen.normal, 0.0).astype(np.float64)
    edges = _edges(known, normal, reach, view.projection == "latlong", depth_tolerance_m)
    trust = np.where(known, _inwards(edges, view.projection == "latlong"), 0.0)
    # Single floats: 0.3 μm at 5 m, and half the room for what is kept.
    normals, reaches = (values.reshape(-1, 3).astype(np.float32) for values in (normal, reach))
    return Texels(known.ravel(), normals, reaches, trust.ravel())


def _edges(
    known: NDArray[np.bool_],
    normal: Float,
    reach: Float,
    goes_round: bool,
    depth_tolerance_m: float,
) -> NDArray[np.bool_]:
    """(h, w) texels of which a neighbour shows another surface, or none."""
    edges = ~known
    for axis in (0, 1):
        next_known, next_normal, next_reach = (
            np.roll(values, -1, axis) for values in (known, normal, reach)
        )
        cosine = np.einsum("hwc,hwc->hw", normal, next_normal)
        off_plane = np.abs(np.einsum("hwc,hwc->hw", normal, next_reach - reach))
        jump = ~(next_known & (cosine > NORMAL_COSINES[0]) & (off_plane < depth_tolerance_m))
        if axis == 0 or not goes_round:
            jump[(slice(None),) * axis + (-1,)] = False
        edges |= jump | np.roll(jump, 1, axis)
    return edges


def _inwards(edges: NDArray[np.bool_], goes_round: bool) -> Float:
    """(h, w) 1/13 at edges, rising inwards to 1, by distance along rows and columns."""
    steps = np.where(edges, 0.0, float(EDGE_TEXELS))
    for _ in range(EDGE_TEXELS - 1):
        padded = np.pad(steps, 1, mode="edge")
        if goes_round:
            padded[1:-1, 0], padded[1:-1, -1] = steps[:, -1], steps[:, 0]
        around: list[Any] = [
            padded[2:, 1:-1],
            padded[:-2, 1:-1],
            padded[1:-1, 2:],
            padded[1:-1, :-2],
        ]
        steps = np.minimum(steps, np.min(around, axis=0) + 1)
    return (steps + 1) / (EDGE_TEXELS + 1)
