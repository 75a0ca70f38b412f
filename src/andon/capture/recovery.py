"""The response of the camera that took a bracket, from the bracket itself.

g(Z) is the ln of the exposure, light × time, that makes code Z. Each photograph j of each pixel i
says ``g(Z_ij) = ln E_i + ln t_j``; pixels are many and codes 256, so g, E and their errors follow
by least squares, channel by channel.

What is not light is kept out: codes at the ends have weight 0 (clipped) or little; pixels at edges
are not asked; pixels whose worst photograph fits too badly are things that move, and are left out
before g is solved anew.

Sources: Debevec & Malik 1997, equation 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.capture.brackets import Bracket
from andon.responses import Response

__all__ = [
    "CODES",
    "MIDDLE",
    "ChannelCurve",
    "Fall",
    "Recovery",
    "certainty_of",
    "recover_curves",
    "seconds_of",
]

Float = NDArray[np.float64]

CODES = 256
MIDDLE = 128  # Debevec & Malik's anchor: g(128) = 0
# λ of the curve's smoothness, against hat weights of up to 127 in so many equations. With half of
# it curves of known cameras swing by 1 %, in periods of the exposures' step; with four times, what
# a film does is smoothed away: the memorial series' residual grows by a fifth.
SMOOTHNESS = 110.0
# Equations from photographs; Debevec & Malik ask for more than there are codes. With 4000 a third
# of the memorial series' codes had none.
EQUATIONS = 20_000
# Pixels whose worst residual exceeds the median's so many times are things that move, or dirt;
# those of fewer codes than the least are noise.
OUTLIER, LEAST_OUTLIER_CODES = 3.0, 6.0
ROUNDS = 3
HAT = np.minimum(np.arange(CODES), CODES - 1 - np.arange(CODES)).astype(np.float64)


@dataclass(frozen=True)
class Fall:
    """The deepest fall of a fitted curve: g at `codes[1]` is lower than at `codes[0]` < it.

    `ev` is its depth in stops, > 0; `noise_ev` the standard error of that difference.
    """

    codes: tuple[int, int]
    ev: float
    noise_ev: float


@dataclass(frozen=True)
class ChannelCurve:
    """One channel's response.

    Attributes
    ----------
    fitted : (256,) g as least squares gives it; g(128) = 0.
    rising : (256,) the same, forced to rise from the middle outwards.
    support : (256,) equations that say something about each code.
    kept_share : share of the pixels that fit.
    fall : where `fitted` falls most between supported codes, or None where it rises everywhere.
    """

    fitted: Float
    rising: Float
    support: NDArray[np.int64]
    kept_share: float
    fall: Fall | None


@dataclass(frozen=True)
class Recovery:
    """The responses of the three channels."""

    channels: tuple[ChannelCurve, ...]

    @property
    def curves(self) -> Float:
        """(256, 3), rising."""
        return np.stack([channel.rising for channel in self.channels], axis=-1)

    @property
    def response(self) -> Response:
        """The curves as a response: strictly rising, 1 at white."""
        curves = self.curves
        linear = np.exp(curves - curves[-1])
        # A black that is not black is a pedestal: it is light 0.
        linear = (linear - linear[0]) / (1 - linear[0])
        steps = np.maximum(np.diff(linear, axis=0), 1e-9)
        rising = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        encoded = np.repeat(np.arange(CODES)[:, None] / (CODES - 1), 3, axis=1)
        return Response("curve", linear=rising / rising[-1], encoded=encoded)


def recover_curves(bracket: Bracket, /) -> Recovery:
    """The response that explains the bracket best. `check_exposures` must have passed.

    Least squares of g(Z) = ln E + ln t with hat weights and a smooth g, per channel, repeated
    without the pixels that do not fit. Source: Debevec & Malik 1997, equation 3.
    """
    samples = _samples(bracket)
    logs = np.log(seconds_of(bracket))
    return Recovery(tuple(_channel(samples[..., c], logs) for c in range(3)))


def certainty_of(curve: Float, /) -> Float:
    """(256,) how much each code says of light: the hat times dZ/dg, which noise is divided by.

    Small where film or sensor no longer answers to light: the fog of a dark scan. Sources: Debevec
    & Malik 1997, equation 4, for the hat; Mann & Picard 1995 for the slope.
    """
    slope = np.gradient(curve)
    return HAT / np.maximum(slope, np.median(slope) * 1e-3 + 1e-9)


def seconds_of(bracket: Bracket, /) -> Float:
    """(n,) exposures, which `check_exposures` has found to be known."""
    assert bracket.seconds is not None
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
    spread = _spread(total, count)
    at = rows[spread], columns[spread]
    return np.stack([picture[at] for picture in bracket.codes], axis=1).astype(np.int64)


def _spread(brightness: NDArray[np.int64], count: int) -> NDArray[np.intp]:
    """Indices of up to `count` pixels: half evenly over their ranks, half over their brightness.

    Ranks alone leave out what few pixels show: the windows of a church.
    """
    order = np.argsort(brightness, kind="stable")
    ranks = np.linspace(0, len(order) - 1, count - count // 2).astype(int)
    ends = float(brightness.min()), float(brightness.max())
    levels = np.linspace(*ends, count // 2)
    reached = np.searchsorted(brightness[order], levels)
    return order[np.unique(np.concatenate([ranks, reached]))]


def _channel(codes: NDArray[np.int64], log_seconds: Float) -> ChannelCurve:
    """g of one channel from (n, photographs) codes."""
    rises = _rises(codes, log_seconds)
    fits, weights = rises, HAT[codes] * rises[:, None]
    solved = _Solved(codes, log_seconds, weights)
    for _ in range(ROUNDS):
        # In codes, in which noise is the same everywhere: logarithms of dark ones spread.
        slope = np.maximum(np.gradient(solved.curve), 1e-4)[codes]
        residual = np.abs(solved.residual) / slope
        worst = np.where(weights > 0, residual, 0.0).max(axis=1)
        usual = OUTLIER * 1.4826 * float(np.median(worst[rises]))
        fits = rises & (worst <= max(usual, LEAST_OUTLIER_CODES))
        solved = _Solved(codes, log_seconds, weights * fits[:, None])
    curve = solved.curve
    support = _support(codes, weights * fits[:, None])
    # Codes that no photograph has are bent by their neighbours alone: a curve that falls is none.
    rising = np.maximum.accumulate(curve[MIDDLE:])
    falling = np.minimum.accumulate(curve[: MIDDLE + 1][::-1])[::-1]
    forced = np.concatenate([falling[:-1], rising])
    return ChannelCurve(curve, forced, support, float(fits.mean()), _fall(solved, support))


def _rises(codes: NDArray[np.int64], log_seconds: Float) -> NDArray[np.bool_]:
    """(n,) pixels that are nowhere darker, beyond noise, in a longer exposure.

    Least squares follow what moved a long way before they can tell it. Where most pixels fall it is
    not they that moved: all are kept, and contradict each other.
    """
    ordered = codes[:, np.argsort(log_seconds, kind="stable")]
    rises: NDArray[np.bool_] = np.all(np.diff(ordered, axis=1) >= -LEAST_OUTLIER_CODES, axis=1)
    return rises if rises.mean() > 0.5 else np.ones(len(codes), bool)


class _Solved:
    """Least squares for g (256,) and ln E (n,), by the normal equations.

    Each photograph of each pixel: w·(g(Z) − ln E) = w·ln t; each inner code: λ·w·g″ = 0.
    ln E of a pixel stands in its own equations only and is eliminated first.
    """

    def __init__(self, codes: NDArray[np.int64], log_seconds: Float, weights: Float) -> None:
        weight = weights**2
        total = weight.sum(axis=1) + 1e-9
        known = weight @ log_seconds
        share = weight / total[:, None]
        right = _sums(codes, weight * log_seconds - share * known[:, None])
        matrix = np.diag(_sums(codes, weight))
        # What the elimination of ln E ties together: the codes that one pixel has.
        pairs = codes[:, :, None] * CODES + codes[:, None, :]
        ties = np.bincount(
            pairs.ravel(), (weight[:, :, None] * share[:, None, :]).ravel(), CODES**2
        )
        matrix = matrix - ties.reshape(CODES, CODES) + _smoothness()
        matrix[MIDDLE, MIDDLE] += weight.sum() + 1.0  # g(128) = 0
        curve = np.linalg.solve(matrix, right)
        self.curve = curve - curve[MIDDLE]
        exposure = self.curve[codes] - log_seconds
        self.residual = exposure - (share * exposure).sum(axis=1, keepdims=True)
        self._matrix, self._squares = matrix, float((weight * self.residual**2).sum())
        self._free = int((weight > 0).sum() - len(codes) - CODES)

    def error_of(self, first: int, second: int) -> float:
        """Standard error of g(second) − g(first)."""
        pick = np.zeros(CODES)
        pick[first], pick[second] = -1.0, 1.0
        variance = self._squares / max(self._free, 1)
        return float(np.sqrt(variance * (pick @ np.linalg.solve(self._matrix, pick))))


def _sums(codes: NDArray[np.int64], values: Float) -> Float:
    """(256,) sum of the values that stand at each code."""
    return np.asarray(np.bincount(codes.ravel(), values.ravel(), CODES), np.float64)


@cache
def _smoothness() -> Float:
    """λ²·Σ w²·(g″)² as a matrix, (256, 256)."""
    bend = np.zeros((CODES - 2, CODES))
    inner = np.arange(1, CODES - 1)
    for offset, factor in ((-1, 1.0), (0, -2.0), (1, 1.0)):
        bend[inner - 1, inner + offset] = factor * SMOOTHNESS * np.maximum(HAT[inner], 1)
    return bend.T @ bend


def _support(codes: NDArray[np.int64], weights: Float) -> NDArray[np.int64]:
    """(256,) how often a code stands in a pixel that has another photograph to be held against."""
    says = (weights > 0) & ((weights > 0).sum(axis=1, keepdims=True) > 1)
    return np.bincount(codes[says], minlength=CODES).astype(np.int64)


def _fall(solved: _Solved, support: NDArray[np.int64]) -> Fall | None:
    codes = np.flatnonzero(support)
    curve = solved.curve[codes]
    if len(codes) < 2 or (np.diff(curve) >= 0).all():
        return None
    depth = np.maximum.accumulate(curve) - curve
    low = int(np.argmax(depth))
    high = int(np.argmax(curve[: low + 1]))
    ends = int(codes[high]), int(codes[low])
    return Fall(ends, float(depth[low] / np.log(2)), solved.error_of(*ends) / float(np.log(2)))
