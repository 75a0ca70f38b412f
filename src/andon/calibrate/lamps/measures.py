"""How far a predicted photograph is from the one that was taken, and how far trivial guesses are.

==============  ==================================================================
prediction      what it is
==============  ==================================================================
fitted          the picture with the fitted lamps
unchanged       the photograph as it is
gain_one        the photograph times the one number that brings it nearest
gain_channels   the photograph times the three numbers that bring it nearest
==============  ==================================================================

The gains are the best there are: of the pixels that the fit may look at they have the least error
in encoded values, the one that is reported, found by search and not by the fit's robust squares.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.display.ciede2000 import delta_e_2000, lab_of_linear
from andon.responses import Response, srgb_decode

__all__ = ["Measures", "best_gain", "best_gains", "encoded", "measured"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Of pixels from which a gain is searched: its error is then far below the last digit shown.
MOST_SEARCHED = 100_000
# Of the logarithm of a gain: e^±7 is a thousandfold either way; golden section to 1e-5 of it.
WIDEST_LOG, LOG_END = 7.0, 1e-5
GOLDEN = (np.sqrt(5) - 1) / 2
# From where the search starts, so that it ends in the deepest of several valleys.
GRID = 57


@dataclass(frozen=True)
class Measures:
    """Error of a prediction over some pixels.

    Attributes
    ----------
    pixels : of which the others are means.
    rmse_linear : of linear camera values, 1 is the camera's white; clipped there where the
        reference is.
    rmse_encoded : of values as the camera encodes them, clipped, 0…1.
    psnr_db : −20·lg of `rmse_encoded`; ∞ where there is no error.
    delta_e_mean, delta_e_95 : CIEDE2000 of the pictures as an sRGB screen shows them, mean and
        95th percentile.
    gain : (3,) what the photograph was multiplied by; None of the fit.
    """

    pixels: int
    rmse_linear: float
    rmse_encoded: float
    psnr_db: float
    delta_e_mean: float
    delta_e_95: float
    gain: tuple[float, float, float] | None = None


def encoded(linear: Float, response: Response, /) -> Float:
    """Encoded values (…, 3) in 0…1, as the camera clips them."""
    return np.clip(np.asarray(response.encode(np.clip(linear, 0, 1)), np.float64), 0, 1)


def measured(
    predicted: Float,
    reference: Float,
    response: Response,
    /,
    gain: Float | None = None,
    *,
    white: float = 1.0,
) -> Measures:
    """Error of linear values (n, 3) against those of the reference (n, 3), n ≥ 1.

    `white` is the largest value that the reference can have.
    """
    predicted = np.minimum(predicted, white)
    codes, wanted = encoded(predicted, response), encoded(reference, response)
    rmse = float(np.sqrt(np.mean((codes - wanted) ** 2)))
    away = delta_e_2000(_lab(codes), _lab(wanted))
    return Measures(
        len(predicted),
        float(np.sqrt(np.mean((predicted - reference) ** 2))),
        rmse,
        float(-20 * np.log10(rmse)) if rmse > 0 else float("inf"),
        float(away.mean()),
        float(np.percentile(away, 95)),
        None if gain is None else (float(gain[0]), float(gain[1]), float(gain[2])),
    )


def _lab(codes: Float) -> Float:
    return lab_of_linear(np.asarray(srgb_decode(codes), np.float64))


def best_gain(photograph: Float, reference: Float, response: Response, /) -> Float:
    """(3,) equal gains with the least RMSE in encoded values, of linear values (n, 3)."""
    return np.full(3, _searched(*_sparse(photograph, reference), response, [0, 1, 2]))


def best_gains(photograph: Float, reference: Float, response: Response, /) -> Float:
    """(3,) the same, each channel by itself."""
    sparse = _sparse(photograph, reference)
    return np.array([_searched(*sparse, response, [channel]) for channel in range(3)])


def _sparse(photograph: Float, reference: Float) -> tuple[Float, Float]:
    step = max(1, -(-len(photograph) // MOST_SEARCHED))
    return photograph[::step], reference[::step]


def _searched(
    photograph: Float, reference: Float, response: Response, channels: list[int]
) -> float:
    wanted = encoded(reference, response)[:, channels]

    def error(log_gain: float) -> float:
        codes = encoded(np.exp(log_gain) * photograph, response)[:, channels]
        return float(np.mean((codes - wanted) ** 2))

    grid = np.linspace(-WIDEST_LOG, WIDEST_LOG, GRID)
    start = grid[int(np.argmin([error(value) for value in grid]))]
    low, high = start - (grid[1] - grid[0]), start + (grid[1] - grid[0])
    a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_a, at_b = error(a), error(b)
    while high - low > LOG_END:
        if at_a <= at_b:
            high, b, at_b = b, a, at_a
            a = high - GOLDEN * (high - low)
            at_a = error(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + GOLDEN * (high - low)
            at_b = error(b)
    return float(np.exp((low + high) / 2))
