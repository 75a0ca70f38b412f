"""Lamps with an area: Lambertian emitters of one luminance, or of one for each triangle."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from andon.lamps.model import Shadow

__all__ = ["AreaLamp", "DiskLamp", "MeshLamp", "PolygonLamp", "SphereLamp", "TubeLamp"]

Float = NDArray[np.float64]

# Points on an area lamp from which its shadow is looked at, and the maps that they see. In the
# furnished room 16 samples with 512² texels err by 4 % of the light (RMS), 256² by 8 %, 1024² by
# 3 %, rays from the same points by 1 %; a pair of maps takes 2 MB.
SOFT_SHADOW = Shadow(map_size=512, samples=16, near_m=0.002)


@dataclass(frozen=True)
class AreaLamp:
    """What all area lamps share.

    Attributes
    ----------
    name : unique in the scene.
    luminance_cd_m2 : (3,) cd/m² per channel, the same in all directions.
    shadow : None for a lamp that casts none.
    drawn : the area is seen in the picture.
    body : name of the `Body` whose light this is, which it does not fall on; "": none.
    owner : name of the scene's lamp that this is a part of; "": none.
    """

    name: str
    luminance_cd_m2: Float
    shadow: Shadow | None = field(default=SOFT_SHADOW, kw_only=True)
    drawn: bool = field(default=True, kw_only=True)
    body: str = field(default="", kw_only=True)
    owner: str = field(default="", kw_only=True)


@dataclass(frozen=True)
class SphereLamp(AreaLamp):
    """A glowing ball.

    Attributes
    ----------
    position_m : (3,) metres, its centre.
    radius_m : > 0.
    glass_m : as of a `PointLamp`.
    """

    position_m: Float
    radius_m: float
    glass_m: float = field(default=0.0, kw_only=True)


@dataclass(frozen=True)
class DiskLamp(AreaLamp):
    """A flat round lamp.

    Attributes
    ----------
    position_m : (3,) metres, its centre.
    direction : (3,) unit, normal of the emitting side.
    radius_m : > 0.
    two_sided : emits to both sides.
    """

    position_m: Float
    direction: Float
    radius_m: float
    two_sided: bool = False


@dataclass(frozen=True)
class PolygonLamp(AreaLamp):
    """A flat polygon.

    Attributes
    ----------
    vertices_m : (k, 3) metres, k ≥ 3, counter-clockwise as seen from the emitting side.
    two_sided : emits to both sides.
    texture : (h, w, 3) factors on the luminance, mean 1, or None; of a rectangle only: row 0 runs
        from vertex 3 to vertex 2 (the top), the last row from vertex 0 to vertex 1.
    """

    vertices_m: Float
    two_sided: bool = False
    texture: Float | None = None


@dataclass(frozen=True)
class TubeLamp(AreaLamp):
    """A capsule: all points near a line.

    Attributes
    ----------
    ends_m : (2, 3) metres, both ends of the line.
    radius_m : > 0, how near.
    """

    ends_m: Float
    radius_m: float


@dataclass(frozen=True)
class MeshLamp(AreaLamp):
    """Triangles that emit to the side on which they run counter-clockwise.

    Its facets do not hide one another: exact for convex meshes.

    Attributes
    ----------
    positions_m : (n, 3) metres, world.
    triangles : (m, 3) int32.
    facet_luminance_cd_m2 : (m, 3) cd/m² of each triangle; None: `luminance_cd_m2` for all.
    facet_groups : (m,) facets of one number shine alike at all times; None: facets with
        luminances of their own never do.
    """

    positions_m: Float
    triangles: NDArray[np.int32]
    facet_luminance_cd_m2: Float | None = None
    facet_groups: NDArray[np.int32] | None = None
