"""ARKit's LiDAR as two apps leave it: Stray Scanner's folders and Apple's ARKitScenes.

Stray Scanner (kekeblom/StrayVisualizer): rgb.mp4 of 1920×1440, depth/000000.png of 256×192 in mm,
confidence/ of 0, 1, 2, camera_matrix.csv of the video, odometry.csv with named columns, world from
camera; its own viewer hands these poses to Open3D as they are: the camera's y is down, and the
world is ARKit's, y up.

ARKitScenes (Baruch et al. 2021): lowres_wide and lowres_depth with names ``VIDEO_TIME.png``, a
``.pincam`` for each (width height fx fy cx cy), and lowres_wide.traj with lines ``time`` rotation
vector, translation of *camera from world*, radians and metres; the world's z is up.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from andon.errors import InputError
from andon.files.captures.model import Capture, CaptureFrame, Photo
from andon.files.captures.tables import (
    Z_UP_WORLD,
    Float,
    depth_of,
    nearest_time,
    numbers_of,
    photo_of,
    picture_files,
    pinhole,
    pose_of,
    rows_of,
    text_lines,
)
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.paths import check_file
from andon.spaces import invert_rigid

__all__ = ["is_arkitscenes", "is_stray", "open_arkitscenes", "open_stray"]

# Of 0, 1, 2: what ARKit calls low is mostly the mixed pixels of edges.
LEAST_CONFIDENCE = 1
COLUMNS = ("frame", "x", "y", "z", "qx", "qy", "qz", "qw")
# Depth and poses of ARKitScenes are stamped within a millisecond; its own reader takes 5 ms.
MOST_SECONDS = 0.005


def is_stray(folder: Path) -> bool:
    """Whether a folder is Stray Scanner's."""
    return (folder / "odometry.csv").is_file() and (folder / "camera_matrix.csv").is_file()


def open_stray(folder: Path, *, limits: Limits = DEFAULT_LIMITS) -> Capture:
    """The frames of odometry.csv that have a depth."""
    matrix = rows_of(folder / "camera_matrix.csv", 3, separator=",", limits=limits)
    if matrix.shape != (3, 3):
        raise InputError("must have 3 rows", file=folder / "camera_matrix.csv")
    intrinsics = matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]
    odometry = _odometry(folder / "odometry.csv", limits)
    depths = {path.stem: path for path in picture_files(folder / "depth", (".png", ".npy"))}
    rows = [row for row in odometry if f"{int(row[0]):06d}" in depths]
    if not rows:
        raise InputError("has no depth of a frame of odometry.csv", file=folder / "depth")

    def read(number: int) -> CaptureFrame:
        row = rows[number]
        name = f"{int(row[0]):06d}"
        photo, size = _video_frame(folder / "rgb.mp4", int(row[0]), limits)
        depth = _trusted(depth_of(depths[name], limits=limits), folder / "confidence", name, limits)
        pose = pose_of(row[1:4], row[4:8], folder / "odometry.csv", f"frame {name}")
        view = pinhole(size, intrinsics, pose, path=folder / "camera_matrix.csv")
        return CaptureFrame(name, photo, depth, view, True)

    return Capture("stray", folder, tuple(f"{int(row[0]):06d}" for row in rows), read)


def _odometry(path: Path, limits: Limits) -> Float:
    """(n, 8) frame, position, quaternion, whatever the order of the columns."""
    lines = text_lines(path, limits)
    if not lines:
        raise InputError("has no line", file=path)
    header = [word.strip().lower() for word in lines[0][1].split(",")]
    if any(column not in header for column in COLUMNS):
        raise InputError(f"must have the columns {', '.join(COLUMNS)}", file=path, field="line 1")
    places = [header.index(column) for column in COLUMNS]
    found: list[list[float]] = []
    for number, line in lines[1:]:
        words = line.split(",")
        if len(words) != len(header):
            raise InputError(f"must have {len(header)} columns", file=path, field=f"line {number}")
        found.append(numbers_of([words[place] for place in places], path, number))
    return np.array(found).reshape(-1, len(COLUMNS))


def _trusted(depth: Float, folder: Path, name: str, limits: Limits) -> Float:
    """The depth without what ARKit trusts least, where it says so."""
    path = folder / f"{name}.png"
    if not path.is_file():
        return depth
    # 0 is a level here, not a hole.
    confidence = np.nan_to_num(depth_of(path, 1.0, limits))
    if confidence.shape != depth.shape:
        raise InputError(f"must be {depth.shape[1]}×{depth.shape[0]} px, as its depth", file=path)
    return np.where(confidence >= LEAST_CONFIDENCE, depth, np.nan)


def _video_frame(path: Path, number: int, limits: Limits) -> tuple[Photo, tuple[int, int]]:
    """A frame of a video as PNG: all before it are stepped through, since seeking is inexact."""
    import cv2

    check_file(path, limits)
    video = cv2.VideoCapture(str(path))
    try:
        size = (int(video.get(cv2.CAP_PROP_FRAME_WIDTH)), int(video.get(cv2.CAP_PROP_FRAME_HEIGHT)))
        check_size(*size, path, limits)
        sound = number >= 0 and all(video.grab() for _ in range(number + 1))
        read, picture = video.retrieve() if sound else (False, None)
    finally:
        video.release()
    if not read or picture is None:
        raise InputError(f"has no frame {number}", file=path)
    done, data = cv2.imencode(".png", picture)
    if not done:
        raise InputError(f"frame {number} cannot be taken", file=path)
    return Photo(data.tobytes(), ".png"), (picture.shape[1], picture.shape[0])


def is_arkitscenes(folder: Path) -> bool:
    """Whether a folder is a scan of ARKitScenes."""
    return (folder / "lowres_depth").is_dir() and (folder / "lowres_wide").is_dir()


def open_arkitscenes(folder: Path, *, limits: Limits = DEFAULT_LIMITS) -> Capture:
    """Pictures of lowres_wide with a depth of the same name."""
    depths = {path.stem: path for path in picture_files(folder / "lowres_depth", (".png",))}
    photos = [p for p in picture_files(folder / "lowres_wide", (".png",)) if p.stem in depths]
    if not photos:
        raise InputError("has no picture with a depth of its name", file=folder / "lowres_wide")
    poses = rows_of(folder / "lowres_wide.traj", 7, limits=limits)

    def read(number: int) -> CaptureFrame:
        path = photos[number]
        photo, size = photo_of(path, limits)
        pincam = folder / "lowres_wide_intrinsics" / f"{path.stem}.pincam"
        row = rows_of(pincam, 6, limits=limits)[0]
        if (int(row[0]), int(row[1])) != size:
            raise InputError(f"is {size[0]}×{size[1]} px, its .pincam is not", file=path)
        pose = _traj_pose(poses, path, folder / "lowres_wide.traj")
        view = pinhole(size, row[2:].tolist(), pose, path=pincam)
        depth = depth_of(depths[path.stem], limits=limits)
        depth = _trusted(depth, folder / "confidence", path.stem, limits)
        return CaptureFrame(path.stem, photo, depth, view, pose is not None)

    return Capture("arkitscenes", folder, tuple(path.stem for path in photos), read)


def _traj_pose(poses: Float, photo: Path, path: Path) -> Float | None:
    time = numbers_of([photo.stem.rpartition("_")[2]], photo, 0)[0]
    index = nearest_time(poses[:, 0], time, MOST_SECONDS)
    if index is None:
        return None
    vector, position = poses[index, 1:4], poses[index, 4:7]
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle > 0 else np.zeros(3)
    quaternion = [*(axis * np.sin(angle / 2)), np.cos(angle / 2)]
    return Z_UP_WORLD @ invert_rigid(pose_of(position, quaternion, path, f"time {time:g}"))
