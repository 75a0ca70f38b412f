"""Pictures of what is missing: a frame in grey, and where something is not, in a loud colour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import photometric

__all__ = ["MISSING_RGB", "marked"]

# No light in a room looks like this.
MISSING_RGB = (255, 0, 255)
# Grey that is left of the picture: it tells where one is looking, and competes with no mark.
KEPT = 0.6


def marked(rgb: NDArray[np.uint8], missing: NDArray[np.bool_], /) -> NDArray[np.uint8]:
    """The picture (H, W, 3), sRGB, in grey, with the pixels of `missing` (H, W) in magenta."""
    grey = KEPT * photometric(rgb.astype(np.float64))
    picture = np.repeat(np.round(grey)[..., None], 3, axis=-1).astype(np.uint8)
    picture[missing] = MISSING_RGB
    return picture
