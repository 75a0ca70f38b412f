"""Values between keyframes (glTF 2.0, section 3.11 and appendix C)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.quaternions import slerp

__all__ = ["Interpolation", "Track"]

Float = NDArray[np.float64]
Interpolation = Literal["LINEAR", "STEP", "CUBICSPLINE"]


@dataclass(frozen=True)
class Track:
    """What some nodes do at common times; held before the first and after the last of them.

    Attributes
    ----------
    path : ``translation``, ``rotation``, ``scale`` or ``weights``.
    interpolation : between the keys.
    times : (k,) seconds, rising.
    nodes : (m,) places of the nodes.
    values : (k, m, w); of CUBICSPLINE (k, 3, m, w): in-tangent, value, out-tangent.
    """

    path: str
    interpolation: Interpolation
    times: Float
    nodes: NDArray[np.int64]
    values: Float

    def at(self, seconds: float, /) -> Float:
        """(m, w) at a time; rotations are unit quaternions."""
        times = self.times
        here = int(np.clip(np.searchsorted(times, seconds, side="right") - 1, 0, len(times) - 1))
        after = min(here + 1, len(times) - 1)
        span = float(times[after] - times[here])
        share = float(np.clip((seconds - times[here]) / span, 0, 1)) if span > 0 else 0.0
        if self.interpolation == "CUBICSPLINE":
            return self._cubic(here, after, share, span)
        first, second = self.values[here], self.values[after]
        if self.interpolation == "STEP" or share == 0:
            return first
        if self.path == "rotation":
            return slerp(first, second, share)
        return (1 - share) * first + share * second

    def _cubic(self, here: int, after: int, t: float, span: float) -> Float:
        """Hermite's cubic (appendix C.5); of a rotation normalised, as it asks for."""
        value, leaving = self.values[here, 1], self.values[here, 2] * span
        arriving, following = self.values[after, 0] * span, self.values[after, 1]
        found = (
            (2 * t**3 - 3 * t**2 + 1) * value
            + (t**3 - 2 * t**2 + t) * leaving
            + (3 * t**2 - 2 * t**3) * following
            + (t**3 - t**2) * arriving
        )
        if self.path != "rotation":
            return found
        length: Float = np.linalg.norm(found, axis=-1, keepdims=True)
        # Through 0 there is no way; the key before stands in.
        unit: Float = found / np.where(length > 0, length, 1.0)
        return np.where(length > 0, unit, value)
