"""Differences as pictures: blue where too little, red where too much, with a labelled scale."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["outlined", "signed_colour"]

Rgb = NDArray[np.uint8]
Float = NDArray[np.float64]

# Ends of two scales of equal lightness steps from one white (the form of ColorBrewer's RdBu).
BLUE, WHITE, RED = (33.0, 82.0, 160.0), (247.0, 247.0, 247.0), (178.0, 24.0, 43.0)
UNKNOWN = (120, 120, 120)
INK, PAPER = (32, 32, 32), (245, 243, 238)
OUTLINE = (0, 200, 90)
BAR_WIDTH_PX, BAR_PX, LABEL_PX, ABOVE_PX, BELOW_PX = 74, 16, 15, 28, 10


def signed_colour(
    values: NDArray[Any], unit: str, /, *, top: float, known: NDArray[np.bool_] | None = None
) -> Rgb:
    """(H, W + bar, 3) uint8: a linear scale from −top in blue to +top in red, white is 0.

    Parameters
    ----------
    values : (H, W).
    unit : written at the bar.
    top : > 0, the ends of the scale; what is beyond has the colour of the end.
    known : (H, W); other pixels are grey.
    """
    picture = _coloured(np.clip(np.nan_to_num(values) / top, -1, 1))
    if known is not None:
        picture[~known] = UNKNOWN
    return np.concatenate([picture, _bar(len(picture), top, unit)], axis=1)


def outlined(picture: Rgb, mask: NDArray[np.bool_], /) -> Rgb:
    """The picture (H, W, 3) with the rim of `mask` (H, W) in green, as thick as can be seen."""
    import cv2

    thick = 1 + 2 * max(1, round(max(mask.shape) / 800))
    inner = cv2.erode(mask.astype(np.uint8), np.ones((thick, thick), np.uint8))
    marked = picture.copy()
    marked[mask & (np.asarray(inner) == 0)] = OUTLINE
    return marked


def _coloured(share: Float) -> Rgb:
    """Colours (…, 3) of −1…1."""
    side = np.where(share[..., None] < 0, BLUE, RED)
    mixed = np.asarray(WHITE) + np.abs(share)[..., None] * (side - np.asarray(WHITE))
    return np.round(mixed).astype(np.uint8)


def _bar(height: int, top: float, unit: str) -> Rgb:
    from PIL import Image, ImageDraw, ImageFont

    above = ABOVE_PX if height >= 2 * (ABOVE_PX + BELOW_PX) else min(BELOW_PX, (height - 1) // 2)
    length = max(1, height - above - min(BELOW_PX, (height - 1) // 2))
    scale = np.repeat(_coloured(np.linspace(1, -1, length))[:, None], BAR_PX, axis=1)
    image = Image.new("RGB", (BAR_WIDTH_PX, height), PAPER)
    image.paste(Image.fromarray(scale), (8, above))
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size=12)
    step = next((s for s in (0.5, 1.0, 2.0) if s / 2 * (length - 1) >= LABEL_PX), 2.0)
    for share in np.round(np.arange(1, -1 - step / 2, -step), 6):
        y = above + (1 - share) / 2 * (length - 1)
        draw.line([(24, y), (28, y)], fill=INK)
        draw.text(
            (30, y), f"{share * top:+.3g}" if share else "0", fill=INK, font=font, anchor="lm"
        )
    if above == ABOVE_PX:
        draw.text((8, 10), unit, fill=INK, font=font, anchor="lm")
    return np.asarray(image)
