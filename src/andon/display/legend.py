"""Parts of a picture in flat colours, and below it what they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.display.false_colour import CAPTION_FONT_PX, CAPTION_MARGIN_PX, CAPTION_PX, INK, PAPER

__all__ = ["Part", "with_legend"]

Rgb = NDArray[np.uint8]

SWATCH_PX = 14
# Between two entries of a line.
APART_PX = 18


@dataclass(frozen=True, eq=False)
class Part:
    """Pixels that are alike.

    Attributes
    ----------
    text : what they are.
    rgb : their colour in the legend.
    mask : (H, W) where that is put into the picture; None: nowhere, it is in it.
    """

    text: str
    rgb: tuple[int, int, int]
    mask: NDArray[np.bool_] | None = None


def with_legend(picture: Rgb, parts: Sequence[Part], /) -> Rgb:
    """The picture (H, W + n, 3) with `parts` in their colours, and lines that name them below.

    Masks cover its first columns; what is right of them, a scale, stays.
    """
    from PIL import Image, ImageDraw, ImageFont

    painted = picture.copy()
    for part in parts:
        if part.mask is not None:
            painted[:, : part.mask.shape[1]][part.mask] = part.rgb
    font = ImageFont.load_default(size=CAPTION_FONT_PX)
    places: list[tuple[int, int]] = []
    x, line = CAPTION_MARGIN_PX, 0
    for part in parts:
        width = SWATCH_PX + CAPTION_MARGIN_PX + int(np.ceil(font.getlength(part.text)))
        if x > CAPTION_MARGIN_PX and x + width > picture.shape[1] - CAPTION_MARGIN_PX:
            x, line = CAPTION_MARGIN_PX, line + 1
        places.append((x, line))
        x += width + APART_PX
    image = Image.new("RGB", (picture.shape[1], CAPTION_PX * (line + 1)), PAPER)
    draw = ImageDraw.Draw(image)
    for part, (left, row) in zip(parts, places, strict=True):
        middle = CAPTION_PX * row + CAPTION_PX // 2
        half = SWATCH_PX // 2
        box = (left, middle - half, left + SWATCH_PX, middle + half)
        draw.rectangle(box, fill=part.rgb, outline=INK)
        at = (left + SWATCH_PX + CAPTION_MARGIN_PX, middle)
        draw.text(at, part.text, fill=INK, font=font, anchor="lm")
    return np.concatenate([painted, np.asarray(image)], axis=0)
