"""Settings of the display."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Exposure"]


@dataclass(frozen=True)
class Exposure:
    """How luminance becomes a display value.

    Attributes
    ----------
    units_per_cd_m2 : display-linear units per cd/m², > 0; None repeats the camera
        (1/luminance_per_unit), under which unchanged light keeps its bytes.
    tone : ``none`` clips each channel at white, as a camera does; ``hue`` lets what is brighter
        than white fade to white without changing its hue; ``reinhard`` bends what is above 0.6 of
        white towards white (leaves identity below that).
    """

    units_per_cd_m2: float | None = None
    tone: Literal["none", "hue", "reinhard"] = "none"
