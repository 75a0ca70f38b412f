"""A scene as Radiance is told it: `radiance_bundle` writes the files, `rtrace` computes from them.

::

    parts, lamps, bodies ──radiance_bundle──▶ surfaces.rad, *.cal, *.dat, *.hdr, *.rtm
                                              lamps.rad, scene.oct; bounce.rad, bounce.oct

Three sorts of thing have to be said in another's terms: surfaces, lamps, and lamps in shells.

=================== ================================== ======================================
choice              taken                              instead of
=================== ================================== ======================================
surfaces            *plastic* without specularity:     mirrors and gloss: an illuminance map
                    ρ·E/π, both sides                  holds what is diffuse, as in the paper
textures            mesh and picture, bilinear,        one reflectance for each triangle
                    repeated as glTF's
what emits          *glow*, beside *plastic* in a      *light*: every triangle would be
                    mixture; off for maps of lamps     aimed at, and would reflect nothing
point lamps         balls of 0.1 mm, the distribution   Radiance's spotlight (hard edge) and
                    as function or data                ies2rad (six digits, no type A)
area lamps          flat tiles, one ray to the         Radiance's own large balls, which have
                    middle of each                     no horizon
shells              black outside of tiles; light      a *trans* paper whose bounces rtrace
                    inside is the lamps' own balance   would have to find through the openings
skies               *glow* at infinity, hidden by      our direct engine's sky, which nothing
                    what stands before it              hides
=================== ================================== ======================================

The direct light of all of them but skies is `andon.transport.direct`'s within 1 % (median), which
the tests hold; so a map of the bounces alone (ab N less ab 0) fits that engine's light.

Sources: the Radiance reference manual (Ward, *The RADIANCE 4.0 Synthetic Imaging System*);
the relighting paper, section 2.4, for diffuse surfaces and one map for each lamp.
"""

from __future__ import annotations

from andon.transport.baked.radiance.bodies import unsaid
from andon.transport.baked.radiance.lamps import is_distant_glow
from andon.transport.baked.radiance.painted import with_triangle_reflectance
from andon.transport.baked.radiance.scene import OCTREE, radiance_bundle

__all__ = [
    "OCTREE",
    "is_distant_glow",
    "radiance_bundle",
    "unsaid",
    "with_triangle_reflectance",
]
