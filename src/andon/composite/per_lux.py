"""What one lux more adds to a pixel: by the photograph, and where that is too dark, by ρ.

The photograph knows the reflectance of a surface as ``captured/E0``. Its error has a floor (a code
of rounding and noise), so the *relative* error grows as E0 falls; a picture of ρ has the same
relative error everywhere. Both are weighed by their inverse variances::

    w = 1/(1 + (ε/(r·x))²)        x = 0.18·E0/(π·luminance_per_unit), what a mid-grey would show
                                  ε the first code above black (`noise_floor`); here 8-bit sRGB's
    per_lux = w·captured/E0 + (1 − w)·ρ/(π·luminance_per_unit)

=====================  ======  ======  ======  ======  ======  ======
E0 : that of its white    1     0.1     0.03   0.017    0.01   0.001
w                      0.9997  0.972   0.759   0.50    0.260   0.0035
=====================  ======  ======  ======  ======  ======  ======

The picture of ρ takes its scale from the photograph, channel by channel, where E0 is strong: few
photographs come with their exposure and white balance, and dark and lit parts have to agree.

The weight is a function of E0 alone: that of a captured value would follow its noise, and would
take black paint for a lack of light. Source: Gauss's weights of two measurements of one thing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.composite.curves import light_of
from andon.composite.model import Ambient, MeasuredSurface
from andon.quantities import CameraFrame

__all__ = [
    "MAP_ERROR",
    "MID_GREY",
    "NOISE_FLOOR",
    "map_scale",
    "noise_floor",
    "per_lux",
    "photograph_weight",
    "shown_reflectance",
]

Float = NDArray[np.float64]

# The least ε, of white: one code of 8-bit sRGB at black (IEC 61966-2-1). A sensor of twelve stops
# ends there, too, however finely its codes are read.
NOISE_FLOOR = 1 / (255 * 12.92)
# r: what painted, rendered and estimated reflectances are taken to be right within.
MAP_ERROR = 0.1
# Of photographers' grey cards.
MID_GREY = 0.18

# Where the scale of ρ is found: the photograph counts nearly alone, and neither it nor ρ is black.
STRONG = 0.9
LEAST_REFLECTANCE = 0.02
# Share of the pixels; fewer tell more of one thing than of the exposure.
LEAST_SHARE = 0.01


def noise_floor(frame: CameraFrame, /) -> float:
    """ε, of white: the first code above black as light, half of it rounding, half noise."""
    first = frame.response.decode(np.full(3, frame.code_step))
    return max(NOISE_FLOOR, float(np.max(first)))


def photograph_weight(
    lux: Float, luminance_per_unit: float, /, floor: float = NOISE_FLOOR
) -> Float:
    """w in (0, 1) of a photograph with noise `floor` in `lux` > 0 (...) of E0.

    In 8-bit sRGB it is ½ at 1.7 % of the white's light, where codes are linear at 22 %.
    """
    shown = MID_GREY * lux / (np.pi * luminance_per_unit)
    return 1 / (1 + (floor / (MAP_ERROR * shown)) ** 2)


def per_lux(frame: CameraFrame, ambient: Ambient, measured: MeasuredSurface | None, /) -> Float:
    """What one lux more adds to `light_of` each pixel (H, W, 3) of the real surface.

    With a curve ρ is told in its lux: f⁻¹ of what the camera would show of it in the mean of E0.
    """
    e0, unit = ambient.lux_of(frame.view.name), frame.luminance_per_unit
    captured = np.asarray(frame.linear, np.float64)
    if measured is None:
        return captured / e0
    by_photograph = np.maximum(light_of(captured, measured), 0) / e0
    if measured.reflectance is None:
        return by_photograph
    mean = ambient.mean_lux
    known = np.maximum(light_of(measured.reflectance * mean / (np.pi * unit), measured), 0) / mean
    return _joined(by_photograph, known, e0, frame)


def shown_reflectance(
    frame: CameraFrame, ambient: Ambient, measured: MeasuredSurface | None, /
) -> Float:
    """ρ (H, W, 3) that the photograph shows, and where it is too dark, that is known."""
    e0, unit = ambient.lux_of(frame.view.name), frame.luminance_per_unit
    shown = np.pi * unit * np.asarray(frame.linear, np.float64) / e0
    if measured is None or measured.reflectance is None:
        return shown
    return _joined(shown, measured.reflectance, e0, frame)


def _joined(by_photograph: Float, known: Float, e0: Float, frame: CameraFrame) -> Float:
    w = photograph_weight(e0, frame.luminance_per_unit, noise_floor(frame))
    return w * by_photograph + (1 - w) * known


def map_scale(reflectance: Float, frame: CameraFrame, ambient: Ambient, /) -> Float:
    """(3,) by how much the photograph shows more than ρ (H, W, 3): the median where E0 is strong.

    1 for a channel where too few pixels tell.
    """
    linear, e0 = np.asarray(frame.linear, np.float64), ambient.lux_of(frame.view.name)
    floor = noise_floor(frame)
    w = photograph_weight(e0, frame.luminance_per_unit, floor)
    tells = (w >= STRONG) & (linear >= floor / MAP_ERROR) & (reflectance >= LEAST_REFLECTANCE)
    if frame.clipped is not None:
        tells &= ~frame.clipped[..., None]
    shown = shown_reflectance(frame, ambient, None)
    scale = np.ones(3)
    for c in np.flatnonzero(tells.mean(axis=(0, 1)) >= LEAST_SHARE):
        own = tells[..., c]
        scale[c] = np.median(shown[..., c][own] / reflectance[..., c][own])
    return scale
