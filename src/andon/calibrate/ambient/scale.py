"""Scale and colour of an estimate, which the photograph alone does not tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.ambient.model import AmbientEstimate
from andon.errors import InputError
from andon.quantities import CameraFrame, Photometry, Surface, photometric

__all__ = ["Placed", "placed"]

Float = NDArray[np.float64]

By = Literal["lux", "reflectance", "nothing"]


@dataclass(frozen=True, eq=False)
class Placed:
    """E0 with a scale.

    Attributes
    ----------
    lux : (H, W, 3) > 0.
    photometry : ``absolute`` in lx; ``relative``: the photometric mean over the surface is 1.
    by : what the scale is from.
    """

    lux: Float
    photometry: Photometry
    by: By


def placed(
    estimate: AmbientEstimate,
    frame: CameraFrame,
    seen: Surface,
    /,
    *,
    mean_lux: float | None = None,
    mean_reflectance: float | None = None,
    colour: Float | None = None,
) -> Placed:
    """The estimate in lux.

    Parameters
    ----------
    mean_lux : photometric mean of E0 over the surface, > 0.
    mean_reflectance : photometric mean of what the surface reflects, in (0, 1]: needs a frame whose
        `luminance_per_unit` is stated.
    colour : (3,) of the mean light, > 0, of any scale; default: neutral.

    One of the first two at most; without, E0 is relative.
    Raises `InputError` for numbers out of range.
    """
    _check(mean_lux, mean_reflectance, colour)
    tinted = estimate.relative * (np.ones(3) if colour is None else colour)
    valid = seen.valid
    mean = float(photometric(tinted[valid]).mean())
    if mean_lux is not None:
        return Placed(tinted * (mean_lux / mean), "absolute", "lux")
    if mean_reflectance is not None:
        luminance = frame.luminance_per_unit * np.asarray(frame.linear, np.float64)[valid]
        shown = np.pi * float(photometric(luminance / tinted[valid]).mean())
        return Placed(tinted * (shown / mean_reflectance), "absolute", "reflectance")
    return Placed(tinted / mean, "relative", "nothing")


def _check(lux: float | None, reflectance: float | None, colour: Float | None) -> None:
    if lux is not None and reflectance is not None:
        raise InputError("give one of lux and reflectance", field="lux")
    if lux is not None and not (np.isfinite(lux) and lux > 0):
        raise InputError(f"must be > 0 lx, got {lux:g}", field="lux")
    if reflectance is not None and not 0 < reflectance <= 1:
        raise InputError(f"must be in (0, 1], got {reflectance:g}", field="reflectance")
    if colour is not None and not (np.isfinite(colour).all() and (colour > 0).all()):
        raise InputError(f"must be > 0 in each channel, got {colour.tolist()}", field="colour")
