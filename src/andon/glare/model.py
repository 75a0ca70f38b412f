"""Sources of glare as the eye sees them: where, how much light, which outline.

::

        right ─▶ φ = 0            φ grows from `right` towards `down` = direction × right.
       ╱                          θ0(φ): angle from `direction` to the outline.
   direction
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["Outline", "Source", "right_of"]

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Outline:
    """Edge of a source of uniform luminance: θ0 over φ.

    Attributes
    ----------
    radii_radians : (n,) θ0 > 0 at φ = 2π·i/n, between them linear in φ; n = 1 is a circle.
    name : ``circle``, ``ellipse``, …
    """

    radii_radians: Float
    name: str = "circle"

    def __post_init__(self) -> None:
        radii = np.asarray(self.radii_radians, np.float64)
        if radii.ndim != 1 or not len(radii) or not np.all((radii > 0) & (radii < np.pi / 2)):
            raise InputError("radii must be in (0, π/2)", field="outline.radii_radians")
        object.__setattr__(self, "radii_radians", radii)

    def radius(self, phi_radians: NDArray[np.float64], /) -> Float:
        """(...) θ0 at azimuths φ (...), radians."""
        count = len(self.radii_radians)
        place = np.mod(np.asarray(phi_radians) / (2 * np.pi) * count, count)
        first = np.floor(place).astype(int) % count
        part = place - np.floor(place)
        return (1 - part) * self.radii_radians[first] + part * self.radii_radians[
            (first + 1) % count
        ]

    @cached_property
    def solid_angle_sr(self) -> float:
        """Of the inside: the mean over φ of 2π(1 − cos θ0)."""
        phi = (np.arange(720, dtype=np.float64) + 0.5) * (np.pi / 360)
        return float(np.mean(2 * np.pi * (1 - np.cos(self.radius(phi)))))


def right_of(direction: Float, /) -> Float:
    """(3,) unit vector perpendicular to `direction`: camera +x turned into its plane."""
    axis = np.array([1.0, 0, 0]) if abs(direction[0]) < 0.999 else np.array([0.0, 0, 1])
    right = axis - axis @ direction * direction
    return right / np.linalg.norm(right)


@dataclass(frozen=True, eq=False)
class Source:
    """One source, seen by one eye.

    Attributes
    ----------
    direction : (3,) unit, camera frame (x right, y down, z forward).
    illuminance_lux : (3,) at the eye on a plane that faces the source: ∫ L dω.
    outline : its edge about `direction`.
    right : (3,) unit, perpendicular to `direction`, where φ = 0.
    name : of the lamp, or where it was found.
    clipped : the picture ended at its sensor's white there; the source is brighter than stated.
    """

    direction: Float
    illuminance_lux: Float
    outline: Outline = field(default_factory=lambda: Outline(np.array([np.radians(0.05)])))
    right: Float | None = None
    name: str = ""
    clipped: bool = False

    @property
    def axes(self) -> tuple[Float, Float]:
        """(right, down), each (3,)."""
        right = right_of(self.direction) if self.right is None else self.right
        return right, np.cross(self.direction, right)

    @property
    def luminance_cd_m2(self) -> Float:
        """(3,) mean over the outline."""
        return self.illuminance_lux / self.outline.solid_angle_sr

    def rounded(self) -> Source:
        """The same with a circle of the same solid angle as outline."""
        radius = 2 * np.arcsin(np.sqrt(self.outline.solid_angle_sr / (4 * np.pi)))
        return replace(self, outline=Outline(np.array([radius])))
