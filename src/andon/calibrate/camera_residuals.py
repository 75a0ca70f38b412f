"""Each photograph of a bracket predicted from the light that all others give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.capture.brackets import Bracket
from andon.capture.recovery import CODES, certainty_of, seconds_of

__all__ = ["Residuals", "residuals_of"]

Float = NDArray[np.float64]

# Pixels looked at, drawn at random: light that few pixels have, a window's, must be among them.
PIXELS, SEED = 100_000, 0
# Of the predicted code, between which a photograph tells its exposure: neither fog nor shoulder.
TELLING_CODES = (32, 224)
LEAST_TELLING = 50


@dataclass(frozen=True)
class Residuals:
    """Photograph minus its prediction, at pixels where it is not clipped.

    Attributes
    ----------
    codes : (pixels, n, 3), photographed; of all pixels that were drawn.
    predicted : (pixels, n, 3) codes; NaN where nothing predicts, or the photograph is clipped.
    log_exposure : (pixels, n, 3) ln of light × time as all *others* say.
    rms_codes, rms_ev : root mean square over all photographs; stops are weighted by how certain
        both sides are, since a code of a black shadow is a stop by itself.
    photograph_codes, photograph_ev : (n,) the same of each photograph.
    exposure_ev : (n,) median by which a photograph is brighter than predicted, in stops; NaN
        where fewer than `LEAST_TELLING` pixels tell.
    """

    codes: NDArray[np.int64]
    predicted: Float
    log_exposure: Float
    rms_codes: float
    rms_ev: float
    photograph_codes: Float
    photograph_ev: Float
    exposure_ev: Float


def residuals_of(bracket: Bracket, curves: Float, /) -> Residuals:
    """Residuals of a bracket under g = `curves` (256, 3), ln exposure, rising."""
    codes = _drawn(bracket)
    logs = np.log(seconds_of(bracket))
    channels = [_channel(codes[..., c], curves[:, c], logs) for c in range(3)]
    expected, weight, light = (np.stack(part, axis=-1) for part in zip(*channels, strict=True))
    inside = (codes > 0) & (codes < CODES - 1)
    predicted = np.where(inside, expected, np.nan)
    measured = np.stack([curves[codes[..., c], c] for c in range(3)], axis=-1)
    stops = (measured - light) / np.log(2)
    squares_codes, squares_ev = (predicted - codes) ** 2, weight * stops**2
    return Residuals(
        codes,
        predicted,
        light,
        float(np.sqrt(np.nanmean(squares_codes))),
        float(np.sqrt(np.nansum(squares_ev) / weight.sum())),
        np.sqrt([_mean(squares_codes[:, k]) for k in range(len(logs))]),
        np.sqrt(np.nansum(squares_ev, axis=(0, 2)) / np.maximum(weight.sum(axis=(0, 2)), 1e-30)),
        _exposures(expected, stops),
    )


def _mean(values: Float) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else float("nan")


def _drawn(bracket: Bracket) -> NDArray[np.int64]:
    """(pixels, n, 3) codes of random pixels that all photographs saw."""
    seen = np.flatnonzero(np.logical_and.reduce(list(bracket.seen)))
    generator = np.random.default_rng(SEED)
    if len(seen) > PIXELS:
        seen = generator.choice(seen, PIXELS, replace=False)
    return np.stack([codes.reshape(-1, 3)[seen] for codes in bracket.codes], axis=1).astype(int)


def _channel(codes: NDArray[np.int64], curve: Float, logs: Float) -> tuple[Float, Float, Float]:
    """Of one channel (pixels, n): predicted code, weight of both sides, ln light × time."""
    weights = certainty_of(curve)[codes]
    light = weights * (curve[codes] - logs)
    others = weights.sum(axis=1, keepdims=True) - weights
    known = others > 1e-9 * weights.max()
    exposure = (light.sum(axis=1, keepdims=True) - light) / np.where(known, others, np.nan) + logs
    # Equal values of a curve that was made to rise: interpolation wants them apart.
    rising = curve + 1e-9 * np.arange(CODES)
    predicted = np.interp(exposure, rising, np.arange(CODES, dtype=float))
    predicted = np.where(known, predicted, np.nan)
    return predicted, np.where(known, np.minimum(weights, others), 0.0), exposure


def _exposures(predicted: Float, stops: Float) -> Float:
    """(n,) EV, the median of the three channels; chosen by the prediction, never by the code."""
    low, high = TELLING_CODES
    tells = (predicted >= low) & (predicted <= high)
    found = np.full(predicted.shape[1:], np.nan)
    for k, c in np.ndindex(*found.shape):
        if tells[:, k, c].sum() >= LEAST_TELLING:
            found[k, c] = np.median(stops[tells[:, k, c], k, c])
    some = np.isfinite(found).any(axis=1)
    return np.array(
        [np.nanmedian(row) if is_known else np.nan for row, is_known in zip(found, some, strict=True)]
    )
