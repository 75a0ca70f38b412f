"""The geometry of a scene at one moment, ready to be seen and to cast shadows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry, Material, merged
from andon.surface.movers import Mover
from andon.surface.occluder import Occluder
from andon.surface.placing import middle_of

__all__ = ["EMPTY_GEOMETRY", "ObjectInfo", "ShadowBias", "SurfaceModel", "states_reflectance"]

EMPTY_GEOMETRY = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))


@dataclass(frozen=True)
class ShadowBias:
    """How far receivers are lifted along their normal before shadows are looked up, at least: where
    a texel of the lamp's map is wider, it is the texel (direct.wgsl).

    Attributes
    ----------
    real_m : on the real surface: what decimation and the noise of a depth image leave between
        surface and occluder. Shadows thinner than this, at contacts, are lost.
    object_m : on virtual objects, whose occluder is the object itself: float32 rounding only.
    """

    real_m: float = 1e-3
    object_m: float = 1e-3


@dataclass(frozen=True)
class ObjectInfo:
    """A virtual object, as stages tell its pixels from others.

    Attributes
    ----------
    name : for messages.
    first_slot, slots : its materials, which no other object shares, are numbers `first_slot` to
        `first_slot` + `slots` − 1 of the G-buffer's `material_id` on virtual objects.
    triangles : how many it has.
    lit_by_probes : takes indirect light from probes, instead of E0.
    lit_by_lamps : takes direct light from lamps.
    entry : its number among the scene's objects; −1: it is none of them.
    """

    name: str
    first_slot: int
    slots: int
    triangles: int
    lit_by_probes: bool = True
    lit_by_lamps: bool = True
    entry: int = -1


@dataclass(frozen=True)
class SurfaceModel:
    """What there is to be seen.

    Attributes
    ----------
    real : the real geometry as triangles (from a mesh, or a triangulated depth image).
    depth : view name → (H, W) depth in metres of that view's own picture, NaN in holes.
    normals : view name → (H, W, 3) world normals; with `depth`, those fitted to it; alone, a
        normals-only surface, which has no positions and so takes distant lamps only.
    objects : virtual objects in the world that stand still, each with materials of its own.
    filled : view name → (H, W) bool, holes that got a depth from beside them.
    occluder : what the real geometry's shadows are cast by (decimated).
    casters : what the virtual objects' shadows are cast by.
    bias : see `ShadowBias`.
    objects_table : the virtual objects in the order of their slots, which count up from 0: first
        those of `objects`, in the order of its triangles and materials, then the `movers`.
    movers : virtual objects that move.
    notes : what a reader of files wants said to whoever looks at the picture.
    """

    real: Geometry = EMPTY_GEOMETRY
    depth: Mapping[str, NDArray[np.float64]] = field(default_factory=dict[str, NDArray[np.float64]])
    normals: Mapping[str, NDArray[np.float64]] = field(
        default_factory=dict[str, NDArray[np.float64]]
    )
    filled: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict[str, NDArray[np.bool_]])
    objects: Geometry = EMPTY_GEOMETRY
    occluder: Occluder = field(default_factory=lambda: Occluder(EMPTY_GEOMETRY, 0, 0.0))
    casters: Geometry = EMPTY_GEOMETRY
    bias: ShadowBias = field(default_factory=ShadowBias)
    objects_table: tuple[ObjectInfo, ...] = ()
    movers: tuple[Mover, ...] = ()
    notes: tuple[str, ...] = ()

    @cached_property
    def shadow_casters(self) -> Geometry:
        """All that casts shadows, real and virtual; movers where they were last."""
        moving = [mover.geometry for mover in self.movers if mover.casts_shadow]
        return merged(self.occluder.geometry, self.casters, *moving)

    @cached_property
    def object_of_slot(self) -> NDArray[np.int32]:
        """(slots,) which row of `objects_table` a material of a virtual object belongs to."""
        counts = [info.slots for info in self.objects_table]
        return np.repeat(np.arange(len(counts), dtype=np.int32), counts)

    @property
    def moving_table(self) -> tuple[ObjectInfo, ...]:
        """The rows of `objects_table` that belong to `movers`."""
        return self.objects_table[len(self.objects_table) - len(self.movers) :]

    @property
    def object_materials(self) -> tuple[Material, ...]:
        """(slots,) the materials of virtual objects."""
        drawn = [self.objects] if len(self.objects.triangles) else []
        drawn += [mover.geometry for mover in self.movers]
        return tuple(material for part in drawn for material in part.materials)

    @cached_property
    def emitted_cd_m2(self) -> NDArray[np.float64]:
        """(slots, 3) what the materials of virtual objects emit."""
        emitted = [material.emissive_cd_m2 for material in self.object_materials]
        return np.array(emitted, float).reshape(-1, 3)

    @property
    def has_objects(self) -> bool:
        """There are virtual objects."""
        return len(self.objects.triangles) > 0 or len(self.movers) > 0

    def corners_of(self, index: int, movers: Sequence[Geometry] = (), /) -> NDArray[np.float64]:
        """(triangles, 3, 3) metres: the object of row `index`, of which `movers` are the moving."""
        first = len(self.objects_table) - len(self.movers)
        if index >= first:
            moved = movers[index - first]
            return moved.positions[moved.triangles]
        counts = [info.triangles for info in self.objects_table[: index + 1]]
        own = slice(sum(counts[:-1]), sum(counts))
        return self.objects.positions[self.objects.triangles[own]]

    @cached_property
    def still_middles(self) -> NDArray[np.float64]:
        """(n, 3) metres: the middles of the bounding boxes of the objects in `objects`."""
        count = len(self.objects_table) - len(self.movers)
        middles = [middle_of(self.corners_of(index)) for index in range(count)]
        return np.array(middles, float).reshape(-1, 3)

    @property
    def is_distant_only(self) -> bool:
        """No positions are known: only directional, sky and hemisphere lamps can light it."""
        return bool(self.normals) and not self.depth and len(self.real.triangles) == 0


def states_reflectance(real: Geometry, /) -> bool:
    """The mesh has materials of its own; readers give a nameless one where a file has none."""
    return any(material.name for material in real.materials)
