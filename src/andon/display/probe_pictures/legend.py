"""The strip of paper below a picture: what the colours mean, how many, how long."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["STRIP_PX", "Entry", "legend", "round_length"]

Rgb = NDArray[np.uint8]
Entry = tuple[tuple[int, int, int] | None, str]

STRIP_PX = 58
INK, PAPER, FAINT = (32, 32, 32), (245, 243, 238), (120, 118, 112)
MARGIN_PX, GAP_PX, DOT_PX = 14, 18, 5
OVERSAMPLING = 2


def round_length(most: float, /) -> float:
    """The largest of 1, 2, 5 × 10ⁿ that is at most `most` (> 0)."""
    power = 10 ** np.floor(np.log10(most))
    return float(max(step * power for step in (1, 2, 5) if step * power <= most * (1 + 1e-9)))


def legend(
    width: int, entries: list[Entry], note: str, scale: tuple[float, float] | None, /
) -> Rgb:
    """(STRIP_PX, width, 3) uint8: dots with their words, a note, and a scale bar on the right.

    `scale` is the length of the bar in metres and in pixels.
    """
    from PIL import Image, ImageDraw, ImageFont

    times = OVERSAMPLING
    image = Image.new("RGB", (width * times, STRIP_PX * times), PAPER)
    draw: Any = ImageDraw.Draw(image)
    small: Any = ImageFont.load_default(size=12 * times)
    x = MARGIN_PX * times
    for colour, text in entries:
        if colour is not None:
            r, y = DOT_PX * times, 19 * times
            draw.ellipse((x, y - r, x + 2 * r, y + r), fill=colour, outline=INK, width=times // 2)
            x += 2 * r + 6 * times
        x = _write(draw, (x, 19 * times), text, 14 * times, INK) + GAP_PX * times
    _write(draw, (MARGIN_PX * times, 42 * times), note, 12 * times, FAINT)
    if scale is not None:
        _bar(draw, small, width * times, scale)
    small_image = image.resize((width, STRIP_PX), Image.Resampling.LANCZOS)
    return np.asarray(small_image, np.uint8)


def _write(draw: Any, at: tuple[int, int], text: str, size: int, ink: tuple[int, int, int]) -> int:
    """Writes from the left, centred on a height; where it ends. Pillow's font has no ² and no π."""
    from PIL import ImageFont

    font: Any = ImageFont.load_default(size=size)
    raised: Any = ImageFont.load_default(size=0.65 * size)
    x, y = at
    for part in re.split("([²π])", text):
        if part == "²":
            draw.text((x, y - 0.28 * size), "2", fill=ink, font=raised, anchor="lm")
            x += round(raised.getlength("2"))
        elif part == "π":
            _pi(draw, (x, y), size, ink)
            x += round(0.62 * size)
        else:
            draw.text((x, y), part, fill=ink, font=font, anchor="lm")
            x += round(font.getlength(part))
    return x


def _pi(draw: Any, at: tuple[int, int], size: int, ink: tuple[int, int, int]) -> None:
    """A letter π of three strokes, as high as an x."""
    x, y = at
    top, foot, stroke = y - 0.14 * size, y + 0.36 * size, max(1, round(0.08 * size))
    draw.line([(x + 0.04 * size, top), (x + 0.56 * size, top)], fill=ink, width=stroke)
    for leg in (0.18, 0.42):
        draw.line([(x + leg * size, top), (x + leg * size, foot)], fill=ink, width=stroke)


def _bar(draw: Any, font: Any, width: int, scale: tuple[float, float]) -> None:
    metres, pixels = scale
    times = OVERSAMPLING
    right, y = width - MARGIN_PX * times, 42 * times
    left = right - pixels * times
    draw.line([(left, y), (right, y)], fill=INK, width=2 * times)
    for x in (left, right):
        draw.line([(x, y - 4 * times), (x, y + 4 * times)], fill=INK, width=times)
    text = f"{metres:g} m amid the probes"
    draw.text((left - 8 * times, y), text, fill=INK, font=font, anchor="rm")
