"""Baked light: illuminance maps of Radiance on the surfaces of a frame, wherever its camera is.

What
    A map holds what a camera of the bake saw: depth, normal, and lux of each lamp. A point of the
    frame is projected into every map; the four texels around it count if their surface is the
    point's; maps that see it are blended, or the first one is taken, as in the relighting paper
    (section 2.3). What no map sees is counted (`BakedSeen`) and gets no light, but along rims of
    a pixel or two, which take that of what lies beside them in the picture (`rims`).
Is it the same surface?
    The paper compares depths: |depth in the map − stored| < ε. On a floor at a slant neighbouring
    texels differ by more than any useful ε, and in a corner both walls have the same depth. Here
    a texel counts if the point lies in the texel's *tangent plane*, within `depth_tolerance_m`, and
    the normals agree: fully up to 30°, not at all from 60° on. Held against each other on a floor
    3…9 m away, seen from 0.8 m above, and within 2 cm of the corner of a lit floor and a dark wall:

    ================  ================================  =====================================
    rule              floor: points that are accepted   corner: points with the other's light
    ================  ================================  =====================================
    depth, ε = 2 cm   33 %                              13 %
    depth, ε = 10 cm  89 %                              14 %
    tangent planes    100 %                             0 %
    ================  ================================  =====================================

Why the texel's plane and not the point's
    They are one on flat surfaces and differ by the same second order on curved ones. A texel's
    plane is one number, its distance from the map's camera, and testing it one product; a texel's
    place would have to be made from its depth by the map's projection, four times a pixel.
Thin walls, things before walls
    The sides of a wall of 1 cm lie within the tolerance; their normals are opposite. What stands
    before a wall by more than the tolerance gives it no light, nor has the wall a value behind it.
    A picture frame of 1 cm on a wall may, along its edges, take a texel of the wall's light.
Blending
    A map counts by its texels per square metre of the surface (cos of the angle of view · f²/d², in
    the direction where they lie farthest apart), so the one that resolves best. Weights fall to 0
    over 24 texels towards a map's border, 12 towards the edges of what it sees, by the fourth
    power: maps that disagree by 10 % meet with steps below 1 % of the light in 2 mm. A map that
    alone sees a point counts, however little.
Instead of what
    Textures of lux on the surface itself need an atlas of every mesh, and a real room is a depth
    image. Blending in the picture (Debevec's view-dependent textures) by angles to the *viewer*
    serves gloss; illuminance has no view. Volumes of probes hold soft light, not the shadow edges
    of a lantern's frame.
Time
    Between two moments the mean by time; where only one is valid, since something moved, that one.
    Lamps are kept apart, so that each flickers by itself.
Two engines
    `reference` in NumPy; `stage` on the GPU: one fragment pass over all maps. A texel is one read
    of 16 bytes: plane, trust, normal as 3 × snorm16, lux as 3 half floats. Maps of all sizes share
    pages of one texture; lamps are added up into it when a share changes.

Errors of maps without errors of their own: second order in the texels where light is smooth (a
quarter for twice the texels: median 7·10⁻⁴, 2·10⁻⁴, 4·10⁻⁵ of a room's light with 64, 128, 256
texels across 86°); first order within a texel of creases and shadow edges.

Sources: the relighting paper, section 2.3; Debevec, Yu & Borshukov 1998 (projected, view-dependent
textures, feathered by visibility); Williams 1978 (depth compared with a map's).
"""

from __future__ import annotations

from andon.transport.baked.model import BakedLight, BakedMoment, IlluminanceMap
from andon.transport.baked.reference import baked_illuminance, illuminance_at

__all__ = ["BakedLight", "BakedMoment", "IlluminanceMap", "baked_illuminance", "illuminance_at"]
