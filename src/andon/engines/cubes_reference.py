"""Cube maps by rays: all six faces at once, the ray scenes built once for all places."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.engines.cubes import CubeSetting
from andon.harmonics import cube_directions
from andon.quantities import Surface
from andon.rays import RayScene
from andon.spaces import View
from andon.surface import reference as surface
from andon.transport.direct import reference as direct
from andon.transport.direct.casters import ShadowRays
from andon.transport.probes.capture import Seen

__all__ = ["ReferenceCubes"]

Float = NDArray[np.float64]


class ReferenceCubes:
    """Looks around from places, in float64."""

    name = "reference"
    adapter = "CPU (NumPy, Embree)"

    def __init__(self, setting: CubeSetting, size: int) -> None:
        self.setting, self.size = setting, size
        self._real = RayScene(setting.surface.real)
        self._objects = RayScene(setting.surface.objects)
        self._shadows = ShadowRays(setting.prepared.casters(setting.moment))
        # One tall picture of six faces.
        self._directions = cube_directions(size).reshape(6 * size, size, 3)

    def look(self, position: Float, /, *, lit: bool = True) -> tuple[Seen, Float | None]:
        """See `CubeEngine`."""
        pose = np.eye(4)
        pose[:3, 3] = position
        # Its directions are never asked for; of this kind of view the depth is the distance.
        view = View("latlong", self.size, 6 * self.size, world_from_camera=pose)
        met = surface.trace_rays(self._real, view, self._directions, is_object=False)
        if len(self._objects.geometry.triangles):
            virtual = surface.trace_rays(self._objects, view, self._directions, is_object=True)
            met = surface.nearest(met, virtual)
        lux = self._lux(met) if lit else None
        return self._seen(met), lux

    def _lux(self, met: Surface) -> Float:
        bias = self.setting.prepared.surface.bias
        bias_m: Float = np.where(met.is_object, bias.object_m, bias.real_m)
        lux = direct.illuminate(met, self.setting.lamps, self._shadows, bias_m=bias_m)
        return self._cube(lux)

    def _seen(self, met: Surface) -> Seen:
        distance = np.where(met.valid, met.depth, np.inf)
        return Seen(
            self._cube(met.position),
            self._cube(met.normal),
            self._cube(distance),
            self._cube(met.is_object & met.valid),
            self._cube(met.reflectance),
            self._cube(met.emitted_cd_m2),
        )

    def _cube(self, picture: NDArray[Any]) -> NDArray[Any]:
        return picture.reshape(6, self.size, self.size, *picture.shape[2:])
