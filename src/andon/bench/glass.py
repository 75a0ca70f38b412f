"""Speed of the defocus: three layers of a ball of 670 px, beside OpenCV's filter of one picture."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from andon.bench.registry import BenchRow, Duel
from andon.glass.defocus.kernels import kernel
from andon.glass.defocus.stage import DefocusStage
from andon.gpu.device import open_gpu
from andon.gpu.textures import Texture, make_texture

__all__ = ["ROWS"]

WIDTH, HEIGHT, RADIUS = 1280, 720, 335
WITHIN = (WIDTH // 2 - RADIUS, HEIGHT // 2 - RADIUS, 2 * RADIUS, 2 * RADIUS)
# Two pictures in [0, 1] are the same where no channel differs by more: hard edges are everywhere,
# and our discs are softer at the rim. Deep inside the glass, since OpenCV knows of no other rim.
AGREED, INSIDE = 8 / 255, 200
SHARE = 0.999


def _picture() -> np.ndarray[Any, np.dtype[np.float32]]:
    """(H, W, 3) in [0, 1]: rectangles over rectangles, and grain."""
    generator = np.random.default_rng(1)
    picture = np.full((HEIGHT, WIDTH, 3), 0.5, np.float32)
    for _ in range(400):
        row, column, tall, wide = generator.integers((0, 0, 8, 8), (HEIGHT, WIDTH, 90, 90))
        picture[row : row + tall, column : column + wide] = generator.random(3)
    return np.clip(picture + generator.normal(0, 0.02, picture.shape), 0, 1).astype(np.float32)


def _disc(diameter_px: float) -> np.ndarray[Any, np.dtype[np.float32]]:
    """The reference's own weights, which sum to 1."""
    shape = kernel("optical")
    size = shape.sizes(np.array([diameter_px]))
    reach = int(np.ceil(shape.reach(size)[0]))
    around = range(-reach, reach + 1)
    weights = np.array([[shape.weights(y, x, size)[0] for x in around] for y in around])
    return (weights / weights.sum()).astype(np.float32)


def _layers(picture: Any, diameter_px: float) -> dict[str, Texture]:
    """A ball before nothing: `picture` is refracted, and a tenth each sticks to it, is mirrored."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    cover = np.hypot(rows - HEIGHT / 2, columns - WIDTH / 2) < RADIUS
    seen, blur, none = picture * cover[..., None], cover * diameter_px, cover * 0.0
    values = {
        "refracted": [seen, blur],
        "surface": [0.1 * seen, none],
        "reflected": [0.1 * seen, blur],
        "sizes": [cover, blur, none, none],
        "target": [0 * seen, none],
    }
    made = {name: make_texture(open_gpu(), "rgba16float", WIDTH, HEIGHT) for name in values}
    for name, parts in values.items():
        made[name].write(np.dstack(parts))
    return made


def _against_opencv(diameter_px: float) -> Duel:
    """Ours blurs three layers and composes; the peer filters one picture of three channels once."""
    import cv2

    gpu, picture = open_gpu(), _picture()
    made, disc = _layers(picture, diameter_px), _disc(diameter_px)
    stage = DefocusStage(gpu, **made, kind="optical", size=(WIDTH, HEIGHT))
    diameters = (diameter_px, diameter_px, diameter_px)

    def ours() -> None:
        encoder = gpu.device.create_command_encoder()
        stage.encode(encoder, WITHIN, diameters, diameters)
        gpu.device.queue.submit([encoder.finish()])
        gpu.wait()

    def peer() -> Any:
        return cv2.filter2D(picture, -1, disc, borderType=cv2.BORDER_REPLICATE)

    ours()
    middle = HEIGHT // 2, WIDTH // 2
    inside = tuple(slice(centre - INSIDE, centre + INSIDE) for centre in middle)
    # Ours is 1.2 of the picture: refracted, and a tenth twice.
    difference = made["target"].read()[inside][..., :3] / 1.2 - peer()[inside]
    same = float((np.abs(difference).max(axis=-1) <= AGREED).mean())
    return Duel(ours, peer, same, SHARE, gpu.adapter_name, peer_repeats=11)


ROWS: tuple[BenchRow, ...] = tuple(
    BenchRow(
        f"glass.defocus.{diameter_px}_px.opencv",
        "glass",
        f"OpenCV filter2D with a disc of {diameter_px} px, float32, one layer of three",
        WIDTH * HEIGHT,
        partial(_against_opencv, float(diameter_px)),
    )
    for diameter_px in (8, 20, 40, 60)
)
