"""A still photograph as a `CameraFrame`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.pictures import Picture
from andon.lenses import undistort
from andon.quantities import CameraFrame
from andon.responses import Response
from andon.spaces import View, another_size

__all__ = ["frame_from_picture", "linear_from_picture"]

# Codes this close to the end of the range count as clipped (sensor noise keeps many of them off
# the very last code).
CLIPPED_CODES = 1


def linear_from_picture(picture: Picture, response: Response, /) -> NDArray[np.float32]:
    """Linear light (H, W, 3) in [0, 1] for encoded pictures, unbounded for HDR ones."""
    values = picture.values
    if picture.encoding == "linear":
        return np.asarray(values, np.float32)
    top = np.iinfo(values.dtype).max
    codes = np.arange(top + 1, dtype=np.float64) / top
    table = response.decode(np.repeat(codes[:, None], 3, axis=1)).astype(np.float32)
    return np.stack([table[values[..., c], c] for c in range(3)], axis=-1)


def frame_from_picture(
    picture: Picture,
    view: View,
    response: Response,
    /,
    *,
    luminance_per_unit: float,
    file: str = "",
    undistorted: bool = True,
    time_seconds: float = 0.0,
) -> CameraFrame:
    """The picture as linear light, undistorted unless told otherwise.

    Raises `InputError` where the picture's size is not the view's, or where an HDR picture has
    pixels that are not finite.
    """
    if picture.shape != view.shape:
        remedy = "give the camera of this picture, or scale one of them"
        raise another_size(picture.shape, view, file=file, field="capture.source", remedy=remedy)
    linear = linear_from_picture(picture, response)
    if not np.isfinite(linear).all():
        bad = int(np.count_nonzero(~np.isfinite(linear).all(axis=-1)))
        raise InputError(f"has {bad} pixels that are NaN or infinite", file=file)
    clipped, code_step = np.zeros(view.shape, bool), 0.0
    if picture.encoding == "srgb":
        top = np.iinfo(picture.values.dtype).max
        code_step = 1 / top
        clipped = np.asarray((picture.values >= top - CLIPPED_CODES).any(axis=-1), bool)
    if undistorted and view.distortion:
        linear = np.nan_to_num(undistort(linear, view))
        codes = np.asarray(clipped, np.uint8)
        clipped = undistort(codes, view, method="nearest") > 0
    view = replace(view, distortion=())
    return CameraFrame(linear, view, response, luminance_per_unit, time_seconds, clipped, code_step)
