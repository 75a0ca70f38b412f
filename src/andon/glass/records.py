"""Host structs of the glass: what its shaders know of the solids, the eye and the lamps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.bvh import Places
from andon.glass.model import (
    MAX_HIGHLIGHTS,
    MAX_SOLIDS,
    Ball,
    Closed,
    Highlight,
    LensShape,
    Slab,
    Solid,
)
from andon.gpu.layout import HostStruct

__all__ = [
    "GLASS_RECORD",
    "HIGHLIGHT_RECORD",
    "SOLID_RECORD",
    "STRUCTS",
    "pack_highlights",
    "pack_solids",
]

Float = NDArray[np.float64]

SOLID_RECORD = HostStruct(
    "SolidRecord",
    (
        # columns of world_from_glass
        ("right", "vec3f"),
        ("interfaces", "u32"),
        ("up", "vec3f"),
        ("first_node", "i32"),  # of a mesh, in the texture of nodes
        ("front", "vec3f"),
        ("highlight_exponent", "f32"),
        ("centre", "vec3f"),
        ("sticker_alpha", "f32"),  # 1 − transmittance of the sticker; 0 without one
        # ball: radius; slab: half width, height, thickness; mesh: how many nodes;
        # lens: rim, front, back, thickness
        ("size", "vec4f"),
        ("index", "vec4f"),  # red, green, blue
        ("absorption_per_m", "vec3f"),
        ("first_triangle", "i32"),
    ),
)

GLASS_RECORD = HostStruct(
    "GlassRecord",
    (
        ("focus_dioptres", "f32"),
        ("pupil_m", "f32"),  # 0: nothing is blurred
        ("largest_px", "f32"),
        ("units_per_cd_m2", "f32"),
        ("highlights", "u32"),
        # 1: blur by how far away a layer appears, 0: by how far away its light comes from
        ("apparent", "u32"),
    ),
)

HIGHLIGHT_RECORD = HostStruct(
    "HighlightRecord",
    (
        # w = 1: place in metres, light in cd. w = 0: direction to the lamp, light in lux.
        ("place", "vec4f"),
        ("light", "vec3f"),
        ("solid", "i32"),  # that mirrors it
    ),
)

STRUCTS = {s.name: s for s in (SOLID_RECORD, GLASS_RECORD, HIGHLIGHT_RECORD)}


def _size(shape: Ball | Slab | LensShape | Closed, nodes: int) -> Sequence[float]:
    match shape:
        case Ball(radius):
            return (radius, 0, 0, 0)
        case Slab(half):
            return (*half, 0)
        case LensShape(radius, (front, back), thickness):
            return (radius, front, back, thickness)
        case Closed():
            return (nodes, 0, 0, 0)


def pack_solids(
    solids: Sequence[Solid],
    /,
    *,
    meshes: Places,
) -> NDArray[Any]:
    """(MAX_SOLIDS,) `SOLID_RECORD`.

    Parameters
    ----------
    solids : at most MAX_SOLIDS, outermost first.
    meshes : of the solids that are `Closed`, in their order.
    """
    table = np.zeros(MAX_SOLIDS, SOLID_RECORD.dtype)
    rows = iter(zip(meshes.first_node, meshes.node_count, meshes.first_triangle, strict=True))
    for row, solid in enumerate(solids):
        node, nodes, triangle = next(rows) if isinstance(solid.shape, Closed) else (0, 0, 0)
        pose = solid.world_from_glass
        alpha = 0.0 if solid.sticker is None else 1 - solid.sticker.transmittance
        table[row] = SOLID_RECORD.pack(
            right=pose[:3, 0],
            up=pose[:3, 1],
            front=pose[:3, 2],
            centre=pose[:3, 3],
            interfaces=solid.interfaces,
            first_node=node,
            first_triangle=triangle,
            highlight_exponent=solid.highlight_exponent,
            sticker_alpha=alpha,
            size=_size(solid.shape, nodes),
            index=(*solid.index, 1.0),
            absorption_per_m=solid.absorption_per_m,
        )[0]
    return table


def pack_highlights(highlights: Sequence[Highlight], /) -> NDArray[Any]:
    """(MAX_HIGHLIGHTS,) `HIGHLIGHT_RECORD`; at most as many are given."""
    table = np.zeros(MAX_HIGHLIGHTS, HIGHLIGHT_RECORD.dtype)
    for row, one in enumerate(highlights):
        table[row] = HIGHLIGHT_RECORD.pack(
            place=(*one.towards, 0.0 if one.distant else 1.0), light=one.light, solid=one.solid
        )[0]
    return table
