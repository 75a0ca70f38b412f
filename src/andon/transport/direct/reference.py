"""Direct illuminance in float64, shadows by rays: the truth that the shaders are held against."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.lamps import (
    DirectionalLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    SkyLamp,
    intensity_cd,
)
from andon.quantities import Surface
from andon.rays import RayScene

__all__ = ["illuminance", "illuminate", "visibility"]

Float = NDArray[np.float64]


def illuminance(lamp: Lamp, position: Float, normal: Float, /) -> Float:
    """Unshadowed illuminance (..., 3) in lux at `position` (..., 3) with unit `normal` (..., 3).

    Source: the relighting paper, equation (1), with I(ω) of `intensity_cd`.
    """
    match lamp:
        case PointLamp():  # and spots and luminaires, which are points with an I(ω)
            return _from_a_place(lamp, position, normal)
        case DirectionalLamp():
            cosine = -normal @ lamp.direction
            return np.maximum(cosine, 0)[..., None] * lamp.illuminance_lux
        case SkyLamp():
            # A dome of luminance E/π seen by a surface tilted by θ: E·(1 + cos θ)/2.
            return (0.5 + 0.5 * (normal @ lamp.up))[..., None] * lamp.illuminance_lux
        case HemisphereLamp():
            sky = (0.5 + 0.5 * (normal @ lamp.up))[..., None]
            return sky * lamp.sky_illuminance_lux + (1 - sky) * lamp.ground_illuminance_lux


def _from_a_place(lamp: PointLamp, position: Float, normal: Float) -> Float:
    reach = lamp.position_m - position
    square = np.einsum("...i,...i->...", reach, reach)
    cosine_over_square = np.einsum("...i,...i->...", reach, normal) / square**1.5
    factor = np.maximum(cosine_over_square, 0)
    return factor[..., None] * intensity_cd(lamp, -reach / np.sqrt(square)[..., None])


def visibility(lamp: Lamp, points: Float, casters: RayScene, /) -> NDArray[np.bool_]:
    """(n,) bool: the lamp is seen from `points` (n, 3), already lifted off their surface.

    Sky and hemisphere lamps are ambient: they cast no shadow.
    """
    if isinstance(lamp, SkyLamp | HemisphereLamp) or lamp.shadow is None:
        return np.ones(len(points), bool)
    if isinstance(lamp, DirectionalLamp):
        return casters.sees_infinity(points, -lamp.direction)
    return casters.is_visible(points, lamp.position_m)


def illuminate(
    surface: Surface, lamps: Sequence[Lamp], casters: RayScene, /, *, bias_m: NDArray[np.float64]
) -> Float:
    """Illuminance (H, W, 3) in lux that `lamps` add to `surface`; 0 in holes.

    Parameters
    ----------
    casters : what casts shadows.
    bias_m : (H, W) lift along the normal before a shadow ray starts, metres.
    """
    total = np.zeros((*surface.view.shape, 3))
    mask = surface.valid
    position, normal = surface.position[mask], surface.normal[mask]
    lifted = position + normal * bias_m[mask][:, None]
    added = np.zeros_like(position)
    for lamp in lamps:
        light = illuminance(lamp, position, normal)
        lit = light.max(axis=-1) > 0
        light[lit] *= visibility(lamp, lifted[lit], casters)[:, None]
        added += light
    total[mask] = added
    return total
