"""Checks on vectors and matrices of scene tables."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import AfterValidator

from andon.errors import InputError
from andon.scene.base import Affine, Vector, refusal
from andon.spaces import View

__all__ = ["Direction", "Pose", "Transform", "UnitQuaternion"]

# Files carry a quaternion with three digits or more; further from unit length is a mistake.
QUATERNION_TOLERANCE = 1e-2


def _check_direction(value: Vector) -> Vector:
    # hypot neither overflows nor underflows where squaring would.
    if not np.hypot(np.hypot(value[0], value[1]), value[2]) > 0:
        raise refusal("must not be the zero vector")
    return value


def _check_pose(value: Affine) -> Affine:
    try:
        View("pinhole", 1, 1, 1.0, 1.0, world_from_camera=np.array(value))
    except InputError as error:
        raise refusal(error.rule) from None
    return value


def _check_transform(value: Affine) -> Affine:
    matrix = np.array(value)
    if tuple(value[3]) != (0, 0, 0, 1) or np.linalg.matrix_rank(matrix[:3, :3]) < 3:
        raise refusal("must be an invertible affine matrix whose last row is 0, 0, 0, 1")
    return value


def _check_quaternion(
    value: tuple[float, float, float, float],
) -> tuple[float, float, float, float]:
    length = float(np.linalg.norm(value))
    if not abs(length - 1) <= QUATERNION_TOLERANCE:
        raise refusal(f"must be a unit quaternion (x, y, z, w), got length {length:.4g}")
    return value


Direction = Annotated[Vector, AfterValidator(_check_direction)]
Pose = Annotated[Affine, AfterValidator(_check_pose)]
Transform = Annotated[Affine, AfterValidator(_check_transform)]
UnitQuaternion = Annotated[tuple[float, float, float, float], AfterValidator(_check_quaternion)]
