"""How exactly Radiance computes a map: three presets with their measured errors and times.

Reflected light is smooth, and costs thousands of rays a point: it is traced at a share of the
points and smoothed to all, see `andon.transport.baked.radiance.smoothing`. What comes straight from
lamps is computed everywhere, and exactly: testing only the lamps that matter (``-dt``, ``-dc``)
halves the time and took 38 % of the light away where a lampshade is 140 tiles, since Radiance
guesses the rest from the ones that it tests.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

__all__ = ["FEW_POINTS", "QUALITIES", "Quality"]

# Fewer points than this are no picture, whose neighbours tell about each other: all are traced, and
# none is smoothed.
FEW_POINTS = 1000


@dataclass(frozen=True)
class Quality:
    """Options of `rtrace`, how its answers are used, and what both give.

    Attributes
    ----------
    name : the key in `QUALITIES`.
    share : of the points at which reflected light is traced, 0…1.
    neighbours : among these, from which each point gets its light.
    ambient_divisions : ``-ad``, rays of each hemisphere.
    alone_divisions : the same, of points that are not smoothed.
    ambient_accuracy : ``-aa``, how far kept irradiance may be off where it is used again.
    ambient_resolution : ``-ar``, how densely irradiance is kept at most: the scene's size times
        accuracy, divided by it.
    limit_weight : ``-lw``, paths that carry less end.
    direct_subdivision : ``-ds``, area lamps are cut down to this share of their distance.
    median_error, p95_error : relative, of all light in the maps of a furnished room, measured.
    seconds_per_100k_points : of the same maps on one core, for orientation.
    """

    name: str
    share: float
    neighbours: int
    ambient_divisions: int
    alone_divisions: int
    ambient_accuracy: float
    ambient_resolution: int
    limit_weight: float
    direct_subdivision: float
    median_error: float
    p95_error: float
    seconds_per_100k_points: float

    def options(self, bounces: int, /, *, alone: bool = False) -> list[str]:
        """Arguments of `rtrace` for light that is reflected up to `bounces` times.

        `alone` for points that are not smoothed.
        """
        values: dict[str, float] = {
            "ab": bounces,
            "ad": self.alone_divisions if alone else self.ambient_divisions,
            "as": 0,
            "aa": self.ambient_accuracy,
            "ar": self.ambient_resolution,
            "ds": self.direct_subdivision,
            "lw": self.limit_weight,
            "lr": 8,
        }
        return [word for key, value in values.items() for word in (f"-{key}", f"{value:.10g}")]

    def traced(self, count: int, /) -> int:
        """At how many of `count` points reflected light is traced."""
        if count < FEW_POINTS:
            return count
        return max(FEW_POINTS, round(self.share * count))


QUALITIES: Mapping[str, Quality] = MappingProxyType(
    {
        "draft": Quality("draft", 0.02, 24, 64, 256, 0.3, 16, 5e-3, 0.2, 0.06, 0.5, 15.0),
        "normal": Quality("normal", 0.125, 24, 64, 512, 0.2, 32, 2e-3, 0.2, 0.03, 0.2, 60.0),
        "fine": Quality("fine", 1.0, 12, 512, 2048, 0.15, 64, 5e-4, 0.1, 0.02, 0.1, 3000.0),
    }
)
