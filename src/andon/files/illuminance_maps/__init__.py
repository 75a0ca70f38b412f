"""Folders of baked illuminance maps: a manifest, and EXR pictures that any program opens.

::

    maps.json ──▶ cameras, moments, lamps        camera × moment ──▶ geometry   N.X N.Y N.Z Z
                                          lamp × camera × moment ──▶ light      R G B, lx

``docs/illuminance-maps.md`` specifies it for those who read it without this package.

======================== =============================================================
alternative              why not
======================== =============================================================
one multi-part EXR       a bake that goes on would write it anew for each map, and what
                         is one file cannot be named by what it depends on, task by task
NumPy's .npz             no lighting program opens it, nothing says units
layers of lamps in one   a lamp that changes would have all others traced again
======================== =============================================================
"""

from __future__ import annotations

from andon.files.illuminance_maps.folder import map_file, read_geometry, read_lux, read_moment
from andon.files.illuminance_maps.manifest import (
    MANIFEST,
    read_manifest,
    read_manifest_file,
    write_manifest,
)
from andon.files.illuminance_maps.model import BakedLamp, IlluminanceMap, Manifest, MapFile, Part
from andon.files.illuminance_maps.pixels import (
    geometry_bytes,
    light_bytes,
    read_geometry_picture,
    read_light_picture,
)
from andon.files.reader import Reader

__all__ = [
    "ILLUMINANCE_MAP_READERS",
    "MANIFEST",
    "BakedLamp",
    "IlluminanceMap",
    "Manifest",
    "MapFile",
    "Part",
    "geometry_bytes",
    "light_bytes",
    "map_file",
    "read_geometry",
    "read_geometry_picture",
    "read_light_picture",
    "read_lux",
    "read_manifest",
    "read_moment",
    "write_manifest",
]

ILLUMINANCE_MAP_READERS = (
    Reader("maps.json", (".json",), read_manifest_file),
    Reader("geometry.exr", (".exr",), read_geometry_picture),
    Reader("illuminance.exr", (".exr",), read_light_picture),
)
