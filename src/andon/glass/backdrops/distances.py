"""How far rays go to a backdrop of simple form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Backdrop

__all__ = ["plane_axes", "plane_distance", "sphere_distance"]

Float = NDArray[np.float64]


def plane_axes(backdrop: Backdrop, /) -> Float:
    """(2, 3): a place on the plane of kind ``texture`` times these is (±1, ±1) at its corners."""
    return np.stack([v / (v @ v) for v in (backdrop.right_m, backdrop.up_m)])


def plane_distance(backdrop: Backdrop, origins: Float, directions: Float, /) -> Float:
    """(n,) metres along unit `directions` (n, 3) to the plane of kind ``texture``, without end.

    At most 0 where it lies behind `origins` (n, 3); infinite or NaN along it.
    """
    normal = np.cross(*plane_axes(backdrop))
    with np.errstate(divide="ignore", invalid="ignore"):
        return ((backdrop.centre_m - origins) @ normal) / (directions @ normal)


def sphere_distance(radius_m: float, eye: Float, origins: Float, directions: Float, /) -> Float:
    """(n,) metres along unit `directions` (n, 3) to where rays leave the sphere around `eye` (3,).

    Infinite where it passes beside the sphere, or has left it.
    """
    from_eye = origins - eye
    along = np.einsum("ni,ni->n", from_eye, directions)
    # The nearest point to the eye, as a vector: |e|² − along² has no digits left far away.
    across = from_eye - along[:, None] * directions
    half = radius_m * radius_m - np.einsum("ni,ni->n", across, across)
    distance = np.sqrt(np.maximum(half, 0)) - along
    return np.where((half > 0) & (distance > 0), distance, np.inf)
