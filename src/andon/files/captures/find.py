"""Which format a folder is, and its capture."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from andon.errors import InputError
from andon.files.captures.arkit import is_arkitscenes, is_stray, open_arkitscenes, open_stray
from andon.files.captures.colmap import is_colmap, open_colmap
from andon.files.captures.model import Capture
from andon.files.captures.realsense import (
    is_realsense,
    is_snapshot,
    open_realsense,
    open_snapshot,
)
from andon.files.captures.record3d import is_record3d, open_record3d
from andon.files.captures.slambook import is_slambook, open_slambook
from andon.files.captures.tum import is_tum, open_tum
from andon.files.limits import DEFAULT_LIMITS, Limits

__all__ = ["FORMATS", "open_capture"]

# Name → what tells it, how it is opened. The first that fits is taken.
FORMATS: dict[str, tuple[Callable[[Path], bool], Callable[..., Capture]]] = {
    "record3d": (is_record3d, open_record3d),
    "tum": (is_tum, open_tum),
    "stray": (is_stray, open_stray),
    "arkitscenes": (is_arkitscenes, open_arkitscenes),
    "colmap": (is_colmap, open_colmap),
    "realsense": (is_realsense, open_realsense),
    "realsense-snapshot": (is_snapshot, open_snapshot),
    "slambook": (is_slambook, open_slambook),
}


def open_capture(
    path: str | Path, *, scale_to_m: float | None = None, limits: Limits = DEFAULT_LIMITS
) -> Capture:
    """The capture in a folder, or in a .r3d file.

    Parameters
    ----------
    scale_to_m : metres per unit, of COLMAP alone: the others are in metres already.

    Raises `InputError` where nothing tells the format, or its lists are at fault.
    """
    path = Path(path)
    if not path.exists():
        raise InputError("must exist", file=path, remedy="check the name and the folder")
    found = next((name for name, (tells, _) in FORMATS.items() if tells(path)), None)
    if found is None:
        raise InputError(
            f"is no capture of a known format: {', '.join(FORMATS)}",
            file=path,
            remedy="name the folder that holds the lists (rgb.txt, pose.txt, odometry.csv …)",
        )
    if scale_to_m is None:
        return FORMATS[found][1](path, limits=limits)
    if found != "colmap":
        raise InputError(f"belongs to COLMAP, {found} is in metres", field="--scale-to-m")
    if not 0 < scale_to_m < float("inf"):
        raise InputError(f"must be > 0, got {scale_to_m:g}", field="--scale-to-m")
    return open_colmap(path, scale_to_m=scale_to_m, limits=limits)
