"""How exactly Radiance computes a map: three presets with their measured errors and times.

Reflected light is smooth, and costs thousands of rays a point: it is traced at a share of the
points and smoothed to all, see `andon.transport.baked.radiance.smoothing`. What comes straight from
lamps is computed everywhere.

What was measured, and decided by it (a room of 15,000 triangles, a lantern of 140 tiles):

* Nothing is kept for reuse (``-aa 0``). With Radiance's irradiance cache the light depends on the
  order of the points, and its deep records carry more bounces than are asked for: +1 to +2 % in an
  integrating sphere, +7 to +10 % in the room. Without it the sphere's series is met to 0.5 %, which
  is what its facets are off.
* Every lamp is tested at every point (``-dt 0``). Testing those alone that matter halves the time
  and took 38 % of the light away: tiles of one lamp are not chance, by which Radiance guesses the
  ones that it leaves out.
* Errors, at 160 random points of that room, 4 bounces, against 6000 rays each (whose own noise is
  in them, about 2 % of the reflected light): the median is that of noise. The 95th percentile is
  that of a lattice with paper behind it, a few pixels wide: cells of more pixels than that mix
  them, in every preset. Of "fine" median and time are those of a sixteenth of the map with 18 of
  the points, too few for a percentile: it states that of "normal", and 5 of the 18, on that paper,
  are off by 47 % and more.
* Paths end by chance (``-lw`` 1/rays, ``-lr`` < 0), which has no error on the mean.
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
    tiles : of each area lamp where direct light is corrected by many.
    direct_subdivision : ``-ds``, area lamps are cut down to this share of their distance.
    median_error, p95_error : relative, of all light in the maps of a furnished room, measured.
    seconds_per_100k_points : of the same maps on one core, for orientation.
    """

    name: str
    share: float
    neighbours: int
    ambient_divisions: int
    alone_divisions: int
    tiles: int
    direct_subdivision: float
    median_error: float
    p95_error: float
    seconds_per_100k_points: float

    def options(self, bounces: int, /, *, alone: bool = False) -> list[str]:
        """Arguments of `rtrace` for light that is reflected up to `bounces` times.

        `alone` for points that are not smoothed.
        """
        rays = self.alone_divisions if alone else self.ambient_divisions
        values: dict[str, float] = {
            "ab": bounces,
            "ad": rays,
            "as": 0,
            "aa": 0,
            # Paths that carry less than a ray of the first hemisphere go on by chance (-lr < 0).
            "lw": 1 / rays,
            "lr": -(bounces + 8),
            "ds": self.direct_subdivision,
        }
        return [word for key, value in values.items() for word in (f"-{key}", f"{value:.6g}")]

    def traced(self, count: int, /) -> int:
        """At how many of `count` points reflected light is traced."""
        if count < FEW_POINTS:
            return count
        return max(FEW_POINTS, round(self.share * count))


QUALITIES: Mapping[str, Quality] = MappingProxyType(
    {
        "draft": Quality("draft", 0.01, 24, 36, 256, 128, 0.2, 0.065, 0.56, 13.0),
        "normal": Quality("normal", 0.04, 40, 36, 1024, 512, 0.2, 0.046, 0.32, 85.0),
        "fine": Quality("fine", 0.15, 24, 256, 4096, 2048, 0.2, 0.02, 0.32, 620.0),
    }
)
