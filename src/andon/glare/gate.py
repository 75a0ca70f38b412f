"""The contrast from which a source has a halo and needles.

::

    1 ┤          ┌────
      │         ╱           smoothstep over [40, 50] × ambient, so that a source which crosses the
    0 ┤────────╯            gate in motion does not pop
      └────────┴─┴────▶ contrast = luminance of the source : luminance that the eye is adapted to
              40 50
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["HIGHLIGHT_CONTRAST", "RAMP", "gate"]

# "Ips/Ia ≥ 40", table 2 of the glare paper.
HIGHLIGHT_CONTRAST = 40.0
# The ramp ends at this many times the contrast. Ours: short beside the range of sources, which is
# decades, and long beside what luminance changes by from frame to frame.
RAMP = 1.25


def gate(
    luminance_cd_m2: ArrayLike,
    ambient_cd_m2: ArrayLike,
    /,
    *,
    contrast: float = HIGHLIGHT_CONTRAST,
) -> NDArray[np.float64]:
    """(...) weight in [0, 1] of halo and needles: 0 up to `contrast`, 1 from 1.25 times that on.

    Parameters
    ----------
    luminance_cd_m2, ambient_cd_m2 : (...) ≥ 0, of the source and of what the eye is adapted to;
        in the dark (0) every source passes.

    Source: the glare paper, table 2; the ramp is ours.
    """
    least = contrast * np.asarray(ambient_cd_m2, np.float64)
    width = np.maximum(least * (RAMP - 1), np.finfo(np.float64).tiny)
    with np.errstate(over="ignore"):
        along = np.clip((np.asarray(luminance_cd_m2, np.float64) - least) / width, 0, 1)
    return along * along * (3 - 2 * along)
