"""Projection of baked maps: against a closed form, and one engine against the other.

The maps are made without error, so what is measured is what projecting them adds: the light of a
point lamp without shadows, in the furnished room, seen by four panoramas and asked by another view.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.gpu.device import open_gpu
from andon.quantities import Surface
from andon.spaces import View, look_at
from andon.surface.reference import trace
from andon.surface.stage import SurfaceStage
from andon.transport.baked import BakedLight, BakedMoment, IlluminanceMap, illuminance_at
from andon.transport.baked.rims import with_rims
from andon.transport.baked.stage import BakedBuffers, BakedPicture
from andon.verify.registry import Row
from andon.verify.rooms import camera_in, random_view
from andon.verify.setting import room, room_lamps, room_setting

__all__ = ["ROWS", "projected_light", "projection_error", "projection_parity"]

Float = NDArray[np.float64]

MAPS = 4
MAP_WIDTH = 512
WIDTH, HEIGHT = 320, 180
LAMP = "lamp"
# Nearer than this to the plane of a surface the lamp is at a slant where light is nearly none.
LEAST_LUX = 1e-3


def _light(position: Float, normal: Float) -> Float:
    """(..., 3) lx of the room's first lamp: I·cos φ/d², without shadows."""
    (lamp,) = room_lamps(1)
    reach = lamp.position_m - position
    squared = np.sum(reach**2, axis=-1)
    with np.errstate(invalid="ignore"):
        height = np.maximum(np.sum(reach * normal, axis=-1), 0)
    return (height / squared**1.5)[..., None] * lamp.intensity_cd


@cache
def projected_light() -> BakedLight:
    """The room in four panoramas."""
    maps = tuple(_map(random_view(seed).position) for seed in range(MAPS))
    moment = BakedMoment(0.0, maps)
    return BakedLight((0.0,), lambda _: moment, lambda _: {LAMP: 1.0})


def _map(eye: Float) -> IlluminanceMap:
    pose = look_at(eye, eye + np.array([0.0, 0.0, -1.0]))
    view = View("latlong", MAP_WIDTH, MAP_WIDTH // 2, world_from_camera=pose)
    seen, single = trace(room(), view, is_object=False), np.float32
    lux = np.where(seen.valid[..., None], _light(seen.position, seen.normal), 0).astype(single)
    return IlluminanceMap(view, seen.depth.astype(single), seen.normal.astype(single), {LAMP: lux})


def _asked(surface: Surface) -> tuple[Float, NDArray[np.bool_], Float]:
    """Light and cover of a surface's pixels, and the closed form there."""
    position, normal = surface.position[surface.valid], surface.normal[surface.valid]
    lux, covered = illuminance_at(projected_light(), 0.0, position, normal)
    return lux, covered, _light(position, normal)


def projection_error() -> float:
    """Median relative error, in %, of covered pixels that the lamp lights."""
    lux, covered, truth = _asked(trace(room(), camera_in(room(), WIDTH, HEIGHT), is_object=False))
    lit = covered & (truth.max(axis=-1) > LEAST_LUX * truth.max())
    return float(100 * np.median(np.abs(lux[lit] - truth[lit]).max(axis=-1) / truth[lit].max(-1)))


def uncovered_share() -> float:
    """Share of the view's pixels, in %, that none of the four panoramas sees."""
    _, covered, _ = _asked(trace(room(), camera_in(room(), WIDTH, HEIGHT), is_object=False))
    return float(100 * np.count_nonzero(~covered) / len(covered))


def _with_rims(surface: Surface, lux: Float, covered: NDArray[np.bool_]) -> Float:
    """(n, 3) the same with the light of rims, as frames have it."""
    picture, there = np.zeros((*surface.view.shape, 3)), np.zeros(surface.view.shape, bool)
    picture[surface.valid], there[surface.valid] = lux, covered
    return with_rims(picture, there, surface, projected_light().depth_tolerance_m)[surface.valid]


def projection_parity() -> float:
    """Share of pixels, in %, on which engines differ by more than 1e-3, or in what is covered."""
    gpu, setting = open_gpu(), room_setting(1, WIDTH, HEIGHT)
    (view,) = (frame.view for frame in setting.frames.values())
    stage = SurfaceStage(gpu, setting.surface, view)
    seen = stage.surface
    buffers = BakedBuffers(gpu, projected_light())
    picture = BakedPicture(buffers, view, seen.texture.view, seen.view_buffer)
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder)
    picture.encode(encoder, 0.0)
    gpu.device.queue.submit([encoder.finish()])
    surface = seen.read()
    ours = picture.lux.read()[surface.valid]
    lux, covered, _ = _asked(surface)
    lux = _with_rims(surface, lux, covered)
    off = np.abs(ours[:, :3] - lux) > 1e-3 * lux + 1e-5 * lux.max()
    wrong = off.any(axis=-1) | (covered != (ours[:, 3] > 0))
    return float(100 * np.count_nonzero(wrong) / len(wrong))


ROWS: tuple[Row, ...] = (
    Row(
        "baked.projection.closed_form",
        "baked",
        0.1,
        "%",
        "I·cos φ/d², median over pixels; maps without error of their own",
        projection_error,
    ),
    Row(
        "baked.projection.uncovered",
        "baked",
        None,
        "%",
        "all pixels of a view of the furnished room, four panoramas at random places",
        uncovered_share,
    ),
    Row(
        "baked.projection.parity",
        "baked",
        0.1,
        "%",
        "the reference engine: pixels that differ by more than 0.1 %, or in what is covered",
        projection_parity,
    ),
)
