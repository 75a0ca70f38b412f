"""Radiance's RGBE pictures (.hdr, .pic): three mantissas and a shared exponent in four bytes.

Own reader, because the usual ones reject legal headers, ignore EXPOSURE, VIEW and the orientation,
or return 8 bits. Format: G. Ward, "Real Pixels", Graphics Gems II (1991), and Radiance's file
format notes ("picture files").

::

    #?RADIANCE                     any number of NAME=value and comment lines
    EXPOSURE=2.5                   values are radiance × 2.5; several lines multiply
    FORMAT=32-bit_rle_rgbe
                                   an empty line
    -Y 512 +X 1024                 first axis: rows from the top; second: columns from the left
    scanlines                      flat, old run-length or new run-length, told apart per line
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.paths import open_bounded
from andon.files.pictures.model import Picture
from andon.files.pictures.primaries import rec709_from_chromaticities, rec709_from_xyz
from andon.files.pictures.scanlines import decode_scanlines

__all__ = ["read_hdr"]

# Radiance's own primaries (radiance/src/common/color.h): where a file states these, or nothing,
# its channels are taken as Rec.709 ones without mixing (CONVENTIONS, Radiance border).
RADIANCE_XY = (0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 1 / 3, 1 / 3)

# Radiance keeps XYZ in photometric units: Y is 179 lm/W times the radiance (WHTEFFICACY).
XYZ_LUMENS_PER_WATT = 179.0

RESOLUTION = re.compile(r"^([+-])([XY])\s+(\d{1,9})\s+([+-])([XY])\s+(\d{1,9})\s*$")
FORMATS = ("32-bit_rle_rgbe", "32-bit_rle_xyze")


@dataclass
class _Header:
    form: str = FORMATS[0]
    exposure: NDArray[np.float64] = field(default_factory=lambda: np.ones(3))
    primaries: tuple[float, ...] | None = None
    view: str | None = None
    attributes: dict[str, str] = field(default_factory=dict[str, str])


def read_hdr(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Picture:
    """Radiance in W/(sr·m²) of a Radiance picture, as (H, W, 3) float32, linear Rec.709.

    The factor 179 that turns it into luminance in cd/m² is *not* applied: most files with this
    suffix are not absolute, and the caller knows which are. EXPOSURE and COLORCORR are divided
    out; XYZE is converted (and divided by its 179); the picture is turned upright.
    """
    data = open_bounded(path, limits)
    if not data.startswith(b"#?"):
        raise InputError("must be a Radiance picture that starts with #?", file=path)
    lines, resolution, start = _split_header(data, path, limits)
    header = _parse_header(lines, path)
    match = RESOLUTION.match(resolution)
    if match is None or match[2] == match[5]:
        raise InputError(
            f"the resolution line must be like '-Y 512 +X 1024', got {resolution[:60]!r}", file=path
        )
    count, length = int(match[3]), int(match[6])
    check_size(length, count, path, limits)
    rgbe = decode_scanlines(data, start, count, length, str(path))
    values = _upright(_decode_rgbe(rgbe, header.exposure), match)
    matrix = _matrix(header, str(path))
    if matrix is not None:
        values = (values @ matrix.T).astype(np.float32)
    return Picture(
        np.ascontiguousarray(values),
        "linear",
        view_line=header.view,
        attributes=dict(header.attributes),
    )


def _split_header(data: bytes, path: str | Path, limits: Limits) -> tuple[list[str], str, int]:
    """Header lines, the resolution line, and where the pixels start."""
    lines: list[str] = []
    start = 0
    while True:
        end = data.find(b"\n", start, limits.max_header_bytes)
        if end < 0:
            raise InputError("the header must end with an empty line", file=path)
        line = data[start:end].decode("utf-8", errors="replace").rstrip("\r")
        start = end + 1
        if not line.strip():
            break
        lines.append(line)
    end = data.find(b"\n", start, start + 200)
    if end < 0:
        raise InputError("must have a resolution line after the header", file=path)
    return lines, data[start:end].decode("ascii", errors="replace").rstrip("\r"), end + 1


def _parse_header(lines: list[str], path: str | Path) -> _Header:
    header = _Header()
    for line in lines:
        # Lines that a program copied from its input are indented by a tab and describe *that*.
        if line.startswith(("#", "\t", " ")) or "=" not in line:
            continue
        key, value = (part.strip() for part in line.split("=", 1))
        if key == "FORMAT":
            header.form = value
        elif key == "VIEW":
            header.view = f"{header.view} {value}" if header.view else value
        elif key == "EXPOSURE":
            header.exposure = header.exposure * _numbers(value, 1, key, path)
        elif key == "COLORCORR":
            header.exposure = header.exposure * _numbers(value, 3, key, path)
        elif key == "PRIMARIES":
            header.primaries = tuple(_numbers(value, 8, key, path).tolist())
        else:
            header.attributes[key] = value
    if header.form not in FORMATS:
        raise InputError(f"FORMAT must be one of {FORMATS}, got {header.form[:40]!r}", file=path)
    if not (np.isfinite(header.exposure).all() and (header.exposure > 0).all()):
        raise InputError("EXPOSURE and COLORCORR must multiply to > 0", file=path)
    return header


def _numbers(value: str, count: int, key: str, path: str | Path) -> NDArray[np.float64]:
    try:
        numbers = np.array([float(part) for part in value.split()])
    except ValueError:
        numbers = np.empty(0)
    if numbers.shape != (count,):
        raise InputError(f"must be {count} numbers, got {value[:60]!r}", file=path, field=key)
    return numbers


def _matrix(header: _Header, file: str) -> NDArray[np.float64] | None:
    if header.form == FORMATS[1]:
        # XYZE's white is the equal-energy point: neutral light has X = Y = Z.
        return rec709_from_xyz((1 / 3, 1 / 3)) / XYZ_LUMENS_PER_WATT
    primaries = header.primaries
    # Photoshop writes eight zeros for "none".
    if primaries is None or not any(primaries):
        return None
    if np.allclose(primaries, RADIANCE_XY, rtol=0, atol=1e-3):
        return None
    return rec709_from_chromaticities(primaries, file)


def _decode_rgbe(rgbe: NDArray[np.uint8], exposure: NDArray[np.float64]) -> NDArray[np.float32]:
    """(n, m, 3) float32 = (mantissa + ½)·2^(exponent − 136) / exposure; exponent 0 is black.

    The half is Radiance's: its writer truncates mantissas, so the middle of the step is unbiased.
    """
    scale = np.ldexp(np.float32(1), rgbe[..., 3].astype(np.int32) - 136)
    scale[rgbe[..., 3] == 0] = 0
    values = rgbe[..., :3].astype(np.float32)
    values += np.float32(0.5)
    values *= scale[..., None]
    if (exposure != 1).any():
        values /= exposure.astype(np.float32)
    return values


def _upright(values: NDArray[np.float32], match: re.Match[str]) -> NDArray[np.float32]:
    """Row 0 on top, column 0 at the left. Y grows upwards in Radiance, so −Y runs down."""
    signs = {match[2]: match[1], match[5]: match[4]}
    if match[2] == "X":
        values = values.swapaxes(0, 1)
    if signs["Y"] == "+":
        values = values[::-1]
    if signs["X"] == "-":
        values = values[:, ::-1]
    return values
