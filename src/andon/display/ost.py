"""Optical see-through in float64: what to show so that display + τ·real is what is wanted.

::

    real ──▶ τ ──┬──────────────▶ (+) ──▶ seen
                 └──▶ (−) ─clip 0…peak, 8 bits─▲
    wanted ──────────▲

``display = clip(wanted − τ·real, 0, peak)``. Black adds nothing. Two things are out of reach: what
should be darker than the real light that passes (shadows, dimmed rooms, dark objects before bright
walls), and what should exceed it by more than the peak. Both are counted, nothing is hidden.

Without compensation the display knows nothing of the room: what is virtual is drawn at its full
luminance on black, and the room shines through it. The finished picture does not say what in it is
virtual, so every pixel that differs from the photograph by more than the eye notices counts:

==========================================  ======================================================
rule without a mask                         why it is, or is not
==========================================  ======================================================
**wanted where it was changed, else black**  virtual objects and glass as they are; where lamps
                                            light real surfaces these are shown a second time
max(0, wanted − real) everywhere            right for added light; of objects it leaves what
                                            compensation for τ = 1 leaves: nothing shines through
changed: added light, darkened: wanted      jumps inside an object where it is as bright as the
                                            wall behind it
==========================================  ======================================================

The photograph in the dimmed light of the scene is unchanged too: no such display dims a room.

Source: spec of the display, ``seen = display + τ·real``; the display's response is that of sRGB
(IEC 61966-2-1).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.display.model import Exposure, Seen, SeeThrough
from andon.display.reference import encode
from andon.quantities import CameraFrame, DisplayImage, Luminance, photometric
from andon.responses import srgb_decode, srgb_encode

__all__ = [
    "UNCHANGED",
    "display_codes",
    "reach",
    "real_light",
    "seen_light",
    "seen_through",
    "shown_share",
]

Float = NDArray[np.float64]

# Weber's fraction of the eye at best, about 1 %: smaller differences count as none. Below it lies
# a floor of 1e-4 of the photograph's white, a third of its first 8-bit step.
UNCHANGED = 0.01
FLOOR = 1e-4


def real_light(linear: NDArray[Any], settings: SeeThrough, /) -> Float:
    """(H, W, 3), the light of the room as captured; black where there is no photograph."""
    light = np.asarray(linear, np.float64)
    return light if settings.has_real_light else np.zeros_like(light)


def shown_share(
    wanted: Float, real: Float, settings: SeeThrough, white_cd_m2: float, /, unlit: Float
) -> Float:
    """(H, W, 3) linear display values in [0, 1], before rounding.

    Parameters
    ----------
    wanted, real : (H, W, 3) cd/m²; infinite where half floats ended.
    white_cd_m2 : luminance of the photograph's value 1, for the floor of what counts as changed.
    unlit : (H, W, 3) cd/m², the photograph in the dimmed light of the scene without lamps.
    """
    if settings.compensation:
        light = wanted - settings.transmittance * real
    else:
        is_virtual = _differs(wanted, real, white_cd_m2) & _differs(wanted, unlit, white_cd_m2)
        light = np.where(is_virtual[..., None], wanted, 0.0)
    return np.clip(light / settings.peak_luminance_cd_m2, 0, 1)


def _differs(a: Float, b: Float, white_cd_m2: float) -> NDArray[np.bool_]:
    return np.any(np.abs(a - b) > UNCHANGED * b + FLOOR * white_cd_m2, axis=-1)


def display_codes(share: Float, /) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 for the display from linear values in [0, 1]; its response is sRGB."""
    return np.asarray(np.clip(srgb_encode(share), 0, 1) * 255 + 0.5, np.uint8)


def seen_light(codes: NDArray[np.uint8], real: Float, settings: SeeThrough, /) -> Float:
    """(H, W, 3) cd/m²: the light of the display's codes and the real light that passes."""
    shown = settings.peak_luminance_cd_m2 * srgb_decode(codes / 255)
    return np.asarray(shown + settings.transmittance * real, np.float64)


def reach(
    wanted: Float, real: Float, seen: Float, settings: SeeThrough, white_cd_m2: float, /
) -> dict[str, float]:
    """`dark_share`, `bright_share`, `mean_error_cd_m2` and `mean_wanted_cd_m2` of `Seen`.

    A pixel is out of reach if a channel is, by more than 1 % and 1e-4 of the photograph's white.
    """
    passes = settings.transmittance * real
    most = passes + settings.peak_luminance_cd_m2
    floor = FLOOR * white_cd_m2
    dark = np.any(wanted < passes * (1 - UNCHANGED) - floor, axis=-1)
    bright = np.any(wanted > most * (1 + UNCHANGED) + floor, axis=-1)
    finite = np.minimum(wanted, np.finfo(np.float32).max)
    return {
        "dark_share": float(dark.mean()),
        "bright_share": float(bright.mean()),
        "mean_error_cd_m2": float(np.abs(photometric(seen - finite)).mean()),
        "mean_wanted_cd_m2": float(photometric(finite).mean()),
    }


def seen_through(
    wanted: Luminance, frame: CameraFrame, exposure: Exposure, codes: NDArray[np.uint8], /
) -> Seen:
    """The simulated view of `codes` on a display in front of the room of `frame`.

    `exposure` has a `see_through`; its exposure and tone are those of the picture of the view.
    """
    settings, per_unit = exposure.see_through, frame.luminance_per_unit
    assert settings is not None
    real = per_unit * real_light(frame.linear, settings)
    seen = seen_light(codes, real, settings)
    cd_m2 = np.asarray(wanted.cd_m2, np.float64)
    return Seen(
        Luminance(seen, wanted.photometry),
        DisplayImage(encode(seen, exposure, frame.response, per_unit)),
        **reach(cd_m2, real, seen, settings, per_unit),
    )
