"""The geometry of a scene at one moment, ready to be seen and to cast shadows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry, merged
from andon.surface.occluder import Occluder

__all__ = ["EMPTY_GEOMETRY", "ShadowBias", "SurfaceModel"]

EMPTY_GEOMETRY = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))


@dataclass(frozen=True)
class ShadowBias:
    """How far receivers are lifted along their normal before shadows are looked up.

    Attributes
    ----------
    real_m : on the real surface: what decimation and the noise of a depth image leave between
        surface and occluder. Shadows thinner than this, at contacts, are lost.
    object_m : on virtual objects, whose occluder is the object itself: float32 rounding only.
    """

    real_m: float = 1e-3
    object_m: float = 1e-3


@dataclass(frozen=True)
class SurfaceModel:
    """What there is to be seen.

    Attributes
    ----------
    real : the real geometry as triangles (from a mesh, or a triangulated depth image).
    depth : view name → (H, W) depth in metres of that view's own picture, NaN in holes.
    normals : view name → (H, W, 3) world normals; with `depth`, those fitted to it; alone, a
        normals-only surface, which has no positions and so takes distant lamps only.
    objects : virtual objects in the world.
    occluder : what the real geometry's shadows are cast by (decimated).
    casters : what the virtual objects' shadows are cast by.
    bias : see `ShadowBias`.
    object_triangles : name of each virtual object and how many of `objects.triangles` are its own,
        in their order.
    notes : what a reader of files wants said to whoever looks at the picture.
    """

    real: Geometry = EMPTY_GEOMETRY
    depth: Mapping[str, NDArray[np.float64]] = field(default_factory=dict[str, NDArray[np.float64]])
    normals: Mapping[str, NDArray[np.float64]] = field(
        default_factory=dict[str, NDArray[np.float64]]
    )
    objects: Geometry = EMPTY_GEOMETRY
    occluder: Occluder = field(default_factory=lambda: Occluder(EMPTY_GEOMETRY, 0, 0.0))
    casters: Geometry = EMPTY_GEOMETRY
    bias: ShadowBias = field(default_factory=ShadowBias)
    object_triangles: tuple[tuple[str, int], ...] = ()
    notes: tuple[str, ...] = ()

    @cached_property
    def shadow_casters(self) -> Geometry:
        """All that casts shadows, real and virtual."""
        return merged(self.occluder.geometry, self.casters)

    @property
    def is_distant_only(self) -> bool:
        """No positions are known: only directional, sky and hemisphere lamps can light it."""
        return bool(self.normals) and not self.depth and len(self.real.triangles) == 0
