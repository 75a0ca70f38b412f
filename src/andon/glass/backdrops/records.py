"""Host structs: what shaders know of a body's backdrop, sticker and environment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.atlas import Atlas, Rectangle
from andon.glass.model import MAX_SOLIDS, Ball, Closed, Solid
from andon.gpu.layout import HostStruct

__all__ = [
    "BACKDROP_RECORD",
    "ENVIRONMENT_RECORD",
    "KINDS",
    "STRUCTS",
    "backdrop_variants",
    "pack_backdrops",
    "pack_environments",
]

KINDS = ("texture", "frame", "surface")

BACKDROP_RECORD = HostStruct(
    "BackdropRecord",
    (
        ("centre", "vec3f"),
        ("distance_m", "f32"),
        ("right", "vec3f"),  # half the width
        ("kind", "i32"),  # of KINDS
        ("up", "vec3f"),  # half the height
        ("levels", "i32"),
        ("light", "vec3f"),  # of a picture's 1, in units of the frame
        ("sticker_levels", "i32"),
        ("picture", "vec4f"),  # column, row, width, height in the atlas
        ("sticker", "vec4f"),
        ("sticker_repeats", "vec2f"),
        ("padding", "vec2f"),
    ),
)

ENVIRONMENT_RECORD = HostStruct(
    "EnvironmentRecord",
    (
        *((f"{channel}_{part}", "vec4f") for channel in ("red", "green", "blue") for part in "ab"),
        ("last", "vec3f"),
        ("padding", "f32"),
    ),
)

STRUCTS = {struct.name: struct for struct in (BACKDROP_RECORD, ENVIRONMENT_RECORD)}

_FOLDER = "andon/glass/backdrops"


def pack_backdrops(
    solids: Sequence[Solid], atlas: Atlas, dimming: tuple[float, float, float], /
) -> NDArray[Any]:
    """(8,) `BACKDROP_RECORD` of a scene's bodies, and of none."""
    records = np.zeros(MAX_SOLIDS, BACKDROP_RECORD.dtype)
    for index, solid in enumerate(solids):
        backdrop = solid.backdrop
        picture, sticker = atlas.backdrops[index], atlas.stickers[index]
        records[index : index + 1] = BACKDROP_RECORD.pack(
            centre=backdrop.centre_m,
            distance_m=backdrop.distance_m,
            right=backdrop.right_m,
            kind=KINDS.index(backdrop.kind),
            up=backdrop.up_m,
            levels=picture.levels,
            light=dimming,
            sticker_levels=sticker.levels,
            picture=_corner_size(picture),
            sticker=_corner_size(sticker),
            sticker_repeats=sticker_repeats(solid),
        )
    return records


def _corner_size(rectangle: Rectangle) -> tuple[int, int, int, int]:
    return rectangle.column, rectangle.row, rectangle.width, rectangle.height


def sticker_repeats(solid: Solid, /) -> tuple[bool, bool]:
    """Columns and rows of a sticker begin again: around a ball, and by glTF's rule on meshes."""
    return isinstance(solid.shape, Ball | Closed), isinstance(solid.shape, Closed)


def pack_environments(coefficients: NDArray[Any], luminance_per_unit: float, /) -> NDArray[Any]:
    """(8,) `ENVIRONMENT_RECORD` of (n ≤ 8, 9, 3) coefficients in cd/m²."""
    records = np.zeros(MAX_SOLIDS, ENVIRONMENT_RECORD.dtype)
    for record, own in zip(records, coefficients / luminance_per_unit, strict=False):
        for channel, name in enumerate(("red", "green", "blue")):
            record[f"{name}_a"], record[f"{name}_b"] = own[:4, channel], own[4:8, channel]
        record["last"] = own[8]
    return records


def backdrop_variants(solids: Sequence[Solid], projection: str, /) -> dict[str, str]:
    """`variants` of a shader that imports which.wgsl: just the kinds that the bodies have.

    `projection` is the view's, of the frame that is seen through the glass.
    """
    present = {solid.backdrop.kind for solid in solids}
    kinds = [kind for kind in KINDS if kind in present] or ["texture"]
    arguments = "solid, origin, direction, footprint"
    calls = {kind: f"return {kind}_seen({arguments});" for kind in kinds}
    others = [f"  if (kind == {KINDS.index(kind)}) {{ {calls[kind]} }}" for kind in kinds[1:]]
    body = (
        ["  let kind = backdrops[solid].kind;"] * bool(others) + others + ["  " + calls[kinds[0]]]
    )
    text = "\n".join(
        [
            *(f"//!import {_FOLDER}/{kind}.wgsl" for kind in kinds),
            "fn backdrop_seen(solid: i32, origin: vec3f, direction: vec3f, footprint: Footprint)"
            " -> Seen {",
            *body,
            "}",
        ]
    )
    projected = f"{_FOLDER}/projections/{{}}.wgsl"
    return {
        f"{_FOLDER}/which.wgsl": text,
        projected.format("pinhole"): projected.format(projection),
    }
