"""The two kinds of pictures in the folder as OpenEXR files: geometry, and light.

::

    depth (h, w), normal (h, w, 3) ◀──▶ N.X N.Y N.Z Z      float32, metres; world
    lux (h, w, 3)                  ◀──▶ R G B              float32, lx

Everything is 32-bit float, as it was traced: light belongs to exactly these points. (As half floats
normals would err by 0.03° and save a tenth of a folder; surfaces in rooms are flat, and flat ones
compress to nothing.) OpenEXR keeps all bits of a float, NaN's as well (measured); NaN is written
as one pattern all the same, so that equal maps are equal bytes.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.pictures.exr import ExrPart, openexr, read_exr_part
from andon.files.pictures.primaries import REC709_XY
from andon.quantities import Photometry

__all__ = [
    "geometry_bytes",
    "light_bytes",
    "read_geometry_picture",
    "read_light_picture",
]

Float32 = NDArray[np.float32]
Shape = tuple[int, int]

GEOMETRY_CHANNELS = ("N.X", "N.Y", "N.Z", "Z")
LIGHT_CHANNELS = ("R", "G", "B")
# A normal's length: what rounding to float32, or somebody's half floats, leave.
LENGTH_TOLERANCE = 2e-3


def light_bytes(lux: NDArray[Any], *, photometry: Photometry = "absolute") -> bytes:
    """An EXR file of illuminance (h, w, 3) in lx, finite and ≥ 0; the same bytes each time."""
    stored = np.asarray(lux, np.float32)
    if stored.ndim != 3 or stored.shape[2] != 3 or not stored.size:
        raise InputError(f"must be (h, w, 3), got {stored.shape}", field="lux")
    _check_lux(stored, None)
    planes = dict(zip(LIGHT_CHANNELS, np.moveaxis(stored + np.float32(0), -1, 0), strict=True))
    header = {"chromaticities": REC709_XY, "andon:unit": "lx", "andon:photometry": photometry}
    return _exr_bytes(planes, header)


def geometry_bytes(depth_m: NDArray[Any], normal: NDArray[Any]) -> bytes:
    """An EXR file of depth (h, w) > 0 in metres and unit normals (h, w, 3); the same bytes each
    time. Where either is NaN there is no surface."""
    depth, directions = np.asarray(depth_m, np.float32), np.asarray(normal, np.float32)
    if depth.ndim != 2 or not depth.size or directions.shape != (*depth.shape, 3):
        raise InputError(
            f"must be (h, w) and (h, w, 3), got {depth.shape} and {directions.shape}",
            field="depth and normal",
        )
    hole = np.isnan(depth) | np.isnan(directions).any(axis=-1)
    depth = np.where(hole, np.float32(np.nan), depth)
    directions = np.where(hole[..., None], np.float32(np.nan), directions + np.float32(0))
    _check_geometry(depth, directions, None)
    planes = dict(zip(GEOMETRY_CHANNELS, (*np.moveaxis(directions, -1, 0), depth), strict=True))
    return _exr_bytes(planes, {"andon:unit": "m"})


def read_light_picture(
    path: str | Path, *, limits: Limits = DEFAULT_LIMITS, shape: Shape | None = None
) -> tuple[Float32, Photometry]:
    """(h, w, 3) lx, finite and ≥ 0, and its photometry. Another size than `shape` is refused before
    anything is decoded."""
    part = _part(path, LIGHT_CHANNELS, "lx", limits, shape)
    word = part.attributes.get("andon:photometry", "absolute")
    if word not in ("absolute", "relative"):
        raise InputError(
            f"must be absolute or relative, got {str(word)[:40]!r}",
            file=path,
            field="andon:photometry",
        )
    lux = np.stack([part.channels[name] for name in LIGHT_CHANNELS], axis=-1)
    _check_lux(lux, path)
    return lux, word


def read_geometry_picture(
    path: str | Path, *, limits: Limits = DEFAULT_LIMITS, shape: Shape | None = None
) -> tuple[Float32, Float32]:
    """Depth (h, w) in metres and unit normals (h, w, 3), both NaN where there is no surface.

    Another size than `shape` is refused before anything is decoded.
    """
    part = _part(path, GEOMETRY_CHANNELS, "m", limits, shape)
    depth = part.channels["Z"]
    normal = np.stack([part.channels[name] for name in GEOMETRY_CHANNELS[:3]], axis=-1)
    _check_geometry(depth, normal, path)
    return depth, normal


def _part(
    path: str | Path,
    wanted: tuple[str, ...],
    unit: str,
    limits: Limits,
    shape: Shape | None,
) -> ExrPart:
    part = read_exr_part(path, limits=limits, shape=shape)
    missing = [name for name in wanted if name not in part.channels]
    if missing:
        raise InputError(
            f"must have the channels {', '.join(wanted)}, lacks {', '.join(missing)}", file=path
        )
    if part.origin != (0, 0) or part.channels[wanted[0]].shape != part.shape:
        raise InputError("must hold all pixels of the picture", file=path, field="dataWindow")
    stated = part.attributes.get("andon:unit", unit)
    if stated != unit:
        raise InputError(
            f"must be {unit!r}, got {str(stated)[:40]!r}", file=path, field="andon:unit"
        )
    return part


def _check_lux(lux: Float32, path: str | Path | None) -> None:
    with np.errstate(invalid="ignore"):
        wrong = ~((lux >= 0) & (lux < np.inf))
    if wrong.any():
        row, column, channel = (int(i) for i in np.argwhere(wrong)[0])
        raise InputError(
            f"must be finite and ≥ 0 lx, is {float(lux[row, column, channel]):g} in "
            f"{int(wrong.any(axis=-1).sum())} pixels",
            file=path,
            field=f"row {row}, column {column}, {'RGB'[channel]}",
            remedy="bake again" if path is not None else None,
        )


def _check_geometry(depth: Float32, normal: Float32, path: str | Path | None) -> None:
    remedy = "bake again" if path is not None else None
    hole = np.isnan(depth)
    with np.errstate(invalid="ignore", over="ignore"):
        _refuse_first(
            ~hole & ~((depth > 0) & (depth < np.inf)), "Z", "> 0 m, or NaN", depth, path, remedy
        )
        length = np.sqrt((normal.astype(np.float64) ** 2).sum(axis=-1))
        off = ~hole & ~(np.abs(length - 1) <= LENGTH_TOLERANCE)
        _refuse_first(off, "N", "of length 1 where there is depth", length, path, remedy)
        _refuse_first(
            hole & ~np.isnan(normal).all(axis=-1), "N", "NaN where Z is", length, path, remedy
        )


def _refuse_first(
    wrong: NDArray[np.bool_],
    channel: str,
    rule: str,
    values: NDArray[Any],
    path: str | Path | None,
    remedy: str | None,
) -> None:
    if wrong.any():
        row, column = (int(i) for i in np.argwhere(wrong)[0])
        raise InputError(
            f"must be {rule}, is {float(values[row, column]):g}",
            file=path,
            field=f"row {row}, column {column}, {channel}",
            remedy=remedy,
        )


def _exr_bytes(planes: Mapping[Any, Float32], attributes: dict[str, Any]) -> bytes:
    """The wheel writes files, not bytes: through a temporary one."""
    wheel = openexr()
    header = {"compression": wheel.ZIP_COMPRESSION, "type": wheel.scanlineimage, **attributes}
    channels = {name: np.ascontiguousarray(plane) for name, plane in planes.items()}
    with tempfile.TemporaryDirectory(prefix="andon-exr-") as folder:
        path = Path(folder) / "a.exr"
        try:
            wheel.File(header, channels).write(str(path))
        except RuntimeError as error:  # the library's words for a file system that refuses
            raise OSError(str(error)) from error
        return path.read_bytes()
