"""The veil of a whole picture by either engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.plan import plan_whole
from andon.glare.whole_picture.reference import scattered
from andon.spaces import View

__all__ = ["EngineName", "Scatter", "scatter"]

Float = NDArray[np.float64]
EngineName = Literal["auto", "gpu", "reference"]


@dataclass(frozen=True, eq=False)
class Scatter:
    """A picture with its veil.

    Attributes
    ----------
    picture, veil : (H, W, 3); picture = (1 − k)·light + veil.
    share : k, the mean over the light of the picture of what leaves its pixel.
    engine : ``gpu`` or ``reference``.
    """

    picture: Float
    veil: Float
    share: float
    engine: str


def scatter(light: Float, view: View, kernel: Kernel, engine: EngineName, /) -> Scatter:
    """Scatters all light (H, W, 3), finite and ≥ 0, of a picture of `view`."""
    found = scattered(light, plan_whole(view, kernel))
    weight = light.sum(axis=-1) * view.solid_angles()
    total = float(weight.sum())
    share = float((found.share * weight).sum() / total) if total > 0 else kernel.share
    return Scatter(found.picture, found.glare, share, "reference")
