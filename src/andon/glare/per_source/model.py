"""Settings of the per-source renderer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["Bloom", "PerSource"]

# Angle beyond the outline in degrees (...), negative inside → sr⁻¹ (...): the paper's form,
# `andon.observer.spread.paper.outline_bloom`.
Bloom = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class PerSource:
    """How sources are drawn.

    Attributes
    ----------
    bloom : None: the kernel convolved with each source's shape; else this form of the angle from
        the outline (mode `paper`).
    core : the plateau within θ_min is drawn; None: where pixels are finer than θ_min.
    least_cd_m2 : ≥ 0; a source is not drawn where its veil is weaker than this: a stated share of
        the ambient luminance. 0: everywhere. Of n sources n times this is left out.
    """

    bloom: Bloom | None = None
    core: bool | None = None
    least_cd_m2: float = 0.0
    bloom_drawn: bool = True

    def __post_init__(self) -> None:
        if not (np.isfinite(self.least_cd_m2) and self.least_cd_m2 >= 0):
            raise InputError("must be ≥ 0 cd/m²", field="glare.least_cd_m2")
