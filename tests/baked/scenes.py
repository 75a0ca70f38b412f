"""Maps whose light is a known function of place, seen by the surface's own reference."""

import numpy as np

from andon.spaces import View, look_at
from andon.surface.reference import trace
from andon.transport.baked.model import BakedLight, BakedMoment, IlluminanceMap

LAMP = np.array([0.4, 1.9, -0.3])
CANDELA = np.array([90.0, 70.0, 40.0])


def candles(position, normal, at=LAMP):
    """(…, 3) lx of a point lamp, without shadows: I·cos φ/d²."""
    reach = at - position
    squared = np.sum(reach**2, axis=-1)
    cosine = np.maximum(np.sum(reach * normal, axis=-1), 0) / np.sqrt(squared)
    return (cosine / squared)[..., None] * CANDELA


def baked_map(geometry, view, light=candles, name="lamp"):
    """What a bake without any error writes: `light` of position and normal, in each texel."""
    surface = trace(geometry, view, is_object=False)
    there = surface.valid[..., None]
    with np.errstate(invalid="ignore"):
        lux = np.where(there, light(surface.position, surface.normal), 0).astype(np.float32)
    return IlluminanceMap(
        view, surface.depth.astype(np.float32), surface.normal.astype(np.float32), {name: lux}
    )


def still(*maps, **settings):
    """Light of one moment."""
    moment = BakedMoment(0.0, maps)
    names = {name for seen in maps for name in seen.lux}
    return BakedLight((0.0,), lambda _: moment, lambda _: dict.fromkeys(names, 1.0), **settings)


def pinhole(width, height, eye, target, field=1.2, name="mono"):
    """A view with a horizontal field of `field` radians."""
    focal = width / 2 / np.tan(field / 2)
    middle = ((width - 1) / 2, (height - 1) / 2)
    return View(
        "pinhole", width, height, focal, focal, *middle,
        world_from_camera=look_at(eye, target), name=name,
    )  # fmt: skip


def latlong(width, eye, target=(0.0, 1.0, 0.0)):
    return View("latlong", width, width // 2, world_from_camera=look_at(eye, target))


def fisheye(width, eye, target):
    middle = (width - 1) / 2
    focal = width / np.pi
    return View(
        "fisheye",
        width,
        width,
        focal,
        focal,
        middle,
        middle,
        world_from_camera=look_at(eye, target),
    )
