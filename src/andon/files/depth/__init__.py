"""Depth and disparity: whatever numbers a file holds, as (H, W) float64.

Nothing is interpreted here. Units, the difference between depth, distance and disparity, and which
values mean "unknown" are said by the scene file and applied by the surface stage, because the same
formats carry all of them. So integers keep their size, and NaN and infinity stay what they are.

====== ======================================== ==============================================
format numbers                                  traps handled
====== ======================================== ==============================================
NPY    any integer or float type                pickled objects are refused
NPZ    the only array, or depth/disparity/arr_0 an archive that unpacks to far more than its size
PFM    float32                                  rows run from the bottom; byte order by sign
PNG    8 or 16 bit gray                         values are not scaled to 1
PGM    8 or 16 bit                              16 bit are big-endian
EXR    channel Z, else Y, else the first        outside the data window is NaN
====== ======================================== ==============================================
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.depth.netpbm import read_pfm, read_pgm
from andon.files.depth.numpy_files import read_npy, read_npz
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.numbers import to_float64
from andon.files.paths import open_bounded
from andon.files.pictures.exr import read_exr_part
from andon.files.pictures.png import decode_png_raw
from andon.files.reader import Reader, choose_reader

__all__ = ["DEPTH_READERS", "read_depth_array"]


def _read_png(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    data = open_bounded(path, limits)
    return decode_png_raw(data, str(path), limits).astype(np.float64)


def _read_exr(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    part = read_exr_part(path, limits=limits)
    names = sorted(part.channels, key=lambda name: (_depth_rank(name), name))
    return to_float64(part.placed(part.channels[names[0]], np.nan))


def _depth_rank(name: str) -> int:
    """Z first (of any layer), then Y, then the rest."""
    return {"Z": 0, "Y": 1}.get(name.rsplit(".", 1)[-1], 2)


DEPTH_READERS = (
    Reader("depth.npy", (".npy",), read_npy),
    Reader("depth.npz", (".npz",), read_npz),
    Reader("depth.pfm", (".pfm",), read_pfm),
    Reader("depth.png", (".png",), _read_png),
    Reader("depth.pgm", (".pgm",), read_pgm),
    Reader("depth.exr", (".exr",), _read_exr),
)


def read_depth_array(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    """The raw numbers of a depth or disparity file, (H, W) float64, row 0 on top.

    Raises
    ------
    InputError
        if the suffix is unknown, the file has several channels, or is damaged or too large.
    """
    values: NDArray[np.float64] = choose_reader(path, DEPTH_READERS, "depth file").read(
        path, limits=limits
    )
    return values
