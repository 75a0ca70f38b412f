"""A shell as physics wants it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Geometry

__all__ = ["KEPT", "Drum", "Shell"]

Float = NDArray[np.float64]

# How many shells, and what they are made from, are kept ready: far more than scenes have, because
# of one more than are kept, visited in turn, none would be found.
KEPT = 128
# Sums of shares may exceed 1 by rounding only.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Drum:
    """A cylinder or cone about the upright (+Y) through the lamp, open above and below.

    Attributes
    ----------
    radius_m, top_radius_m : of the lower and the upper rim, > 0.
    height_m : from rim to rim, > 0.
    drop_m : how far the lower rim is below the lamp, between 0 and `height_m`.
    """

    radius_m: float
    top_radius_m: float
    height_m: float
    drop_m: float

    def __post_init__(self) -> None:
        for name in ("radius_m", "top_radius_m", "height_m"):
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(
                    f"must be > 0 m, got {getattr(self, name):g}", field=f"shell.drum.{name}"
                )
        if not 0 < self.drop_m < self.height_m:
            raise InputError(
                f"must be between 0 and height_m, {self.height_m:g} m, got {self.drop_m:g}",
                field="shell.drum.drop_m",
                remedy="the lamp is inside its shade",
            )


@dataclass(frozen=True, eq=False)
class Shell:
    """A translucent layer around a lamp; it moves with the lamp.

    Compared by identity: what is computed from a shell is kept for as long as *this* shell is
    used, wherever its lamp goes.

    Attributes
    ----------
    radius_m : radius of a sphere around the lamp, or None.
    mesh : one layer of triangles in metres, world axes; its origin is where the lamp is. Or None.
    drum : a lampshade open above and below, or None.
    transmittance : (3,) net t in [0, 1]: share of the light that meets the shell and leaves
        through it, interreflection included.
    absorptance : share of that light that is lost, t + absorptance ≤ 1. What is left leaves
        through the openings; where there are none, it is absorbed too.
    mode : ``exact`` area lamps and an energy balance; ``paper`` the source paper's point lamps.
    real : the shell is a real thing of the photograph, see `andon.lamps.bodies.Body`.
    margin_m : how near the real surface is to it where it is the shell; None: see `Body`.
    """

    radius_m: float | None = None
    mesh: Geometry | None = None
    transmittance: Float = field(default_factory=lambda: np.full(3, 0.5))
    absorptance: float = 0.0
    mode: Literal["exact", "paper"] = "exact"
    drum: Drum | None = None
    real: bool = False
    margin_m: float | None = None

    def __post_init__(self) -> None:
        if sum(form is not None for form in (self.radius_m, self.mesh, self.drum)) != 1:
            raise InputError("exactly one of radius_m, mesh, drum is allowed", field="shell")
        if self.margin_m is not None and not 0 < self.margin_m < np.inf:
            raise InputError(f"must be > 0 m, got {self.margin_m:g}", field="shell.margin_m")
        if self.radius_m is not None and not 0 < self.radius_m < np.inf:
            raise InputError(f"must be > 0 m, got {self.radius_m:g}", field="shell.radius_m")
        t = np.broadcast_to(np.asarray(self.transmittance, np.float64), 3)
        object.__setattr__(self, "transmittance", t)
        if not ((t >= 0).all() and self.absorptance >= 0):
            raise InputError(
                f"transmittance and absorptance must be ≥ 0, got {t.tolist()} and "
                f"{self.absorptance:g}",
                field="shell.transmittance",
            )
        if not t.max() + self.absorptance <= 1 + ROUNDING:
            raise InputError(
                f"absorptance + transmittance must be ≤ 1, got {t.max() + self.absorptance:g}",
                field="shell.absorptance",
            )

    @property
    def reflectance(self) -> tuple[float, float, float]:
        """(3,) what is neither let through nor absorbed, for the light of other lamps."""
        r, g, b = np.clip(1 - self.transmittance - self.absorptance, 0, 1).tolist()
        return r, g, b
