"""Speed of baked light: a whole picture of it from several maps, and one in which nothing changes.

The peer of a picture is the reference engine at the same points; that of an unchanged frame is the
same frame drawn anew.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from andon.bench.registry import BenchRow, Duel
from andon.gpu.device import open_gpu
from andon.surface.reference import trace
from andon.surface.stage import SurfaceStage
from andon.transport.baked import BakedLight, BakedMoment, IlluminanceMap, illuminance_at
from andon.transport.baked.rims import with_rims
from andon.transport.baked.stage import BakedBuffers, BakedPicture
from andon.verify.rooms import random_view
from andon.verify.setting import room, room_setting

__all__ = ["ROWS", "room_light"]

WIDTH, HEIGHT = 1280, 720
MAP_WIDTH, MAP_HEIGHT = 384, 216
# Two pictures are the same where they differ by no more than this share.
AGREED = 1e-3
LAMP = "lamp"
# What a frame with four maps may take on two cores of software Vulkan.
MOST_MS = 60.0
# An unchanged frame costs less than this part of a drawn one.
UNCHANGED_RATIO = 20.0


def room_light(count: int) -> BakedLight:
    """`count` maps of the furnished room from cameras in it, with smooth light that is made up."""
    maps = tuple(_map(seed) for seed in range(count))
    moment = BakedMoment(0.0, maps)
    return BakedLight((0.0,), lambda _: moment, lambda _: {LAMP: 1.0})


def _map(seed: int) -> IlluminanceMap:
    view = random_view(seed, MAP_WIDTH, MAP_HEIGHT)
    seen = trace(room(), view, is_object=False)
    lux = np.where(seen.valid[..., None], 100 + 20 * np.nan_to_num(seen.position), 0)
    single = np.float32
    return IlluminanceMap(
        view, seen.depth.astype(single), seen.normal.astype(single), {LAMP: lux.astype(single)}
    )


def _frame(count: int) -> tuple[Callable[[bool], bool], Callable[[], Any], float]:
    """A frame drawn (True: anew), the same by NumPy, and the share of pixels that are the same."""
    gpu, light, setting = open_gpu(), room_light(count), room_setting(1, WIDTH, HEIGHT)
    (view,) = (frame.view for frame in setting.frames.values())
    stage = SurfaceStage(gpu, setting.surface, view)
    seen = stage.surface
    buffers = BakedBuffers(gpu, light)
    picture = BakedPicture(buffers, view, seen.texture.view, seen.view_buffer)

    def submitted(encode: Callable[[Any], Any]) -> Any:
        encoder = gpu.device.create_command_encoder()
        result = encode(encoder)
        gpu.device.queue.submit([encoder.finish()])
        gpu.wait()
        return result

    submitted(stage.encode)
    surface = seen.read()
    position, normal = surface.position[surface.valid], surface.normal[surface.valid]

    def ours(anew: bool) -> bool:
        return submitted(lambda encoder: picture.encode(encoder, 0.0, changed=anew))

    def peer() -> Any:
        lux, covered = illuminance_at(light, 0.0, position, normal)
        whole, there = np.zeros((*surface.view.shape, 3)), np.zeros(surface.view.shape, bool)
        whole[surface.valid], there[surface.valid] = lux, covered
        lit = with_rims(whole, there, surface, light.depth_tolerance_m)
        return lit[surface.valid], covered

    ours(True)
    got, (lux, covered) = picture.lux.read()[surface.valid], peer()
    known = got[:, 3] > 0
    near = (np.abs(got[:, :3] - lux) <= AGREED * lux).all(axis=1)
    return ours, peer, float(np.count_nonzero(near & (known == covered)) / len(near))


def _against_numpy(count: int) -> Duel:
    ours, peer, same = _frame(count)
    return Duel(partial(ours, True), peer, same, 0.999, open_gpu().adapter_name, peer_repeats=1)


def _unchanged() -> Duel:
    ours, _, same = _frame(4)
    again, anew = partial(ours, False), partial(ours, True)
    return Duel(again, anew, same, 0.999, open_gpu().adapter_name)


ROWS: tuple[BenchRow, ...] = (
    *(
        BenchRow(
            f"baked.picture.{count}_maps.numpy",
            "baked",
            "NumPy, the reference at the same points",
            WIDTH * HEIGHT,
            partial(_against_numpy, count),
            bar=MOST_MS if count == 4 else None,
            bar_is_milliseconds=count == 4,
        )
        for count in (1, 2, 4, 8)
    ),
    BenchRow(
        "baked.unchanged.drawn",
        "baked",
        "the same frame drawn anew",
        WIDTH * HEIGHT,
        _unchanged,
        bar=UNCHANGED_RATIO,
    ),
)
