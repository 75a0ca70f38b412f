"""Parts that readers of captures share: lists of numbers, poses, depth in millimetres."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.captures.model import Photo
from andon.files.depth import read_depth_array
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.paths import open_bounded
from andon.files.pictures import decode_picture
from andon.quaternions import rotation_matrices
from andon.spaces import View

__all__ = [
    "GL_CAMERA",
    "Y_DOWN_WORLD",
    "Z_UP_WORLD",
    "depth_of",
    "nearest_time",
    "numbers_of",
    "photo_of",
    "photo_of_bytes",
    "picture_files",
    "pinhole",
    "pose_of",
    "rows_of",
    "text_lines",
]

Float = NDArray[np.float64]

# Our world from theirs: what is up there becomes +Y.
Z_UP_WORLD: Float = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
Y_DOWN_WORLD: Float = np.diag([1.0, -1, -1, 1])
# ARKit's camera (x right, y up, z backward) from ours.
GL_CAMERA: Float = np.diag([1.0, -1, -1, 1])
MILLIMETRES = 0.001
PICTURES = (".png", ".jpg", ".jpeg")


def text_lines(path: Path, limits: Limits = DEFAULT_LIMITS) -> list[tuple[int, str]]:
    """(line number, text) of all lines that are neither empty nor comments (#)."""
    data = open_bounded(path, limits, max_bytes=limits.max_text_bytes)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError("must be UTF-8 text", file=path) from error
    lines = ((number, line.strip()) for number, line in enumerate(text.splitlines(), start=1))
    return [(number, line) for number, line in lines if line and not line.startswith("#")]


def numbers_of(words: Sequence[str], path: Path, line: int) -> list[float]:
    """Finite numbers. Raises `InputError` that names the line."""
    found: list[float] = []
    for word in words:
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(f"must be numbers, got {word[:40]!r}", file=path, field=f"line {line}")
        found.append(value)
    return found


def rows_of(
    path: Path, columns: int, *, separator: str | None = None, limits: Limits = DEFAULT_LIMITS
) -> Float:
    """(n, columns) of a text file of numbers; lines starting with # are comments."""
    rows: list[list[float]] = []
    for number, line in text_lines(path, limits):
        words = line.split(separator)
        if len(words) != columns:
            raise InputError(
                f"must have {columns} numbers, has {len(words)}", file=path, field=f"line {number}"
            )
        rows.append(numbers_of(words, path, number))
    if not rows:
        raise InputError("has no line of numbers", file=path)
    return np.array(rows)


def pose_of(position: Any, quaternion_xyzw: Any, path: Path, what: str) -> Float:
    """(4, 4) of a position and a rotation. Raises `InputError` for a rotation of length 0."""
    quaternion = np.asarray(quaternion_xyzw, np.float64)
    if not 0.5 < np.linalg.norm(quaternion) < 2:
        raise InputError("must have a unit quaternion", file=path, field=what)
    pose = np.eye(4)
    pose[:3, :3] = rotation_matrices(quaternion)
    pose[:3, 3] = position
    return pose


def nearest_time(times: Float, time: float, most_seconds: float) -> int | None:
    """Which of `times` (n,) lies nearest, if within `most_seconds`."""
    index = int(np.argmin(np.abs(times - time)))
    return index if abs(float(times[index]) - time) <= most_seconds else None


def photo_of(path: Path, limits: Limits = DEFAULT_LIMITS) -> tuple[Photo, tuple[int, int]]:
    """An encoded picture, checked by decoding it, and its (width, height)."""
    return photo_of_bytes(open_bounded(path, limits), path, limits)


def photo_of_bytes(
    data: bytes, path: Path | str, limits: Limits = DEFAULT_LIMITS
) -> tuple[Photo, tuple[int, int]]:
    """As `photo_of`, of bytes; `path` is for messages."""
    height, width = decode_picture(data, str(path), limits).shape
    suffix = ".png" if data.startswith(b"\x89PNG") else ".jpg"
    return Photo(data, suffix), (width, height)


def depth_of(path: Path, scale_to_m: float = MILLIMETRES, limits: Limits = DEFAULT_LIMITS) -> Float:
    """(h, w) metres; what is not positive or not finite is a hole."""
    metres = read_depth_array(path, limits=limits) * scale_to_m
    with np.errstate(invalid="ignore"):
        return np.where((metres > 0) & np.isfinite(metres), metres, np.nan)


def picture_files(folder: Path, suffixes: Sequence[str] = PICTURES) -> list[Path]:
    """The files of a folder by their numbers, or else by name."""
    if not folder.is_dir():
        return []
    files = [path for path in folder.iterdir() if path.suffix.lower() in suffixes]
    return sorted(
        files,
        key=lambda path: (len(path.stem), path.stem) if path.stem.isdecimal() else (0, path.stem),
    )


def pinhole(
    size: tuple[int, int],
    intrinsics: Sequence[float],
    world_from_camera: Float | None,
    *,
    distortion: Sequence[float] = (),
    path: Path,
) -> View:
    """The view of a picture of (width, height) with fx, fy, cx, cy; the default pose for None."""
    fx, fy, cx, cy = (float(value) for value in intrinsics)
    posed: dict[str, Any] = (
        {} if world_from_camera is None else {"world_from_camera": world_from_camera}
    )
    try:
        return View("pinhole", *size, fx, fy, cx, cy, tuple(distortion), **posed)
    except InputError as error:
        raise InputError(error.rule, file=path, field=error.field) from error
