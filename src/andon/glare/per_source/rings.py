"""Which pixels around a source are averaged, and how finely.

A pixel holds the mean of the veil over its square. Where the veil is steep within a pixel that is
not its value in the middle, so the view is cut in three rings about each source:

========== =================================== ===========================================
ring       from the source's widest radius     samples of a pixel
========== =================================== ===========================================
``near``   up to 3 pixels                      n × n, as dense as θ_min/4
``middle`` up to 14 pixels                     2 × 2: error of θ⁻³ at 3 pixels 0.2 %
``far``    beyond                              its middle: error at 14 pixels 0.2 %
========== =================================== ===========================================

Samples are those of n equal parts, drawn apart by 1/√(1 − n⁻²): they then have the square's own
second moment (for 2 × 2 they are Gauss's). Halos are averaged in the same way, over 0.05°.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.model import Outline
from andon.glare.per_source.coordinates import chord
from andon.glare.per_source.tables import COLUMNS, VeilTable
from andon.glare.pixels import pixel_radians
from andon.spaces import View

__all__ = ["Rings", "halo_samples", "offsets", "reach_chord", "rings_of"]

Float = NDArray[np.float64]

NEAR_PIXELS, MIDDLE_PIXELS = 3.0, 14.0
SAMPLES_PER_CORE = 4.0
LEAST_SAMPLES, MOST_SAMPLES = 3, 64
# A ring has σ = 0.24°: of pixels of 0.1° their middles say all but 0.7 % of its height.
HALO_SAMPLE_DEGREES, MOST_HALO_SAMPLES = 0.1, 8


@dataclass(frozen=True)
class Rings:
    """Rings of one source in one view.

    Attributes
    ----------
    ends : chords from the source's direction at which near, middle and far end.
    samples : along a side of a pixel in each of them.
    """

    ends: tuple[float, float, float]
    samples: tuple[int, int, int]


def rings_of(view: View, kernel: Kernel, outline: Outline, reach: float, /) -> Rings:
    """The rings of a source whose veil is drawn up to the chord `reach`."""
    pixel, widest = pixel_radians(view), float(outline.radii_radians.max())
    dense = np.ceil(SAMPLES_PER_CORE * pixel / np.radians(kernel.minimum_degrees))
    ends = [
        min(float(chord(min(widest + pixels * pixel, np.pi))), reach)
        for pixels in (NEAR_PIXELS, MIDDLE_PIXELS)
    ]
    near = int(np.clip(dense, LEAST_SAMPLES, MOST_SAMPLES))
    return Rings((ends[0], ends[1], reach), (near, 2, 1))


def halo_samples(view: View, /) -> int:
    """Samples along a side of a pixel in the ring of a halo."""
    dense = np.ceil(pixel_radians(view) / np.radians(HALO_SAMPLE_DEGREES))
    return int(np.clip(dense, 1, MOST_HALO_SAMPLES))


def offsets(samples: int, /) -> Float:
    """(samples², 2) of the samples of a pixel from its middle, in pixels."""
    along = np.zeros(1)
    if samples > 1:
        along = ((np.arange(samples) + 0.5) / samples - 0.5) / np.sqrt(1 - samples**-2.0)
    return np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)


def reach_chord(table: VeilTable, light: float, least: float, /) -> float:
    """Chord beyond which the veil of `light` lx is less than `least` cd/m²; 2 is everywhere."""
    if least <= 0:
        return 2.0
    edge = np.array([table.edge.max()])
    m = table.distances(edge, np.arange(COLUMNS, dtype=np.float64))
    veil = light * table.values.max(axis=0) * table.columns(m, edge)[1]
    bright = np.nonzero(veil >= least)[0]
    last = min(int(bright.max(initial=0)) + 1, COLUMNS - 1)
    return float(min(m[last] + table.frame.focus, 2.0))
