"""Illuminance maps of a scene, made once by Radiance.

What
    `bake_maps` fills the folder that a scene's [baked] table names; `plan_maps` says what it would
    do. One task for each lamp, camera and moment computes the light of that lamp, direct and
    reflected, on the surface that the camera sees then; one for each camera and moment keeps what
    it sees. Frames project these maps onto what they see (`andon.transport.baked`).
Why a task for each lamp
    Light adds. A lamp that changes is computed again and no other, flicker is a factor on one
    lamp's maps, and each lamp may be baked as a whole or for its reflected light alone.
Why maps of illuminance, not pictures
    A picture is ρ·E/π of one place's colours; illuminance varies slowly, holds on any texture, and
    is what relighting adds. It is asked for at points (`rtrace -I`), not rendered.
What maps do not have
    Flicker (frames multiply it in), light of what is no lamp (E0, things that emit), and the
    direct light of lamps of transport ``direct+bounce``.

Sources: the maps seen from several cameras and projected are those of the relighting system that
this package follows (`andon.transport.baked`); Ward 1994 (the Radiance system).
"""

from __future__ import annotations

from andon.bake.maps.drive import Progress, bake_maps
from andon.bake.maps.plan import MapsPlan, plan_maps, searched_cameras
from andon.bake.maps.report import BakedMapsReport

__all__ = ["BakedMapsReport", "MapsPlan", "Progress", "bake_maps", "plan_maps", "searched_cameras"]
