"""NPY and NPZ arrays of depth. Nothing is unpickled, and sizes are checked before memory is taken.

Format: NumPy enhancement proposal 1 (versions 1.0 and 2.0 of NPY).
"""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.numbers import to_float64
from andon.files.paths import open_bounded

__all__ = ["read_npy", "read_npz"]

NPZ_KEYS = ("depth", "disparity", "arr_0")
HEADER_BYTES = 2**14  # NumPy's own readers take headers of up to 10000 characters


def read_npy(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    """The (H, W) numbers of an NPY file as float64."""
    return _parse_npy(open_bounded(path, limits), path, limits)


def read_npz(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    """The single array of an NPZ file, or the one named depth, disparity or arr_0, as float64."""
    data = open_bounded(path, limits)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            member = _choose_member(archive, path)
            with archive.open(member) as stream:
                head = stream.read(HEADER_BYTES)
                needed = _parse_header(head, path, limits)[2]
                # An archive can hold a thousand times its own size; the header says how much.
                content = head + stream.read(max(needed - len(head), 0))
    except InputError:
        raise
    except Exception as error:  # BadZipFile, zlib.error, NotImplementedError, RuntimeError …
        raise InputError(f"must be a sound NPZ archive: {str(error)[:120]}", file=path) from error
    return _parse_npy(content, path, limits)


def _choose_member(archive: zipfile.ZipFile, path: str | Path) -> str:
    names = {name.removesuffix(".npy"): name for name in archive.namelist()}
    if len(names) == 1:
        return next(iter(names.values()))
    for key in NPZ_KEYS:
        if key in names:
            return names[key]
    found = ", ".join(sorted(names)[:8]) or "none"
    raise InputError(
        f"must hold one array, or one named {', '.join(NPZ_KEYS)}; has {found}", file=path
    )


def _parse_header(data: bytes, path: str | Path, limits: Limits) -> tuple[Any, Any, int]:
    """((shape, Fortran order, dtype), where the numbers start, how many bytes the array needs)."""
    stream = io.BytesIO(data[:HEADER_BYTES])
    try:
        version = np.lib.format.read_magic(stream)
        if version == (1, 0):
            parsed = np.lib.format.read_array_header_1_0(stream)
        elif version == (2, 0):
            parsed = np.lib.format.read_array_header_2_0(stream)
        else:
            raise ValueError(f"version {version}")
    except Exception as error:  # ValueError, SyntaxError, TypeError, tokenize errors …
        raise InputError(
            f"must be a sound NPY array: {str(error)[:120]}",
            file=path,
            remedy="write it by np.save",
        ) from error
    shape, _, dtype = parsed
    if dtype.hasobject or dtype.kind not in "fiu":
        raise InputError(f"must hold integers or floats, has {str(dtype)[:60]}", file=path)
    height, width = _two_sides(shape, path)
    check_size(width, height, path, limits)
    start = stream.tell()
    return parsed, start, start + height * width * dtype.itemsize


def _two_sides(shape: tuple[int, ...], path: str | Path) -> tuple[int, int]:
    sides = shape
    if len(shape) == 3 and 1 in (shape[0], shape[2]):
        sides = shape[1:] if shape[0] == 1 else shape[:2]
    if len(sides) != 2:
        raise InputError(f"must have the shape (H, W), has {str(shape)[:60]}", file=path)
    return sides[0], sides[1]


def _parse_npy(data: bytes, path: str | Path, limits: Limits) -> NDArray[np.float64]:
    (shape, fortran, dtype), start, needed = _parse_header(data, path, limits)
    if len(data) < needed:
        raise InputError(f"must have {needed} bytes, is cut short at {len(data)}", file=path)
    height, width = _two_sides(shape, path)
    values = np.frombuffer(data, dtype, count=height * width, offset=start)
    return to_float64(values.reshape((height, width), order="F" if fortran else "C"))
