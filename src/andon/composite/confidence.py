"""How far a relit pixel may be trusted: what the photograph's own errors have become in it.

A captured value is known to its noise, and to half a step of its codes. Relighting multiplies both
by (dimming·E0 + ΔE)/E0, and the display bends them. So the spread σ of the captured value is
sent through the relighting and the display themselves, up and down, and half of what comes out is
the spread of the picture::

    captured ± σ ──relit──▶ linear ± σ_linear ──shown──▶ codes ± σ_codes

Two points instead of a slope, because in the dark σ is as large as the value, and there every curve
bends. Source: Julier & Uhlmann 2004 (sigma points), in one dimension.

Not in it: errors of E0, of geometry and of lamps, which nobody states.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from andon.quantities import CameraFrame, photometric

__all__ = ["BAR_CODES", "Cause", "Confidence", "confidence_of"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Codes in 8 bits at which the confidence is ½: the RMS error of a picture with a PSNR of 38 dB,
# which is what a relit picture is held to (`andon verify relight.synthetic`).
BAR_CODES = 255 * 10 ** (-38 / 20)
# A clipped channel that is shown within this of white is right whatever it was.
WHITE_CODES = 1.0


class Cause(IntEnum):
    """Why a pixel is not sure; of several the last."""

    SOUND = 0
    AMPLIFIED = 1  # low E0: steps and noise are brightened to more than `BAR_CODES`
    CLIPPED = 2  # white in the photograph and not in the picture: only a bound is known
    BEYOND = 3  # outside what was measured of its surface's curve
    HOLE = 4  # no geometry: no light is added
    VIRTUAL = 5  # objects, bodies, lamps: nothing of the photograph is in it
    UNCOVERED = 6  # no illuminance map sees it: no baked light is added
    GLASS = 7  # what is behind it comes from elsewhere in the picture


# Causes whose error nobody can tell.
UNKNOWN = (Cause.BEYOND, Cause.HOLE, Cause.UNCOVERED, Cause.GLASS)


@dataclass(frozen=True, eq=False)
class Confidence:
    """What to think of each pixel.

    Attributes
    ----------
    expected_error_codes : (H, W) float32, standard deviation in 8-bit codes, RMS of the channels,
        before rounding; of clipped channels that of a value anywhere up to white. NaN: unknown.
    relative_error : (H, W) float32, standard deviation of the luminance, as a share of it; NaN
        where unknown, clipped or black.
    confidence : (H, W) float32, 1/(1 + (σ/σ0)²) with σ the expected error and σ0 = 3.2 codes; 0
        where the error is unknown.
    cause : (H, W) uint8 of `Cause`.
    """

    expected_error_codes: NDArray[np.float32]
    relative_error: NDArray[np.float32]
    confidence: NDArray[np.float32]
    cause: NDArray[np.uint8]

    def share(self, cause: Cause, /) -> float:
        """Of all pixels."""
        return float((self.cause == cause).mean())


def confidence_of(
    frame: CameraFrame,
    relit: Callable[[Float], Float],
    shown: Callable[[Float], Float],
    causes: Mapping[Cause, Mask],
    sigma: Float,
    /,
) -> Confidence:
    """The confidence in a frame.

    Parameters
    ----------
    frame : what was captured; its `code_step` says how finely.
    relit : captured linear light (H, W, 3) → the same under its new light, linear.
    shown : that → codes in [0, 255], not rounded; never falling.
    causes : masks (H, W) of what is not told by the photograph: from `Cause.BEYOND` on.
    sigma : (H, W, 3) standard deviation of what was captured, as an encoded value.
    """
    captured = np.asarray(frame.linear, np.float64)
    up, down = _around(frame, captured, sigma)
    codes, relative = _spread(captured, up, down, relit, shown)
    white = shown(relit(captured))
    clipped = _clipped_channels(frame, captured) & (white < 255 - WHITE_CODES)
    # Anywhere between what it would be if it were just white, and white: RMS of the distance.
    codes = np.where(clipped, (255 - white) / np.sqrt(3), codes)
    error = np.sqrt((codes**2).mean(axis=-1))
    cause = np.where(error > BAR_CODES, Cause.AMPLIFIED, Cause.SOUND).astype(np.uint8)
    for name, mask in sorted([(Cause.CLIPPED, clipped.any(axis=-1)), *causes.items()]):
        cause[mask] = name
    unknown = np.isin(cause, UNKNOWN)
    error = np.where(unknown, np.nan, np.where(cause == Cause.VIRTUAL, 0.0, error))
    relative[unknown | clipped.any(axis=-1)] = np.nan
    relative[cause == Cause.VIRTUAL] = 0
    trust = np.where(unknown, 0.0, 1 / (1 + (np.nan_to_num(error) / BAR_CODES) ** 2))
    return Confidence(
        error.astype(np.float32), relative.astype(np.float32), trust.astype(np.float32), cause
    )


def _around(frame: CameraFrame, captured: Float, sigma: Float) -> tuple[Float, Float]:
    """Captured light one σ above, and one below but not below none."""
    decode = frame.response.decode
    codes = np.asarray(frame.response.encode(captured), np.float64)
    up, down = decode(codes + sigma), decode(np.maximum(codes - sigma, 0))
    return np.asarray(up, np.float64), np.asarray(down, np.float64)


def _spread(
    captured: Float,
    up: Float,
    down: Float,
    relit: Callable[[Float], Float],
    shown: Callable[[Float], Float],
) -> tuple[Float, Float]:
    """σ in codes (H, W, 3), and of luminance as a share of it (H, W)."""
    middle, high, low = (relit(light) for light in (captured, up, down))
    # What is nearer to black than σ has nothing below: all of its spread is above.
    cut = down <= 0
    codes = np.where(cut, shown(high) - shown(middle), (shown(high) - shown(low)) / 2)
    linear = np.where(cut, high - middle, (high - low) / 2)
    luminance = photometric(middle)
    sigma = np.sqrt(photometric_variance(linear))
    known = luminance > 0
    return codes, np.where(known, sigma / np.where(known, luminance, 1.0), np.nan)


def photometric_variance(sigma: Float, /) -> Float:
    """Variance (...) of the photometric value from σ (..., 3) of channels that err on their own."""
    weights = photometric(np.eye(3))
    return (sigma**2) @ weights**2


def _clipped_channels(frame: CameraFrame, captured: Float) -> Mask:
    """(H, W, 3) channels at the end of the sensor's range."""
    if frame.clipped is None or frame.code_step == 0:
        return np.zeros(captured.shape, bool)
    # As in capture: the last code but one counts, and undistortion mixes it with its neighbours.
    codes = np.asarray(frame.response.encode(captured), np.float64)
    return frame.clipped[..., None] & (codes > 1 - 1.5 * frame.code_step)
