"""Which layer of the glass is looked at, by hysteresis.

::

    surface ├──────────────┼────────┤····► background       p = 0 … 1, in dioptres
            0             0.5  0.5 + hysteresis              left only beyond the mark
"""

from __future__ import annotations

import math
from typing import Literal

from andon.errors import InputError

__all__ = ["Layer", "LayerChoice"]

Layer = Literal["surface", "background"]
# Layers nearer to each other than this look the same to any eye (its depth of focus is ±0.3 D).
SAME_DIOPTRES = 0.01


class LayerChoice:
    """Keeps the layer that was chosen until the gaze has come well over to the other one.

    `hysteresis` is the share of the way between both layers that has to be crossed beyond the
    middle, 0…1; from 0.5 on the other layer itself has to be reached.
    """

    def __init__(self, hysteresis: float = 0.3) -> None:
        if not 0 <= hysteresis <= 1:
            raise InputError(f"must be 0…1, got {hysteresis:g}", field="hysteresis")
        self._mark = min(0.5 + hysteresis, 1.0)
        self._layer: Layer | None = None
        self.changes = 0

    def update(
        self, dioptres: float | None, surface_dioptres: float, background_dioptres: float, /
    ) -> Layer:
        """The layer looked at; None or NaN, a gaze that is not known, is the surface.

        Either layer may be the nearer one, and the background's vergence may be negative. Layers
        that cannot be told apart, or of which one is not known, change nothing.
        """
        if dioptres is None or math.isnan(dioptres):
            return self._choose("surface")
        way = background_dioptres - surface_dioptres
        if not abs(way) > SAME_DIOPTRES:
            return self._layer or "surface"
        share = (dioptres - surface_dioptres) / way
        if self._layer is None:
            return self._choose("background" if share > 0.5 else "surface")
        if self._layer == "surface" and share >= self._mark:
            return self._choose("background")
        if self._layer == "background" and share <= 1 - self._mark:
            return self._choose("surface")
        return self._layer

    def _choose(self, layer: Layer) -> Layer:
        self.changes += self._layer not in (None, layer)
        self._layer = layer
        return layer
