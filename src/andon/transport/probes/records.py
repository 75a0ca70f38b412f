"""A probe volume as the shaders hold it: pictures of numbers, and where in them what begins.

One picture of float32 texels holds the geometry; whole numbers are exact up to 2²⁴.

=========  ======  ====================================================================
part       texels  of
=========  ======  ====================================================================
cells      5       rows of the inverse (xyz) and origin (w); neighbours; corners
facets     4       corners (xyz) and their probes (w); ring's first, count, cell, extent
rings      ¼       facets that share a corner, listed
starts     ¼       cells where walks begin, listed
places     4       where a probe is captured; where it counts; its 8 neighbours
zones      3       grid: origin and first start; 1/step; shape
boxes      2       low corner and number of the zone; high corner
=========  ======  ====================================================================
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.model import Distances
from andon.harmonics import convolved
from andon.transport.probes.hidden import NEIGHBOURS, Walls
from andon.transport.probes.lookup import step_limit
from andon.transport.probes.space import ProbeSpace

__all__ = [
    "DATA_WIDTH",
    "Packed",
    "atlas_tiles",
    "pack_distances",
    "pack_light",
    "pack_space",
    "settings_text",
]

Float32 = NDArray[np.float32]

# Texels a row of the pictures of numbers; `datum` of cells.wgsl divides by it.
DATA_WIDTH = 2048
# What float32 holds without loss.
MOST_NUMBERS = 1 << 24
# Boxes may be without end; shaders have no infinity.
ENDLESS = 1e30


@dataclass(frozen=True, eq=False)
class Packed:
    """Texels (rows, DATA_WIDTH, 4) and the first texel of each part."""

    texels: Float32
    firsts: dict[str, int]


def pack_space(space: ProbeSpace, walls: Walls | None = None, /) -> Packed:
    """All of a volume's geometry; `places` only where there are walls."""
    parts = {
        "cells": _cells(space),
        "facets": _facets(space),
        "rings": _listed(space.facet_rings[1]),
        "starts": _listed(space.grid_starts),
        "places": np.zeros((0, 4)) if walls is None else _places(walls),
        "zones": _zones(space),
        "boxes": _boxes(space),
    }
    sizes = [len(part) for part in parts.values()]
    firsts = dict(zip(parts, np.cumsum([0, *sizes[:-1]]).tolist(), strict=True))
    return Packed(_rows(np.concatenate(list(parts.values()))), firsts)


def _rows(texels: NDArray[Any]) -> Float32:
    """Texels (t, 4) as rows of a picture, the last filled up."""
    rows = max(1, -(-len(texels) // DATA_WIDTH))
    if rows * DATA_WIDTH > MOST_NUMBERS:
        raise InputError(
            f"a probe volume of {len(texels)} texels is too large for shaders, {MOST_NUMBERS} can "
            "be",
            field="probes.volume",
            remedy="use fewer probes, or the reference engine",
        )
    picture = np.zeros((rows * DATA_WIDTH, 4), np.float32)
    picture[: len(texels)] = texels
    return picture.reshape(rows, DATA_WIDTH, 4)


def _listed(numbers: NDArray[np.integer]) -> NDArray[np.float64]:
    flat = np.zeros(-(-len(numbers) // 4) * 4)
    flat[: len(numbers)] = numbers
    return flat.reshape(-1, 4)


def _cells(space: ProbeSpace) -> NDArray[np.float64]:
    rows = np.concatenate([space.inverses, space.origins[:, :, None]], axis=2)
    tables = np.stack([space.neighbours, space.corners], axis=1).astype(np.float64)
    return np.asarray(np.concatenate([rows, tables], axis=1).reshape(-1, 4), np.float64)


def _facets(space: ProbeSpace) -> NDArray[np.float64]:
    probes = space.facets[..., None].astype(np.float64)
    corners = np.concatenate([space.positions[space.facets], probes], axis=2)
    firsts, _ = space.facet_rings
    extents = np.where(space.facet_zones >= 0, space.zone_extents[space.facet_zones], 1.0)
    lists = (firsts[:-1], np.diff(firsts), space.facet_cells)
    last = np.stack([*(column.astype(np.float64) for column in lists), extents], axis=1)
    return np.concatenate([corners, last[:, None]], axis=1).reshape(-1, 4)


def _places(walls: Walls) -> NDArray[np.float64]:
    count = len(walls.positions)
    texels = np.zeros((count, 2 + NEIGHBOURS // 4, 4))
    texels[:, 0, :3], texels[:, 1, :3] = walls.capture_positions, walls.positions
    texels[:, 2:] = walls.neighbours.reshape(count, -1, 4)
    return texels.reshape(-1, 4)


def _zones(space: ProbeSpace) -> NDArray[np.float64]:
    texels = np.zeros((len(space.zone_names), 3, 4))
    texels[:, 0, :3], texels[:, 0, 3] = space.grid_origins, space.grid_firsts
    texels[:, 1, :3], texels[:, 2, :3] = 1 / space.grid_steps, space.grid_shapes
    return texels.reshape(-1, 4)


def _boxes(space: ProbeSpace) -> NDArray[np.float64]:
    texels = np.zeros((len(space.boxes), 2, 4))
    texels[..., :3] = np.clip(space.boxes, -ENDLESS, ENDLESS)
    texels[:, 0, 3] = space.box_zones
    return texels.reshape(-1, 4)


def pack_light(coefficients: NDArray[Any], /) -> Float32:
    """Convolved coefficients (n, k, 3) as texels: 7 of each nine, of bands 0 to 2 and maybe 4."""
    lit = convolved(coefficients)
    count = lit.shape[1]
    low = np.zeros((len(lit), 9, 3))
    low[:, : min(9, count)] = lit[:, :9]
    nines = [low] if count < 25 else [low, lit[:, 16:25]]
    texels = np.zeros((len(lit), len(nines), 7, 4))
    for number, nine in enumerate(nines):
        first = np.moveaxis(nine[:, :8], 1, 2).reshape(len(lit), 6, 4)
        texels[:, number, :6], texels[:, number, 6, :3] = first, nine[:, 8]
    return _rows(texels.reshape(-1, 4))


def atlas_tiles(count: int, /) -> int:
    """Tiles in a row of the picture of distances."""
    return max(1, int(np.ceil(np.sqrt(count))))


def pack_distances(distances: Distances, /) -> Float32:
    """Mean and variance of each texel (…, …, 2): a tile a probe, with a margin of one texel.

    Variances instead of mean squares: what float32 leaves of the difference of two squares would
    be too rough.
    """
    mean = distances.mean_m.astype(np.float64)
    variance = np.maximum(distances.mean_square_m2 - mean**2, 0)
    both = _with_margin(np.stack([mean, variance], axis=-1))
    count, side = both.shape[:2]
    tiles = atlas_tiles(count)
    atlas = np.zeros((-(-count // tiles), tiles, side, side, 2), np.float32)
    atlas.reshape(-1, side, side, 2)[:count] = both
    return atlas.transpose(0, 2, 1, 3, 4).reshape(-1, tiles * side, 2)


def _with_margin(pictures: NDArray[np.float64]) -> NDArray[np.float64]:
    """Octahedral pictures (n, s, s, c) with the texels across their edges around them."""
    side = pictures.shape[1]
    wide = np.zeros((len(pictures), side + 2, side + 2, pictures.shape[3]))
    wide[:, 1:-1, 1:-1] = pictures
    wide[:, 0, 1:-1], wide[:, -1, 1:-1] = pictures[:, 0, ::-1], pictures[:, -1, ::-1]
    wide[:, 1:-1, 0], wide[:, 1:-1, -1] = pictures[:, ::-1, 0], pictures[:, ::-1, -1]
    for row, across in ((0, -1), (-1, 0)):
        for column, aside in ((0, -1), (-1, 0)):
            wide[:, row, column] = pictures[:, across, aside]
    return wide


def settings_text(
    space: ProbeSpace, packed: Packed, terms: int, walls: Walls | None = None, /
) -> str:
    """The module that stands in for settings.wgsl."""
    numbers: dict[str, int | float] = {
        f"PROBE_{name.upper()}": first for name, first in packed.firsts.items()
    }
    numbers |= {
        "PROBE_BOX_COUNT": len(space.boxes),
        "PROBE_CELL_STEPS": step_limit(len(space.corners)),
        "PROBE_FACET_STEPS": step_limit(len(space.facets)),
        "PROBE_TERMS": terms,
        "PROBE_SIDE": 1.0 if walls is None else float(walls.distances.mean_m.shape[-1]),
        "PROBE_TILES": 1 if walls is None else atlas_tiles(len(walls.positions)),
        "PROBE_FAR_M": 1.0 if walls is None else float(walls.distances.far_m),
    }
    lines = [
        f"const {name}: {'f32' if isinstance(value, float) else 'i32'} = {value};"
        for name, value in numbers.items()
    ]
    return "\n".join(lines)
