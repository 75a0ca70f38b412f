"""What is to be said of a bake."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["BakeReport"]


@dataclass(frozen=True)
class BakeReport:
    """Counts of a bake.

    Attributes
    ----------
    engine, adapter : what captured.
    probes, bounces, cells : how many.
    captured, kept : results that were computed, and that an earlier bake had left.
    damaged : kept results that were not whole and were computed again.
    seconds : of the captures alone, 0 where all were kept.
    in_walls : names of probes that mostly see backs of surfaces.
    not_finite : texels whose light was no number.
    clipped : names of probes with light that 8 bits cut off (of panoramas: a sun, a lamp).
    clipped_share : the largest share of a probe's sphere that it is, 0…1.
    negative : negative values of panoramas, counted as 0.
    black : channels of probes that lose more light than there is, and are black.
    unphotographed_share : of what is seen of a photographed surface, the mean share that no
        photograph shows.
    surroundings_share : of what probes see, the mean share that lies beyond all that is known of a
        photographed scene, and has the luminance E0/π.
    unscaled : panoramas whose linear value 1 is 1 cd/m² because nobody says more.
    needs_white : frames will need capture.luminance_per_unit.
    bounces_by : what computed the bounces, "probes" or "radiance".
    """

    engine: str
    adapter: str
    probes: int
    bounces: int
    cells: int
    captured: int
    kept: int
    damaged: int
    seconds: float
    in_walls: tuple[str, ...] = ()
    not_finite: int = 0
    clipped: tuple[str, ...] = ()
    clipped_share: float = 0.0
    negative: int = 0
    black: int = 0
    unphotographed_share: float = 0.0
    surroundings_share: float = 0.0
    unscaled: tuple[str, ...] = ()
    needs_white: bool = False
    bounces_by: str = "probes"
