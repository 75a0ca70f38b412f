"""Every reader of this package in one table.

The fuzz suite walks `READERS`: a format that is added here without a specimen in the tests fails
them, so no reader escapes truncation, flipped bytes and hostile headers.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from andon.files.cameras import CAMERA_READERS
from andon.files.depth import DEPTH_READERS
from andon.files.exposures import EXPOSURE_READERS
from andon.files.gaps import GAP_READERS
from andon.files.gaze import GAZE_READERS
from andon.files.harmonics import HARMONIC_READERS
from andon.files.illuminance_maps import ILLUMINANCE_MAP_READERS
from andon.files.meshes import MESH_READERS
from andon.files.photometry import PHOTOMETRY_READERS
from andon.files.pictures import PICTURE_READERS
from andon.files.radiance_text import RADIANCE_READERS
from andon.files.reader import Reader, choose_reader
from andon.files.responses import RESPONSE_READERS
from andon.files.volumes import VOLUME_READERS

__all__ = ["READERS", "Kind", "reader_for"]

Kind = Literal[
    "picture",
    "depth",
    "mesh",
    "camera",
    "response",
    "surface-response",
    "photometry",
    "volume",
    "exposures",
    "gaze",
    "gaps",
    "maps",
    "geometry",
    "illuminance",
    "radiance",
    "harmonics",
]

READERS: tuple[Reader, ...] = (
    *PICTURE_READERS,
    *DEPTH_READERS,
    *MESH_READERS,
    *CAMERA_READERS,
    *RESPONSE_READERS,
    *PHOTOMETRY_READERS,
    *VOLUME_READERS,
    *EXPOSURE_READERS,
    *GAZE_READERS,
    *GAP_READERS,
    *ILLUMINANCE_MAP_READERS,
    *RADIANCE_READERS,
    *HARMONIC_READERS,
)


def reader_for(path: str | Path, kind: Kind) -> Reader:
    """The reader for a file by its suffix; otherwise an error that names the accepted ones."""
    return choose_reader(path, [r for r in READERS if r.kind == kind], f"{kind} file")
