"""Leaves against the light, drawn: what stands behind a mask, which has none of its own.

Each leaf lets a share of the light through that falls on it, more of the green; where leaves lie
over one another the shares multiply, as light does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["foliage"]

Float = NDArray[np.float64]

# Drawn larger and made smaller, for smooth edges.
FINER = 2
# Far leaves to near ones: (their area in areas of the picture, their length and blur as shares of
# its height).
LAYERS = ((0.85, 0.063, 0.0015), (1.05, 0.115, 0.0009), (0.65, 0.22, 0.0006))
# Through the blade of a leaf, and of that through its veins.
BLADE = np.array([0.30, 0.47, 0.07])
VEIN = np.array([0.62, 0.70, 0.55])
# Length : half of the widest, and points along the outline of a leaf.
ASPECTS, POINTS = (0.25, 0.42), 40


def foliage(width: int, height: int, seed: int = 0, /) -> Float:
    """(H, W, 3) share of the light of the sky that comes through, 1 where no leaf is."""
    import cv2

    draws = np.random.default_rng(seed)
    light = np.ones((height * FINER, width * FINER, 3), np.float32)
    for cover, length, blur in LAYERS:
        layer = np.ones_like(light)
        # Leaves lie in 1.2 times the width and the height; one has a quarter of its length squared.
        for _ in range(round(cover * 1.44 * width / height / (0.25 * length**2))):
            _leaf(layer, draws, length * height * FINER)
        light *= cv2.GaussianBlur(layer, (0, 0), blur * height * FINER)
    small = cv2.resize(light, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.float64)


def _leaf(layer: NDArray[np.float32], draws: np.random.Generator, length: float) -> None:
    """Multiplies `layer` by one leaf: pointed, bent, with a midrib and side veins."""
    import cv2

    height, width = layer.shape[:2]
    place = draws.uniform(-0.1, 1.1, 2) * (width, height)
    turn, size = draws.normal(0.5, 0.9), length * draws.uniform(0.6, 1.3)
    along = np.array([np.cos(turn), np.sin(turn)])
    across = np.array([-along[1], along[0]])
    t = np.linspace(0, 1, POINTS)
    # Widest at a third of its length, and pointed at the tip.
    half = draws.uniform(*ASPECTS) * size * np.sin(np.pi * t**0.75) * (1 - 0.35 * t)
    bend = draws.normal(0, 0.12) * size * t**2
    spine = place + np.outer(t - 0.5, along) * size + np.outer(bend, across)
    left, right = spine + half[:, None] * across, spine - half[:, None] * across
    tint = BLADE * draws.uniform(0.6, 1.15) * draws.normal(1, 0.07, 3)
    outline = np.concatenate([left, right[::-1]])
    x0, y0 = np.maximum(np.floor(outline.min(axis=0)).astype(int) - 2, 0)
    x1, y1 = np.minimum(np.ceil(outline.max(axis=0)).astype(int) + 2, (width, height))
    if x1 <= x0 or y1 <= y0:
        return
    shape, veins = np.zeros((2, y1 - y0, x1 - x0), np.float32)
    corner = np.array([x0, y0])
    cv2.fillPoly(shape, [_fixed(outline - corner)], 1.0, cv2.LINE_AA, 4)
    thick = max(1, round(size / 70))
    cv2.polylines(veins, [_fixed(spine - corner)], False, 1.0, thick, cv2.LINE_AA, 4)
    for start in range(4, 33, 4):
        for side in (left, right):
            reach = min(start + 7, POINTS - 1)
            end = spine[reach] + 0.85 * (side[reach] - spine[reach])
            pair = _fixed(np.stack([spine[start], end]) - corner)
            cv2.polylines(veins, [pair], False, 0.5, 1, cv2.LINE_AA, 4)
    through = tint * (1 - veins[..., None] * (1 - VEIN))
    layer[y0:y1, x0:x1] *= 1 - shape[..., None] * (1 - through)


def _fixed(points: Float) -> NDArray[np.int32]:
    """Sixteenths of a pixel, as OpenCV's drawing takes them."""
    return np.asarray(np.rint(points * 16), np.int32)
