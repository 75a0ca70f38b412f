"""What is baked: illuminance maps of one moment, and which of them a frame mixes.

::

    lamp × camera × moment ──▶ lux (h, w, 3)          camera × moment ──▶ depth, normal (h, w)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.files.illuminance_maps import IlluminanceMap, Part
from andon.quantities import Photometry

__all__ = ["BakedLight", "BakedMoment", "BakedSeen", "IlluminanceMap", "Mode", "Part"]

Float = NDArray[np.floating[Any]]

# How maps that see the same point are mixed.
Mode = Literal["blend", "first_valid"]


@dataclass(frozen=True, eq=False)
class BakedMoment:
    """All maps of one moment, in the order of their cameras."""

    time_seconds: float
    maps: tuple[IlluminanceMap, ...]


@dataclass(frozen=True, eq=False)
class BakedLight:
    """What a frame adds of baked light.

    Attributes
    ----------
    moments : seconds, increasing; of a still scene one. Before the first and after the last one
        the light stands still.
    load : number of a moment → its maps; kept by the loader, so asking again costs nothing.
    shares : time in seconds → lamp name → factor on its maps (flicker); always all lamps.
    parts : lamp name → what of its light is in the maps.
    mode, depth_tolerance_m : as in [baked].
    photometry : of the lux.
    """

    moments: tuple[float, ...]
    load: Callable[[int], BakedMoment]
    shares: Callable[[float], Mapping[str, float]]
    parts: Mapping[str, Part] = field(default_factory=dict[str, Part])
    mode: Mode = "blend"
    depth_tolerance_m: float = 0.02
    photometry: Photometry = "absolute"

    def around(self, time_seconds: float, /) -> tuple[int, int, float]:
        """The moments before and after a time, and the share of the later one, 0…1.

        At a moment, before the first and after the last one both are the same and the share is 0.
        """
        times = np.asarray(self.moments)
        later = int(np.searchsorted(times, time_seconds, side="left"))
        if later == len(times):
            return later - 1, later - 1, 0.0
        if later == 0 or times[later] == time_seconds:
            return later, later, 0.0
        span = times[later] - times[later - 1]
        return later - 1, later, float((time_seconds - times[later - 1]) / span)


@dataclass(frozen=True, eq=False)
class BakedSeen:
    """What baked light a view sees.

    Attributes
    ----------
    lux : (H, W, 3) lx; where no map is valid that of a rim (rims.py), or 0.
    covered : (H, W) a map is valid there.
    asked : (H, W) pixels that take baked light: surfaces, but no luminous bodies.
    """

    lux: Float
    covered: NDArray[np.bool_]
    asked: NDArray[np.bool_]

    @property
    def uncovered(self) -> NDArray[np.bool_]:
        """(H, W) pixels that should have baked light, and that no map sees."""
        return self.asked & ~self.covered

    @property
    def uncovered_share(self) -> float:
        """Of all pixels that take baked light."""
        count = int(np.count_nonzero(self.asked))
        return float(np.count_nonzero(self.uncovered) / count) if count else 0.0
