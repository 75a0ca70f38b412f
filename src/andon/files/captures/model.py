"""What every reader of captures gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View

__all__ = ["Capture", "CaptureFrame", "Photo"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Photo:
    """An encoded picture as the capture holds it: not decoded, so nothing is lost.

    Attributes
    ----------
    data : PNG or JPEG.
    suffix : ``.png`` or ``.jpg``.
    """

    data: bytes
    suffix: str


@dataclass(frozen=True)
class CaptureFrame:
    """One moment of a capture.

    Attributes
    ----------
    name : as the capture names it.
    photo : the picture.
    depth_m : (h, w) planar depth z in metres, NaN in holes; of its own resolution.
    view : of the *picture*, pose in our world.
    has_pose : False where the capture states none: then the camera looks along −Z.
    """

    name: str
    photo: Photo
    depth_m: Float
    view: View
    has_pose: bool


@dataclass(frozen=True)
class Capture:
    """A capture whose frames are read one by one.

    Attributes
    ----------
    format : name of the format.
    path : folder or file.
    names : of all frames, in order.
    read : number of a frame → frame; raises `InputError` for files at fault.
    notes : what was assumed.
    """

    format: str
    path: Path
    names: tuple[str, ...]
    read: Callable[[int], CaptureFrame]
    notes: tuple[str, ...] = ()
