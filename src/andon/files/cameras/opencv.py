"""OpenCV's calibration files (YAML and JSON), and ROS's, which say the same in other words.

Files vary in their key names, so each fact has a list of names, the most specific first. A YAML
file is first walked as a stream of events, in which aliases (the "billion laughs" of YAML), depth
and number of values are refused before any object is built.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.cameras.toml import DISTORTION_COUNTS, MAX_SIDE
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.paths import open_bounded
from andon.files.tree import Tree, check_complexity
from andon.spaces import Projection, View

__all__ = ["read_opencv"]

MATRIX_KEYS = ("camera_matrix", "cameraMatrix", "Camera_Matrix", "CameraMatrix", "K", "M1", "K1")
DISTORTION_KEYS = (
    "distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "dist_coeffs",
    "DistortionCoefficients", "D", "D1",
)  # fmt: skip
WIDTH_KEYS = ("image_width", "image_Width", "width")
HEIGHT_KEYS = ("image_height", "image_Height", "height")
SIZE_KEYS = ("image_size", "imageSize", "resolution")
MODEL_KEYS = ("projection", "model", "camera_model", "distortion_model")
FISHEYE_NAMES = ("fisheye", "equidistant", "kannala_brandt", "opencv_fisheye")
PINHOLE_NAMES = ("pinhole", "plumb_bob", "rational_polynomial", "opencv", "radtan", "perspective")


def read_opencv(
    path: str | Path,
    *,
    limits: Limits = DEFAULT_LIMITS,
    size: tuple[int, int] | None = None,
) -> View:
    """The (first) camera of an OpenCV calibration file, at the default pose.

    Parameters
    ----------
    size : (width, height) in pixels for files that do not state it; it must agree with those that
        do.
    """
    data = open_bounded(path, limits, max_bytes=limits.max_camera_bytes)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("must be UTF-8 text", file=path) from error
    is_json = Path(path).suffix.lower() == ".json"
    value = _parse_json(text, path) if is_json else _parse_yaml(text, path, limits)
    check_complexity(value, str(path), limits)
    return _view(Tree(value, "", str(path)), size)


def _parse_json(text: str, path: str | Path) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"must be sound JSON: {str(error)[:160]}", file=path) from error


def _parse_yaml(text: str, path: str | Path, limits: Limits) -> Any:
    import yaml

    # OpenCV before 3.2 wrote "%YAML:1.0", which is no directive of any YAML version.
    if text.startswith("%YAML"):
        text = text.partition("\n")[2]
    # libyaml is twenty times faster; PyYAML can be built without it.
    fast: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        events = yaml.parse(text, Loader=fast)  # pyright: ignore
        _check_events(cast("Iterable[Any]", events), path, limits)

        class Loader(fast):
            """The safe loader, to which OpenCV's matrix tag is a plain table."""

        def matrix(loader: Any, node: Any) -> Any:
            return loader.construct_mapping(node, deep=True)

        Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", matrix)
        Loader.add_constructor("!opencv-matrix", matrix)
        return yaml.load(text, Loader=Loader)
    except InputError:
        raise
    except (yaml.YAMLError, ValueError, TypeError, RecursionError, OverflowError) as error:
        line = " ".join(str(error).split())
        raise InputError(f"must be sound YAML: {line[:160]}", file=path) from error


def _check_events(events: Iterable[Any], path: str | Path, limits: Limits) -> None:
    """Aliases, nesting and the number of values, before anything is built from them."""
    from yaml import events as kinds

    depth = count = 0
    for event in events:
        if isinstance(event, kinds.AliasEvent):
            raise InputError("must not use YAML aliases", file=path, remedy="write values out")
        count += isinstance(event, kinds.NodeEvent)
        depth += isinstance(event, kinds.CollectionStartEvent)
        depth -= isinstance(event, kinds.CollectionEndEvent)
        if depth > limits.max_depth or count > limits.max_nodes:
            raise InputError(
                f"must have at most {limits.max_nodes} values nested {limits.max_depth} deep",
                file=path,
            )


def _first(root: Tree, keys: tuple[str, ...]) -> Tree | None:
    return next((root.at(key) for key in keys if key in root), None)


def _view(root: Tree, size: tuple[int, int] | None) -> View:
    stated = _first(root, MATRIX_KEYS)
    if stated is None:
        raise root.error("must hold a camera matrix", f"known names are {', '.join(MATRIX_KEYS)}")
    matrix = _matrix(stated)
    if matrix.shape != (3, 3) or not np.array_equal(matrix[2], [0, 0, 1]) or matrix[1, 0] != 0:
        raise stated.error("must be 3×3: [fx, 0, cx], [0, fy, cy], [0, 0, 1]")
    # A skew of a thousandth of a pixel over the picture is rounding; real skew is not modelled.
    if abs(matrix[0, 1]) > 1e-6 * abs(matrix[0, 0]):
        raise stated.error(f"must have no skew, got {matrix[0, 1]:g}", "calibrate without skew")
    projection = _model(root)
    listed = _first(root, DISTORTION_KEYS)
    distortion = () if listed is None else tuple(_matrix(listed).ravel().tolist())
    if listed is not None and len(distortion) not in DISTORTION_COUNTS[projection]:
        counts = ", ".join(map(str, DISTORTION_COUNTS[projection]))
        raise listed.error(f"must be {counts} numbers for {projection}, got {len(distortion)}")
    width, height = _size(root, size)
    fx, fy, cx, cy = matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]
    try:
        return View(
            projection, width, height, float(fx), float(fy), float(cx), float(cy), distortion
        )
    except InputError as error:
        raise InputError(error.rule, file=root.file, field=error.field) from error


def _matrix(entry: Tree) -> NDArray[np.float64]:
    """A matrix from ``{rows, cols, data}``, a nested list or a flat one."""
    if not isinstance(entry.value, dict):
        rows = entry.elements()
        if rows and isinstance(rows[0].value, list):
            lengths = {len(row.elements()) for row in rows}
            if len(lengths) != 1:
                raise entry.error("must have rows of equal length")
            return np.array([row.numbers() for row in rows])
        flat = entry.numbers()
        return np.array(flat).reshape((3, 3) if len(flat) == 9 else (1, -1))
    count = 10_000  # far above any camera matrix; per-view tables are not read
    rows, columns = entry.at("rows").integer(1, count), entry.at("cols").integer(1, count)
    data = entry.at("data").numbers()
    if len(data) != rows * columns:
        raise entry.error(f"must have {rows}×{columns} numbers, has {len(data)}")
    return np.array(data).reshape(rows, columns)


def _model(root: Tree) -> Projection:
    flag = root.get("fisheye_model")
    if flag is not None and flag.value in (1, True):
        return "fisheye"
    stated = _first(root, MODEL_KEYS)
    if stated is None:
        return "pinhole"
    name = stated.text().strip().lower()
    if name in FISHEYE_NAMES:
        return "fisheye"
    if name in PINHOLE_NAMES:
        return "pinhole"
    raise stated.error(
        f"must be one of {', '.join((*PINHOLE_NAMES, *FISHEYE_NAMES))}, got {name[:40]!r}"
    )


def _size(root: Tree, size: tuple[int, int] | None) -> tuple[int, int]:
    stated: tuple[int, int] | None = None
    width, height, both = (_first(root, k) for k in (WIDTH_KEYS, HEIGHT_KEYS, SIZE_KEYS))
    if width is not None and height is not None:
        stated = width.integer(1, MAX_SIDE), height.integer(1, MAX_SIDE)
    elif both is not None:
        sides = both.elements()
        if len(sides) != 2:
            raise both.error("must be [width, height]")
        stated = sides[0].integer(1, MAX_SIDE), sides[1].integer(1, MAX_SIDE)
    if stated is None and size is None:
        raise root.error(
            "must state the size of the picture",
            "add image_width and image_height, or give the size of the picture",
        )
    if stated is not None and size is not None and stated != tuple(size):
        raise root.error(f"is for {stated[0]}×{stated[1]} px, the picture has {size[0]}×{size[1]}")
    result = stated or size
    assert result is not None
    return result
