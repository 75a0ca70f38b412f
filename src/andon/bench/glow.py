"""Speed of the glow: bodies all over a picture of 1280×720, beside OpenCV's Gaussian."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from andon.bench.registry import BenchRow, Duel
from andon.glow.model import Glow
from andon.glow.stage import GlowStage
from andon.gpu.device import open_gpu
from andon.gpu.textures import make_texture
from andon.spaces import pinhole_view

__all__ = ["ROWS"]

WIDTH, HEIGHT = 1280, 720
FOCAL_PX = 1000.0
BODIES = 60
# Two filtered pictures are the same where no channel differs by more than this share of the peak.
AGREED = 0.01


def _bodies() -> np.ndarray[Any, np.dtype[np.float32]]:
    """(H, W, 3) discs of 2 to 25 px and 1 to 20 units, everywhere."""
    generator = np.random.default_rng(1)
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    picture = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    for _ in range(BODIES):
        row, column, radius = generator.uniform((0, 0, 2), (HEIGHT, WIDTH, 25))
        disc = np.hypot(rows - row, columns - column) < radius
        picture[disc] = generator.uniform(1, 20, 3)
    return picture


def _against_opencv(sigma_px: float) -> Duel:
    """Ours filters and composes; the peer filters, in float32, with zeros beyond the border."""
    import cv2

    gpu, bodies = open_gpu(), _bodies()
    view = pinhole_view(WIDTH, HEIGHT, FOCAL_PX)
    source = make_texture(gpu, "rgba16float", WIDTH, HEIGHT, label="bodies")
    target = make_texture(gpu, "rgba16float", WIDTH, HEIGHT, label="light")
    source.write(np.dstack([bodies, np.ones(view.shape, np.float32)]))
    stage = GlowStage(gpu, source, target, Glow(sigma_px / FOCAL_PX, 0.32), view)

    def finish(encoder: Any) -> None:
        gpu.device.queue.submit([encoder.finish()])
        gpu.wait()

    def ours() -> None:
        encoder = gpu.device.create_command_encoder()
        stage.encode(encoder)
        finish(encoder)

    def peer() -> Any:
        return cv2.GaussianBlur(bodies, (0, 0), sigma_px, borderType=cv2.BORDER_CONSTANT)

    encoder = gpu.device.create_command_encoder()
    stage.encode_filtered(encoder, target)
    finish(encoder)
    expected = np.asarray(peer(), np.float64)
    difference = np.abs(target.read()[..., :3] - expected).max(axis=-1)
    same = float((difference <= AGREED * expected.max()).mean())
    return Duel(ours, peer, same, 1.0, gpu.adapter_name, peer_repeats=11)


ROWS: tuple[BenchRow, ...] = tuple(
    BenchRow(
        f"relight.glow.{sigma_px}_px.opencv",
        "relight",
        f"OpenCV GaussianBlur, float32, σ = {sigma_px} px",
        WIDTH * HEIGHT,
        partial(_against_opencv, float(sigma_px)),
        bar=bar,
    )
    # Below some 5 px our passes over the whole picture cost more than all of OpenCV's filter.
    for sigma_px, bar in ((4, None), (11, None), (20, 3.0), (80, 10.0))
)
