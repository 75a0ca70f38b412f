"""Moving pictures: animated WebP, PNG and GIF, whole or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.atomic import write_atomically

__all__ = ["MOVING_SUFFIXES", "check_moving", "frame_times", "write_moving"]

# suffix: (Pillow's name, unit of its frame times in ms, options)
_FORMATS: dict[str, tuple[str, int, dict[str, Any]]] = {
    ".webp": ("WEBP", 1, {"quality": 90, "method": 4}),
    ".png": ("PNG", 1, {}),
    ".apng": ("PNG", 1, {}),
    ".gif": ("GIF", 10, {}),
}
MOVING_SUFFIXES = tuple(_FORMATS)
# Players take a GIF's shorter frames for 100 ms.
SHORTEST_GIF_MS = 20


def write_moving(
    path: str | Path, frames: Sequence[NDArray[np.uint8]], frames_per_second: float, /
) -> Path:
    """Writes frames (H, W, 3) uint8 sRGB that loop forever; the suffix decides; returns the path.

    WebP is lossy (quality 90), PNG exact, GIF has 256 colours a frame. Frame times are whole
    milliseconds, of GIF whole hundredths, and add up to the clip's length: none is lost.

    Raises
    ------
    InputError
        for other suffixes, no frames, frames of several sizes, and more frames a second than the
        format holds.
    MachineError
        if the folder cannot be written or the disk is full.
    """
    path = Path(path)
    check_moving(path, frames_per_second)
    if not frames or any(frame.shape != frames[0].shape for frame in frames):
        raise InputError("a moving picture must have frames of one size", file=path)
    name, unit_ms, options = _FORMATS[path.suffix.lower()]
    times = frame_times(len(frames), frames_per_second, unit_ms)
    from PIL import Image

    pictures = [Image.fromarray(np.ascontiguousarray(frame)) for frame in frames]
    if len(pictures) > 1:
        moving = {"append_images": pictures[1:], "save_all": True, "duration": times, "loop": 0}
        options = options | moving

    def fill(temporary: Path) -> None:
        pictures[0].save(temporary, format=name, **options)

    return write_atomically(path, fill)


def check_moving(path: Path, frames_per_second: float, /) -> None:
    """Refuses a suffix that is no moving picture's, and more frames a second than it holds."""
    if path.suffix.lower() not in _FORMATS:
        known = ", ".join(_FORMATS)
        raise InputError(
            f"the suffix of a moving picture must be {known}, got {path.suffix!r}", file=path
        )
    most = 1000 / (SHORTEST_GIF_MS if path.suffix.lower() == ".gif" else 1)
    if not 0 < frames_per_second <= most:
        raise InputError(
            f"must be more than 0 and at most {most:g} frames a second for {path.suffix}, "
            f"got {frames_per_second:g}",
            file=path,
        )


def frame_times(count: int, frames_per_second: float, unit_ms: int = 1, /) -> list[int]:
    """Milliseconds that each of `count` frames stands: multiples of `unit_ms` without drift."""
    ends = np.rint(np.arange(count + 1) * 1000 / (frames_per_second * unit_ms)).astype(np.int64)
    times: list[int] = (np.diff(ends) * unit_ms).tolist()
    return times
