"""Real panoramas that rows are measured on: HDR, of ``ANDON_DATA``."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.pictures import read_picture
from andon.harmonics import nonnegative
from andon.verify.registry import NotShown

__all__ = ["CC0", "PANORAMAS", "panorama", "panorama_path"]

# Blender's, each with its own licence file beside it; figures from them may be kept.
CC0 = tuple(
    f"hdri_blender_cc0/{n}.exr" for n in ["city", "forest", "interior", "studio", "sunrise"]
)
# And more: those of which less than a thousandth of the light is lost with negative pixels.
PANORAMAS = (
    *CC0,
    "hdri_night_open3d/nightlights_latlong512.hdr",
    *(f"hdri_pmndrs_cc0/{name}.exr" for name in ["apartment", "bridge", "city", "venice"]),
    "hdri_spiaggia/spiaggia_di_mondello_1k.hdr",
)


def panorama_path(name: str, /) -> Path:
    """The file of a panorama, by folder and name; raises `NotShown`."""
    folder = os.environ.get("ANDON_DATA")
    if not folder:
        raise NotShown("ANDON_DATA is not set: the folder that holds hdri_blender_cc0 and others")
    path = Path(folder) / name
    if not path.is_file():
        raise NotShown(f"{path} is missing")
    return path


@cache
def panorama(name: str, /) -> NDArray[np.float32]:
    """(H, 2H, 3) linear light of a panorama, negative pixels set to 0."""
    return nonnegative(read_picture(panorama_path(name)).values).values
