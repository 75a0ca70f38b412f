"""PFM (floats, bottom-up) and PGM (integers, top-down) as depth.

Formats: P. Debevec's PFM as used by Middlebury's stereo benchmark; Netpbm's pgm(5).
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.numbers import to_float64
from andon.files.paths import open_bounded

__all__ = ["read_pfm", "read_pgm"]

TOKEN = re.compile(rb"(?:[ \t\r\n\v\f]+|#[^\r\n]*)*([^\s#]+)")


def read_pfm(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    """The (H, W) numbers of a one-channel PFM file as float64, row 0 on top.

    The sign of the scale is the byte order. Its size is *not* applied: Middlebury writes 1/255
    there for files whose numbers are pixels already.
    """
    data = open_bounded(path, limits)
    (magic, width, height, scale), start = _header(data, 4, path, limits)
    if magic != b"Pf":
        raise InputError(f"must be a one-channel PFM (Pf), starts with {magic[:8]!r}", file=path)
    columns, rows = _integer(width, "width", path), _integer(height, "height", path)
    check_size(columns, rows, path, limits)
    try:
        factor = float(scale)
    except ValueError:
        factor = 0.0
    if not math.isfinite(factor) or factor == 0:
        raise InputError(f"the scale must be a number ≠ 0, got {scale[:20]!r}", file=path)
    kind = np.dtype("<f4" if factor < 0 else ">f4")
    return _pixels(data, start, rows, columns, kind, path)[::-1].copy()


def read_pgm(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    """The (H, W) raw numbers of an 8- or 16-bit PGM file (P5 or P2) as float64."""
    data = open_bounded(path, limits)
    (magic, width, height, most), start = _header(data, 4, path, limits)
    if magic not in (b"P5", b"P2"):
        raise InputError(f"must be a PGM (P5 or P2), starts with {magic[:8]!r}", file=path)
    columns, rows = _integer(width, "width", path), _integer(height, "height", path)
    check_size(columns, rows, path, limits)
    maximum = _integer(most, "maximum", path)
    if not 1 <= maximum <= 65535:
        raise InputError(f"the maximum must be 1…65535, got {maximum}", file=path)
    if magic == b"P2":
        return _text_pixels(data[start:], rows, columns, path)
    kind = np.dtype(np.uint8 if maximum < 256 else ">u2")
    return _pixels(data, start, rows, columns, kind, path)


def _header(data: bytes, count: int, path: str | Path, limits: Limits) -> tuple[list[bytes], int]:
    """`count` tokens and the position after the single white space that ends the last one."""
    tokens: list[bytes] = []
    at = 0
    for _ in range(count):
        match = TOKEN.match(data, at, limits.max_header_bytes)
        if match is None:
            raise InputError("the header must not be cut short", file=path)
        tokens.append(match[1])
        at = match.end()
    return tokens, at + (2 if data[at : at + 2] == b"\r\n" else 1)


def _integer(token: bytes, name: str, path: str | Path) -> int:
    if not re.fullmatch(rb"\d{1,9}", token):
        raise InputError(f"the {name} must be a whole number, got {token[:20]!r}", file=path)
    return int(token)


def _pixels(
    data: bytes, start: int, rows: int, columns: int, kind: np.dtype[np.generic], path: str | Path
) -> NDArray[np.float64]:
    needed = start + rows * columns * kind.itemsize
    if len(data) < needed:
        raise InputError(f"must have {needed} bytes, is cut short at {len(data)}", file=path)
    values = np.frombuffer(data, kind, count=rows * columns, offset=start)
    return to_float64(values.reshape(rows, columns))


def _text_pixels(text: bytes, rows: int, columns: int, path: str | Path) -> NDArray[np.float64]:
    words = text.split(None, rows * columns)[: rows * columns]
    try:
        values = np.array([int(word) for word in words], np.float64)
    except (ValueError, OverflowError) as error:
        raise InputError("pixels must be whole numbers", file=path) from error
    if len(values) < rows * columns:
        raise InputError(f"must have {rows * columns} pixels, has {len(values)}", file=path)
    return values.reshape(rows, columns)
