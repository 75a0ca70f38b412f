"""[scene], [rig] and [capture]: the session, who looks, and what was seen."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, cast

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from andon.errors import InputError
from andon.scene.base import (
    Count,
    Fraction,
    NonNegative,
    Pixels,
    Positive,
    Reference,
    Table,
    Vector,
    refusal,
)
from andon.scene.geometry import Direction, Pose
from andon.spaces import WORLD_FROM_CAMERA_DEFAULT, View, look_at

__all__ = [
    "About",
    "Camera",
    "Capture",
    "PoseSource",
    "ResponseTable",
    "Rig",
    "StereoSource",
    "Trajectory",
]

METRES_PER_UNIT = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}

# Numbers of coefficients that OpenCV's two camera models know.
_DISTORTION_LENGTHS = {"pinhole": (0, 4, 5, 8, 12, 14), "fisheye": (0, 4), "latlong": (0,)}


class About(Table):
    """The session as a whole."""

    name: str = Field(
        default="scene",
        description="Title for reports.",
    )
    photometry: Literal["absolute", "relative"] = Field(
        default="absolute",
        description="Whether lux and cd/m² are absolute, or relative to the light of the "
        "photograph; every number that leaves the program carries this word.",
    )
    unit: Literal["m", "cm", "mm", "in", "ft"] = Field(
        default="m",
        description="Unit of mesh files that do not say (OBJ); the scene file is in metres.",
    )
    up: Literal["y", "z"] = Field(
        default="y",
        description="Up axis of mesh files that do not say (OBJ).",
    )
    seed: Count = Field(
        default=0,
        description="Seed from which every random stream is derived.",
    )
    duration_seconds: NonNegative = Field(
        default=0.0,
        description="Length in seconds; 0 is a still.",
    )
    frames_per_second: Positive = Field(
        default=30.0,
        description="Frames per second of a sequence.",
    )

    @property
    def metres_per_unit(self) -> float:
        """Metres in one `unit`."""
        return METRES_PER_UNIT[self.unit]


class Camera(Table):
    """Intrinsics and pose of one camera or eye, here or in a camera file."""

    file: Reference | None = Field(
        default=None,
        description="Camera file; excludes the intrinsics below, not the pose.",
    )
    projection: Literal["pinhole", "fisheye", "latlong"] = Field(
        default="pinhole",
        description="Which direction a pixel has.",
    )
    width: Pixels | None = Field(
        default=None,
        description="Pixels; default: the picture's.",
    )
    height: Pixels | None = Field(
        default=None,
        description="Pixels; default: the picture's.",
    )
    fx: Positive | None = Field(
        default=None,
        description="Focal length along a row in pixels.",
    )
    fy: Positive | None = Field(
        default=None,
        description="Focal length along a column; default: fx.",
    )
    cx: float | None = Field(
        default=None,
        description="Principal point, column; default: the middle.",
    )
    cy: float | None = Field(
        default=None,
        description="Principal point, row; default: the middle.",
    )
    hfov_degrees: Annotated[float, Field(gt=0, le=360)] | None = Field(
        default=None,
        description="Full horizontal angle instead of fx, degrees; below 180 for pinhole.",
    )
    distortion: tuple[float, ...] = Field(
        default=(),
        description="OpenCV coefficients: pinhole k1 k2 p1 p2 [k3 …], fisheye k1 k2 k3 k4.",
    )
    world_from_camera: Pose | None = Field(
        default=None,
        description="4×4 rigid pose (OpenCV axes), row by row; with a trajectory: rig_from_camera. "
        "Default: the origin, looking along −Z, +Y up.",
    )
    position: Vector | None = Field(
        default=None,
        description="Position in metres, with `look_at`, instead of world_from_camera.",
    )
    look_at: Vector | None = Field(
        default=None,
        description="Point in metres that is in the middle.",
    )
    up: Direction = Field(
        default=(0.0, 1.0, 0.0),
        description="Which way is up for `look_at`.",
    )

    @model_validator(mode="after")
    def _check_camera(self) -> Camera:
        inline = {"projection", "width", "height", "fx", "fy", "cx", "cy", "hfov_degrees"}
        both = sorted(inline & self.model_fields_set)
        if self.file is not None and both:
            raise refusal("file excludes the intrinsics", key=both[0], remedy="keep one of them")
        if self.fx is not None and self.hfov_degrees is not None:
            raise refusal("fx and hfov_degrees exclude each other", key="hfov_degrees")
        if self.fy is not None and self.fx is None:
            raise refusal("fy without fx", key="fy", remedy="state fx too")
        lengths = _DISTORTION_LENGTHS[self.projection]
        if len(self.distortion) not in lengths:
            raise refusal(
                f"a {self.projection} camera has {' or '.join(map(str, lengths))} coefficients, "
                f"got {len(self.distortion)}",
                key="distortion",
            )
        if self.projection == "pinhole" and (self.hfov_degrees or 0) >= 180:
            raise refusal(
                f"must be < 180° for pinhole, got {self.hfov_degrees:g}", key="hfov_degrees"
            )
        self._check_pose()
        return self

    def _check_pose(self) -> None:
        if (self.position is None) != (self.look_at is None):
            raise refusal("position and look_at belong together", key="position")
        if self.position is None:
            return
        if self.world_from_camera is not None:
            raise refusal("excludes position and look_at", key="world_from_camera")
        try:
            self.pose()
        except InputError as error:
            raise refusal(error.rule, key="look_at") from None

    def pose(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """(4, 4) ``world_from_camera``; the default pose where none is stated."""
        if self.position is not None:
            return look_at(np.array(self.position), np.array(self.look_at), self.up)
        if self.world_from_camera is not None:
            return np.array(self.world_from_camera, dtype=np.float64)
        return WORLD_FROM_CAMERA_DEFAULT

    @property
    def has_pose(self) -> bool:
        """The table states a pose of its own."""
        return self.position is not None or self.world_from_camera is not None

    def view(self, name: str, *, width: int | None = None, height: int | None = None) -> View:
        """The `View` of these intrinsics; `width`, `height` are the picture's, in pixels.

        Raises `InputError` if the camera lives in a file, if nobody says how large the picture
        is, if the picture's size is not the stated one, or if there is no focal length.
        """
        field = f"rig.{'camera' if name == 'mono' else name}"
        if self.file is not None:
            raise InputError("the intrinsics are in a file", field=f"{field}.file")
        columns, rows = self._size(field, width, height)
        cx = (columns - 1) / 2 if self.cx is None else self.cx
        cy = (rows - 1) / 2 if self.cy is None else self.cy
        fx = self.fx if self.projection != "latlong" else 1.0
        if fx is None and self.hfov_degrees is not None:
            half = np.radians(self.hfov_degrees) / 2
            fx = float(columns / 2 / (np.tan(half) if self.projection == "pinhole" else half))
        if fx is None:
            raise InputError(
                "has no focal length", field=f"{field}.fx", remedy="state fx or hfov_degrees"
            )
        return View(
            self.projection, columns, rows, fx, self.fy or fx, cx, cy,
            distortion=self.distortion, world_from_camera=self.pose(), name=name,
        )  # fmt: skip

    def _size(self, field: str, width: int | None, height: int | None) -> tuple[int, int]:
        for key, stated, came in (("width", self.width, width), ("height", self.height, height)):
            if stated is None and came is None:
                raise InputError("the size is not known", field=f"{field}.{key}", remedy="state it")
            if stated is not None and came is not None and stated != came:
                raise InputError(
                    f"is {stated} px, but the picture has {came} px",
                    field=f"{field}.{key}",
                    remedy="correct it, or leave it out with intrinsics that fit the picture",
                )
        return cast(int, self.width or width), cast(int, self.height or height)


class Trajectory(Table):
    """Poses of the rig over time."""

    file: Reference = Field(description="Trajectory file.")
    format: Literal["tum"] = Field(
        default="tum",
        description="tum: lines of time_seconds tx ty tz qx qy qz qw, world_from_rig.",
    )
    time_offset_seconds: float = Field(
        default=0.0,
        description="Added to the file's times to get session time, seconds.",
    )


class Rig(Table):
    """One camera or two eyes."""

    kind: Literal["mono", "stereo"] = Field(
        default="mono",
        description="One view or two.",
    )
    camera: Camera | None = Field(
        default=None,
        description="The camera of a mono rig.",
    )
    left: Camera | None = Field(
        default=None,
        description="The left eye of a stereo rig.",
    )
    right: Camera | None = Field(
        default=None,
        description="The right eye of a stereo rig.",
    )
    trajectory: Trajectory | None = Field(
        default=None,
        description="Poses over time.",
    )

    @model_validator(mode="after")
    def _check_eyes(self) -> Rig:
        wrong = {"mono": ("left", "right"), "stereo": ("camera",)}[self.kind]
        for key in wrong:
            if getattr(self, key) is not None:
                raise refusal(f"a {self.kind} rig has no {key}", key=key, remedy="change rig.kind")
        if self.kind == "stereo":
            for key in ("left", "right"):
                if getattr(self, key) is None:
                    raise refusal(
                        "a stereo rig needs both eyes", key=key, remedy=f"add [rig.{key}]"
                    )
        return self

    @property
    def cameras(self) -> tuple[tuple[str, Camera], ...]:
        """(name of the view, camera): mono, or left and right; empty where none is stated."""
        named = (("mono", self.camera), ("left", self.left), ("right", self.right))
        return tuple((name, camera) for name, camera in named if camera is not None)


class ResponseTable(Table):
    """How the camera encodes light."""

    kind: Literal["linear", "srgb", "gamma", "curve"] = Field(description="Family of curves.")
    gamma: Positive | None = Field(
        default=None,
        description="γ of kind gamma: encoded = linear^(1/γ).",
    )
    file: Reference | None = Field(
        default=None,
        description="Response file of kind curve.",
    )

    @model_validator(mode="after")
    def _check_response(self) -> ResponseTable:
        for key, kind in (("gamma", "gamma"), ("file", "curve")):
            if (getattr(self, key) is not None) != (self.kind == kind):
                raise refusal(f"kind {kind!r} needs {key}, other kinds do not take it", key=key)
        return self


class StereoSource(Table):
    """Two sources of pictures."""

    left: Reference = Field(description="Source of the left eye's pictures.")
    right: Reference = Field(description="Source of the right eye's pictures.")


class PoseSource(Table):
    """Where the rig's pose comes from while capturing."""

    kind: Literal["fixed", "trajectory", "marker", "board", "openxr"] = Field(
        default="fixed",
        description="fixed: [rig]; marker: one ArUco marker; board: ChArUco or AprilTag.",
    )
    dictionary: str = Field(
        default="DICT_ARUCO_ORIGINAL",
        description="OpenCV's name of the marker family.",
    )
    marker_length_m: Positive | None = Field(
        default=None,
        description="Side of a marker in metres.",
    )
    square_length_m: Positive | None = Field(
        default=None,
        description="Side of a board's square in metres.",
    )
    board_columns: Annotated[int, Field(ge=1, le=1000)] | None = Field(
        default=None,
        description="Squares of the board along a row.",
    )
    board_rows: Annotated[int, Field(ge=1, le=1000)] | None = Field(
        default=None,
        description="Squares of the board along a column.",
    )
    world_from_marker: Pose | None = Field(
        default=None,
        description="4×4 rigid pose of the marker or board; default: the world's origin.",
    )
    hold_seconds: NonNegative = Field(
        default=0.5,
        description="Last pose is held this long after loss.",
    )
    fade_seconds: NonNegative = Field(
        default=0.5,
        description="Then the added light fades, seconds.",
    )


def _response_from_text(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    kind, _, gamma = value.partition(":")
    if not gamma:
        return {"kind": kind}
    try:
        return {"kind": kind, "gamma": float(gamma)}
    except ValueError:
        raise refusal(f"must be like 'gamma:2.2', got {value[:40]!r}") from None


AnyResponse = Annotated[
    ResponseTable,
    BeforeValidator(_response_from_text, json_schema_input_type=str | ResponseTable),
]


def _source_tag(value: Any) -> str:
    return "<pair>" if isinstance(value, Mapping | StereoSource) else "<path>"


AnySource = Annotated[
    Annotated[Reference, Tag("<path>")] | Annotated[StereoSource, Tag("<pair>")],
    Discriminator(_source_tag),
]


class Capture(Table):
    """The pictures and what their numbers mean."""

    source: AnySource | None = Field(
        default=None,
        description="Picture, folder, video or session; `device:0`, `openxr:` or `simulated:`; "
        "or { left = …, right = … }.",
    )
    response: AnyResponse | None = Field(
        default=None,
        description='"linear", "srgb", "gamma:2.2", or { kind, gamma, file }. Default: linear for '
        "EXR and HDR files, srgb for others.",
    )
    luminance_per_unit: Positive | None = Field(
        default=None,
        description="cd/m² of linear value 1. Default: 1 (then E0 sets the scale).",
    )
    clipped_luminance_cd_m2: Positive | None = Field(
        default=None,
        description="cd/m² assumed where the sensor clipped; default: as captured.",
    )
    undistort: bool = Field(
        default=True,
        description="Remove lens distortion; else draw with it.",
    )
    depth: Reference | None = Field(
        default=None,
        description="Depth that comes with each frame.",
    )
    pose: PoseSource = Field(
        default=PoseSource(),
        description="Where the pose comes from.",
    )
    gaze: Reference | None = Field(
        default=None,
        description="Gaze recorded with the frames; see [gaze].",
    )
    noise: Fraction = Field(
        default=0.0,
        description="Of a simulated camera: noise σ relative to white.",
    )
