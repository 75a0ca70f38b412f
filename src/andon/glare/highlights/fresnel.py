"""How much of light an interface mirrors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["DIELECTRIC", "dielectric", "paper_condition", "schlick", "total_reflection"]

Float = NDArray[np.float64]

# Straight ahead, of an index of 1.5: glTF's dielectrics.
DIELECTRIC = 0.04


def schlick(cosine: ArrayLike, straight: ArrayLike, /) -> Float:
    """(...) reflectance at `cosine` of the angle of incidence; `straight` is that at 0°.

    Source: Schlick 1994. Within 0.05 of the exact term for an index of 1.5.
    """
    straight = np.asarray(straight, np.float64)
    return straight + (1 - straight) * (1 - np.clip(cosine, 0, 1)) ** 5


def dielectric(cosine: ArrayLike, ratio: ArrayLike, /) -> Float:
    """(...) Fresnel's reflectance of unpolarised light, exact.

    Parameters
    ----------
    cosine : of the angle of incidence, [0, 1].
    ratio : index beyond the interface over that before it; below 1 light inside is totally
        reflected from the critical angle on.
    """
    cosine, ratio = np.clip(cosine, 0, 1), np.asarray(ratio, np.float64)
    square = ratio**2 - 1 + cosine**2
    g = np.sqrt(np.maximum(square, 0))
    # Born and Wolf, 1.5.2, with g = n·cos θ_t.
    a = (g - cosine) / np.maximum(g + cosine, 1e-30)
    b = (cosine * (g + cosine) - 1) / np.where(square > 0, cosine * (g - cosine) + 1, 1)
    return np.where(square <= 0, 1.0, 0.5 * a**2 * (1 + b**2))


def total_reflection(cosine: ArrayLike, eta: ArrayLike, /) -> NDArray[np.bool_]:
    """(...) bool, 1 − η²(1 − cos²θ) < 0: nothing gets through.

    `eta` is the index before the interface over that beyond it: n for light or an eye in water.
    The glare paper prints η = 1/n, for which it never holds: see `paper_condition`.
    """
    return 1 - np.asarray(eta) ** 2 * (1 - np.asarray(cosine) ** 2) < 0


def paper_condition(cosine: ArrayLike, index: float, /) -> NDArray[np.bool_]:
    """(...) bool: the paper's condition as printed, η = 1/n of the medium. False for all angles."""
    return total_reflection(cosine, 1 / index)
