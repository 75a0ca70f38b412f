"""The speed rows: what is timed, beside whom, and how it is known that both do the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from andon.verify.registry import Stage

__all__ = ["BenchRow", "Duel", "rows"]


@dataclass(frozen=True)
class Duel:
    """Two sides, ready to be timed.

    Attributes
    ----------
    ours, peer : one repetition each; return when the work is done.
    agreement : share in [0, 1] of pixels on which both gave the same answer, or another figure of
        agreement that `agreed` accepts.
    agreed : the least `agreement` at which times are printed at all.
    adapter : what ours ran on.
    close : lets go of what both hold.
    peer_repeats : at most so many repetitions of a slow peer.
    peer_less : what the peer does besides what is timed; its time is taken off.
    ours_less : what ours does besides what is timed; its time is taken off.
    ours_repeats : at most so many repetitions of ours.
    peer_parts : a repetition of the peer does so many times what ours does once; may be < 1.
    """

    ours: Callable[[], object]
    peer: Callable[[], object]
    agreement: float
    agreed: float
    adapter: str
    close: Callable[[], object] = lambda: None
    peer_repeats: int = 5
    peer_less: Callable[[], object] | None = None
    peer_parts: float = 1
    ours_less: Callable[[], object] | None = None
    ours_repeats: int | None = None


@dataclass(frozen=True)
class BenchRow:
    """One comparison.

    Attributes
    ----------
    name : ``stage.what.peer``.
    peer : name of the other side.
    pixels : of one repetition.
    prepare : makes the `Duel`; raises `NotShown` where a peer is missing.
    bar : the ratio peer/ours, or Mpix/s where `bar_is_rate`, must be at least this; None is
        published only.
    """

    name: str
    stage: Stage
    peer: str
    pixels: int
    prepare: Callable[[], Duel]
    bar: float | None = None
    bar_is_rate: bool = False
    bar_is_milliseconds: bool = False

    def holds(self, ours_seconds: float, peer_seconds: float) -> bool | None:
        """Whether the bar is met; None where there is none."""
        if self.bar is None:
            return None
        if self.bar_is_rate:
            return self.pixels / ours_seconds / 1e6 >= self.bar
        if self.bar_is_milliseconds:
            return ours_seconds * 1e3 <= self.bar
        return peer_seconds / ours_seconds >= self.bar


def rows() -> tuple[BenchRow, ...]:
    """All rows, stage by stage."""
    from andon.bench import (
        areas,
        bake,
        baked,
        glare,
        glare_frame,
        glare_needles,
        glare_quads,
        glass,
        glass_frame,
        glow,
        probe_light,
        probes,
        relight,
    )

    light = relight.ROWS + areas.ROWS + glow.ROWS
    rest = glass.ROWS + glass_frame.ROWS + probes.ROWS + probe_light.ROWS
    veils = glare.ROWS + glare_frame.ROWS + glare_needles.ROWS + glare_quads.ROWS
    return light + baked.ROWS + bake.ROWS + rest + veils
