"""All figures on one sheet, each a row of captioned panels under its title."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from andon.cli.figures.model import Figure
from andon.display.false_colour import GAP_PX, INK, PAPER, contact_sheet

__all__ = ["row_of", "sheet_of"]

Rgb = NDArray[np.uint8]

SHEET_PX, TITLE_PX = 1440, 46
# Fonts with Japanese that systems bring along, by the names that Pillow finds them under.
JAPANESE_FONTS = (
    "NotoSansCJK-Regular.ttc",
    "NotoSansJP-Regular.otf",
    "ipagp.ttf",
    "ipag.ttf",
    "TakaoPGothic.ttf",
    "DroidSansFallbackFull.ttf",
    "YuGothM.ttc",
    "meiryo.ttc",
    "Hiragino Sans GB.ttc",
)


def sheet_of(figures: Sequence[Figure], /) -> Rgb:
    """(H, 1440, 3): figures from above to below, each as wide as the sheet."""
    rows: list[Rgb] = []
    for figure in figures:
        count = len(figure.panels)
        row = row_of(figure, (SHEET_PX - (count - 1) * GAP_PX) // count)
        rows += [_title(figure), _filled(row)]
    return np.concatenate(rows)


def row_of(figure: Figure, width: int | None = None, /) -> Rgb:
    """(H, W, 3): the panels of a figure side by side, each `width` wide, or as it is."""
    tiles = [
        (panel.caption, panel.picture if width is None else _sized(panel.picture, width))
        for panel in figure.panels
    ]
    return contact_sheet(tiles, columns=len(tiles), gap_px=GAP_PX)


def _title(figure: Figure) -> Rgb:
    """The figure's number and name; the paper's own word beside it, if a font can write it."""
    image = Image.new("RGB", (SHEET_PX, TITLE_PX), PAPER)
    pen: Any = ImageDraw.Draw(image)
    font: Any = ImageFont.load_default(size=20)
    at = TITLE_PX * 0.62
    pen.text((8, at), figure.title, fill=INK, font=font, anchor="lm")
    japanese: Any = _japanese(20)
    if japanese is not None:
        left = 8 + font.getlength(figure.title + "   ")
        pen.text((left, at), figure.term, fill=INK, font=japanese, anchor="lm")
    return np.asarray(image, np.uint8)


def _japanese(size: int) -> Any:
    """A font with Japanese; None where none is at hand."""
    for name in JAPANESE_FONTS:
        try:
            return ImageFont.truetype(name, size)
        except OSError:
            continue
    return None


def _sized(picture: Rgb, width: int) -> Rgb:
    height = max(1, round(picture.shape[0] * width / picture.shape[1]))
    method = cv2.INTER_AREA if width < picture.shape[1] else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(picture, (width, height), interpolation=method), np.uint8)


def _filled(row: Rgb) -> Rgb:
    """As wide as the sheet: paper beside it."""
    sheet = np.full((row.shape[0], SHEET_PX, 3), PAPER, np.uint8)
    sheet[:, : row.shape[1]] = row
    return sheet
