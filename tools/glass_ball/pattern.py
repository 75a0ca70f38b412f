"""A pattern full of detail at all sizes: tiles within tiles, with letters, stripes and rings."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

__all__ = ["pattern"]

# Of the largest tiles, in shares of the picture's width: 32 × 24 of them.
COLUMNS = 32
# Tiles are halved so many times at most, each time by chance.
DEPTH = 2
HALVED = (0.75, 0.45)
MARKS = "ABCDEFGHJKLMNPRSTUVWXYZ23456789&?%@"
# sRGB: a warm and a cool family with a light and a dark one, so that neighbours differ in
# lightness or in hue.
COLOURS = (
    (214, 73, 51), (238, 150, 75), (244, 211, 94), (92, 158, 96), (34, 116, 116),
    (53, 104, 178), (94, 74, 146), (178, 84, 132), (240, 236, 224), (38, 42, 54),
    (148, 196, 214), (128, 90, 64),
)  # fmt: skip


def pattern(width: int, height: int, seed: int) -> NDArray[np.uint8]:
    """(height, width, 3) sRGB. The same for the same `seed`."""
    random = np.random.default_rng(seed)
    picture = Image.new("RGB", (width, height), COLOURS[8])
    draw = ImageDraw.Draw(picture)
    side = width / COLUMNS
    for row in range(int(np.ceil(height / side))):
        for column in range(COLUMNS):
            _divided(draw, random, column * side, row * side, side, 0)
    return np.asarray(picture)


def _divided(draw: Any, random: Any, x: float, y: float, side: float, depth: int) -> None:
    if depth < DEPTH and random.random() < HALVED[depth]:
        half = side / 2
        for dx, dy in ((0, 0), (half, 0), (0, half), (half, half)):
            _divided(draw, random, x + dx, y + dy, half, depth + 1)
        return
    paper, ink = (COLOURS[i] for i in random.choice(len(COLOURS), 2, replace=False))
    draw.rectangle([x, y, x + side, y + side], fill=paper)
    motif = random.choice(
        [_letter, _stripes, _rings, _corner, _dots], p=[0.4, 0.2, 0.15, 0.1, 0.15]
    )
    motif(draw, random, x, y, side, ink)


def _letter(draw: Any, random: Any, x: float, y: float, side: float, ink: Any) -> None:
    # Pillow's own font is Aileron, CC0.
    font = ImageFont.load_default(size=0.85 * side)
    mark = MARKS[int(random.integers(len(MARKS)))]
    draw.text((x + side / 2, y + side / 2), mark, fill=ink, font=font, anchor="mm")


def _stripes(draw: Any, random: Any, x: float, y: float, side: float, ink: Any) -> None:
    count = int(random.choice([2, 3, 4]))
    upright = bool(random.integers(2))
    for index in range(count):
        start = (index + 0.25) / count * side
        end = start + side / (2 * count)
        across = [x + start, y, x + end, y + side]
        along = [x, y + start, x + side, y + end]
        draw.rectangle(across if upright else along, fill=ink)


def _rings(draw: Any, random: Any, x: float, y: float, side: float, ink: Any) -> None:
    for share in (0.46, 0.26):
        radius = share * side
        box = [x + side / 2 - radius, y + side / 2 - radius]
        box += [x + side / 2 + radius, y + side / 2 + radius]
        draw.ellipse(box, outline=ink, width=max(1, round(0.09 * side)))


def _corner(draw: Any, random: Any, x: float, y: float, side: float, ink: Any) -> None:
    corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
    left_out = int(random.integers(4))
    draw.polygon([c for i, c in enumerate(corners) if i != left_out], fill=ink)


def _dots(draw: Any, random: Any, x: float, y: float, side: float, ink: Any) -> None:
    count = int(random.choice([2, 3]))
    step = side / count
    for row in range(count):
        for column in range(count):
            cx, cy = x + (column + 0.5) * step, y + (row + 0.5) * step
            radius = 0.3 * step
            draw.ellipse([cx - radius, cy - radius, cx + radius, cy + radius], fill=ink)
