"""RealSense, as Open3D's recorder and Intel's viewer save it.

Open3D's ``realsense_recorder.py`` (reconstruction system): color/000000.jpg, depth/000000.png in
mm, *aligned to colour*, camera_intrinsic.json with ``intrinsic_matrix`` column by column. The
viewer's snapshot (librealsense): ``NAME_Color.png``, ``NAME_Depth.raw`` (uint16, 1 mm by default)
and two metadata CSV files with lines ``Fx,615.3``. There depth is of a camera of its own; it fits
the picture only if it was aligned, and then both have the same intrinsics.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from andon.errors import InputError
from andon.files.captures.model import Capture, CaptureFrame
from andon.files.captures.tables import (
    Float,
    depth_of,
    numbers_of,
    photo_of,
    picture_files,
    pinhole,
    text_lines,
)
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.paths import open_bounded
from andon.files.tree import Tree, check_complexity

__all__ = ["is_realsense", "is_snapshot", "open_realsense", "open_snapshot"]

INTRINSICS = "camera_intrinsic.json"
COLOUR, DEPTH = "_Color", "_Depth"
KEYS = ("fx", "fy", "ppx", "ppy")
SAME_PX = 0.5


def is_realsense(folder: Path) -> bool:
    """Whether a folder is Open3D's."""
    return (folder / INTRINSICS).is_file() and (folder / "color").is_dir()


def is_snapshot(folder: Path) -> bool:
    """Whether a folder has a snapshot of the viewer."""
    return any(folder.glob(f"*{DEPTH}.raw"))


def open_realsense(folder: Path, *, limits: Limits = DEFAULT_LIMITS) -> Capture:
    """Pictures with a depth of the same name; without poses."""
    size, intrinsics = _intrinsics(folder / INTRINSICS, limits)
    depths = {path.stem: path for path in picture_files(folder / "depth", (".png",))}
    photos = [path for path in picture_files(folder / "color") if path.stem in depths]
    if not photos:
        raise InputError("has no picture in color/ with a depth of its name", file=folder)

    def read(number: int) -> CaptureFrame:
        path = photos[number]
        photo, found = photo_of(path, limits)
        if found != size:
            raise InputError(f"is {found[0]}×{found[1]} px, {INTRINSICS} says {size}", file=path)
        view = pinhole(size, intrinsics, None, path=folder / INTRINSICS)
        return CaptureFrame(
            path.stem, photo, depth_of(depths[path.stem], limits=limits), view, False
        )

    return Capture("realsense", folder, tuple(path.stem for path in photos), read)


def _intrinsics(path: Path, limits: Limits) -> tuple[tuple[int, int], list[float]]:
    """(width, height) and fx, fy, cx, cy of Open3D's PinholeCameraIntrinsic."""
    data = open_bounded(path, limits, max_bytes=limits.max_camera_bytes)
    try:
        parsed = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InputError(f"must be sound JSON: {str(error)[:120]}", file=path) from error
    check_complexity(parsed, str(path), limits)
    root = Tree(parsed, "", str(path))
    size = (
        root.at("width").integer(1, limits.max_side),
        root.at("height").integer(1, limits.max_side),
    )
    check_size(*size, path, limits)
    matrix = root.at("intrinsic_matrix").numbers(9)
    return size, [matrix[0], matrix[4], matrix[6], matrix[7]]


def open_snapshot(folder: Path, *, limits: Limits = DEFAULT_LIMITS) -> Capture:
    """Snapshots whose depth was aligned to colour."""
    raws = sorted(folder.glob(f"*{DEPTH}.raw"))

    def read(number: int) -> CaptureFrame:
        raw = raws[number]
        name = raw.name.removesuffix(f"{DEPTH}.raw")
        photo, size = photo_of(folder / f"{name}{COLOUR}.png", limits)
        colour = _metadata(folder / f"{name}{COLOUR}_metadata.csv", limits)
        depth = _metadata(folder / f"{name}{DEPTH}_metadata.csv", limits)
        width, height = int(depth["resolution x"]), int(depth["resolution y"])
        scale = (size[0] / width, size[1] / height) * 2 if width and height else (1.0,) * 4
        if any(
            abs(colour[key] - depth[key] * s) > SAME_PX for key, s in zip(KEYS, scale, strict=True)
        ):
            raise InputError(
                "is of another camera than the picture: their intrinsics differ",
                file=raw,
                remedy="align depth to colour (rs.align) before saving",
            )
        view = pinhole(size, [colour[key] for key in KEYS], None, path=raw)
        return CaptureFrame(name, photo, _raw_depth(raw, width, height, limits), view, False)

    names = tuple(raw.name.removesuffix(f"{DEPTH}.raw") for raw in raws)
    notes = ("the depth unit is taken as 1 mm, the camera's default: the files do not state it",)
    return Capture("realsense", folder, names, read, notes)


def _metadata(path: Path, limits: Limits) -> dict[str, float]:
    """The numbers of lines ``name,value``, names in lower case."""
    found: dict[str, float] = {}
    for number, line in text_lines(path, limits):
        name, _, value = line.partition(",")
        key = name.strip().lower()
        if key in (*KEYS, "resolution x", "resolution y"):
            found[key] = numbers_of([value.strip().rstrip(",")], path, number)[0]
    missing = [key for key in (*KEYS, "resolution x", "resolution y") if key not in found]
    if missing:
        raise InputError(f"must state {', '.join(missing)}", file=path)
    return found


def _raw_depth(path: Path, width: int, height: int, limits: Limits) -> Float:
    check_size(width, height, path, limits)
    data = open_bounded(path, limits)
    if len(data) != 2 * width * height:
        raise InputError(
            f"must have {2 * width * height} bytes for {width}×{height} px, has {len(data)}",
            file=path,
        )
    metres = np.frombuffer(data, "<u2").reshape(height, width) * 0.001
    return np.where(metres > 0, metres, np.nan)
