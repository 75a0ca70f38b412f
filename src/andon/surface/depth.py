"""Depth images: from a file's numbers to metres, holes as NaN."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.spaces import View, another_size
from andon.surface.resample import SAME_PICTURE

__all__ = ["DepthEncoding", "depth_from_raw"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class DepthEncoding:
    """What the numbers of a depth file mean.

    Attributes
    ----------
    kind : ``z`` (planar depth), ``distance`` (ray length) or ``disparity`` (pixels).
    scale_to_m : metres per unit (0.001 for millimetres); for disparity: pixels per unit.
    baseline_m, doffs_px : stereo baseline and principal-point offset, for disparity:
        z = baseline·fx/(disparity + doffs).
    invalid : numbers that mean "no measurement", besides NaN, ±inf and what is not positive in
        metres (disparity: in pixels).
    shift_m : added after scaling, of z and distance: relative depth is metric but for both.
    """

    kind: Literal["z", "distance", "disparity"] = "z"
    scale_to_m: float = 1.0
    baseline_m: float | None = None
    doffs_px: float = 0.0
    invalid: tuple[float, ...] = ()
    shift_m: float = 0.0


def depth_from_raw(raw: Float, view: View, encoding: DepthEncoding, /, *, file: str = "") -> Float:
    """Depth (H, W) in metres, NaN in holes: planar for pinhole, distance for other projections.

    Raises `InputError` where the size does not fit the view, the encoding lacks what its kind
    needs, or no pixel has a depth.
    """
    if raw.shape != view.shape:
        raise another_size(raw.shape, view, file=file, field="surface.depth", remedy=SAME_PICTURE)
    raw = np.where(np.isin(raw, encoding.invalid) | ~np.isfinite(raw), np.nan, raw)
    depth = _metres(raw, view, encoding, file)
    with np.errstate(invalid="ignore"):
        depth = np.where(depth > 0, depth, np.nan)
    if not np.isfinite(depth).any():
        raise InputError(
            "has no pixel with a depth above 0",
            file=file,
            field="surface.depth",
            remedy="check kind, scale_to_m and invalid",
        )
    return depth


def _metres(raw: Float, view: View, encoding: DepthEncoding, file: str) -> Float:
    if encoding.kind == "disparity":
        if encoding.baseline_m is None or view.projection != "pinhole":
            raise InputError(
                "disparity needs baseline_m and a pinhole camera",
                file=file,
                field="surface.depth.baseline_m",
            )
        with np.errstate(divide="ignore", invalid="ignore"):
            shifted = raw * encoding.scale_to_m + encoding.doffs_px
            return np.where(shifted > 0, encoding.baseline_m * view.fx / shifted, np.nan)
    depth = raw * encoding.scale_to_m + encoding.shift_m
    with np.errstate(invalid="ignore"):
        depth = np.where(depth > 0, depth, np.nan)
    if encoding.kind == "distance" and view.projection == "pinhole":
        return depth * view.directions()[..., 2]
    if encoding.kind == "z" and view.projection != "pinhole":
        cosine = view.directions()[..., 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(cosine > 0, depth / cosine, np.nan)
    return depth
