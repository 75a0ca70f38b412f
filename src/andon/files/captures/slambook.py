"""The layout of the book "14 lectures on visual SLAM", chapter 5: color/, depth/, pose.txt.

Gao et al. 2017, ``ch5/joinMap``: depth in mm, registered to colour, 0 unknown; a line of pose.txt
for each picture, ``tx ty tz qx qy qz qw``, world from camera. The world stands as a camera does: y
down. Intrinsics are in the book's program only, for 640×480.
"""

from __future__ import annotations

from pathlib import Path

from andon.errors import InputError
from andon.files.captures.model import Capture, CaptureFrame
from andon.files.captures.tables import (
    Y_DOWN_WORLD,
    depth_of,
    photo_of,
    picture_files,
    pinhole,
    pose_of,
    rows_of,
)
from andon.files.limits import DEFAULT_LIMITS, Limits

__all__ = ["is_slambook", "open_slambook"]

INTRINSICS, SIZE = (518.0, 519.0, 325.5, 253.5), (640, 480)
DEPTHS = (".pgm", ".png")


def is_slambook(folder: Path) -> bool:
    """Whether a folder has poses, pictures and depth."""
    return all((folder / name).exists() for name in ("pose.txt", "color", "depth"))


def open_slambook(folder: Path, *, limits: Limits = DEFAULT_LIMITS) -> Capture:
    """Pictures with a depth of the same number; line n of the poses belongs to picture n."""
    depths = {path.stem: path for path in picture_files(folder / "depth", DEPTHS)}
    photos = [path for path in picture_files(folder / "color") if path.stem in depths]
    poses = rows_of(folder / "pose.txt", 7, limits=limits)
    if not photos:
        raise InputError("has no picture in color/ with a depth of its number", file=folder)

    def read(number: int) -> CaptureFrame:
        path = photos[number]
        photo, size = photo_of(path, limits)
        if size != SIZE:
            raise InputError(
                f"is {size[0]}×{size[1]} px; the book's camera has 640×480",
                file=path,
                remedy="state --camera",
            )
        line = int(path.stem) - 1 if path.stem.isdecimal() else number
        if not 0 <= line < len(poses):
            raise InputError(f"has no line for {path.name}", file=folder / "pose.txt")
        row = poses[line]
        pose = pose_of(row[:3], row[3:], folder / "pose.txt", f"pose {line + 1}")
        view = pinhole(size, INTRINSICS, Y_DOWN_WORLD @ pose, path=path)
        depth = depth_of(depths[path.stem], limits=limits)
        return CaptureFrame(path.stem, photo, depth, view, True)

    names = tuple(path.stem for path in photos)
    notes = ("intrinsics are those of the book's program", _LEVEL)
    return Capture("slambook", folder, names, read, notes)


_LEVEL = "which way is up is not stated: level is what the first camera was"
