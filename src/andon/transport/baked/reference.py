"""Illuminance maps projected onto points, in float64: which map saw the point, and what it saw.

::

       camera of a map                 P  the point, n its normal
            ◺ ╲                        ×  its four texels: where they lie, their normals, their lux
               ╲  ×   ×
    ────────────╲───P─────  surface    a texel counts if P lies in its tangent plane and n agrees
                  ×   ×
                        ┌───── a wall: its texels lie in another plane and face elsewhere
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, transform_points
from andon.transport.baked.model import BakedLight, BakedMoment, IlluminanceMap, Mode
from andon.transport.baked.texels import (
    BORDER_TEXELS,
    LEAST_WEIGHT,
    MOST_DENSITY,
    NORMAL_COSINES,
    VALID_LEAST,
    Texels,
    kept_texels,
)

__all__ = [
    "baked_illuminance",
    "border_share",
    "illuminance_at",
    "map_illuminance",
    "texel_density",
    "texel_taps",
]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]


def illuminance_at(
    light: BakedLight, time_seconds: float, position: Float, normal: Float, /
) -> tuple[Float, Bool]:
    """Illuminance (n, 3) in lx and whether a map covers each point (n,), at a time.

    Between two moments their mean by time; where only one of them is valid, since something
    moved, that one. See `baked_illuminance` for the points.
    """
    earlier, later, share = light.around(time_seconds)
    shares = light.shares(time_seconds)

    def of(moment: int) -> tuple[Float, Bool]:
        return baked_illuminance(
            light.load(moment),
            position,
            normal,
            shares=shares,
            mode=light.mode,
            depth_tolerance_m=light.depth_tolerance_m,
        )

    lux, covered = of(earlier)
    if later == earlier:
        return lux, covered
    next_lux, next_covered = of(later)
    part = np.where(covered, np.where(next_covered, share, 0.0), 1.0)[:, None]
    return (1 - part) * lux + part * next_lux, covered | next_covered


def baked_illuminance(
    moment: BakedMoment,
    position: Float,
    normal: Float,
    /,
    *,
    shares: Mapping[str, float],
    mode: Mode = "blend",
    depth_tolerance_m: float = 0.02,
) -> tuple[Float, Bool]:
    """Illuminance of baked light at points.

    Parameters
    ----------
    moment : the maps; none cover nothing.
    position : (n, 3) m, world. Points that are not finite are not covered.
    normal : (n, 3) unit, world, towards the side that is lit.
    shares : lamp name → factor on its maps, ≥ 0; a lamp that is not named counts in full.
    mode : ``blend`` all maps that see a point, or take the ``first_valid`` one.
    depth_tolerance_m : how far off a texel's tangent plane a point may be, in m.

    Returns
    -------
    lux (n, 3), 0 where no map is valid, and covered (n,).
    """
    position, normal = np.asarray(position, np.float64), np.asarray(normal, np.float64)
    total, weights = np.zeros((len(position), 3)), np.zeros(len(position))
    for seen in moment.maps:
        lux, weight = map_illuminance(seen, position, normal, shares, depth_tolerance_m)
        if mode == "first_valid":
            weight = np.where((weights == 0) & (weight > 0), 1.0, 0.0)
        total += weight[:, None] * lux
        weights += weight
    covered = weights > 0
    return total / np.where(covered, weights, 1.0)[:, None], covered


def map_illuminance(
    seen: IlluminanceMap,
    position: Float,
    normal: Float,
    shares: Mapping[str, float],
    depth_tolerance_m: float,
    /,
) -> tuple[Float, Float]:
    """What one map says of points: lux (n, 3), and its weight (n,) in a blend, 0 if not valid.

    The weight is texels per m², feathered towards the borders of the map and of what it sees: by
    the fourth power, so that a map that counts 100 times as much as its neighbour does not take
    over within one texel of its border.
    """
    lux, weight = np.zeros((len(position), 3)), np.zeros(len(position))
    reach = position - seen.view.position
    with np.errstate(invalid="ignore", divide="ignore"):
        pixels = seen.view.project(transform_points(seen.view.camera_from_world, position))
        facing = -np.einsum("ij,ij->i", reach, normal) / np.linalg.norm(reach, axis=1)
        border = border_share(seen.view, pixels)
        looked = (border > 0) & (facing > 0) & np.isfinite(pixels).all(axis=1)
    texels = kept_texels(seen, depth_tolerance_m)
    index, parts = texel_taps(seen.view, pixels[looked])
    valid = parts * _agreement(texels, index, reach[looked], normal[looked], depth_tolerance_m)
    sums = valid.sum(axis=1)
    share = np.maximum((sums - VALID_LEAST) / (1 - VALID_LEAST), 0)
    valid /= np.maximum(sums, VALID_LEAST)[:, None]
    trust = np.einsum("nk,nk->n", valid, texels.trust[index])
    density = np.minimum(facing[looked] * texel_density(seen.view, position[looked]), MOST_DENSITY)
    lux[looked] = np.einsum("nk,nkc->nc", valid, _mixed(seen, shares)[index])
    feathered = (border[looked] * trust) ** 4 * share + LEAST_WEIGHT
    weight[looked] = np.where(share > 0, density * feathered, 0.0)
    return lux, weight


def _agreement(
    texels: Texels, index: Int, reach: Float, normal: Float, depth_tolerance_m: float
) -> Float:
    """(n, 4) 0…1: how far each texel's surface is that of the point."""
    theirs = texels.normal[index]
    off_plane = np.einsum("nkc,nkc->nk", theirs, reach[:, None] - texels.reach[index])
    low, high = NORMAL_COSINES
    cosine = np.einsum("nkc,nc->nk", theirs, normal)
    alike = np.clip((cosine - low) / (high - low), 0, 1)
    near = texels.valid[index] & (np.abs(off_plane) < depth_tolerance_m)
    return np.where(near, alike, 0.0)


def _mixed(seen: IlluminanceMap, shares: Mapping[str, float]) -> Float:
    """(h·w, 3) lx of all lamps together."""
    total = np.zeros((*seen.view.shape, 3))
    for name, lux in seen.lux.items():
        factor = shares.get(name, 1.0)
        if factor:
            total += factor * np.where(np.isfinite(lux), lux, 0.0)
    return total.reshape(-1, 3)


def border_share(view: View, pixels: Float, /) -> Float:
    """(n,) 0 outside the map, rising to 1 well within; a latlong map has no border.

    Whatever lies within the map, even on its border, has a share > 0.
    """
    if view.projection == "latlong":
        return np.ones(len(pixels))
    with np.errstate(invalid="ignore"):
        beyond = np.minimum(pixels + 0.5, np.array([view.width, view.height]) - 0.5 - pixels)
        within = beyond.min(axis=1)
        part = np.minimum(within / min(BORDER_TEXELS, min(view.shape) / 4), 1)
        return np.where(within >= 0, np.maximum(part, LEAST_WEIGHT), 0.0)


def texel_taps(view: View, pixels: Float, /) -> tuple[Int, Float]:
    """Flat indices (n, 4) and bilinear parts (n, 4) of the texels around pixel coordinates (n, 2).

    Latlong goes round, and over the poles down on the other side. Elsewhere the parts of texels
    outside the map are 0.
    """
    first = np.floor(pixels)
    x, y = (pixels - first).T
    column, row = first.astype(np.int64).T
    columns = np.stack([column, column + 1, column, column + 1], axis=-1)
    rows = np.stack([row, row, row + 1, row + 1], axis=-1)
    parts = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y], axis=-1)
    height, width = view.shape
    if view.projection == "latlong":
        over = (rows < 0) | (rows >= height)
        columns = (columns + np.where(over, width // 2, 0)) % width
    outside = (columns < 0) | (columns >= width)
    if view.projection != "latlong":
        outside |= (rows < 0) | (rows >= height)
    index = np.clip(rows, 0, height - 1) * width + np.clip(columns, 0, width - 1)
    return index, np.where(outside, 0.0, parts)


def texel_density(view: View, position: Float, /) -> Float:
    """(n,) texels per m² of a surface at points (n, 3) that faces the camera of a map.

    By the direction in which texels lie farthest apart: at the poles of a latlong map there are
    many to the steradian, but all in one direction.
    """
    reach = position - view.position
    squared = np.einsum("ij,ij->i", reach, reach)
    if view.projection == "latlong":
        return min(view.height / np.pi, view.width / (2 * np.pi)) ** 2 / squared
    if view.projection == "fisheye":
        return view.fx * view.fy / squared
    return view.fx * view.fy / (reach @ view.world_from_camera[:3, 2]) ** 2
