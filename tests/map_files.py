"""A small folder of baked illuminance maps: two cameras, two moments, two lamps."""

import numpy as np

from andon.files.illuminance_maps import (
    BakedLamp,
    Manifest,
    geometry_bytes,
    light_bytes,
    map_file,
)
from andon.files.illuminance_maps.manifest import manifest_text
from andon.spaces import View, look_at

__all__ = ["CAMERAS", "map_geometry", "map_lux", "small_manifest", "small_maps", "write_maps"]

SEED = 5
CAMERAS = (
    View("pinhole", 9, 6, 8.0, 8.0, 4.0, 2.5, name="door"),
    View("fisheye", 7, 7, 2.5, 2.5, 3.0, 3.0, name="ceiling",
         world_from_camera=look_at(np.array([0.1, 2.4, 0.2]), np.array([0.0, 0.0, 0.0]))),
)  # fmt: skip


def map_geometry(camera):
    """Depth (h, w) with one hole and unit normals, float32, of a camera; any numbers will do."""
    rng = np.random.default_rng((SEED, camera))
    depth = rng.uniform(0.5, 6, CAMERAS[camera].shape).astype(np.float32)
    normal = rng.normal(size=(*depth.shape, 3))
    normal = (normal / np.linalg.norm(normal, axis=-1, keepdims=True)).astype(np.float32)
    depth[2, 3], normal[2, 3] = np.nan, np.nan
    return depth, normal


def map_lux(lamp, camera, moment):
    """(h, w, 3) float32 lux of a lamp (number), from nothing to bright."""
    rng = np.random.default_rng((SEED, lamp, camera, moment))
    lux = (10 ** rng.uniform(-3, 4, (*CAMERAS[camera].shape, 3))).astype(np.float32)
    lux[2, 3] = 0
    return lux


def small_manifest():
    """The manifest, and the pictures that it names as file → bytes."""
    files, geometry, light = {}, {}, {}
    lamps = (BakedLamp("lantern", "all"), BakedLamp("lamp at the window", "bounce"))
    for camera in range(len(CAMERAS)):
        name = f"geometry-{camera}.exr"
        files[name] = geometry_bytes(*map_geometry(camera))
        for moment in range(2):  # nothing moves: both moments share a picture
            geometry[camera, moment] = map_file(name, files[name])
            for number, lamp in enumerate(lamps):
                name_of_light = f"light-{number}-{camera}-{moment}.exr"
                files[name_of_light] = light_bytes(map_lux(number, camera, moment))
                file = map_file(name_of_light, files[name_of_light])
                light[lamp.name, camera, moment] = file
    facts = {"lamp lantern": "position [0, 1, 0]", "surfaces": "3 parts"}
    manifest = Manifest(
        CAMERAS, (0.0, 0.5), lamps, geometry, light, "normal", 4, facts=facts, generator="Andon 1"
    )
    return manifest, files


def small_maps():
    """All files of the folder, name → bytes."""
    manifest, files = small_manifest()
    return {**files, "maps.json": manifest_text(manifest).encode()}


def write_maps(folder):
    """Write the folder; its manifest."""
    for name, contents in small_maps().items():
        (folder / name).write_bytes(contents)
    return small_manifest()[0]
