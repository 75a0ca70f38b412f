"""The reference photograph and the mask, brought to where the photograph's pixels are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.motion import (
    NOT_ASKED,
    Aligning,
    Motion,
    camera_motion,
)
from andon.capture.align import moved_picture
from andon.capture.still import CLIPPED_CODES, linear_from_picture
from andon.errors import InputError
from andon.files.pictures import Picture, read_picture
from andon.lenses import undistort
from andon.quantities import CameraFrame, photometric
from andon.responses import Response
from andon.spaces import View

__all__ = ["Target", "mask_of", "target_of"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Of the longer side: a camera that moved more saw other parts of near things, and no one motion
# brings them back.
MOST_MOTION = 0.02


@dataclass(frozen=True, eq=False)
class Target:
    """The reference as the photograph's camera would have seen it.

    Attributes
    ----------
    linear : (H, W, 3) linear camera values.
    white : (H, W, 3) bool, values at the white end, of which only the least is known.
    seen : (H, W) bool, pixels that the reference shows.
    motion : how the camera had moved.
    is_encoded : it came as codes, not as light.
    """

    linear: Float
    white: Mask
    seen: Mask
    motion: Motion
    is_encoded: bool

    def decoded(self, old: Response, new: Response, /) -> Target:
        """The same codes, meant by another response."""
        return replace(self, linear=new.decode(np.clip(old.encode(self.linear), 0, 1)))


def _picture_of(source: Any, field: str, /) -> tuple[Picture, str]:
    """A picture from a path, or an array (H, W, 3) as of `andon.relight`; and its name."""
    if isinstance(source, str | Path):
        return read_picture(source), str(source)
    if isinstance(source, Picture):
        return source, field
    values = np.asarray(source)
    is_codes = values.dtype in (np.dtype(np.uint8), np.dtype(np.uint16))
    if values.ndim != 3 or values.shape[2] != 3 or not (is_codes or values.dtype.kind == "f"):
        raise InputError(
            f"must be a path or (H, W, 3) uint8, uint16 or float, got {values.shape} "
            f"{values.dtype}",
            field=field,
        )
    return Picture(values, "srgb" if is_codes else "linear"), field


def target_of(source: Any, frame: CameraFrame, view: View, align: Aligning, /) -> Target:
    """The reference of a photograph.

    Parameters
    ----------
    source : path or array.
    frame : the photograph.
    view : of the photograph's camera, with its distortion.

    Raises
    ------
    InputError
        for another size, pixels that are no numbers, and a camera that moved too far.
    """
    picture, name = _picture_of(source, "reference")
    _check_size(picture.shape, view, name)
    linear = np.asarray(linear_from_picture(picture, frame.response), np.float64)
    if not np.isfinite(linear).all():
        bad = int(np.count_nonzero(~np.isfinite(linear).all(axis=-1)))
        raise InputError(f"has {bad} pixels that are NaN or infinite", file=name)
    white = np.zeros(linear.shape, bool)
    if picture.encoding == "srgb":
        white = picture.values >= np.iinfo(picture.values.dtype).max - CLIPPED_CODES
    seen = np.ones(view.shape, bool)
    if view.distortion:
        linear = np.asarray(undistort(linear, view), np.float64)
        seen = np.asarray(np.isfinite(linear).all(axis=-1), bool)
        linear = np.nan_to_num(linear)
        white = undistort(white.astype(np.uint8), view, method="nearest") > 0
    motion = NOT_ASKED
    if align == "auto":
        motion = camera_motion(_grey(frame.linear, frame), _grey(linear, frame), seen)
        _check_motion(motion, view, name)
    if not motion.is_still:
        linear, white, seen = _moved(linear, white, seen, motion)
    return Target(linear, white, seen, motion, picture.encoding == "srgb")


def _grey(linear: NDArray[Any], frame: CameraFrame) -> Float:
    codes = np.clip(frame.response.encode(np.clip(linear, 0, 1).astype(np.float64)), 0, 1)
    return photometric(codes)


def _moved(linear: Float, white: Mask, seen: Mask, motion: Motion) -> tuple[Float, Mask, Mask]:
    moved, covered = moved_picture(linear.astype(np.float32), seen, motion.matrix)
    # A pixel that takes any part of its light from a clipped one is clipped.
    open_ = [
        moved_picture(seen.astype(np.float32), ~white[..., c], motion.matrix) for c in range(3)
    ]
    whites = np.stack([~free for _, free in open_], axis=-1)
    return np.asarray(moved, np.float64), whites & covered[..., None], covered


def mask_of(source: Any, view: View, /) -> Mask:
    """(H, W) bool: pixels of a mask that are brighter than half, undistorted.

    Raises `InputError` for another size, and a mask that selects nothing.
    """
    name = str(source) if isinstance(source, str | Path) else "mask"
    if isinstance(source, str | Path):
        picture = read_picture(source)
        inside = picture.is_painted
    else:
        inside = np.asarray(source)
        if inside.dtype != bool or inside.ndim != 2:
            raise InputError(
                f"must be a path or (H, W) bool, got {inside.shape} {inside.dtype}", field="mask"
            )
    _check_size(inside.shape, view, name)
    if view.distortion:
        inside = undistort(inside.astype(np.uint8), view, method="nearest") > 0
    if not inside.any():
        raise InputError(
            "selects nothing: no pixel is brighter than half",
            file=name,
            remedy="paint white where the fit may look",
        )
    return np.asarray(inside, bool)


def _check_size(shape: tuple[int, ...], view: View, name: str) -> None:
    if tuple(shape) != view.shape:
        raise InputError(
            f"is {shape[1]}×{shape[0]} px but the photograph is {view.width}×{view.height}",
            file=name,
            remedy="give one of the photograph's size, taken with the same camera from one place",
        )


def _check_motion(motion: Motion, view: View, name: str) -> None:
    most = MOST_MOTION * max(view.shape)
    if motion.corner_px > most:
        raise InputError(
            f"its camera moved by {motion.corner_px:.1f} px against the photograph's, "
            f"{most:.1f} px can be brought back",
            file=name,
            remedy="take both from a tripod; --fit-align none believes that they are",
        )
