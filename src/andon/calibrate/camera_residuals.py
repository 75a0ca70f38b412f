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
# One other code at least between which noise of a code is no large share of the light.
SAYING_CODES = (16, 240)


@dataclass(frozen=True)
class Residuals:
    """Photograph minus its prediction, at pixels where it is not clipped.

    Attributes
    ----------
    codes : (pixels, n, 3), photographed; of all pixels that were drawn.
    predicted : (pixels, n, 3) codes; NaN where nothing predicts, or the photograph is clipped.
    log_exposure : (pixels, n, 3) ln of light × time as all *others* say.
    median_codes : of the absolute residual over all photographs.
    rms_codes, rms_ev : root mean square over all photographs; stops where `TELLING_CODES` are
        predicted, since a code of a black shadow is a stop by itself.
    photograph_codes, photograph_ev : (n,) the same of each photograph.
    exposure_ev : (n,) median by which a photograph is brighter than predicted, in stops; NaN
        where fewer than `LEAST_TELLING` pixels tell.
    """

    codes: NDArray[np.int64]
    predicted: Float
    log_exposure: Float
    median_codes: float
    rms_codes: float
    rms_ev: float
    photograph_codes: Float
    photograph_ev: Float
    exposure_ev: Float


def residuals_of(bracket: Bracket, curves: Float, /, *, pixels: int = PIXELS) -> Residuals:
    """Residuals of a bracket under g = `curves` (256, 3), ln exposure, rising."""
    codes = _drawn(bracket, pixels)
    logs = np.log(seconds_of(bracket))
    channels = [_channel(codes[..., c], curves[:, c], logs) for c in range(3)]
    expected, light = (np.stack(part, axis=-1) for part in zip(*channels, strict=True))
    predicted: Float = np.where((codes > 0) & (codes < CODES - 1), expected, np.nan)
    left: Float = np.asarray(codes, np.float64) - predicted
    measured = np.stack([curves[codes[..., c], c] for c in range(3)], axis=-1)
    tells = (expected >= TELLING_CODES[0]) & (expected <= TELLING_CODES[1])
    stops = np.where(tells, (measured - light) / np.log(2), np.nan)
    return Residuals(
        codes,
        predicted,
        light,
        float(np.nanmedian(np.abs(left))),
        _rms(left),
        _rms(np.where(np.isfinite(predicted), stops, np.nan)),
        np.array([_rms(left[:, k]) for k in range(len(logs))]),
        np.array([_rms(stops[:, k]) for k in range(len(logs))]),
        _exposures(stops),
    )


def _rms(values: Float) -> float:
    """NaN where none is known."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")


def _drawn(bracket: Bracket, pixels: int) -> NDArray[np.int64]:
    """(pixels, n, 3) codes of random pixels that all photographs saw."""
    seen = np.flatnonzero(np.logical_and.reduce(list(bracket.seen)))
    generator = np.random.default_rng(SEED)
    if len(seen) > pixels:
        seen = generator.choice(seen, pixels, replace=False)
    return np.stack([codes.reshape(-1, 3)[seen] for codes in bracket.codes], axis=1).astype(int)


def _channel(codes: NDArray[np.int64], curve: Float, logs: Float) -> tuple[Float, Float]:
    """Of one channel (pixels, n): the predicted code, and ln light × time, by all others."""
    weights = certainty_of(curve)[codes]
    light = weights * (curve[codes] - logs)
    others = weights.sum(axis=1, keepdims=True) - weights
    says = (codes >= SAYING_CODES[0]) & (codes <= SAYING_CODES[1])
    known = says.sum(axis=1, keepdims=True) - says > 0
    exposure = (light.sum(axis=1, keepdims=True) - light) / np.where(known, others, np.nan) + logs
    # Equal values of a curve that was made to rise: interpolation wants them apart.
    rising = curve + 1e-9 * np.arange(CODES)
    predicted = np.asarray(np.interp(exposure, rising, np.arange(CODES, dtype=float)), np.float64)
    return np.where(known, predicted, np.nan), exposure


def _exposures(stops: Float) -> Float:
    """(n,) EV, the median of the three channels; chosen by the prediction, never by the code."""
    count, channels = stops.shape[1:]
    found = np.full((count, channels), np.nan)
    for k, c in np.ndindex(count, channels):
        telling = stops[:, k, c][np.isfinite(stops[:, k, c])]
        if len(telling) >= LEAST_TELLING:
            found[k, c] = np.median(telling)
    return np.array(
        [np.median(row[np.isfinite(row)]) if np.isfinite(row).any() else np.nan for row in found]
    )
