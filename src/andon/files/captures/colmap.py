"""COLMAP's dense workspace: images/, sparse/, stereo/depth_maps (colmap.github.io/format.html).

Depth maps: text ``width&height&channels&``, then float32, little-endian, row by row, planar z, ≤ 0
unknown. Poses are camera from world, quaternions scalar-first. COLMAP's pixel centres lie at
(0.5, 0.5), so principal points are half a pixel less here. Its unit is nobody's metre and its world
stands as its first pictures did.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from andon.errors import InputError
from andon.files.captures.model import Capture, CaptureFrame
from andon.files.captures.tables import (
    Y_DOWN_WORLD,
    Float,
    numbers_of,
    photo_of,
    pinhole,
    pose_of,
    text_lines,
)
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most, check_size
from andon.files.paths import confined, open_bounded
from andon.spaces import invert_rigid

__all__ = ["is_colmap", "open_colmap", "read_depth_map"]

# Model number and name → where fx, fy, cx, cy stand among its parameters, how many there are,
# and which are OpenCV's k1, k2, p1, p2 …
MODELS = {
    (0, "SIMPLE_PINHOLE"): ((0, 0, 1, 2), 3),
    (1, "PINHOLE"): ((0, 1, 2, 3), 4),
    (2, "SIMPLE_RADIAL"): ((0, 0, 1, 2), 4),
    (3, "RADIAL"): ((0, 0, 1, 2), 5),
    (4, "OPENCV"): ((0, 1, 2, 3), 8),
    (6, "FULL_OPENCV"): ((0, 1, 2, 3), 12),
}
HEADER = re.compile(rb"(\d{1,6})&(\d{1,6})&(\d{1,3})&")
KINDS = ("geometric", "photometric")
MOST_NAME = 1024


@dataclass(frozen=True)
class _Camera:
    size: tuple[int, int]
    intrinsics: tuple[float, ...]
    distortion: tuple[float, ...]


@dataclass(frozen=True)
class _Image:
    name: str
    camera: int
    world_from_camera: Float


def is_colmap(folder: Path) -> bool:
    """Whether a folder is a dense workspace, or one with the model in it."""
    return _model(folder) is not None and (folder / "stereo" / "depth_maps").is_dir()


def _model(folder: Path) -> tuple[Path, str] | None:
    for place in (folder / "sparse", folder / "sparse" / "0", folder):
        for suffix in (".txt", ".bin"):
            if (place / f"images{suffix}").is_file() and (place / f"cameras{suffix}").is_file():
                return place, suffix
    return None


def open_colmap(
    folder: Path, *, scale_to_m: float = 1.0, limits: Limits = DEFAULT_LIMITS
) -> Capture:
    """Pictures with a depth map, geometric before photometric; `scale_to_m`: metres per unit."""
    model = _model(folder)
    if model is None:
        raise InputError("has no sparse/cameras and images, .txt or .bin", file=folder)
    place, suffix = model
    if suffix == ".txt":
        cameras = _cameras_text(place / "cameras.txt", limits)
        images = _images_text(place / "images.txt", limits)
    else:
        cameras = _cameras_binary(place / "cameras.bin", limits)
        images = _images_binary(place / "images.bin", limits)
    maps = folder / "stereo" / "depth_maps"
    found: list[tuple[_Image, Path]] = []
    for image in sorted(images, key=lambda image: image.name):
        names = [confined(f"{image.name}.{kind}.bin", maps, file=place) for kind in KINDS]
        found += [(image, path) for path in names if path.is_file()][:1]
    if not found:
        raise InputError("has no depth map of a picture of the model", file=maps)

    def read(number: int) -> CaptureFrame:
        image, path = found[number]
        camera = cameras.get(image.camera)
        if camera is None:
            raise InputError(f"has no camera {image.camera} of {image.name}", file=place)
        photo, size = photo_of(confined(image.name, folder / "images", file=place), limits)
        if size != camera.size:
            raise InputError(f"{image.name} is {size} px, its camera {camera.size}", file=place)
        pose = image.world_from_camera.copy()
        pose[:3, 3] *= scale_to_m
        view = pinhole(
            size, camera.intrinsics, Y_DOWN_WORLD @ pose, distortion=camera.distortion, path=place
        )
        depth = read_depth_map(path, limits=limits) * scale_to_m
        with np.errstate(invalid="ignore"):
            depth = np.where((depth > 0) & np.isfinite(depth), depth, np.nan)
        return CaptureFrame(image.name, photo, depth, view, True)

    notes = ["which way is up is not stated: level is what the first camera was"]
    if scale_to_m == 1:
        notes.append("a unit of COLMAP is taken as 1 m: --scale-to-m states it")
    names = tuple(image.name for image, _ in found)
    return Capture("colmap", folder, names, read, tuple(notes))


def read_depth_map(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Float:
    """The (H, W) numbers of a depth map as float64."""
    data = open_bounded(path, limits)
    header = HEADER.match(data[: limits.max_header_bytes])
    if header is None:
        raise InputError("must begin with width&height&channels&", file=path)
    width, height, channels = (int(number) for number in header.groups())
    check_size(width, height, path, limits)
    if channels != 1:
        raise InputError(f"must have 1 channel, has {channels}: a normal map?", file=path)
    needed = header.end() + 4 * width * height
    if len(data) < needed:
        raise InputError(f"must have {needed} bytes, is cut short at {len(data)}", file=path)
    values = np.frombuffer(data, "<f4", count=width * height, offset=header.end())
    with np.errstate(invalid="ignore"):
        return values.reshape(height, width).astype(np.float64)


def _camera(
    model: int | str, size: tuple[int, int], parameters: list[float], path: Path
) -> _Camera:
    known = next((value for key, value in MODELS.items() if model in key), None)
    if known is None:
        names = ", ".join(name for _, name in MODELS)
        raise InputError(
            f"camera model {str(model)[:40]} is none of {names}",
            file=path,
            remedy="run colmap image_undistorter: depth maps are of its pictures",
        )
    places, count = known
    if len(parameters) != count:
        raise InputError(f"a camera of model {model} must have {count} parameters", file=path)
    fx, fy, cx, cy = (parameters[place] for place in places)
    rest = parameters[max(places) + 1 :]
    distortion = [*rest, 0.0, 0.0, 0.0][:4] if len(rest) in (1, 2) else rest
    check_size(*size, path)
    return _Camera(size, (fx, fy, cx - 0.5, cy - 0.5), tuple(distortion))


def _cameras_text(path: Path, limits: Limits) -> dict[int, _Camera]:
    found: dict[int, _Camera] = {}
    for number, line in text_lines(path, limits):
        words = line.split()
        if len(words) < 5:
            raise InputError(
                "must be ID MODEL WIDTH HEIGHT PARAMS", file=path, field=f"line {number}"
            )
        own, width, height = (int(v) for v in numbers_of([words[0], *words[2:4]], path, number))
        parameters = numbers_of(words[4:], path, number)
        found[own] = _camera(words[1], (width, height), parameters, path)
    return found


def _images_text(path: Path, limits: Limits) -> list[_Image]:
    """Every other line is one of points, and may be empty."""
    data = open_bounded(path, limits, max_bytes=limits.max_mesh_text_bytes)
    found: list[_Image] = []
    is_points = False
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), start=1):
        if line.startswith("#") or (not is_points and not line.strip()):
            continue
        if not is_points:
            words = line.split(None, 9)
            if len(words) != 10:
                raise InputError("must be ID QW … NAME", file=path, field=f"line {number}")
            values = numbers_of(words[:9], path, number)
            found.append(_image(values[1:8], int(values[8]), words[9].strip(), path))
        is_points = not is_points
    return found


def _image(pose: list[float], camera: int, name: str, path: Path) -> _Image:
    w, x, y, z, *position = pose
    return _Image(name, camera, invert_rigid(pose_of(position, [x, y, z, w], path, name[:80])))


class _Bytes:
    """Little-endian numbers one after another. Raises `InputError` at the end."""

    def __init__(self, path: Path, limits: Limits) -> None:
        self.data, self.at, self.path = open_bounded(path, limits), 0, path

    def take(self, form: str) -> list[float]:
        """Numbers of a `struct` format."""
        size = struct.calcsize(f"<{form}")
        self.skip(size)
        return list(struct.unpack_from(f"<{form}", self.data, self.at - size))

    def skip(self, count: int) -> None:
        """Steps on."""
        if count > len(self.data) - self.at:
            raise InputError("must not be cut short", file=self.path)
        self.at += count

    def name(self) -> str:
        """Text up to a zero byte."""
        end = self.data.find(b"\0", self.at, self.at + MOST_NAME)
        if end < 0:
            raise InputError("must have names that end", file=self.path)
        text = self.data[self.at : end].decode("utf-8", "replace")
        self.at = end + 1
        return text


def _cameras_binary(path: Path, limits: Limits) -> dict[int, _Camera]:
    data = _Bytes(path, limits)
    found: dict[int, _Camera] = {}
    (count,) = data.take("Q")
    check_at_most(int(count), limits.max_nodes, "cameras", path)
    counts = {number: known[1] for (number, _), known in MODELS.items()}
    for _ in range(int(count)):
        own, model, width, height = (int(v) for v in data.take("iiQQ"))
        if model not in counts:
            _camera(model, (width, height), [], path)
        parameters = data.take(f"{counts[model]}d")
        found[own] = _camera(model, (width, height), parameters, path)
    return found


def _images_binary(path: Path, limits: Limits) -> list[_Image]:
    data = _Bytes(path, limits)
    found: list[_Image] = []
    (count,) = data.take("Q")
    check_at_most(int(count), limits.max_nodes, "pictures", path)
    for _ in range(int(count)):
        _, *pose, camera = data.take("i7di")
        name = data.name()
        (points,) = data.take("Q")
        data.skip(int(points) * 24)
        found.append(_image(pose, int(camera), name, path))
    return found
