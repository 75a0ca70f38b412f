"""Draws `examples/komorebi/leaves.png`: leaves and boughs against the sky, seen from below.

    python tools/komorebi_leaves.py examples/komorebi/leaves.png

What no leaf covers is white: the gaps.
"""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from andon.files.pictures import write_png
from andon.glare.komorebi.foliage import foliage
from andon.responses import srgb_encode

WIDTH, HEIGHT, SEED = 960, 540, 6
# Starts, bends and ends of boughs as shares of the picture, and how thick they start, in pixels.
BOUGHS = (
    ((-0.02, 0.9), (0.3, 0.62), (0.78, 0.16), 15),
    ((0.36, 0.6), (0.5, 0.62), (0.72, 0.5), 8),
    ((0.55, 0.42), (0.56, 0.3), (0.5, 0.02), 6),
    ((1.02, 0.75), (0.85, 0.72), (0.6, 0.95), 9),
)


def main(out: Path) -> None:
    """Draws and writes."""
    light = foliage(WIDTH, HEIGHT, SEED) * (1 - 0.985 * boughs()[..., None])
    # Leaves are lit from the side that is seen as well, by what is around.
    light += 0.008 * np.array([0.7, 1.0, 0.5])
    write_png(out, np.asarray(np.rint(255 * srgb_encode(np.clip(light, 0, 1))), np.uint8))


def boughs() -> NDArray[np.float32]:
    """(H, W) cover of a few boughs, each thinner towards its end."""
    draws = np.random.default_rng(SEED)
    wood = np.zeros((HEIGHT, WIDTH), np.float32)
    for start, middle, end, thick in BOUGHS:
        t = np.linspace(0, 1, 80)[:, None]
        path = (1 - t) ** 2 * np.array(start) + 2 * t * (1 - t) * np.array(middle)
        path = (path + t**2 * np.array(end)) * (WIDTH, HEIGHT)
        path += np.cumsum(draws.normal(0, 0.9, path.shape), axis=0)
        for number in range(79):
            pair = np.asarray(np.rint(path[number : number + 2] * 16), np.int32)
            pixels = max(1, round(thick * (1 - 0.75 * number / 79)))
            cv2.polylines(wood, [pair], False, 1.0, pixels, cv2.LINE_AA, 4)
    return wood


if __name__ == "__main__":
    main(Path(sys.argv[1]))
