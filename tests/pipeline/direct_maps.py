"""A room whose illuminance maps hold lamps' direct light: the sum of a frame is known."""

import numpy as np

import andon
from andon.engines.baked_light import map_facts
from andon.engines.prepared import prepare
from andon.files.illuminance_maps import (
    BakedLamp,
    Manifest,
    geometry_bytes,
    light_bytes,
    map_file,
    write_manifest,
)
from andon.files.pictures import write_png
from andon.scene import scene_from_dict
from andon.spaces import look_at, pinhole_view
from andon.surface import reference as surface
from andon.transport.direct import reference as direct
from andon.transport.direct.casters import ShadowRays
from worlds import block, write_obj

__all__ = ["LAMPS", "bake_direct_light", "lamp_tables", "lux_of", "map_views", "relative", "world"]

LAMPS = {
    "ball": {
        "kind": "sphere",
        "position": [0.5, 1.5, 0.2],
        "radius_m": 0.1,
        "flux_lm": 900.0,
        "drawn": False,
    },
    "spot": {
        "kind": "spot",
        "position": [-1.0, 2.2, 0.5],
        "direction": [0.4, -1.0, -0.5],
        "intensity_cd": 90.0,
    },
}


def lamp_tables(transports, names=tuple(LAMPS), **changes):
    """[[lamp]] tables of `LAMPS`, each with its transport and `changes`."""
    return [
        LAMPS[name] | {"name": name, "transport": transports.get(name, "direct")} | changes
        for name in names
    ]


def world(folder, transports, *, moments=(0.0,), **tables):
    """A room of 4 × 2.5 × 4 m with a box in it, and its scene with maps in `folder`.

    `transports`: name of a lamp → how its light gets to surfaces; ``direct`` where none is given.
    """
    write_obj(folder / "room.obj", block((4, 2.5, 4), (0, 1.25, 0), inwards=True))
    write_obj(folder / "box.obj", block((0.6, 0.6, 0.6), (0.0, 0.3, -0.9)))
    write_png(folder / "photo.png", np.full((48, 64, 3), 120, np.uint8))
    own = {
        "rig": {
            "camera": {"hfov_degrees": 70.0, "position": [0, 1.4, 1.7], "look_at": [0, 0.9, 0]}
        },
        "capture": {"source": "photo.png"},
        "surface": {"mesh": "room.obj"},
        "ambient": {"illuminance_lux": 200.0},
        "lamp": lamp_tables(transports),
        "object": [{"name": "box", "mesh": "box.obj"}],
    }
    if transports:
        own["baked"] = {"folder": "maps", "lamps": list(transports)}
    (folder / "maps").mkdir(exist_ok=True)
    scene = scene_from_dict(own | tables, folder=folder, file="scene")
    if transports:
        parts = {n: "all" if word == "baked" else "bounce" for n, word in transports.items()}
        bake_direct_light(scene, folder / "maps", parts, moments=moments)
    return scene


def map_views():
    """Two cameras of maps under the ceiling."""
    eyes = [((-1.6, 1.8, 1.6), (0.5, 0.4, -1)), ((1.6, 1.8, 1.6), (-0.5, 0.4, -1))]
    return [
        pinhole_view(160, 120, 80, look_at(*eye), name=f"camera {number}")
        for number, eye in enumerate(eyes)
    ]


def bake_direct_light(scene, folder, parts, *, views=None, moments=(0.0,), photometry="absolute"):
    """Maps that hold the direct light of each lamp at each moment, whatever `parts` call it."""
    # Lamps are baked steady; glare is of the eye, and would be planned for seconds.
    prepared = prepare(scene.model_copy(update={"glare": None}), drawn=False)
    views = views or map_views()
    geometry, light = {}, {}
    for index, time in enumerate(moments):
        moment = prepared.at(time)
        rays = ShadowRays(prepared.casters(moment))
        for number, view in enumerate(views):
            seen = surface.see(prepared.surface, view)
            file = geometry_bytes(seen.depth, seen.normal)
            geometry[number, index] = _written(folder, f"{number}-{index}.exr", file)
            for name in parts:
                own = [lamp for lamp in moment.lamps if lamp.owner == name]
                lux = direct.illuminate(seen, own, rays, bias_m=np.full(view.shape, 1e-3))
                file = light_bytes(lux.astype(np.float32), photometry=photometry)
                light[name, number, index] = _written(folder, f"{name}-{number}-{index}.exr", file)
    lamps = tuple(BakedLamp(name, part) for name, part in parts.items())
    facts = map_facts(
        scene, prepared.surface, prepared.lamps(0.0), moments=moments,
        frames=prepared.frames, ambient=prepared.ambient,
    )  # fmt: skip
    manifest = Manifest(
        tuple(views), tuple(moments), lamps, geometry, light, facts=facts, photometry=photometry
    )
    write_manifest(folder, manifest)


def _written(folder, name, contents):
    (folder / name).write_bytes(contents)
    return map_file(name, contents)


def lux_of(scene, engine="reference"):
    """(H, W, 3) of a frame."""
    return np.asarray(andon.render(scene, engine=engine).illuminance.lux, float)


def relative(ours, truth, covered):
    """Median and 95th percentile of the error, of the mean light, where maps see the surface."""
    off = np.abs(ours - truth)[covered].max(axis=-1) / truth[covered].mean()
    return np.median(off), np.percentile(off, 95)
