"""OpenEXR pictures and depth through the OpenEXR 3 wheel, behind guards.

The wheel returns parts without channels for damaged files and allocates what the header asks for,
so the header is read and judged first and the channels are checked after.
"""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most, check_size
from andon.files.paths import check_file
from andon.files.pictures.model import Picture
from andon.files.pictures.primaries import rec709_from_chromaticities

__all__ = ["ExrPart", "openexr", "read_exr", "read_exr_part"]

MAGIC = b"\x76\x2f\x31\x01"
MAX_CHANNELS = 256  # multi-layer renders have up to about 100
HEADER_OF_LAYOUT = ("channels", "dataWindow", "displayWindow", "compression", "lineOrder", "type")


@dataclass(frozen=True)
class ExrPart:
    """One part of an EXR file, in the frame of its *data* window.

    Attributes
    ----------
    channels : (h, w) float32 by name.
    origin : (row, column) of the data window's corner in the display window.
    shape : (H, W) of the display window.
    attributes : header entries that are numbers or text.
    chromaticities : x, y of red, green, blue, white, or None.
    """

    channels: dict[str, NDArray[np.float32]]
    origin: tuple[int, int]
    shape: tuple[int, int]
    attributes: dict[str, Any]
    chromaticities: tuple[float, ...] | None

    def placed(self, values: NDArray[np.float32], fill: float) -> NDArray[np.float32]:
        """`values` (h, w, …) of the data window in the display window (H, W, …)."""
        (row, column), (height, width) = self.origin, self.shape
        if (row, column) == (0, 0) and values.shape[:2] == self.shape:
            return values
        out = np.full((height, width, *values.shape[2:]), fill, np.float32)
        top, left = max(row, 0), max(column, 0)
        bottom = min(row + values.shape[0], height)
        right = min(column + values.shape[1], width)
        if top < bottom and left < right:
            out[top:bottom, left:right] = values[
                top - row : bottom - row, left - column : right - column
            ]
        return out


def read_exr(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Picture:
    """RGB, RGBA, luminance or single-layer EXR as (H, W, 3) float32, linear Rec.709.

    The result covers the display window; pixels outside the data window are black. Values are in
    the file's own unit (see ``attributes['andon:unit']``); negative and non-finite ones are kept.
    """
    part = read_exr_part(path, limits=limits)
    names = _colour_channels(part.channels, path)
    values = np.stack([part.channels[name] for name in names], axis=-1)
    if part.chromaticities is not None and len(set(names)) == 3:
        matrix = rec709_from_chromaticities(part.chromaticities, str(path))
        if matrix is not None:
            values = (values @ matrix.T).astype(np.float32)
    alpha = None if "A" not in part.channels else part.placed(part.channels["A"], 0.0)
    return Picture(part.placed(values, 0.0), "linear", attributes=part.attributes, alpha=alpha)


def read_exr_part(
    path: str | Path,
    *,
    limits: Limits = DEFAULT_LIMITS,
    shape: tuple[int, int] | None = None,
) -> ExrPart:
    """The first part of an EXR file, all its channels as float32.

    Another display or data window than `shape` (H, W) is refused before pixels are decoded.
    """
    check_file(path, limits)
    with Path(path).open("rb") as stream:
        if stream.read(4) != MAGIC:
            raise InputError("must be an OpenEXR file", file=path)
    header = _open(path, header_only=True).header
    origin, display, window = _check_header(header, path, limits)
    if shape is not None and not shape == display == window:
        height, width = window if display == shape else display
        raise InputError(f"must have {shape[1]}×{shape[0]} pixels, has {width}×{height}", file=path)
    part = _open(path, header_only=False)
    channels: dict[str, NDArray[np.float32]] = {}
    for name, channel in part.channels.items():
        pixels = channel.pixels
        if pixels is None or pixels.shape != window:
            continue  # subsampled chroma: its users find it missing and say so
        channels[str(name)] = pixels.astype(np.float32, copy=False)
    if not channels:
        raise InputError("must hold pixels; the file is damaged or cut short", file=path)
    attributes = {
        str(key): value
        for key, value in header.items()
        if isinstance(value, str | int | float) and key not in HEADER_OF_LAYOUT
    }
    if "envmap" in header:
        attributes["envmap"] = _envmap(header["envmap"])
    return ExrPart(channels, origin, display, attributes, _chromaticities(header, path))


def _chromaticities(header: dict[str, Any], path: str | Path) -> tuple[float, ...] | None:
    stated = header.get("chromaticities")
    if stated is None:
        return None
    if not isinstance(stated, tuple) or len(cast("tuple[Any, ...]", stated)) != 8:
        raise InputError("must be eight numbers", file=path, field="chromaticities")
    return tuple(float(value) for value in cast("tuple[Any, ...]", stated))


def _envmap(value: Any) -> str:
    """``latlong`` or ``cube``, as OpenEXR's environment maps are."""
    return "latlong" if value == openexr().ENVMAP_LATLONG else "cube"


def openexr() -> Any:
    """The OpenEXR wheel, which has no type annotations."""
    import OpenEXR  # pyright: ignore[reportMissingTypeStubs, reportUnusedImport]

    return OpenEXR


def _open(path: str | Path, *, header_only: bool) -> Any:
    """The first part as the wheel gives it; every complaint of the wheel is an `InputError`."""
    remarks = io.StringIO()
    try:
        # The wheel prints its remarks on damaged pixels to standard output, where results go.
        with contextlib.redirect_stdout(remarks):
            opened = openexr().File(str(path), separate_channels=True, header_only=header_only)
        parts: list[Any] = opened.parts
    except Exception as error:  # the wheel raises RuntimeError, ValueError, UnicodeDecodeError …
        line = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(
            f"must be a sound OpenEXR file: {line[:200]}", file=path, remedy="export it again"
        ) from error
    if remarks.getvalue() or not parts:
        raise InputError(
            "must be a sound OpenEXR file, its pixels are damaged or cut short",
            file=path,
            remedy="export it again",
        )
    return parts[0]


def _check_header(
    header: dict[str, Any], path: str | Path, limits: Limits
) -> tuple[tuple[int, int], tuple[int, int], tuple[int, int]]:
    """Origin of the data window, shape of the display window, shape of the data window."""
    wheel = openexr()
    if header.get("type") not in (wheel.scanlineimage, wheel.tiledimage):
        raise InputError("must be a flat picture, not a deep one", file=path)
    corners: list[list[int]] = []
    for key in ("dataWindow", "displayWindow"):
        window = header.get(key)
        if window is None:
            raise InputError("must be present", file=path, field=key)
        (left, top), (right, bottom) = ([int(v) for v in corner] for corner in window)
        check_size(right - left + 1, bottom - top + 1, path, limits)
        corners.append([left, top, right - left + 1, bottom - top + 1])
    (left, top, width, height), display = corners
    channels: list[Any] = list(header.get("channels") or ())
    check_at_most(len(channels), MAX_CHANNELS, "channels", path)
    check_at_most(width * height * len(channels), 4 * limits.max_pixels, "values", path)
    origin = (top - display[1], left - display[0])
    return origin, (display[3], display[2]), (height, width)


def _colour_channels(channels: dict[str, NDArray[np.float32]], path: str | Path) -> list[str]:
    """The names of the red, green and blue channels (thrice the same for luminance)."""
    if {"R", "G", "B"} <= channels.keys():
        return ["R", "G", "B"]
    if {"RY", "BY"} & channels.keys() or ("Y" in channels and len(channels) > 2):
        raise InputError(
            "must not store subsampled chroma (Y, RY, BY)", file=path, remedy="export it as RGB"
        )
    if "Y" in channels:
        return ["Y"] * 3
    layers = sorted(name[:-2] for name in channels if name.endswith(".R"))
    layers = [name for name in layers if {f"{name}.G", f"{name}.B"} <= channels.keys()]
    if len(layers) == 1:
        return [f"{layers[0]}.{letter}" for letter in "RGB"]
    names = ", ".join(sorted(channels)[:12])
    raise InputError(
        f"must have channels R, G, B or Y or one layer of them, has {names}",
        file=path,
        remedy="export one layer as RGB",
    )
