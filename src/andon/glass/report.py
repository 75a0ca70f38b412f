"""What a frame tells of its glass."""

from __future__ import annotations

from dataclasses import dataclass

from andon.glass.focus import LayerVergences
from andon.glass.layers import Counts
from andon.glass.model import Focus

__all__ = ["GlassReport"]


@dataclass(frozen=True)
class GlassReport:
    """Where the layers of the glass are, where the eyes look, and what had to be made up.

    Attributes
    ----------
    name : of the first body.
    focus : what the eyes are focused on; None: everything is sharp.
    pupil_mm : diameter.
    limit_dioptres : the nearest that the eyes can focus on.
    vergences : of the layers of the first body, for the point between the eyes.
    interfaces : that the first body has, 1 or 2.
    other_vergences : of the same body with the other number of interfaces.
    crossing_dioptres : where both eyes' rays to the middle of the backdrop cross, < 0 behind the
        eyes; NaN nowhere, None with one eye.
    counts : pixels.
    blur_px : layer → median diameter in pixels of its blur.
    lamps_left_out : mirrored lamps beyond the `MAX_HIGHLIGHTS` brightest.
    """

    name: str
    focus: Focus | None
    pupil_mm: float
    limit_dioptres: float
    vergences: LayerVergences
    interfaces: int
    other_vergences: LayerVergences
    crossing_dioptres: float | None
    counts: Counts
    blur_px: dict[str, float]
    lamps_left_out: int = 0
