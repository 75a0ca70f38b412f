"""What is drawn of a probe volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["PARTS", "Look", "Part", "ProbePicture"]

Part = Literal["balls", "cells", "hull", "graph", "zones"]
PARTS: tuple[Part, ...] = ("balls", "cells", "hull", "graph", "zones")


@dataclass(frozen=True)
class Look:
    """How a volume is drawn.

    Attributes
    ----------
    parts : what is drawn: ``balls`` with the probes' light, ``cells`` (edges of the tetrahedra),
        ``hull``, ``graph`` (which cell borders on which), ``zones`` (boxes).
    irradiance : balls show irradiance/π of their normals, a white surface's luminance, instead of
        the luminance that arrives from there.
    radius_m : of the balls; default: a fifth of what is usual between neighbours.
    units_per_cd_m2 : display value per cd/m², linear; default: chosen, and said in the result.
    """

    parts: tuple[Part, ...] = ("balls", "cells", "hull", "zones")
    irradiance: bool = False
    radius_m: float | None = None
    units_per_cd_m2: float | None = None


@dataclass(frozen=True, eq=False)
class ProbePicture:
    """The picture (H, W, 3) uint8, and the luminance in cd/m² of its white; NaN: no light."""

    rgb: NDArray[np.uint8]
    white_cd_m2: float
