"""Record3D: a .r3d file, which is a zip, or the folder that it unpacks to.

``metadata`` (JSON) has w, h of the pictures, dw, dh of the depth, K column by column
[fx, 0, 0, 0, fy, 0, cx, cy, 1], or perFrameIntrinsicCoeffs (fx, fy, cx, cy), and poses (qx qy qz qw
x y z): world from camera of ARKit, whose camera looks along −z with y up; its world's y is up.
rgbd/N.jpg are pictures, rgbd/N.depth float32 metres, rgbd/N.conf confidences 0, 1, 2, both packed
by LZFSE, for which Python has no decoder of its own: `lzfse` from PyPI is asked for. Depth may also
be rgbd/N.exr, of those who unpacked it. (record3d.app; poses as nerfstudio's ``record3d_utils``
reads them.)
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from andon.errors import InputError, MachineError
from andon.files.captures.model import Capture, CaptureFrame
from andon.files.captures.tables import GL_CAMERA, Float, depth_of, photo_of_bytes, pinhole, pose_of
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.paths import open_bounded
from andon.files.tree import Tree, check_complexity

__all__ = ["is_record3d", "open_record3d"]

LEAST_CONFIDENCE = 1
# Width and height of ARKit's LiDAR and of the camera in front, for files that do not say.
SENSORS = ((192, 256), (256, 192), (480, 640), (640, 480))


def is_record3d(path: Path) -> bool:
    """Whether a file ends in .r3d, or a folder has what it unpacks to."""
    if path.is_file():
        return path.suffix.lower() == ".r3d"
    return (path / "metadata").is_file() and (path / "rgbd").is_dir()


@dataclass(frozen=True)
class _Source:
    """Files of a capture, in a folder or in a zip."""

    names: frozenset[str]
    read: Callable[[str], bytes]


def open_record3d(path: Path, *, limits: Limits = DEFAULT_LIMITS) -> Capture:
    """Pictures with a depth. Raises `MachineError` on reading where LZFSE cannot be unpacked."""
    source = _in_zip(path, limits) if path.is_file() else _in_folder(path, limits)
    root = _metadata(source.read("metadata"), path, limits)
    numbers = sorted(
        int(stem)
        for name in source.names
        if (stem := name.removeprefix("rgbd/").removesuffix(".jpg")).isdecimal()
        and ({f"rgbd/{stem}.depth", f"rgbd/{stem}.exr"} & source.names)
    )
    if not numbers:
        raise InputError("has no rgbd/N.jpg with a depth", file=path)

    def read(index: int) -> CaptureFrame:
        number = numbers[index]
        photo, size = photo_of_bytes(source.read(f"rgbd/{number}.jpg"), path, limits)
        pose = _pose(root, number, path)
        view = pinhole(size, _intrinsics(root, number, size), pose, path=path)
        depth = _depth(source, root, number, path, size, limits)
        return CaptureFrame(str(number), photo, depth, view, pose is not None)

    return Capture("record3d", path, tuple(map(str, numbers)), read)


def _in_folder(folder: Path, limits: Limits) -> _Source:
    names = {f"rgbd/{path.name}" for path in (folder / "rgbd").iterdir()}
    return _Source(frozenset(names), lambda name: open_bounded(folder / name, limits))


def _in_zip(path: Path, limits: Limits) -> _Source:
    data = open_bounded(path, limits)

    def read(name: str) -> bytes:
        try:
            with zipfile.ZipFile(io.BytesIO(data)) as archive:
                if archive.getinfo(name).file_size > limits.max_text_bytes * 4:
                    raise InputError(f"{name} would unpack to too many bytes", file=path)
                return archive.read(name)
        except InputError:
            raise
        except Exception as error:  # BadZipFile, KeyError, zlib.error, NotImplementedError …
            raise InputError(f"must hold a sound {name}: {str(error)[:80]}", file=path) from error

    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            names = frozenset(archive.namelist())
    except Exception as error:
        raise InputError(f"must be a sound zip: {str(error)[:80]}", file=path) from error
    return _Source(names, read)


def _metadata(data: bytes, path: Path, limits: Limits) -> Tree:
    if len(data) > limits.max_text_bytes:
        raise InputError("its metadata is too long", file=path)
    try:
        parsed: Any = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InputError(f"metadata must be sound JSON: {str(error)[:80]}", file=path) from error
    check_complexity(parsed, str(path), limits)
    return Tree(parsed, "metadata", str(path))


def _intrinsics(root: Tree, number: int, size: tuple[int, int]) -> list[float]:
    """fx, fy, cx, cy of the picture of (width, height)."""
    own = root.get("perFrameIntrinsicCoeffs")
    if own is not None and number < len(own.elements()):
        found = list(own.elements()[number].numbers(4))
    else:
        matrix = root.at("K").numbers(9)
        found = [matrix[0], matrix[4], matrix[6], matrix[7]]
    stated = (root.at("w").number(1), root.at("h").number(1))
    if stated == (float(size[0]), float(size[1])):
        return found
    scale = size[0] / stated[0], size[1] / stated[1]
    if abs(scale[0] / scale[1] - 1) > 0.01:
        raise root.error(f"pictures are {size[0]}×{size[1]} px, stated {stated[0]:g}×{stated[1]:g}")
    return [value * s for value, s in zip(found, scale * 2, strict=True)]


def _pose(root: Tree, number: int, path: Path) -> Float | None:
    poses = root.get("poses")
    if poses is None or number >= len(poses.elements()):
        return None
    row = poses.elements()[number].numbers(7)
    return pose_of(row[4:], row[:4], path, f"poses[{number}]") @ GL_CAMERA


def _depth(
    source: _Source, root: Tree, number: int, path: Path, size: tuple[int, int], limits: Limits
) -> Float:
    if f"rgbd/{number}.depth" not in source.names:
        if path.is_file():
            raise InputError("EXR depth is read from unpacked folders only", file=path)
        return depth_of(path / f"rgbd/{number}.exr", 1.0, limits)
    packed = source.read(f"rgbd/{number}.depth")
    width, height = _depth_size(root, size)
    check_size(width, height, path, limits)
    values = _unpacked(packed, 4 * width * height, f"rgbd/{number}.depth", path)
    metres = np.frombuffer(values, "<f4").reshape(height, width).astype(np.float64)
    with np.errstate(invalid="ignore"):
        metres = np.where((metres > 0) & np.isfinite(metres), metres, np.nan)
    name = f"rgbd/{number}.conf"
    if name not in source.names:
        return metres
    confidence = np.frombuffer(_unpacked(source.read(name), width * height, name, path), np.uint8)
    return np.where(confidence.reshape(height, width) >= LEAST_CONFIDENCE, metres, np.nan)


def _depth_size(root: Tree, size: tuple[int, int]) -> tuple[int, int]:
    if root.get("dw") is not None:
        return root.at("dw").integer(1, 65536), root.at("dh").integer(1, 65536)
    # LiDAR's, as upright as the picture is.
    return next(s for s in SENSORS if (s[0] < s[1]) == (size[0] < size[1]))


def _unpacked(data: bytes, count: int, name: str, path: Path) -> bytes:
    """`count` bytes of an LZFSE stream, which is at most a header longer than what it holds."""
    if len(data) > count + 1024:
        raise InputError(f"{name} must unpack to {count} bytes, is longer packed", file=path)
    try:
        import lzfse  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise MachineError(
            f"{path}: {name} is packed by LZFSE, and nothing here unpacks it",
            remedy="pip install lzfse; or unpack the depth to EXR beside the pictures",
        ) from error
    try:
        values = bytes(cast(Any, lzfse).decompress(data))
    except Exception as error:  # its own error class differs between its two packages
        raise InputError(f"{name} must be a sound LZFSE stream", file=path) from error
    if len(values) != count:
        raise InputError(f"{name} must unpack to {count} bytes, has {len(values)}", file=path)
    return values
