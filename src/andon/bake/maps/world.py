"""What a bake is of: what stands there and what is seen at each moment, and which lamps shine.

==================  =====================  ====================================
thing               Radiance is told of it maps see it
==================  =====================  ====================================
real surface        yes                    yes
virtual objects     those that cast        yes
                    shadows
bodies of lamps     yes; dark but for      no: what they hide may be seen
                    their own lamp         from elsewhere
==================  =====================  ====================================

What surfaces emit by themselves lights nothing: baked light is that of lamps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.engines.cubes import photograph_of
from andon.engines.prepared import Prepared
from andon.errors import InputError
from andon.lamps import Body, Lamp, resolve_bodies, resolve_lamps
from andon.quantities import Geometry, Surface
from andon.scene import Scene
from andon.spaces import View
from andon.surface import reference as surface
from andon.surface.model import ObjectInfo, SurfaceModel, states_reflectance
from andon.surface.objects import joined
from andon.transport.baked.radiance.painted import with_triangle_reflectance

__all__ = ["MOST_REFLECTANCE", "BakedWorld"]

Float = NDArray[np.float64]

# Of what a photograph shows. What looks brighter than that in E0 shines by itself or mirrors; as a
# diffuse surface it would pass on more light than it gets.
MOST_REFLECTANCE = 0.95


@dataclass(frozen=True, eq=False)
class _Still:
    """What stands still: all of it, and what of it Radiance is told."""

    seen: tuple[Geometry, ...]
    told: tuple[Geometry, ...]


class BakedWorld:
    """A scene as bakes of maps see it.

    Parameters
    ----------
    scene : has a [baked] table.
    prepared : of the steady scene (``drawn=False``).

    Raises `InputError` where nothing has a place.
    """

    def __init__(self, scene: Scene, prepared: Prepared, /) -> None:
        self.scene, self.prepared = scene.steady(), prepared
        model = prepared.surface
        if model.is_distant_only:
            raise InputError(
                "has no positions, and maps are projected from places",
                file=scene.file,
                field="surface.normals",
                remedy="give a depth or a mesh",
            )
        self._still = _Still(
            tuple(part for part in (model.real, model.objects) if len(part.triangles)),
            tuple(part for part in (self._real(), self._casting()) if len(part.triangles)),
        )
        self._seen: dict[str, Surface] = {}

    @property
    def still(self) -> tuple[Geometry, ...]:
        """What Radiance is told of surfaces that stand still."""
        return self._still.told

    def moving(self, time_seconds: float, /) -> tuple[Geometry, ...]:
        """What Radiance is told of surfaces that move."""
        movers = self.prepared.surface.movers
        return tuple(mover.at(time_seconds) for mover in movers if mover.casts_shadow)

    def parts(self, time_seconds: float, /) -> tuple[Geometry, ...]:
        """What Radiance is told of surfaces at a time."""
        return (*self._still.told, *self.moving(time_seconds))

    def visible(self, time_seconds: float, /) -> Geometry:
        """All triangles that maps may see at a time. Raises `InputError` where there are none."""
        moving = [mover.at(time_seconds) for mover in self.prepared.surface.movers]
        parts = [*self._still.seen, *moving]
        if not parts:
            raise InputError(
                "there is nothing that light could fall on",
                file=self.scene.file,
                field="surface",
                remedy="add surface.mesh, or an [[object]]",
            )
        return joined(parts)

    def lamps(self, time_seconds: float, /) -> Mapping[str, tuple[Lamp, ...]]:
        """Name of each baked lamp → the lamps that it consists of at a time."""
        assert self.scene.baked is not None
        every = resolve_lamps(self.scene, time_seconds)
        return {
            name: tuple(lamp for lamp in every if lamp.owner == name)
            for name in self.scene.baked.lamps
        }

    def bodies(self, time_seconds: float, /) -> tuple[Body, ...]:
        """All luminous bodies at a time; those of other lamps as well."""
        return resolve_bodies(self.scene, time_seconds)

    def seen(self, view: View, time_seconds: float, /) -> Surface:
        """What a map sees at a time."""
        model = self.prepared.surface
        if view.name not in self._seen:
            self._seen[view.name] = surface.see(model, view)
        moving = tuple(mover.at(time_seconds) for mover in model.movers)
        return surface.with_movers(self._seen[view.name], model, moving)

    def _real(self) -> Geometry:
        """The real surface with its reflectance: its materials', or the photograph's."""
        real = self.prepared.surface.real
        if not len(real.triangles) or not self.prepared.frames or states_reflectance(real):
            return real
        middles = real.positions[real.triangles].mean(axis=1)
        shown = photograph_of(self.prepared).at(middles).reflectance
        return with_triangle_reflectance(real, np.clip(shown, 0, MOST_REFLECTANCE))

    def _casting(self) -> Geometry:
        """The virtual objects that stand still, without those that cast no shadows."""
        model = self.prepared.surface
        rows = _still_rows(model)
        keeps = [row.entry < 0 or self.scene.object[row.entry].casts_shadow for row in rows]
        if all(keeps):
            return model.objects
        kept = np.repeat(keeps, [row.triangles for row in rows])
        ids = model.objects.material_ids
        return replace(
            model.objects,
            triangles=model.objects.triangles[kept],
            material_ids=None if ids is None else ids[kept],
        )


def _still_rows(model: SurfaceModel) -> tuple[ObjectInfo, ...]:
    return model.objects_table[: len(model.objects_table) - len(model.movers)]
