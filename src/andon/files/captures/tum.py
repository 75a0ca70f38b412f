"""TUM RGB-D: pictures and depth with times of their own, and poses of motion capture.

Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012; its pages on file
formats and intrinsics: depth is 16-bit PNG, 5000 a metre, registered to the colour picture;
groundtruth.txt has lines ``time tx ty tz qx qy qz qw``, world from camera, the world's z up.
Pictures belong to depth and poses within 20 ms, as in the benchmark's associate.py.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from andon.errors import InputError
from andon.files.captures.model import Capture, CaptureFrame
from andon.files.captures.tables import (
    Z_UP_WORLD,
    Float,
    depth_of,
    nearest_time,
    numbers_of,
    photo_of,
    pinhole,
    pose_of,
    rows_of,
    text_lines,
)
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.paths import confined

__all__ = ["is_tum", "open_tum"]

UNITS_PER_METRE = 5000
MOST_SECONDS = 0.02
# fx, fy, cx, cy and OpenCV's distortion of each Kinect; of other folders ROS's default, which
# the benchmark recommends: its depth was registered with it.
INTRINSICS = {
    "freiburg1": ((517.3, 516.5, 318.6, 255.3), (0.2624, -0.9531, -0.0054, 0.0026, 1.1633)),
    "freiburg2": ((520.9, 521.0, 325.1, 249.7), (0.2312, -0.7849, -0.0033, -0.0001, 0.9172)),
    "freiburg3": ((535.4, 539.2, 320.1, 247.6), ()),
}
ROS_DEFAULT = (525.0, 525.0, 319.5, 239.5), ()
SIZE = (640, 480)


def is_tum(folder: Path) -> bool:
    """Whether a folder has the two lists."""
    return (folder / "rgb.txt").is_file() and (folder / "depth.txt").is_file()


def open_tum(folder: Path, *, limits: Limits = DEFAULT_LIMITS) -> Capture:
    """The pictures that have a depth within 20 ms."""
    rgb_times, rgb_files = _listed(folder, "rgb.txt", limits)
    depth_times, depth_files = _listed(folder, "depth.txt", limits)
    pairs = [
        (index, other)
        for index, time in enumerate(rgb_times)
        if (other := nearest_time(depth_times, float(time), MOST_SECONDS)) is not None
    ]
    if not pairs:
        raise InputError("no picture of rgb.txt has a depth of depth.txt within 20 ms", file=folder)
    poses = None
    if (folder / "groundtruth.txt").is_file():
        poses = rows_of(folder / "groundtruth.txt", 8, limits=limits)
    known = next((name for name in INTRINSICS if name in folder.resolve().name), None)
    intrinsics, distortion = INTRINSICS[known] if known else ROS_DEFAULT

    def read(number: int) -> CaptureFrame:
        index, other = pairs[number]
        photo, size = photo_of(rgb_files[index], limits)
        if size != SIZE:
            raise InputError(
                f"is {size[0]}×{size[1]} px; the benchmark's cameras have 640×480",
                file=rgb_files[index],
                remedy="state --camera",
            )
        pose = None if poses is None else _pose(poses, float(rgb_times[index]), folder)
        depth = depth_of(depth_files[other], 1 / UNITS_PER_METRE, limits)
        view = pinhole(size, intrinsics, pose, distortion=distortion, path=folder)
        return CaptureFrame(rgb_files[index].stem, photo, depth, view, pose is not None)

    names = tuple(rgb_files[index].stem for index, _ in pairs)
    notes = () if known else ("intrinsics are ROS's default of the Kinect: the folder's name "
                              "names none of freiburg1, 2 and 3",)  # fmt: skip
    return Capture("tum", folder, names, read, notes)


def _listed(folder: Path, name: str, limits: Limits) -> tuple[Float, list[Path]]:
    """Times (n,) and files of a list of ``time file``."""
    times: list[float] = []
    files: list[Path] = []
    for number, line in text_lines(folder / name, limits):
        words = line.split(None, 1)
        if len(words) != 2:
            raise InputError(
                "must be a time and a file", file=folder / name, field=f"line {number}"
            )
        times += numbers_of(words[:1], folder / name, number)
        files.append(confined(words[1], folder, file=folder / name))
    if not times:
        raise InputError("names no file", file=folder / name)
    return np.array(times), files


def _pose(poses: Float, time: float, folder: Path) -> Float | None:
    index = nearest_time(poses[:, 0], time, MOST_SECONDS)
    if index is None:
        return None
    row = poses[index]
    path = folder / "groundtruth.txt"
    return Z_UP_WORLD @ pose_of(row[1:4], row[4:8], path, f"time {row[0]:g}")
