"""Speed of light by probes: a whole picture of it on the GPU, beside NumPy at the same points."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, Literal

import numpy as np

from andon.bench.registry import BenchRow, Duel
from andon.gpu.device import open_gpu
from andon.surface.model import SurfaceModel
from andon.surface.stage import SurfaceStage
from andon.surface.virtual import with_mesh_as_object
from andon.transport.probes.stage import ProbeBuffers, ProbePicture
from andon.verify.rows.probe_light import ball_setting

__all__ = ["ROWS"]

WIDTH, HEIGHT = 640, 360
# Two lookups are the same within this share of the mean; both sides see the same G-buffer.
AGREED = 0.01


def _against_numpy(lookup: Literal["pixel", "object"], visibility: bool) -> Duel:
    """The room itself is lit: every pixel shows something that probes light."""
    setting = ball_setting(lookup, visibility=visibility, width=WIDTH, height=HEIGHT)
    probes, (view,) = setting.probes, (frame.view for frame in setting.frames.values())
    assert probes is not None
    model = with_mesh_as_object(SurfaceModel(), setting.surface.real)
    gpu = open_gpu()
    stage = SurfaceStage(gpu, model, view)
    buffers = ProbeBuffers(gpu, probes.dimmed, lookup, model.object_of_slot)
    seen = stage.surface
    picture = ProbePicture(buffers, view, seen.texture.view, seen.view_buffer)
    buffers.move(model.still_middles)

    def finish(encoder: Any) -> None:
        gpu.device.queue.submit([encoder.finish()])
        gpu.wait()

    def ours() -> None:
        encoder = gpu.device.create_command_encoder()
        picture.encode(encoder, [(0, 0, WIDTH, HEIGHT)])
        finish(encoder)

    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder)
    finish(encoder)
    surface = replace(seen.read(), is_object=np.ones(view.shape, bool))

    def peer() -> Any:
        return probes.standing_lux(surface, model, model.still_middles)

    ours()
    expected = np.asarray(peer(), np.float64)
    difference = np.abs(picture.lux.read()[..., :3] - expected).max(axis=-1)
    same = float((difference <= AGREED * expected.mean()).mean())
    return Duel(ours, peer, same, 0.999, gpu.adapter_name, peer_repeats=3)


_SETTINGS: tuple[tuple[Literal["pixel", "object"], bool], ...] = (
    ("pixel", True),
    ("pixel", False),
    ("object", False),
)
ROWS: tuple[BenchRow, ...] = tuple(
    BenchRow(
        f"probes.light.{lookup}.{'walls' if visibility else 'open'}.numpy",
        "probes",
        "NumPy, the reference's lookup at the same points",
        WIDTH * HEIGHT,
        partial(_against_numpy, lookup, visibility),
    )
    for lookup, visibility in _SETTINGS
)
