"""Light between a pixel and its eight neighbours, which no rung is fine enough for.

Where pixels are coarse against θ_min a spread function falls to a tenth from one pixel to the next;
where they are fine the rungs have it all, and there is nothing here (`neighbours_of`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.whole_picture.charts import Chart
from andon.glare.whole_picture.ladder import Ladder
from andon.spaces import View

__all__ = ["DIRECTIONS", "Neighbours", "neighbours_of"]

Float = NDArray[np.float64]

# To the neighbours (column, row) of which each pixel holds what it exchanges with them.
DIRECTIONS = ((1, 0), (0, 1), (1, 1), (-1, 1))
# Less than this share of a pixel's light, to all neighbours together, is left in the pixel.
LEAST = 0.01


@dataclass(frozen=True, eq=False)
class Neighbours:
    """What neighbours exchange; it is the same both ways.

    Attributes
    ----------
    exchanged : (H, W, 4) sr, light at the neighbour of `DIRECTIONS` per luminance here, or back; 0
        where there is none. The columns of a panorama go round.
    solid_angles : (H, W) sr, of the pixels.
    closed : whether there is nothing beyond the border, as in a panorama.
    """

    exchanged: Float
    solid_angles: Float
    closed: bool

    def veil(self, light: Float, /) -> Float:
        """(H, W, n) of light (H, W, n)."""
        total = np.zeros_like(light)
        for index, (across, down) in enumerate(DIRECTIONS):
            # Where there is no neighbour nothing is exchanged with what comes round.
            each = self.exchanged[..., index, None]
            total += each * np.roll(light, (-down, -across), (0, 1))
            total += np.roll(each * light, (down, across), (0, 1))
        return total / self.solid_angles[..., None]

    def share(self) -> Float:
        """(H, W) share of each pixel's light that goes to its neighbours, or beyond the border."""
        share = self.veil(np.ones((*self.solid_angles.shape, 1)))[..., 0]
        if self.closed:
            return share
        # Pixels of the border lose as much as those beside them.
        return np.pad(share[1:-1, 1:-1], 1, "edge")


def neighbours_of(view: View, charts: tuple[Chart, ...], ladder: Ladder, /) -> Neighbours | None:
    """What neighbours exchange in pictures of a view; None where it is next to nothing."""
    directions = view.directions()
    beside = np.zeros((*view.shape, 3))
    for chart in charts:
        share = chart.share(directions, pair=len(charts) == 2)[..., None]
        beside += share * ladder.beside_at(chart.scale(directions))
    if float(np.max(np.abs(beside @ [2.0, 2.0, 4.0]))) < LEAST:
        return None
    solid = view.solid_angles()
    exchanged = np.zeros((*view.shape, 4))
    for index, (across, down) in enumerate(DIRECTIONS):
        kind = 2 if across and down else abs(across)
        there = np.roll(beside[..., kind], (-down, -across), (0, 1))
        size = np.sqrt(solid * np.roll(solid, (-down, -across), (0, 1)))
        exchanged[..., index] = (beside[..., kind] + there) / 2 * size
        if down:
            exchanged[-1, :, index] = 0
        if across and view.projection != "latlong":
            exchanged[:, -1 if across > 0 else 0, index] = 0
    return Neighbours(exchanged, solid, view.projection == "latlong")
