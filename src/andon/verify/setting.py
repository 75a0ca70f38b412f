"""The furnished room as a `Prepared` frame: the same lamps and view for rows and benchmarks."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.prepared import Prepared
from andon.lamps import Lamp, PointLamp, Shadow
from andon.quantities import CameraFrame, Geometry
from andon.spaces import View
from andon.surface.load import surface_of_mesh
from andon.verify.rooms import camera_in, furnished_room, lamps_in

__all__ = ["prepared_of", "room", "room_lamps", "room_setting"]

# What the room is photographed in, so that lamps of 20 to 120 cd matter.
AMBIENT_LUX = 100.0


@cache
def room() -> Geometry:
    """The furnished room, 12,000 triangles and a few."""
    return furnished_room()


def room_lamps(count: int, shadow: Shadow | None = None) -> tuple[PointLamp, ...]:
    """`count` (1…16) point lamps in free air of the room."""
    shadow = shadow or Shadow(filter="none")
    return tuple(
        PointLamp(f"lamp-{index}", lamp.position, lamp.intensity_rgb_cd, shadow)
        for index, lamp in enumerate(lamps_in(room(), count))
    )


def prepared_of(geometry: Geometry, view: View, lamps: tuple[Lamp, ...]) -> Prepared:
    """Triangles, a view and lamps, with a grey photograph in front of them."""
    grey: NDArray[np.float32] = np.full((*view.shape, 3), 0.3, np.float32)
    return Prepared(
        frames={view.name: CameraFrame(grey, view, luminance_per_unit=AMBIENT_LUX / np.pi)},
        surface=surface_of_mesh(geometry, view.position),
        ambient=Ambient(np.full(3, AMBIENT_LUX)),
        lamps=lambda _: lamps,
    )


def room_setting(lamp_count: int, width: int = 1280, height: int = 720) -> Prepared:
    """The room, its camera and `lamp_count` shadowed lamps."""
    return prepared_of(room(), camera_in(room(), width, height), room_lamps(lamp_count))
