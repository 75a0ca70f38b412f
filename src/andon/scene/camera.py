"""A camera of [rig]: intrinsics, distortion, pose, and the `View` that they make."""

from __future__ import annotations

from typing import Annotated, Any, Literal, cast

import numpy as np
from pydantic import Field, model_validator

from andon.errors import InputError
from andon.scene.base import Pixels, Positive, Reference, Table, Vector, refusal
from andon.scene.geometry import Direction, Pose
from andon.spaces import WORLD_FROM_CAMERA_DEFAULT, View, look_at

__all__ = ["Camera"]

# Numbers of coefficients that OpenCV's two camera models know.
_DISTORTION_LENGTHS = {"pinhole": (0, 4, 5, 8, 12, 14), "fisheye": (0, 4), "latlong": (0,)}


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
