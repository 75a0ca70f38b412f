"""Cameras in Andon's own TOML, the same table as ``[rig.camera]`` of a scene file.

::

    [camera]
    projection = "pinhole"       # or "fisheye", "latlong"
    width = 1280
    height = 720
    hfov_degrees = 65.0          # or fx (and fy), in pixels
    distortion = [0.1, -0.2, 0.0, 0.0]
    world_from_camera = [[1, 0, 0, 0], [0, -1, 0, 1.5], [0, 0, -1, 0], [0, 0, 0, 1]]
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.atomic import write_bytes
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.paths import open_bounded
from andon.files.tree import Tree, check_complexity
from andon.spaces import WORLD_FROM_CAMERA_DEFAULT, Projection, View

__all__ = ["CAMERA_KEYS", "camera_from_table", "read_toml", "write_camera"]

CAMERA_KEYS = (
    "projection", "width", "height", "fx", "fy", "cx", "cy", "hfov_degrees", "distortion",
    "world_from_camera", "name",
)  # fmt: skip
PROJECTIONS: tuple[Projection, ...] = ("pinhole", "fisheye", "latlong")
MAX_SIDE = 65536  # View's own limit

# How many coefficients OpenCV's models have (0: none).
DISTORTION_COUNTS = {"pinhole": (0, 4, 5, 8, 12, 14), "fisheye": (0, 4), "latlong": (0,)}


def read_toml(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> View:
    """The view in a TOML file: its ``[camera]`` table, or the whole file."""
    data = open_bounded(path, limits, max_bytes=limits.max_camera_bytes)
    try:
        table: dict[str, Any] = tomllib.loads(data.decode("utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise InputError(f"must be sound TOML: {str(error)[:160]}", file=path) from error
    check_complexity(table, str(path), limits)
    root = Tree(table, "", str(path))
    camera = root.get("camera")
    if camera is None:
        return camera_from_table(root)
    root.only(("camera",))
    return camera_from_table(camera)


def camera_from_table(camera: Tree) -> View:
    """A `View` from a table with the keys of `CAMERA_KEYS`.

    Pinhole and fisheye need exactly one of `fx` and `hfov_degrees`; `fy` defaults to `fx`, the
    principal point to the centre of the picture, the pose to that of `andon.spaces`.
    """
    camera.only(CAMERA_KEYS)
    projection = _projection(camera)
    width = camera.at("width").integer(1, MAX_SIDE)
    height = camera.at("height").integer(1, MAX_SIDE)
    distortion = camera.get("distortion")
    coefficients = distortion.numbers() if distortion else ()
    if len(coefficients) not in DISTORTION_COUNTS[projection]:
        raise camera.at("distortion").error(
            f"must be {' or '.join(map(str, DISTORTION_COUNTS[projection]))} numbers for "
            f"{projection}, got {len(coefficients)}"
        )
    name = camera.get("name")
    try:
        return View(
            projection,
            width,
            height,
            **_intrinsics(camera, projection, width, height),
            distortion=coefficients,
            world_from_camera=_pose(camera),
            name=name.text() if name else "mono",
        )
    except InputError as error:
        if error.file is None:  # View's own checks do not know the file
            raise InputError(error.rule, file=camera.file, field=error.field) from error
        raise


def _projection(camera: Tree) -> Projection:
    stated = camera.get("projection")
    if stated is None:
        return "pinhole"
    for known in PROJECTIONS:
        if stated.value == known:
            return known
    raise stated.error(f"must be one of {', '.join(PROJECTIONS)}, got {str(stated.value)[:40]!r}")


def _intrinsics(camera: Tree, projection: str, width: int, height: int) -> dict[str, float]:
    if projection == "latlong":
        return {}
    focal, hfov = camera.get("fx"), camera.get("hfov_degrees")
    if focal is not None and hfov is None:
        fx = focal.number()
    elif hfov is not None and focal is None:
        most = 179.9 if projection == "pinhole" else 360.0
        half = math.radians(hfov.number(0.01, most)) / 2
        # The picture ends half a pixel beyond the outer pixel centres, so its half width is W/2.
        fx = width / 2 / (math.tan(half) if projection == "pinhole" else half)
    else:
        raise camera.error("must have exactly one of fx and hfov_degrees")
    fy, cx, cy = camera.get("fy"), camera.get("cx"), camera.get("cy")
    return {
        "fx": fx,
        "fy": fy.number() if fy else fx,
        "cx": cx.number() if cx else (width - 1) / 2,
        "cy": cy.number() if cy else (height - 1) / 2,
    }


def _pose(camera: Tree) -> NDArray[np.float64]:
    pose = camera.get("world_from_camera")
    if pose is None:
        return WORLD_FROM_CAMERA_DEFAULT
    rows = [row.numbers(4) for row in pose.elements()]
    if len(rows) != 4:
        raise pose.error(f"must be 4 rows of 4 numbers, got {len(rows)} rows")
    return np.array(rows)


def write_camera(path: str | Path, view: View) -> Path:
    """Write a view as TOML; reading it back gives the same numbers, to the last bit."""
    lines = ["[camera]", f'projection = "{view.projection}"']
    lines += [f"width = {view.width}", f"height = {view.height}"]
    if view.projection != "latlong":
        intrinsics = cast("Mapping[str, Any]", vars(view))
        lines += [f"{key} = {float(intrinsics[key])!r}" for key in ("fx", "fy", "cx", "cy")]
    if view.distortion:
        lines.append(f"distortion = {[float(k) for k in view.distortion]!r}")
    rows = [f"  {[float(v) for v in row]!r}," for row in view.world_from_camera]
    lines += ["world_from_camera = [", *rows, "]"]
    lines.append(f"name = {_toml_text(view.name)}")
    return write_bytes(path, ("\n".join(lines) + "\n").encode())


def _toml_text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return (
        '"' + "".join(c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}" for c in escaped) + '"'
    )
