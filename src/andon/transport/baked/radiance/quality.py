"""How exactly Radiance computes a map: three presets with their measured errors and times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

__all__ = ["QUALITIES", "Quality"]


@dataclass(frozen=True)
class Quality:
    """Options of `rtrace` and what they give.

    Attributes
    ----------
    name : the key in `QUALITIES`.
    ambient_divisions, ambient_super_samples : ``-ad``, ``-as``, rays of each hemisphere, and more
        of them where it varies.
    ambient_accuracy : ``-aa``, how far kept irradiance may be off where it is used again; 0 keeps
        none and traces every point.
    ambient_resolution : ``-ar``, how densely irradiance is kept at most.
    direct_subdivision : ``-ds``, area lamps are cut down to this share of their distance.
    limit_weight : ``-lw``, paths that carry less end.
    median_error, p95_error : relative, of the maps of a furnished room, measured.
    seconds_per_100k_points : of the same maps on one core, for orientation.
    """

    name: str
    ambient_divisions: int
    ambient_super_samples: int
    ambient_accuracy: float
    ambient_resolution: int
    direct_subdivision: float
    limit_weight: float
    median_error: float
    p95_error: float
    seconds_per_100k_points: float

    def options(self, bounces: int, /) -> list[str]:
        """Arguments of `rtrace` for light that is reflected up to `bounces` times."""
        values: dict[str, float] = {
            "ab": bounces,
            "ad": self.ambient_divisions,
            "as": self.ambient_super_samples,
            "aa": self.ambient_accuracy,
            "ar": self.ambient_resolution,
            "ds": self.direct_subdivision,
            "lw": self.limit_weight,
            "lr": -10,
        }
        return [word for key, value in values.items() for word in (f"-{key}", f"{value:.10g}")]


QUALITIES: Mapping[str, Quality] = MappingProxyType(
    {
        "draft": Quality("draft", 256, 64, 0.25, 64, 0.2, 1e-3, 0.05, 0.2, 10.0),
        "normal": Quality("normal", 1024, 256, 0.15, 128, 0.1, 1e-4, 0.02, 0.1, 60.0),
        "fine": Quality("fine", 4096, 1024, 0.1, 256, 0.05, 1e-5, 0.01, 0.05, 300.0),
    }
)
