"""The strip of paper below a picture: what the colours mean, how many, how long."""

from __future__ import annotations

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
    font: Any = ImageFont.load_default(size=14 * times)
    small: Any = ImageFont.load_default(size=12 * times)
    x = MARGIN_PX * times
    for colour, text in entries:
        if colour is not None:
            r, y = DOT_PX * times, 19 * times
            draw.ellipse((x, y - r, x + 2 * r, y + r), fill=colour, outline=INK, width=times // 2)
            x += 2 * r + 6 * times
        draw.text((x, 19 * times), text, fill=INK, font=font, anchor="lm")
        x += round(font.getlength(text)) + GAP_PX * times
    draw.text((MARGIN_PX * times, 42 * times), note, fill=FAINT, font=small, anchor="lm")
    if scale is not None:
        _bar(draw, small, width * times, scale)
    small_image = image.resize((width, STRIP_PX), Image.Resampling.LANCZOS)
    return np.asarray(small_image, np.uint8)


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
