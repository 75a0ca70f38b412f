"""How exactly Radiance computes a map: three presets with their measured errors and times.

Reflected light is smooth, and costs thousands of rays a point: it is traced at a share of the
points and smoothed to all, see `andon.transport.baked.radiance.smoothing`. What comes straight from
lamps is computed everywhere, and corrected by that of more tiles at the same share.

What was measured, and decided by it (R: a furnished room with two lamps of 64 and 80 tiles; L: one
of 15,000 triangles with a lantern of 68 tiles that a wooden frame stands close to):

* Nothing is kept for reuse (``-aa 0``). With Radiance's irradiance cache the light depends on the
  order of the points, and its deep records carry more bounces than are asked for: +1 to +2 % in an
  integrating sphere, +7 to +10 % in L. Without it the sphere's series is met to 0.5 %, which is
  what its facets are off.
* Every lamp is tested at every point (``-dt 0``). Testing those alone that matter halves the time
  and took 38 % of the light away: tiles of one lamp are not chance, by which Radiance guesses the
  ones that it leaves out.
* Direct light in L is off by +5.6 % with 64 tiles, +4.0 % with 256, +2.5 % with 1024 against 4096:
  the frame hides the rims of the paper, where few tiles have their middles. In R by less than
  0.1 %. Corrected by 256, its median error
  goes from 1.6 to 0.7 % of all light, the 95th percentile from 6.4 to 5.0 %.
* Reflected light of 8 tiles against 64 is off by +2 % on the mean in L, +2 to +4 % in R.
* Errors are those of a map of 480 × 270 at 160 random points, 4 bounces, against 2048 rays at each,
  8 tiles for what is reflected and 4096 direct. "draft" R 3.3 and 13 %, L 7.1 and 38 % (of a
  part of the points of "normal"); "normal" R 2.5 and 9.3 %, L 6.8 and 28 %: what L has beyond R is
  reflected light in its dim alcove and on a lattice with paper behind it, noise of few rays.
  Seconds for 100,000 points: "draft" R 16, L 77; "normal" R 27, L 136, of which 55 are reflected.
  Of "fine" nothing but its share of the rays is known: it states half the median of "normal", its
  percentile, and the time that its rays take there.
* Paths end by chance (``-lw`` 1/rays, ``-lr`` < 0). Random numbers that begin alike (``-u-``) make
  reflected light +1.2 to +2.1 ± 0.2 % brighter than others (``-u+``, by the clock) at 1500 random
  points of a box lit by a point lamp, and -0.1 to -0.6 ± 0.4 % in R. It is not that chance: with
  paths that end by none it is +1.3 to +1.6 %, and 0 to +1.6 % with other limits, in no order. That
  is the price of the same bytes in every run.
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
    median_error, p95_error : relative, of all light in the maps of a room, the worse of two.
    seconds_per_100k_points : on one core, the geometric mean of both.
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
        "draft": Quality("draft", 0.01, 24, 36, 256, 128, 0.2, 0.071, 0.38, 35.0),
        "normal": Quality("normal", 0.04, 40, 36, 1024, 256, 0.2, 0.068, 0.28, 60.0),
        "fine": Quality("fine", 0.15, 24, 256, 4096, 1024, 0.2, 0.034, 0.28, 800.0),
    }
)
