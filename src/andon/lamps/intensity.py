"""I(ω): the luminous intensity of a lamp with a place, for whoever asks how bright it is where.

Illuminance asks with the direction to a surface, the picture of the lamp with the direction to
the eye; both get their answer here, so that they cannot disagree.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.distributions import spot_attenuation
from andon.lamps.goniometry import candela, maximum_cd
from andon.lamps.model import GoniometricLamp, PointLamp, SpotLamp

__all__ = ["intensity_cd", "luminaire_axes", "luminaire_from_world"]

Float = NDArray[np.float64]


def intensity_cd(lamp: PointLamp, directions: Float, /) -> Float:
    """Intensity (..., 3) in cd per channel towards unit `directions` (..., 3), world, off the lamp.

    Constant for a point, glTF's cone for a spot, the measured distribution for a luminaire.
    """
    if isinstance(lamp, SpotLamp):
        share = spot_attenuation(
            directions @ lamp.direction,
            inner_radians=lamp.inner_radians,
            outer_radians=lamp.outer_radians,
        )
    elif isinstance(lamp, GoniometricLamp):
        local = directions @ luminaire_from_world(lamp).T
        share = candela(lamp.distribution, local) / maximum_cd(lamp.distribution)
    else:
        share = np.ones(np.shape(directions)[:-1])
    return share[..., None] * lamp.intensity_cd


def luminaire_from_world(lamp: GoniometricLamp, /) -> Float:
    """(3, 3) rotation into the luminaire's frame: rows C = 0, C = 90, and up (see goniometry)."""
    return luminaire_axes(lamp.right, lamp.direction)


def luminaire_axes(right: Float, direction: Float, /) -> Float:
    """(3, 3) rotation into the frame of a luminaire whose C = 0 is `right`, nadir `direction`."""
    return np.stack([right, np.cross(right, direction), -direction])
