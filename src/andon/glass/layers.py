"""The three images that glass shows, before and after they are blurred."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Counts", "Layered", "Layers"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Layers:
    """What one eye sees in glass, image by image, each with the blur that it has.

    All are 0 where there is no glass, and where something nearer hides it. Luminances are of the
    first glass that a pixel sees, in cd/m²; they and α are premultiplied by `coverage`.

    Attributes
    ----------
    coverage : (H, W) [0, 1], share of the pixel that is glass.
    refracted : (H, W, 3) what comes through, Fresnel and absorption included.
    surface : (H, W, 3) what sticks to the glass, times its α.
    surface_alpha : (H, W) α = (1 − transmittance)·cover, times coverage.
    reflected : (H, W, 3) what is mirrored, Fresnel included; adds to both.
    refracted_px, surface_px, reflected_px : (H, W) diameter of the blur disc in pixels, ≥ 0.
    """

    coverage: Float
    refracted: Float
    surface: Float
    surface_alpha: Float
    reflected: Float
    refracted_px: Float
    surface_px: Float
    reflected_px: Float

    def over(self, behind: Float, /) -> Float:
        """(H, W, 3): the layers over what is seen beside them; C_o = α·C_s + (1 − α)·C_b.

        Source: the paper on glass by gaze, equation 3, with Fresnel's mirrored light added.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            clear = np.where(self.coverage > 0, 1 - self.surface_alpha / self.coverage, 0)
        through = self.surface + np.maximum(clear, 0)[..., None] * self.refracted
        return through + self.reflected + (1 - self.coverage)[..., None] * behind


@dataclass(frozen=True)
class Counts:
    """Pixels of glass, and those of them whose light had to be made up.

    Attributes
    ----------
    glass : pixels.
    lost : rays that never left the glass; black.
    missed : rays that hit no backdrop; the body's environment.
    beside : rays whose backdrop is not in the frame; its nearest pixel.
    clamped : images that would be blurred by more than the largest disc.
    """

    glass: int
    lost: int
    missed: int
    beside: int
    clamped: int


@dataclass(frozen=True)
class Layered:
    """What one eye saw in the glass of a frame: sharp `layers`, and `counts` of them."""

    layers: Layers
    counts: Counts
