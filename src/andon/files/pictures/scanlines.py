"""The three ways in which Radiance stores a scanline of RGBE pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["decode_scanlines"]

NEW_RLE_LENGTHS = range(8, 0x8000)  # the lengths for which the new scheme is defined
LOOK_AHEAD = 1024  # pixels


def decode_scanlines(
    data: bytes, start: int, count: int, length: int, file: str
) -> NDArray[np.uint8]:
    """(count, length, 4) uint8 RGBE from `data`, from byte `start` on.

    Raises
    ------
    InputError
        if the data end too early or a run is longer than its line.
    """
    # Every scheme spends at least 4 bytes on a line. Checked first: a claim must not allocate.
    if len(data) - start < 4 * count:
        raise InputError("must not be cut short: pixels are missing", file=file)
    out = np.empty((count, length, 4), np.uint8)
    for row in range(count):
        head = data[start : start + 4]
        if len(head) < 4:
            raise InputError(f"must have {count} lines, is cut short in line {row}", file=file)
        is_new = head[0] == 2 and head[1] == 2 and head[2] < 128 and length in NEW_RLE_LENGTHS
        if is_new:
            if head[2] << 8 | head[3] != length:
                raise InputError(f"line {row} must have {length} pixels", file=file)
            planes, start = _new_runs(data, start + 4, 4 * length, row, file)
            if len(planes) != 4 * length:
                raise InputError(f"line {row} has a run beyond its end", file=file)
            out[row] = np.frombuffer(planes, np.uint8).reshape(4, length).T
        else:
            start = _old_line(data, start, out[row], row, file)
    return out


def _new_runs(data: bytes, at: int, total: int, row: int, file: str) -> tuple[bytearray, int]:
    """`total` bytes of a line whose four planes are run-length coded, and the next position."""
    planes = bytearray()
    try:
        while len(planes) < total:
            code = data[at]
            if code > 128:  # a run
                planes += data[at + 1 : at + 2] * (code - 128)
                at += 2
            elif code:  # literal bytes
                planes += data[at + 1 : at + 1 + code]
                at += code + 1
            else:
                raise InputError(f"line {row} has a run of length 0", file=file)
        if at > len(data):
            raise IndexError
    except IndexError:
        raise InputError(f"line {row} must not be cut short", file=file) from None
    return planes, at


def _old_line(data: bytes, at: int, line: NDArray[np.uint8], row: int, file: str) -> int:
    """Fill `line` (length, 4) from flat pixels; (1, 1, 1, n) repeats the last pixel.

    Consecutive repeat codes are the digits, base 256, lowest first, of one count.
    """
    filled, shift = 0, 0
    while filled < len(line):
        # Bounded looks ahead keep a line of alternating runs from costing its length squared.
        wanted = len(line) - filled
        chunk = np.frombuffer(data[at : at + 4 * min(wanted, LOOK_AHEAD)], np.uint8)
        chunk = chunk[: len(chunk) // 4 * 4].reshape(-1, 4)
        if not len(chunk):
            raise InputError(f"line {row} must not be cut short", file=file)
        codes = (chunk[:, :3] == 1).all(axis=1)
        literal = int(codes.argmax()) if codes.any() else len(chunk)
        if literal:
            line[filled : filled + literal] = chunk[:literal]
            filled, at, shift = filled + literal, at + 4 * literal, 0
            continue
        repeats = int(chunk[0, 3]) << shift
        if filled == 0 or repeats > wanted or shift > 24:
            raise InputError(f"line {row} has a run beyond its end", file=file)
        line[filled : filled + repeats] = line[filled - 1]
        filled, at, shift = filled + repeats, at + 4, shift + 8
    return at
