"""From a bracket to light: the camera's response, and the radiance of each pixel.

============================  ====================================================================
choice                        why not the other
============================  ====================================================================
**own least squares**         OpenCV's takes pixels of a regular grid, whatever they show: borders,
                              clipped ones and what moved are in its equations
**response recovered**        sRGB assumed errs by up to a factor of 2 in the shadows of cameras
                              that make their pictures pleasing
**per channel**               a common curve colours film, whose layers differ
============================  ====================================================================

The unit: code 128 of the reference photograph (the middle one) is the linear value that sRGB gives
it, 0.216, in each channel. So grey stays grey, and the picture is what `capture` makes of the
reference, only without its clipping. It is relative: nothing in a bracket says how bright 1 is.

Sources: Debevec & Malik 1997, equations 3 to 6; Mann & Picard 1995 for the weight of certainty.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.capture.brackets import Bracket
from andon.responses import Response, srgb_decode

__all__ = ["Merged", "merge", "recover_response"]

Float = NDArray[np.float64]

CODES = 256
MIDDLE = 128  # Debevec & Malik's anchor: g(128) = 0
# λ of the curve's smoothness, against hat weights of up to 127.
SMOOTHNESS = 50.0
# Equations from photographs; Debevec & Malik ask for more than there are codes.
EQUATIONS = 4000
# Pixels whose worst residual exceeds the median's so many times are things that move, or dirt;
# those of fewer codes than the least are noise.
OUTLIER, LEAST_OUTLIER_CODES = 3.0, 6.0
ROUNDS = 3
HAT = np.minimum(np.arange(CODES), CODES - 1 - np.arange(CODES)).astype(np.float64)


@dataclass(frozen=True)
class Merged:
    """The light of a bracket.

    Attributes
    ----------
    linear : (H, W, 3) float32, relative; see the module for the unit. 0 where nothing was seen.
    response : the camera's, recovered, per channel.
    clipped_share, black_share : share of pixels with a channel that is white (or black) in every
        photograph: only a lower (or upper) bound of it is known, and stands there.
    unseen_share : share of pixels that are border in every photograph.
    range_ratio : 99.9th to 0.1st percentile of luminance over all pixels seen.
    """

    linear: NDArray[np.float32]
    response: Response
    clipped_share: float
    black_share: float
    unseen_share: float
    range_ratio: float


def recover_response(bracket: Bracket, /) -> Float:
    """(256, 3), g = ln of the exposure (light × time) that makes each code; g(128) = 0, rising.

    Least squares of g(Z) = ln E + ln t with hat weights and a smooth g, per channel, repeated
    without the pixels that do not fit. Source: Debevec & Malik 1997, equation 3.
    """
    samples = _samples(bracket)
    logs = np.log(_seconds(bracket))
    return np.stack([_curve(samples[..., c], logs) for c in range(3)], axis=-1)


def merge(bracket: Bracket, /) -> Merged:
    """The light of each pixel: the mean over its photographs, weighted by how certain they are.

    The weight of a code is the hat of Debevec & Malik 1997 (equation 4) times dZ/d ln E (Mann &
    Picard 1995), which is small where film or sensor no longer answers to light: the fog of a dark
    scan. `check_exposures` must have passed.
    """
    curves = recover_response(bracket)
    seconds = _seconds(bracket)
    planes = [_merged_channel(bracket, curves[:, c], seconds, c) for c in range(3)]
    light = np.stack([plane[0] for plane in planes], axis=-1)
    seen = np.logical_or.reduce(list(bracket.seen))
    scale = seconds[bracket.middle] * float(srgb_decode(np.array(MIDDLE / 255)))
    linear = np.where(seen[..., None], light * scale, 0.0)
    luminance = (linear @ [0.2126, 0.7152, 0.0722])[seen]
    low, high = np.percentile(luminance, [0.1, 99.9])
    states = [np.logical_or.reduce([plane[k] for plane in planes]) & seen for k in (1, 2)]
    return Merged(
        linear.astype(np.float32),
        _response(curves),
        float(states[0].mean()),
        float(states[1].mean()),
        float(1 - seen.mean()),
        float(high / max(low, 1e-30)),
    )


def _seconds(bracket: Bracket) -> Float:
    assert bracket.seconds is not None  # by check_exposures
    return bracket.seconds


def _samples(bracket: Bracket) -> NDArray[np.int64]:
    """(n, photographs, 3) codes of pixels that all saw, of all brightnesses, off edges."""
    import cv2

    seen = np.logical_and.reduce(list(bracket.seen))
    if not seen.any():
        seen = np.logical_or.reduce(list(bracket.seen))
    codes = bracket.codes[bracket.middle].astype(np.float32).mean(axis=-1)
    # Where there is an edge a fraction of a pixel of misalignment changes the code.
    smooth = np.abs(codes - np.asarray(cv2.blur(codes, (5, 5)), np.float32))
    rows, columns = np.nonzero(seen & (smooth <= np.median(smooth[seen])))
    total = np.sum(
        [picture[rows, columns].sum(axis=-1, dtype=np.int64) for picture in bracket.codes], axis=0
    )
    count = min(len(rows), max(EQUATIONS // len(bracket.codes), CODES))
    spread = np.argsort(total, kind="stable")[np.linspace(0, len(rows) - 1, count).astype(int)]
    at = rows[spread], columns[spread]
    return np.stack([picture[at] for picture in bracket.codes], axis=1).astype(np.int64)


def _curve(codes: NDArray[np.int64], log_seconds: Float) -> Float:
    """g of one channel from (n, photographs) codes."""
    weights = HAT[codes]
    curve, light = _solved(codes, log_seconds, weights)
    for _ in range(ROUNDS):
        # In codes, in which noise is the same everywhere: logarithms of dark ones spread.
        slope = np.maximum(np.gradient(curve), 1e-4)[codes]
        residual = np.abs(curve[codes] - light[:, None] - log_seconds) / slope
        worst = np.where(weights > 0, residual, 0.0).max(axis=1)
        fits = worst <= max(OUTLIER * 1.4826 * float(np.median(worst)), LEAST_OUTLIER_CODES)
        curve, light = _solved(codes, log_seconds, weights * fits[:, None])
    # Codes that no photograph has are bent by their neighbours alone: a curve that falls is none.
    rising = np.maximum.accumulate(curve[MIDDLE:])
    falling = np.minimum.accumulate(curve[: MIDDLE + 1][::-1])[::-1]
    return np.concatenate([falling[:-1], rising])


def _solved(codes: NDArray[np.int64], log_seconds: Float, weights: Float) -> tuple[Float, Float]:
    """Least squares for g (256,) and ln E (n,), by the normal equations.

    Each photograph of each pixel: w·(g(Z) − ln E) = w·ln t; each inner code: λ·w·g″ = 0.
    ln E of a pixel stands in its own equations only and is eliminated first.
    """
    flat, weight = codes.ravel(), weights.ravel() ** 2
    pixel = np.repeat(np.arange(len(codes)), codes.shape[1])
    times = np.tile(log_seconds, len(codes))
    total = np.bincount(pixel, weight, len(codes)) + 1e-9
    matrix = np.diag(np.bincount(flat, weight, CODES))
    right = np.bincount(flat, weight * times, CODES)
    link = np.zeros((len(codes), CODES))
    np.add.at(link, (pixel, flat), weight)
    known = np.bincount(pixel, weight * times, len(codes))
    matrix = matrix - link.T @ (link / total[:, None])
    right = right - link.T @ (known / total)
    bend = np.zeros((CODES - 2, CODES))
    inner = np.arange(1, CODES - 1)
    for offset, factor in ((-1, 1.0), (0, -2.0), (1, 1.0)):
        bend[inner - 1, inner + offset] = factor * SMOOTHNESS * np.maximum(HAT[inner], 1)
    matrix += bend.T @ bend
    matrix[MIDDLE, MIDDLE] += weight.sum() + 1.0  # g(128) = 0
    curve = np.linalg.solve(matrix, right)
    curve = curve - curve[MIDDLE]
    return curve, (link @ curve - known) / total


def _merged_channel(
    bracket: Bracket, curve: Float, seconds: Float, channel: int
) -> tuple[Float, NDArray[np.bool_], NDArray[np.bool_]]:
    """Light of one channel (H, W), and where only a bound of it is known: from below, above."""
    slope = np.gradient(curve)
    certainty = HAT / np.maximum(slope, np.median(slope) * 1e-3 + 1e-9)
    shape = bracket.codes[0].shape[:2]
    weight, total = np.zeros(shape), np.zeros(shape)
    least, most = np.full(shape, np.inf), np.full(shape, -np.inf)
    for codes, seen, t in zip(bracket.codes, bracket.seen, seconds, strict=True):
        plane = codes[..., channel]
        w = np.where(seen, certainty[plane], 0.0)
        weight += w
        total += w * (curve[plane] - np.log(t))
        white, black = seen & (plane == CODES - 1), seen & (plane == 0)
        # The shortest that is white bounds from below, the longest that is black from above.
        most = np.where(white, np.maximum(most, curve[-1] - np.log(t)), most)
        least = np.where(black, np.minimum(least, curve[0] - np.log(t)), least)
    known = weight > 0
    is_white, is_black = (
        ~known & np.isfinite(most),
        ~known & ~np.isfinite(most) & np.isfinite(least),
    )
    bound = np.where(is_white, most, np.where(is_black, least, -np.inf))
    logs = np.where(known, total / np.where(known, weight, 1.0), bound)
    return np.exp(logs), is_white, is_black


def _response(curves: Float) -> Response:
    """The curve as a response: strictly rising, 1 at white."""
    linear = np.exp(curves - curves[-1])
    # A black that is not black is a pedestal: it is light 0.
    linear = (linear - linear[0]) / (1 - linear[0])
    steps = np.maximum(np.diff(linear, axis=0), 1e-9)
    rising = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    encoded = np.repeat(np.arange(CODES)[:, None] / (CODES - 1), 3, axis=1)
    return Response("curve", linear=rising / rising[-1], encoded=encoded)
