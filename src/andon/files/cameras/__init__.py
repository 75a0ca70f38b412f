"""Cameras: Andon's TOML, and the calibration files that OpenCV and ROS programs write.

TOML is the format to write, since it is the scene file's own and carries projection and pose. The
others are read because that is what calibration tools leave behind: intrinsics and distortion.
"""

from __future__ import annotations

from pathlib import Path

from andon.errors import InputError
from andon.files.cameras.opencv import read_opencv
from andon.files.cameras.toml import CAMERA_KEYS, camera_from_table, read_toml, write_camera
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.reader import Reader, choose_reader
from andon.spaces import View

__all__ = ["CAMERA_KEYS", "CAMERA_READERS", "camera_from_table", "read_camera", "write_camera"]

CAMERA_READERS = (
    Reader("camera.toml", (".toml",), read_toml),
    Reader("camera.opencv", (".yml", ".yaml", ".json"), read_opencv),
)


def read_camera(
    path: str | Path,
    *,
    limits: Limits = DEFAULT_LIMITS,
    size: tuple[int, int] | None = None,
) -> View:
    """The view that a camera file describes.

    Parameters
    ----------
    size : (width, height) in pixels of the picture that the camera belongs to. It is needed where
        a calibration file does not state it, and must agree where it does.

    Raises
    ------
    InputError
        if the suffix is unknown, a key is unknown or missing, or a value breaks its rule.
    """
    reader = choose_reader(path, CAMERA_READERS, "camera file")
    if reader.read is read_opencv:
        return read_opencv(path, limits=limits, size=size)
    view = read_toml(path, limits=limits)
    if size is not None and tuple(size) != (view.width, view.height):
        raise InputError(
            f"is for {view.width}×{view.height} px, the picture has {size[0]}×{size[1]}", file=path
        )
    return view
