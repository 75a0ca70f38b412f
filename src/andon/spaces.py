"""Frames of reference and the view: which pixel looks where.

::

      world (glTF)           camera (OpenCV)         latlong picture
         +Y                      +Z (forward)          ┌──────┬──────┐ +Y
          │                     /                      │      │      │
          │                    o────── +X (right)      │     −Z      │
          o────── +X           │                       │      │      │
         /                     │                       └──────┴──────┘ −Y
       +Z                     +Y (down)               −X ◁─ column ─▷ +X

A camera without a stated pose stands at the origin and looks along −Z with +Y up: the default
``world_from_camera`` is diag(1, −1, −1). Matrices act on column vectors and are named
``target_from_source``. Pixel *centres* are at integer coordinates, as in OpenCV.

Stages receive per-pixel directions and solid angles from a `View`, never intrinsics.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = [
    "WORLD_FROM_CAMERA_DEFAULT",
    "View",
    "another_size",
    "invert_rigid",
    "look_at",
    "perpendicular",
    "pinhole_view",
    "rotate",
    "transform_points",
]

Float = NDArray[np.float64]
Projection = Literal["pinhole", "fisheye", "latlong"]

WORLD_FROM_CAMERA_DEFAULT: Float = np.diag([1.0, -1.0, -1.0, 1.0])
WORLD_FROM_CAMERA_DEFAULT.flags.writeable = False

# A rotation whose rows deviate more than this from orthonormal is refused rather than repaired:
# files carry 6 or more digits, so a larger error is a mistake (a scaled or mirrored matrix).
ROTATION_TOLERANCE = 1e-3


def transform_points(target_from_source: Float, points: NDArray[Any], /) -> Float:
    """Points (..., 3) in the target frame, from points (..., 3) in the source frame."""
    return points @ target_from_source[:3, :3].T + target_from_source[:3, 3]


def rotate(target_from_source: Float, vectors: NDArray[Any], /) -> Float:
    """Directions (..., 3) in the target frame; the translation does not apply."""
    return vectors @ target_from_source[:3, :3].T


def invert_rigid(target_from_source: Float, /) -> Float:
    """``source_from_target`` of a rigid 4×4 transform."""
    inverse = np.eye(4)
    inverse[:3, :3] = target_from_source[:3, :3].T
    inverse[:3, 3] = -inverse[:3, :3] @ target_from_source[:3, 3]
    return inverse


def look_at(
    eye: NDArray[Any], target: NDArray[Any], up: tuple[float, float, float] = (0, 1, 0)
) -> Float:
    """``world_from_camera`` of a camera at `eye` (3,) that looks at `target` (3,), in metres."""
    forward = np.asarray(target, float) - np.asarray(eye, float)
    right = np.cross(forward, up)
    if not np.linalg.norm(forward) > 0 or not np.linalg.norm(right) > 0:
        raise InputError("eye, target and up must span a plane", field="look_at")
    forward, right = forward / np.linalg.norm(forward), right / np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2] = right, np.cross(forward, right), forward
    pose[:3, 3] = eye
    return pose


@dataclass(frozen=True)
class View:
    """Where every pixel of a picture looks.

    Attributes
    ----------
    projection : ``pinhole``, ``fisheye`` (equidistant: image radius = f·θ) or ``latlong``.
    width, height : pixels.
    fx, fy, cx, cy : pixels; ignored for latlong. (cx, cy) = (0, 0) is the centre of the top left
        pixel.
    distortion : OpenCV coefficients of the picture *as captured*: pinhole (k1, k2, p1, p2[, k3
        …]), fisheye (k1, k2, k3, k4); empty once undistorted. Directions are those of the
        undistorted view.
    world_from_camera : (4, 4) float64, rigid.
    name : ``mono``, ``left`` or ``right``.
    """

    projection: Projection
    width: int
    height: int
    fx: float = 0.0
    fy: float = 0.0
    cx: float = 0.0
    cy: float = 0.0
    distortion: tuple[float, ...] = ()
    world_from_camera: Float = field(default_factory=lambda: WORLD_FROM_CAMERA_DEFAULT)
    name: str = "mono"

    def __post_init__(self) -> None:
        for key in ("width", "height"):
            if not 1 <= getattr(self, key) <= 65536:
                raise InputError(
                    f"must be 1…65536 px, got {getattr(self, key)}", field=f"camera.{key}"
                )
        if self.projection == "latlong":
            if self.distortion:
                raise InputError("latlong has no distortion", field="camera.distortion")
        else:
            self._check_intrinsics()
        self._check_pose()

    def _check_intrinsics(self) -> None:
        for key in ("fx", "fy"):
            if not (np.isfinite(getattr(self, key)) and getattr(self, key) > 0):
                raise InputError(f"must be > 0 px, got {getattr(self, key)}", field=f"camera.{key}")
        if not np.isfinite([self.cx, self.cy, *self.distortion]).all():
            raise InputError("cx, cy and distortion must be finite", field="camera")

    def _check_pose(self) -> None:
        pose = self.world_from_camera
        if pose.shape != (4, 4) or not np.isfinite(pose).all():
            raise InputError("must be a finite 4×4 matrix", field="camera.world_from_camera")
        rotation = pose[:3, :3]
        if (
            np.abs(rotation @ rotation.T - np.eye(3)).max() > ROTATION_TOLERANCE
            or np.linalg.det(rotation) < 0
            or not np.array_equal(pose[3], [0, 0, 0, 1])
        ):
            raise InputError(
                "must be rigid: a rotation and a translation, right-handed, no scale",
                field="camera.world_from_camera",
            )

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width), the leading shape of every picture of this view."""
        return self.height, self.width

    @property
    def camera_from_world(self) -> Float:
        """(4, 4) inverse of the pose."""
        return invert_rigid(self.world_from_camera)

    @property
    def position(self) -> Float:
        """(3,) world position of the camera in metres."""
        return self.world_from_camera[:3, 3]

    def undistorted(self) -> View:
        """The same view without distortion coefficients."""
        return replace(self, distortion=())

    def resized(self, width: int, height: int) -> View:
        """The same view sampled by another number of pixels; centres stay centres."""
        sx, sy = width / self.width, height / self.height
        return replace(
            self,
            width=width,
            height=height,
            fx=self.fx * sx,
            fy=self.fy * sy,
            cx=(self.cx + 0.5) * sx - 0.5,
            cy=(self.cy + 0.5) * sy - 0.5,
        )

    def pixel_grid(self) -> Float:
        """(H, W, 2) pixel coordinates (column, row)."""
        rows, columns = np.mgrid[0 : self.height, 0 : self.width].astype(np.float64)
        return np.stack([columns, rows], axis=-1)

    def rays_planar(self) -> Float:
        """(H, W, 3) camera-frame rays per unit of *depth*: multiply by depth to get the point.

        For pinhole the z component is 1 (depth is planar); fisheye and latlong see sideways and
        backwards, so their depth is the distance and the rays are unit vectors.
        """
        if self.projection == "pinhole":
            x, y = np.moveaxis(self.pixel_grid(), -1, 0)
            return np.stack(
                [(x - self.cx) / self.fx, (y - self.cy) / self.fy, np.ones_like(x)], axis=-1
            )
        return self.directions()

    def directions(self) -> Float:
        """(H, W, 3) unit directions in the camera frame, through the pixel centres."""
        return self.directions_at(self.pixel_grid())

    def directions_at(self, pixels: NDArray[Any], /) -> Float:
        """(..., 3) unit directions in the camera frame through pixel coordinates (..., 2).

        Beyond the border as well: latlong goes round, and over the poles down on the other side.
        """
        x, y = np.moveaxis(np.asarray(pixels, np.float64), -1, 0)
        if self.projection == "latlong":
            azimuth = (x + 0.5) / self.width * 2 * np.pi - np.pi
            elevation = np.pi / 2 - (y + 0.5) / self.height * np.pi
            return np.stack(
                [
                    np.cos(elevation) * np.sin(azimuth),
                    -np.sin(elevation),
                    np.cos(elevation) * np.cos(azimuth),
                ],
                axis=-1,
            )
        x, y = (x - self.cx) / self.fx, (y - self.cy) / self.fy
        if self.projection == "fisheye":
            theta = np.hypot(x, y)
            scale = np.sinc(theta / np.pi)  # sin θ / θ
            rays = np.stack([x * scale, y * scale, np.cos(theta)], axis=-1)
        else:
            rays = np.stack([x, y, np.ones_like(x)], axis=-1)
        return rays / np.linalg.norm(rays, axis=-1, keepdims=True)

    def solid_angles(self) -> Float:
        """(H, W) solid angle of each pixel in sr.

        Exact for latlong (rows are zones of the sphere); the value at the centre times the area
        for the others (relative error at most (pixel angle)²/4, at the centre of a pinhole view).
        """
        if self.projection == "latlong":
            edges = np.sin(np.pi / 2 - np.arange(self.height + 1) / self.height * np.pi)
            zone = (edges[:-1] - edges[1:]) * 2 * np.pi / self.width
            return np.broadcast_to(zone[:, None], self.shape).copy()
        if self.projection == "fisheye":
            x, y = np.moveaxis(self.pixel_grid(), -1, 0)
            theta = np.hypot((x - self.cx) / self.fx, (y - self.cy) / self.fy)
            return np.abs(np.sinc(theta / np.pi)) / (self.fx * self.fy)
        return self.directions()[..., 2] ** 3 / (self.fx * self.fy)

    def project(self, points_camera: NDArray[Any], /) -> Float:
        """Pixel coordinates (..., 2) of camera-frame points (..., 3).

        NaN behind a pinhole, and straight behind a fisheye, where every azimuth is as good.
        """
        x, y, z = np.moveaxis(np.asarray(points_camera, np.float64), -1, 0)
        if self.projection == "latlong":
            azimuth = np.arctan2(x, z)
            elevation = np.arctan2(-y, np.hypot(x, z))
            return np.stack(
                [
                    (azimuth + np.pi) / (2 * np.pi) * self.width - 0.5,
                    (np.pi / 2 - elevation) / np.pi * self.height - 0.5,
                ],
                axis=-1,
            )
        if self.projection == "fisheye":
            planar = np.hypot(x, y)
            with np.errstate(invalid="ignore", divide="ignore"):
                on_axis = np.where(z > 0, 1 / z, np.nan)
                scale = np.where(planar > 0, np.arctan2(planar, z) / planar, on_axis)
        else:
            with np.errstate(invalid="ignore", divide="ignore"):
                scale = np.where(z > 0, 1 / z, np.nan)
        return np.stack([x * scale * self.fx + self.cx, y * scale * self.fy + self.cy], axis=-1)

    def rays_world(self) -> tuple[Float, Float]:
        """Origin (3,) and unit directions (H, W, 3) of the pixels' rays in the world."""
        return self.position, rotate(self.world_from_camera, self.directions())


def perpendicular(axis: NDArray[np.float64], /) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors that form a right-handed frame (right, down, axis) with `axis` (3,)."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    right = np.cross(helper, axis)
    right /= np.linalg.norm(right)
    return right, np.cross(axis, right)


def pinhole_view(
    width: int,
    height: int,
    focal_px: float,
    world_from_camera: Float = WORLD_FROM_CAMERA_DEFAULT,
    /,
    *,
    name: str = "mono",
) -> View:
    """A pinhole `View` of `width` × `height` pixels, its principal point in their middle."""
    middle = ((width - 1) / 2, (height - 1) / 2)
    return View("pinhole", width, height, focal_px, focal_px, *middle, (), world_from_camera, name)


def another_size(
    shape: tuple[int, ...],
    view: View,
    /,
    *,
    file: str | Path | None,
    remedy: str,
    field: str | None = None,
) -> InputError:
    """The refusal of a picture (H, W[, C]) that is not of the size of `view`."""
    return InputError(
        f"is {shape[1]}×{shape[0]} px but the camera is {view.width}×{view.height}",
        file=file,
        field=field,
        remedy=remedy,
    )
