"""What sticks to the ball: a name and a frame, on the half that faces the eyes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

__all__ = ["label"]

PAINT = (246, 243, 234)  # sRGB of white paint
ACCENT = (226, 62, 44)
# Drawn this much larger, then averaged.
OVER = 2


def label(width: int) -> NDArray[np.uint8]:
    """(width/2, width, 4) sRGB and cover, latlong; the middle of the picture looks at the eyes."""
    w, h = width * OVER, width * OVER // 2
    cover = Image.new("L", (w, h), 0)
    accent = Image.new("L", (w, h), 0)
    draw, second = ImageDraw.Draw(cover), ImageDraw.Draw(accent)
    _word(draw, "ANDON", w / 2, 0.50 * h, 0.135 * h)
    _word(second, "SOLID GLASS", w / 2, 0.39 * h, 0.042 * h)
    _word(second, "150 mm   n = 1.51", w / 2, 0.61 * h, 0.042 * h)
    for v in (0.335, 0.665):
        second.rectangle([0.39 * w, (v - 0.007) * h, 0.61 * w, (v + 0.007) * h], fill=255)
    first, other = (np.asarray(layer, np.float64) / 255 for layer in (cover, accent))
    both = np.maximum(first, other)
    share = np.divide(other, first + other, out=np.zeros_like(both), where=first + other > 0)
    colour = np.array(PAINT) * (1 - share[..., None]) + np.array(ACCENT) * share[..., None]
    picture = np.concatenate([colour, 255 * both[..., None]], axis=-1)
    small = picture.reshape(h // OVER, OVER, w // OVER, OVER, 4)
    alpha = small[..., 3:].mean(axis=(1, 3))
    weighted = (small[..., :3] * small[..., 3:]).mean(axis=(1, 3))
    plain = np.broadcast_to(np.array(PAINT, np.float64), weighted.shape)
    rgb = np.divide(weighted, alpha, out=plain.copy(), where=alpha > 0)
    return np.round(np.concatenate([rgb, alpha], axis=-1)).astype(np.uint8)


def _word(draw: Any, text: str, x: float, y: float, size: float) -> None:
    """`text` around (x, y) with strokes thick enough to be read at one part in five."""
    font = ImageFont.load_default(size=size)
    stroke = 0.05 * size
    advances = [font.getlength(letter) + 2.6 * stroke for letter in text]
    at = x - sum(advances) / 2
    for letter, advance in zip(text, advances, strict=True):
        place = (at + advance / 2, y + 0.36 * size)
        draw.text(place, letter, fill=255, font=font, anchor="ms", stroke_width=round(stroke))
        at += advance
