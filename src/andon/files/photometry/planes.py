"""Angles of a distribution: checked, and unfolded to what symmetry leaves out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["checked_angles", "checked_candela", "full_circle", "mirrored"]

Float = NDArray[np.float64]

# Files carry angles with one or two digits after the point.
ANGLE_TOLERANCE_DEGREES = 1e-3
# Planes that stop one step before 360° leave a gap of a step; a wider one is missing data.
WIDEST_GAP_IN_STEPS = 1.5


def checked_angles(
    values: list[float], low: float, high: float, what: str, file: str | Path
) -> Float:
    """(n,) strictly rising angles in low…high degrees."""
    angles = np.array(values, np.float64)
    outside = (angles < low - ANGLE_TOLERANCE_DEGREES) | (angles > high + ANGLE_TOLERANCE_DEGREES)
    if outside.any():
        raise InputError(
            f"must be {low:g}…{high:g}°, got {angles[outside][0]:g}", file=file, field=what
        )
    falls = np.flatnonzero(np.diff(angles) <= 0)
    if len(falls):
        before, after = angles[falls[0] : falls[0] + 2]
        raise InputError(f"must rise, got {before:g} before {after:g}", file=file, field=what)
    return np.clip(angles, low, high)


def checked_candela(values: list[float], scale: float, shape: tuple[int, int], file: str) -> Float:
    """(c, g) candela: `values` times `scale`, finite and not all dark."""
    with np.errstate(over="ignore"):
        candela = np.array(values, np.float64).reshape(shape) * scale
    if not np.isfinite(candela).all():
        raise InputError("are too large to compute with", file=file, field="candela")
    if not candela.max() > 0:
        raise InputError("must have a value > 0: this lamp is dark", file=file, field="candela")
    return candela


def is_angle(angle: float, wanted: float) -> bool:
    """`angle` is `wanted` up to the digits that files carry."""
    return abs(angle - wanted) <= ANGLE_TOLERANCE_DEGREES


def mirrored(angles: Float, candela: Float, about: float) -> tuple[Float, Float]:
    """Both sides of a plane of symmetry at `about`, which is the first or the last angle."""
    if is_angle(float(angles[0]), about):
        other, rows = (2 * about - angles[:0:-1]), candela[:0:-1]
        return np.concatenate([other, angles]), np.concatenate([rows, candela])
    other, rows = (2 * about - angles[-2::-1]), candela[-2::-1]
    return np.concatenate([angles, other]), np.concatenate([candela, rows])


def full_circle(angles: Float, candela: Float, file: str | Path) -> tuple[Float, Float]:
    """C planes from 0° to 360°, both included, of what LM-63 allows.

    ========== ============================================
    planes     the rest
    ========== ============================================
    0          the same in all planes
    0…90       mirrored twice
    0…180      mirrored in the plane 0–180
    90…270     mirrored in the plane 90–270 (since 1995)
    0…360      nothing is left out
    ========== ============================================
    """
    first, last = float(angles[0]), float(angles[-1])
    if len(angles) == 1:
        return np.array([0.0, 360.0]), np.repeat(candela, 2, axis=0)
    if is_angle(first, 90) and is_angle(last, 270):
        return _from_back_half(angles, candela)
    if not is_angle(first, 0):
        raise _refusal(first, last, file)
    if is_angle(last, 90):
        angles, candela = mirrored(angles, candela, 90.0)
        return mirrored(angles, candela, 180.0)
    if is_angle(last, 180):
        return mirrored(angles, candela, 180.0)
    if is_angle(last, 360):
        return angles, candela
    step = float(np.diff(angles).max())
    if last < 180 or 360 - last > WIDEST_GAP_IN_STEPS * step:
        raise _refusal(first, last, file)
    return np.append(angles, 360.0), np.concatenate([candela, candela[:1]])


def _from_back_half(angles: Float, candela: Float) -> tuple[Float, Float]:
    """Planes 90…270: the front half (270…450) mirrors them about 270."""
    whole, rows = mirrored(angles, candela, 270.0)  # 90…450
    if not np.isclose(whole, 360.0, atol=1e-9).any():
        # The plane 0 = 360 lies between two measured ones: by interpolation, as everywhere.
        after = int(np.searchsorted(whole, 360.0))
        share = (360.0 - whole[after - 1]) / (whole[after] - whole[after - 1])
        row = (1 - share) * rows[after - 1] + share * rows[after]
        whole, rows = np.insert(whole, after, 360.0), np.insert(rows, after, row, axis=0)
    turn = int(np.argmin(np.abs(whole - 360.0)))
    front, back = slice(turn, len(whole)), slice(1, turn + 1)
    return (
        np.concatenate([whole[front] - 360.0, whole[back]]),
        np.concatenate([rows[front], rows[back]]),
    )


def _refusal(first: float, last: float, file: str | Path) -> InputError:
    return InputError(
        f"must run 0, 0…90, 0…180, 90…270 or 0…360° for type C, run {first:g}…{last:g}",
        file=file,
        field="horizontal angles",
    )
