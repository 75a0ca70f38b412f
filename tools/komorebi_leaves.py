"""Draws `examples/komorebi/leaves.png`: leaves against the sky, seen from below.

    python tools/komorebi_leaves.py examples/komorebi/leaves.png

Each leaf lets a share of the light through that falls on it, more of the green; where leaves lie
over one another the shares multiply. What no leaf covers is white: the gaps.
"""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np

from andon.files.pictures import write_png
from andon.responses import srgb_encode

WIDTH, HEIGHT = 960, 540
# Drawn larger and made smaller, for smooth edges.
FINER = 2
SEED = 6
# (leaves, length in pixels of the small picture, blur in the same): far ones to near ones.
LAYERS = ((2300, 34, 0.8), (900, 62, 0.5), (150, 120, 0.3))
THROUGH = np.array([0.30, 0.47, 0.07])
VEIN = np.array([0.62, 0.70, 0.55])


def main(out: Path) -> None:
    """Draws and writes."""
    draws = np.random.default_rng(SEED)
    light = np.ones((HEIGHT * FINER, WIDTH * FINER, 3), np.float32)
    for count, length, blur in LAYERS:
        layer = np.ones_like(light)
        for _ in range(count):
            _leaf(layer, draws, length * FINER)
        if length < 40:
            _boughs(light, draws)
        light *= cv2.GaussianBlur(layer, (0, 0), blur * FINER)
    small = cv2.resize(light, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    # Leaves are lit from the side that is seen as well, by what is around.
    small += 0.008 * np.array([0.7, 1.0, 0.5])
    write_png(out, np.asarray(np.rint(255 * srgb_encode(np.clip(small, 0, 1))), np.uint8))


def _leaf(layer: np.ndarray, draws: np.random.Generator, length: float) -> None:
    """Multiplies `layer` by one leaf: pointed, with a midrib and side veins."""
    height, width = layer.shape[:2]
    place = draws.uniform(-0.1, 1.1, 2) * (width, height)
    turn = draws.normal(0.5, 0.9)
    size = length * draws.uniform(0.6, 1.3)
    aspect = draws.uniform(0.25, 0.42)
    along = np.array([np.cos(turn), np.sin(turn)])
    across = np.array([-along[1], along[0]])
    t = np.linspace(0, 1, 40)
    # Widest at a third of its length, and pointed at the tip.
    half = aspect * size * np.sin(np.pi * t**0.75) * (1 - 0.35 * t)
    bend = draws.normal(0, 0.12) * size * t**2
    spine = place + np.outer(t - 0.5, along) * size + np.outer(bend, across)
    outline = np.concatenate(
        [spine + half[:, None] * across, (spine - half[:, None] * across)[::-1]]
    )
    box = _box(outline, width, height)
    if box is None:
        return
    x0, y0, x1, y1 = box
    shape = np.zeros((y1 - y0, x1 - x0), np.float32)
    cv2.fillPoly(shape, [_fixed(outline, x0, y0)], 1.0, cv2.LINE_AA, 4)
    veins = np.zeros_like(shape)
    thick = max(1, round(size / 70))
    cv2.polylines(veins, [_fixed(spine, x0, y0)], False, 1.0, thick, cv2.LINE_AA, 4)
    for place_of_vein in np.linspace(4, 32, 8).astype(int):
        for side in (-1, 1):
            reach = min(place_of_vein + 7, 39)
            end = spine[reach] + side * 0.85 * half[reach] * across
            pair = np.stack([spine[place_of_vein], end])
            cv2.polylines(veins, [_fixed(pair, x0, y0)], False, 0.5, 1, cv2.LINE_AA, 4)
    tint = THROUGH * draws.uniform(0.6, 1.15) * draws.normal(1, 0.07, 3)
    through = tint * (1 - veins[..., None] * (1 - VEIN))
    layer[y0:y1, x0:x1] *= 1 - shape[..., None] * (1 - through)


def _boughs(light: np.ndarray, draws: np.random.Generator) -> None:
    """Darkens `light` along a few boughs behind the leaves, each thinner towards its end."""
    height, width = light.shape[:2]
    wood = np.zeros((height, width), np.float32)
    for start, middle, end, thick in (
        ((-0.02, 0.9), (0.3, 0.62), (0.78, 0.16), 15),
        ((0.36, 0.6), (0.5, 0.62), (0.72, 0.5), 8),
        ((0.55, 0.42), (0.56, 0.3), (0.5, 0.02), 6),
        ((1.02, 0.75), (0.85, 0.72), (0.6, 0.95), 9),
    ):
        t = np.linspace(0, 1, 80)[:, None]
        bough = (1 - t) ** 2 * np.array(start) + 2 * t * (1 - t) * np.array(middle)
        bough = (bough + t**2 * np.array(end)) * (width, height)
        bough += np.cumsum(draws.normal(0, 0.9 * FINER, bough.shape), axis=0)
        for number in range(79):
            pair = _fixed(bough[number : number + 2], 0, 0)
            pixels = max(1, round(thick * FINER * (1 - 0.75 * number / 79)))
            cv2.polylines(wood, [pair], False, 1.0, pixels, cv2.LINE_AA, 4)
    light *= 1 - 0.985 * wood[..., None]


def _box(outline: np.ndarray, width: int, height: int) -> tuple[int, int, int, int] | None:
    x0, y0 = np.maximum(np.floor(outline.min(axis=0)).astype(int) - 2, 0)
    x1, y1 = np.minimum(np.ceil(outline.max(axis=0)).astype(int) + 2, (width, height))
    return (x0, y0, x1, y1) if x1 > x0 and y1 > y0 else None


def _fixed(points: np.ndarray, x0: int, y0: int) -> np.ndarray:
    """Sixteenths of a pixel, as OpenCV's drawing takes them."""
    return np.asarray(np.rint((points - (x0, y0)) * 16), np.int32)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
