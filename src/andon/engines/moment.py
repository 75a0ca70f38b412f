"""What a scene is at one time: all that moves, settled once for both eyes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Focus
from andon.lamps import Body, Lamp
from andon.quantities import Geometry

__all__ = ["Moment"]


@dataclass(frozen=True)
class Moment:
    """The moving part of a scene at one time.

    Attributes
    ----------
    time_seconds : since the start of the session.
    lamps : always the same names and kinds.
    direct_lamps : those of them whose direct light is computed; of the others it is baked.
    bodies : luminous bodies; always the same names and triangles.
    movers : virtual objects that move, in the order of `SurfaceModel.movers`; always the same
        triangles and materials.
    focus : what the eyes are focused on; None: everything.
    object_middles : (n, 3) metres, world: the middle of the bounding box of each virtual object,
        in the order of `SurfaceModel.objects_table`.
    """

    time_seconds: float = 0.0
    lamps: tuple[Lamp, ...] = ()
    bodies: tuple[Body, ...] = ()
    movers: tuple[Geometry, ...] = ()
    object_middles: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    focus: Focus | None = None
    direct_lamps: tuple[Lamp, ...] = ()
