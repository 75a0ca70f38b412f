"""Speed of flare needles: forty lamps in a picture of 1280×720, beside OpenCV's lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.bench.registry import BenchRow, Duel
from andon.glare.model import Source
from andon.glare.needles import Needles, needles_of
from andon.glare.needles.model import REFERENCE_NM, WAVELENGTHS_NM
from andon.glare.needles.records import strip_pixels
from andon.glare.needles.stage import NeedleStage
from andon.gpu.device import open_gpu
from andon.gpu.textures import make_texture
from andon.observer.spread.model import Eye
from andon.spaces import View, pinhole_view

__all__ = ["ROWS"]

WIDTH, HEIGHT, LAMPS = 1280, 720, 40
# 20° across: needles of some 80 pixels.
FOCAL_PX = WIDTH / 2 / np.tan(np.radians(10.0))
# Of our light so much lies within this many pixels of the peer's lines.
AGREED, BESIDE_PX = 0.98, 2


def _view() -> View:
    return pinhole_view(WIDTH, HEIGHT, FOCAL_PX)


def _stars() -> list[Needles]:
    generator = np.random.default_rng(1)
    stars: list[Needles] = []
    for x, y in generator.uniform((-0.16, -0.08), (0.16, 0.08), (LAMPS, 2)):
        direction = np.array([x, y, 1.0]) / np.sqrt(x * x + y * y + 1)
        stars.append(needles_of(Source(direction, np.ones(3)), Eye(pupil_mm=6.0), 0.1))
    return stars


def _ends(stars: list[Needles], view: View) -> NDArray[np.float64]:
    """(n, 2, 2) pixels of foot and tip of each needle."""
    directions: list[NDArray[np.float64]] = []
    for star in stars:
        tips = star.start_radians + star.length_radians * WAVELENGTHS_NM.max() / REFERENCE_NM
        for theta in (star.start_radians, tips):
            turned = np.cos(theta)[:, None] * star.direction + np.sin(theta)[:, None] * star.along
            directions.append(turned)
    feet, tips = np.concatenate(directions[::2]), np.concatenate(directions[1::2])
    return np.stack([view.project(feet), view.project(tips)], axis=1)


def _against_opencv() -> Duel:
    """Ours draws light that falls off; the peer anti-aliased lines of one grey, in 8 bits."""
    import cv2

    gpu, view, stars = open_gpu(), _view(), _stars()
    target = make_texture(gpu, "rgba16float", WIDTH, HEIGHT, label="needles")
    stage = NeedleStage(gpu, view, sum(len(star) for star in stars))
    nothing = np.zeros((*view.shape, 4))
    target.write(nothing)
    ends = np.rint(_ends(stars, view)).astype(int).tolist()

    def ours() -> None:
        stage.update(stars)
        encoder = gpu.device.create_command_encoder()
        stage.encode(encoder, target)
        gpu.device.queue.submit([encoder.finish()])
        gpu.wait()

    def peer(thickness: int = 1) -> Any:
        picture = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        for foot, tip in ends:
            cv2.line(picture, foot, tip, (128, 128, 128), thickness, cv2.LINE_AA)
        return picture

    ours()
    light = np.asarray(target.read()[..., 1], np.float64)
    near = peer(1 + 2 * BESIDE_PX)[..., 1] > 0
    target.write(nothing)
    same = float(light[near].sum() / light.sum())
    return Duel(ours, peer, same, AGREED, gpu.adapter_name, peer_repeats=11)


ROWS: tuple[BenchRow, ...] = (
    BenchRow(
        "glare.needles.opencv",
        "glare",
        f"OpenCV line, 8 bits, anti-aliased, needles of {LAMPS} lamps",
        round(strip_pixels(_stars(), _view())),
        _against_opencv,
    ),
)
