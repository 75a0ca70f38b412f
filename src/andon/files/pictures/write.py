"""Writers of pictures: PNG and JPEG for people, EXR, HDR and NPY for machines. All are atomic."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, MachineError
from andon.files.atomic import write_atomically, write_bytes
from andon.files.pictures.exr import openexr
from andon.files.pictures.primaries import REC709_XY
from andon.quantities import Photometry

__all__ = [
    "npy_bytes",
    "write_exr",
    "write_exr_channels",
    "write_hdr",
    "write_jpeg",
    "write_npy",
    "write_picture",
    "write_png",
]

JPEG_QUALITY = 95  # with full chroma; below that block edges show in dark gradients


def write_png(path: str | Path, values: NDArray[Any]) -> Path:
    """Write (H, W) or (H, W, 3) uint8 or uint16, sRGB-encoded, as PNG; returns the path."""
    _check_array(values, path, (np.uint8, np.uint16))
    if values.dtype == np.uint8:
        return write_bytes(path, _pillow_bytes(values, "PNG"))
    import cv2

    stored = values if values.ndim == 2 else np.ascontiguousarray(values[..., ::-1])
    done, encoded = cv2.imencode(".png", stored)
    if not done:
        raise MachineError(f"{path}: OpenCV could not encode the PNG")
    return write_bytes(path, encoded.tobytes())


def write_jpeg(path: str | Path, values: NDArray[np.uint8], *, quality: int = JPEG_QUALITY) -> Path:
    """Write (H, W) or (H, W, 3) uint8 sRGB as JPEG without chroma subsampling."""
    _check_array(values, path, (np.uint8,))
    return write_bytes(path, _pillow_bytes(values, "JPEG", quality=quality, subsampling=0))


def write_picture(path: str | Path, values: NDArray[Any]) -> Path:
    """Write a picture for people; the suffix decides: .png, .jpg or .jpeg."""
    suffix = Path(path).suffix.lower()
    if suffix == ".png":
        return write_png(path, values)
    if suffix in (".jpg", ".jpeg"):
        return write_jpeg(path, values)
    raise InputError(
        f"the suffix of a picture must be .png, .jpg or .jpeg, got {suffix!r}",
        file=path,
        remedy="measured values are written as .exr, with their unit",
    )


def write_exr(
    path: str | Path,
    values: NDArray[Any],
    *,
    unit: str,
    photometry: Photometry = "absolute",
    attributes: dict[str, str | int | float] | None = None,
    alpha: NDArray[Any] | None = None,
) -> Path:
    """Write measured values as a 32-bit float EXR.

    Parameters
    ----------
    values : (H, W, 3) linear Rec.709 (channels R, G, B), or (H, W) or (H, W, 1) (channel Y).
        Non-finite values are kept.
    unit : header attribute ``andon:unit``: ``lx``, ``cd/m2``, ``m`` …
    photometry : header attribute ``andon:photometry``.
    attributes : further header attributes; they win over the two above.
    alpha : (H, W) cover of colour (H, W, 3), which is premultiplied: 0 is light that is added.
    """
    if values.ndim == 3 and values.shape[2] == 1:
        values = values[..., 0]
    _check_array(values, path, (np.float16, np.float32, np.float64))
    names = "Y" if values.ndim == 2 else "RGB" if alpha is None else "RGBA"
    layers = np.atleast_3d(values) if alpha is None else np.dstack([values, alpha])
    planes = dict(zip(names, np.moveaxis(layers, -1, 0), strict=True))
    header = {
        "chromaticities": REC709_XY,
        "andon:unit": unit,
        "andon:photometry": photometry,
        **(attributes or {}),
    }
    return _write_planes(path, planes, header)


def write_exr_channels(
    path: str | Path,
    channels: Mapping[str, NDArray[Any]],
    *,
    units: Mapping[str, str],
    attributes: Mapping[str, str | int | float] | None = None,
) -> Path:
    """Write named quantities (H, W) as the channels of a 32-bit float EXR.

    Parameters
    ----------
    channels : name → values (H, W), all of one size; non-finite values are kept.
    units : name → unit, of all channels; the header attribute ``andon:unit`` lists them.
    attributes : further header attributes.
    """
    for values in channels.values():
        _check_array(values, path, (np.uint8, np.float16, np.float32, np.float64))
    listed = ", ".join(f"{name} [{units[name]}]" for name in channels)
    return _write_planes(path, channels, {"andon:unit": listed, **(attributes or {})})


def _write_planes(
    path: str | Path, planes: Mapping[str, NDArray[Any]], attributes: Mapping[str, Any]
) -> Path:
    wheel = openexr()
    header: dict[str, Any] = {
        "compression": wheel.ZIP_COMPRESSION,
        "type": wheel.scanlineimage,
        **attributes,
    }
    channels = {name: np.ascontiguousarray(plane, np.float32) for name, plane in planes.items()}

    def fill(temporary: Path) -> None:
        try:
            wheel.File(header, channels).write(str(temporary))
        except RuntimeError as error:  # the library's words for a file system that refuses
            raise OSError(str(error)) from error

    return write_atomically(path, fill)


def write_hdr(path: str | Path, values: NDArray[Any], *, view_line: str | None = None) -> Path:
    """Write (H, W, 3) linear Rec.709 light, finite and ≥ 0, as a Radiance picture (RGBE).

    1 % steps and no unit; `write_exr` keeps float32 and says what the numbers are. `view_line` is
    what the header says after ``VIEW=``.
    """
    import cv2

    _check_array(values, path, (np.float16, np.float32, np.float64))
    if values.ndim != 3:
        raise InputError(f"the array must be (H, W, 3), got {values.shape}", file=path)
    done, encoded = cv2.imencode(".hdr", np.ascontiguousarray(values[..., ::-1], np.float32))
    if not done:
        raise MachineError(f"{path}: OpenCV could not encode the Radiance picture")
    # Other readers take the magic word of Radiance's own programs only.
    first = "#?RADIANCE" if view_line is None else f"#?RADIANCE\nVIEW= {view_line}"
    rest = encoded.tobytes().partition(b"\n")[2]
    return write_bytes(path, first.encode("ascii") + b"\n" + rest)


def write_npy(path: str | Path, values: NDArray[Any]) -> Path:
    """Write any numeric array as NPY."""
    if values.dtype.hasobject:
        raise InputError("an array of Python objects must not be written", file=path)
    return write_bytes(path, npy_bytes(values))


def npy_bytes(values: NDArray[Any]) -> bytes:
    """A numeric array as the contents of an NPY file; the same bytes each time."""
    stream = io.BytesIO()
    np.save(stream, values, allow_pickle=False)
    return stream.getvalue()


def _check_array(values: NDArray[Any], path: str | Path, kinds: tuple[Any, ...]) -> None:
    shaped = values.ndim == 2 or (values.ndim == 3 and values.shape[2] == 3)
    if not shaped or 0 in values.shape or values.dtype not in [np.dtype(kind) for kind in kinds]:
        names = " or ".join(np.dtype(kind).name for kind in kinds)
        raise InputError(
            f"the array must be (H, W) or (H, W, 3) {names}, got {values.shape} {values.dtype}",
            file=path,
        )


def _pillow_bytes(values: NDArray[np.uint8], kind: str, **options: Any) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(values)).save(stream, format=kind, **options)
    return stream.getvalue()
