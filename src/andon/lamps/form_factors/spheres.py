"""The sphere, horizon included."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from andon.lamps.form_factors.vectors import Float, dot, quotient

__all__ = ["sphere_factor"]


def sphere_factor(
    position: ArrayLike, normal: ArrayLike, centre: ArrayLike, radius: float, /
) -> Float:
    """Projected solid angle (...) in sr of a sphere seen from `position` with unit `normal`.

    Source: Lagarde & de Rousiers 2014, the sphere's form factor with its horizon.
    """
    reach = np.asarray(centre, np.float64) - np.asarray(position, np.float64)
    square = dot(reach, reach)
    distance = np.sqrt(square)
    cosine = np.clip(quotient(dot(reach, np.asarray(normal, np.float64)), distance), -1, 1)
    share = np.minimum(quotient(radius**2 * np.ones_like(square), square), 1)
    share = np.where(square <= radius**2, 1.0, share)
    whole = np.pi * share * np.maximum(cosine, 0)
    return np.where(cosine**2 > share, whole, np.clip(_cut(cosine, share), 0, np.pi))


def _cut(cosine: Float, share: Float) -> Float:
    """The sphere astride the horizon; `share` is sin² of its angular radius."""
    sine = np.sqrt(1 - cosine**2)
    # cot σ·cot θ, −1 where the sphere touches the horizon from above
    across = np.sqrt(1 - share) * cosine
    edge = np.clip(-quotient(across, np.sqrt(share) * sine), -1, 1)
    half = sine * np.sqrt(1 - edge**2)
    x = np.sqrt(1 - share) / np.sqrt(share)
    return share * cosine * np.arccos(edge) + (np.arctan2(half, x) - x * share * half)
