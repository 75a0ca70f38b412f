"""The halo around an outline: a coloured ring at an angle from it, as the paper draws it.

The angle is that to the nearest point of the outline. A ring that goes round a wide source is
longer than one around a point and would hold more light; it is weakened so that the share of the
source's light that it holds stays that of a point.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.model import Outline
from andon.glare.per_source.convolution import edge_points
from andon.observer.spread.model import SpreadFunction

__all__ = ["HALO_STEPS", "HaloTable", "halo_table"]

Float = NDArray[np.float64]

HALO_STEPS = 512
# A ring ends where it is this share of its maximum.
LEAST_SHARE = 1e-5
# Angles at which the end of a ring is looked for, degrees.
LOOKED_AT = np.linspace(0, 60, 6001)


@dataclass(frozen=True, eq=False)
class HaloTable:
    """A ring over the angle from the outline.

    Attributes
    ----------
    values : (HALO_STEPS, 3) sr⁻¹ at equal steps from 0.
    end : radians of the last step; beyond it there is none.
    """

    values: Float
    end: float

    def at(self, beyond: Float, /) -> Float:
        """(..., 3) sr⁻¹ at radians (...) from the outline."""
        place = beyond / self.end * (HALO_STEPS - 1)
        first = np.clip(place.astype(np.int32), 0, HALO_STEPS - 2)
        part = (place - first)[..., None]
        value = (1 - part) * self.values[first] + part * self.values[first + 1]
        return np.where((place < HALO_STEPS - 1)[..., None], value, 0.0)

    def weakening(self, outline: Outline, /) -> Float:
        """(3,) share of a point's ring per share of the ring around a convex `outline`.

        What lies δ outside has the length P·cos δ + (2π − ω)·sin δ, of an outline of length P
        around the solid angle ω (Steiner's formula on the sphere).
        """
        delta = np.linspace(0, self.end, HALO_STEPS)
        edge = edge_points(outline)
        sides = np.linalg.norm(edge - np.roll(edge, 1, axis=0), axis=1)
        area = outline.solid_angle_sr
        around = sides.sum() * np.cos(delta) + (2 * np.pi - area) * np.sin(delta)
        return (2 * np.pi * np.sin(delta) @ self.values) / (around @ self.values)


@lru_cache(maxsize=16)
def halo_table(spread: SpreadFunction, /) -> HaloTable:
    """The ring of `spread`; raises `InputError` where it has none."""
    if spread.halo_per_sr is None:
        raise InputError("has no halo", field=f"model {spread.name}")
    ring = spread.halo_per_sr(LOOKED_AT)
    bright = np.nonzero(ring.max(axis=-1) >= LEAST_SHARE * ring.max())[0]
    end = LOOKED_AT[min(int(bright.max()) + 1, len(LOOKED_AT) - 1)]
    theta = np.linspace(0, float(end), HALO_STEPS)
    return HaloTable(spread.halo_per_sr(theta), float(np.radians(end)))
