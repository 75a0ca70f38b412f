"""Maps as the shaders hold them: records of cameras, and pages of texels.

==================  =============  ================================================================
page                bytes a texel  of
==================  =============  ================================================================
surface             16             the tangent plane's offset from the camera, trust, normal
lamps, a layer each 8              lux as half floats, in units of the lamp's largest
mix                 16             the same with the lux of all lamps: what a frame reads
==================  =============  ================================================================

A texel's *plane* is kept rather than its depth: the distance of a point from it is one product,
where a depth would first have to be made a place again by the map's own projection.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.gpu.layout import HostStruct
from andon.spaces import View
from andon.transport.baked.atlas import Atlas, Place
from andon.transport.baked.model import IlluminanceMap, Mode
from andon.transport.baked.texels import (
    BORDER_TEXELS,
    EDGE_TEXELS,
    texels_of,
)

__all__ = [
    "BAKED_MAP",
    "BAKED_SETTINGS",
    "MAX_LAMPS",
    "MAX_MAPS",
    "STORED_MOST",
    "STRUCTS",
    "Pages",
    "check_memory",
    "moments_text",
    "pack_map",
    "pack_pages",
    "pack_shares",
    "settings_text",
]

# Maps of a moment; baked.wgsl has room for two moments.
MAX_MAPS = 64
# Of them, those that a shader is compiled for.
MOST_NAMED = 8
# Layers of a texture, and numbers in mix.wgsl.
MAX_LAMPS = 256
# Of all pages: more than that few adapters have, and software ones take the machine's memory.
MOST_BYTES = 4 << 30
# The largest lux of a lamp is stored as this: below the largest half float, 2³¹ above the smallest
# that has all its bits.
STORED_MOST = 32768.0

# Trust lies in the last bits of the offset, where they mean 2⁻¹⁹ of it: 5 μm at 2.5 m.
TRUST_STEPS, TRUST_BITS = EDGE_TEXELS + 1, 15

_KINDS = {"pinhole": 0, "fisheye": 1, "latlong": 2}

BAKED_MAP = HostStruct(
    "BakedMap",
    (
        # columns of world_from_camera
        ("right", "vec3f"),
        ("kind", "i32"),
        ("down", "vec3f"),
        ("layer", "i32"),
        ("forward", "vec3f"),
        ("border", "f32"),  # texels over which its weight rises
        ("position", "vec3f"),
        ("rate", "f32"),  # texels per radian, squared
        ("focal", "vec2f"),
        ("centre", "vec2f"),  # of whole numbers: texels are read, not drawn
        ("size", "vec2f"),
        ("place", "vec2f"),  # of its top left texel
    ),
)

BAKED_SETTINGS = HostStruct(
    "BakedSettings",
    (
        ("earlier_scale", "f32"),  # lux per stored unit
        ("later_scale", "f32"),
        ("later_share", "f32"),
        ("depth_tolerance_m", "f32"),
    ),
)

STRUCTS = {struct.name: struct for struct in (BAKED_MAP, BAKED_SETTINGS)}


@dataclass(frozen=True, eq=False)
class Pages:
    """The maps of a moment on the pages of an atlas.

    Attributes
    ----------
    surface : (pages, H, W, 4) uint32.
    lamps : (pages, lamps, H, W, 4) float16.
    most_lux : (lamps,) what is stored as `STORED_MOST`.
    """

    surface: NDArray[np.uint32]
    lamps: NDArray[np.float16]
    most_lux: NDArray[np.float64]


def check_memory(atlas: Atlas, /, *, lamps: int, moments: int) -> None:
    """Raises `MachineError` where pages of so many lamps and moments are larger than is sane."""
    texels = atlas.width * atlas.height * atlas.pages
    needed = moments * texels * (16 + 8 * lamps + 16)
    if needed > MOST_BYTES:
        raise MachineError(
            f"the illuminance maps need {needed / 2**30:.1f} GiB on the adapter, more than "
            f"{MOST_BYTES / 2**30:g}",
            remedy="bake fewer or smaller maps (baked.map_size_px), or use --engine reference",
        )


def pack_map(view: View, place: Place, first_layer: int, /) -> NDArray[Any]:
    """One `BAKED_MAP`."""
    pose = view.world_from_camera
    rate = view.fx * view.fy
    if view.projection == "latlong":
        rate = min(view.height / np.pi, view.width / (2 * np.pi)) ** 2
    return BAKED_MAP.pack(
        right=pose[:3, 0],
        down=pose[:3, 1],
        forward=pose[:3, 2],
        position=pose[:3, 3],
        kind=_KINDS[view.projection],
        layer=first_layer + place.page,
        border=min(BORDER_TEXELS, min(view.shape) / 4),
        rate=rate,
        focal=(view.fx, view.fy),
        centre=(view.cx, view.cy),
        size=(view.width, view.height),
        place=(place.x, place.y),
    )


def pack_pages(
    maps: Sequence[IlluminanceMap], atlas: Atlas, lamps: Sequence[str], tolerance_m: float, /
) -> Pages:
    """The texels of a moment; a lamp that a map does not have gives it no light."""
    shape = atlas.height, atlas.width
    surface = np.zeros((atlas.pages, *shape, 4), np.uint32)
    light = np.zeros((atlas.pages, len(lamps), *shape, 4), np.float16)
    most = np.array([_most([seen.lux.get(name) for seen in maps]) for name in lamps])
    for seen, place in zip(maps, atlas.places, strict=True):
        rows = slice(place.y, place.y + seen.view.height)
        columns = slice(place.x, place.x + seen.view.width)
        surface[place.page, rows, columns] = _surface(seen, tolerance_m)
        for number, name in enumerate(lamps):
            if name in seen.lux:
                stored = np.nan_to_num(seen.lux[name], posinf=0.0) * (STORED_MOST / most[number])
                light[place.page, number, rows, columns, :3] = stored
    return Pages(surface, light, most)


def _most(of_maps: Sequence[NDArray[Any] | None]) -> float:
    """Largest finite lux of a lamp; 1 where there is none."""
    most = [np.max(lux, where=np.isfinite(lux), initial=0.0) for lux in of_maps if lux is not None]
    return float(max(most, default=0.0)) or 1.0


def _surface(seen: IlluminanceMap, tolerance_m: float) -> NDArray[np.uint32]:
    """(h, w, 4): the plane through the texel that has the normal *as it is stored*, and trust."""
    texels = texels_of(seen, tolerance_m)
    signed = np.rint(texels.normal * 32767).astype(np.int16)
    offset = np.einsum("tc,tc->t", signed / 32767, texels.reach).astype(np.float32)
    trust = np.rint(texels.trust * TRUST_STEPS).astype(np.uint32)
    x, y, z = signed.view(np.uint16).astype(np.uint32).T
    packed = np.zeros((len(signed), 4), np.uint32)
    packed[:, 0] = (offset.view(np.uint32) & ~np.uint32(TRUST_BITS)) | trust
    packed[:, 1] = x | (y << np.uint32(16))
    packed[:, 2] = z
    return packed.reshape(*seen.view.shape, 4)


def pack_shares(
    lamps: Sequence[str], most_lux: NDArray[np.float64], shares: Mapping[str, float], /
) -> tuple[NDArray[np.float32], float]:
    """Factors from each lamp's stored units to the sum's (MAX_LAMPS,), and lux per unit of it."""
    own = np.array([shares.get(name, 1.0) for name in lamps]) * most_lux
    total = float(own.sum()) or 1.0
    packed = np.zeros(MAX_LAMPS, np.float32)
    packed[: len(lamps)] = own / total
    return packed, total / STORED_MOST


def settings_text(views: Sequence[View], lamps: int, mode: Mode, /) -> str:
    """The module that stands in for settings.wgsl."""
    kinds = {view.projection for view in views}
    flags = {f"BAKED_{kind.upper()}": kind in kinds for kind in _KINDS}
    flags["BAKED_FIRST_VALID"] = mode == "first_valid"
    lines = [f"const {name}: bool = {str(flag).lower()};" for name, flag in flags.items()]
    return "\n".join([*lines, f"const BAKED_LAMPS: i32 = {lamps};"])


def moments_text(maps: int, moments: int, /) -> str:
    """The module that stands in for moments.wgsl: the maps of the moments in use, one by one.

    Maps are called by numbers that are known when a shader is compiled, the first `MOST_NAMED`: a
    software rasteriser reads a camera whose number is a variable once for each pixel of a group,
    which costs a quarter more; but 64 named ones take a minute to compile.
    """
    lines = ["//!import andon/transport/baked/lookup.wgsl"]
    for moment, name in enumerate(("earlier", "later")):
        first, count = moment * MAX_MAPS, maps if moment < moments else 0
        named = [_call(f"{first + number}") for number in range(min(count, MOST_NAMED))]
        lines += [
            f"fn baked_{name}(position: vec3f, normal: vec3f) -> vec4f {{",
            "  var total = vec4f(0.0);",
            *named,
        ]
        if count > MOST_NAMED:
            loop = f"var k = {first + MOST_NAMED}; k < {first + count}; k++"
            lines += [f"  for ({loop}) {{", f"  {_call('k')}", "  }"]
        lines += ["  return known_light(total);", "}"]
    return "\n".join(lines)


def _call(number: str) -> str:
    return f"  total += map_light(baked_maps[{number}], position, normal, total.w);"
