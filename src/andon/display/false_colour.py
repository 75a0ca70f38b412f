"""Measured quantities as pictures for people: false colours with a scale bar, contact sheets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "GAP_PX",
    "contact_sheet",
    "depth_picture",
    "false_colour",
    "normal_picture",
    "top_of",
]

Rgb = NDArray[np.uint8]

BAR_WIDTH_PX = 74
# Height of a line of a caption, of its letters, and its distance from the border.
CAPTION_PX, CAPTION_FONT_PX, CAPTION_MARGIN_PX = 22, 14, 6
# Between pictures side by side, where they would run into each other.
GAP_PX = 6
# Above the scale there is room for a line with the unit, below for half of the last label.
ABOVE_PX, BELOW_PX = 28, 10
# Height of a label of 12 px, with the air that keeps it apart from the next.
LABEL_PX = 15
INK, PAPER = (32, 32, 32), (245, 243, 238)
HOLE = (60, 60, 60)
# Decades below the maximum that the scale shows: two are what a lit room spans.
DECADES = 2.0


def false_colour(
    values: NDArray[Any],
    unit: str,
    /,
    *,
    valid: NDArray[np.bool_] | None = None,
    top: float | None = None,
) -> Rgb:
    """(H, W + bar, 3) uint8: a logarithmic colour scale over two decades, with a labelled bar.

    Parameters
    ----------
    values : (H, W) ≥ 0, e.g. photometric illuminance in lx.
    unit : written at the bar.
    valid : (H, W); holes are dark grey.
    top : the end of the scale, > 0, for pictures that share one; default: `top_of` the values.
    """
    import cv2

    top = top_of(values if valid is None else values[valid]) if top is None else top
    share = np.log10(np.maximum(values, 1e-12) / top) / DECADES + 1
    codes = (np.clip(np.nan_to_num(share), 0, 1) * 255).astype(np.uint8)
    picture = np.asarray(cv2.applyColorMap(codes, cv2.COLORMAP_INFERNO), np.uint8)[..., ::-1].copy()
    if valid is not None:
        picture[~valid] = HOLE
    return np.concatenate([picture, _bar(len(picture), top, unit)], axis=1)


def top_of(values: NDArray[Any], /) -> float:
    """Where a scale of these values ends: at the next 1, 2 or 5 × 10ⁿ."""
    shown = values[np.isfinite(values)]
    # The 99.5th percentile: one pixel under a bulb would else push the room into one colour.
    return _round_up(max(float(np.percentile(shown, 99.5)) if shown.size else 1.0, 1e-6))


def _round_up(value: float) -> float:
    """The next of 1, 2, 5 × 10ⁿ."""
    power = 10 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1, 2, 5, 10) if step * power >= value))


def _bar(height: int, top: float, unit: str) -> Rgb:
    import cv2
    from PIL import Image, ImageDraw, ImageFont

    # Where the scale would have less than half of the height there is no unit.
    top_px = ABOVE_PX if height >= 2 * (ABOVE_PX + BELOW_PX) else min(BELOW_PX, (height - 1) // 2)
    length = height - top_px - min(BELOW_PX, (height - 1) // 2)
    rows = np.linspace(255, 0, length)[:, None].repeat(16, axis=1).astype(np.uint8)
    image = Image.new("RGB", (BAR_WIDTH_PX, height), PAPER)
    colours = np.asarray(cv2.applyColorMap(rows, cv2.COLORMAP_INFERNO), np.uint8)[..., ::-1]
    image.paste(Image.fromarray(np.ascontiguousarray(colours)), (8, top_px))
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size=12)
    steps = [step for step in (0.5, 1.0, DECADES) if step / DECADES * (length - 1) >= LABEL_PX]
    for power in np.arange(0, DECADES + 0.01, steps[0] if steps else 2 * DECADES):
        y = top_px + power / DECADES * (length - 1)
        draw.line([(24, y), (28, y)], fill=INK)
        draw.text((30, y), f"{float(f'{top / 10**power:.2g}'):g}", fill=INK, font=font, anchor="lm")
    if top_px == ABOVE_PX:
        draw.text((8, 10), unit, fill=INK, font=font, anchor="lm")
    return np.asarray(image)


def depth_picture(depth_m: NDArray[Any], valid: NDArray[np.bool_], /) -> Rgb:
    """(H, W, 3) uint8: near is bright, equal steps of 1/depth; holes are dark grey."""
    import cv2

    inverse = np.zeros(depth_m.shape)
    inverse[valid] = 1 / depth_m[valid]
    low, high = np.percentile(inverse[valid], [0.5, 99.5]) if valid.any() else (0.0, 1.0)
    codes = np.clip((inverse - low) / max(high - low, 1e-12) * 255, 0, 255).astype(np.uint8)
    picture = np.asarray(cv2.applyColorMap(codes, cv2.COLORMAP_VIRIDIS), np.uint8)[..., ::-1].copy()
    picture[~valid] = HOLE
    return picture


def normal_picture(normal: NDArray[Any], valid: NDArray[np.bool_], /) -> Rgb:
    """(H, W, 3) uint8: world normals as ½ + ½n; holes are dark grey."""
    picture = np.asarray(np.nan_to_num(normal * 0.5 + 0.5) * 255 + 0.5, np.uint8)
    picture[~valid] = HOLE
    return picture


def contact_sheet(tiles: Sequence[tuple[str, Rgb]], /, *, columns: int = 3, gap_px: int = 0) -> Rgb:
    """Captioned pictures in rows, all brought to the width of the first.

    A caption that is wider than its picture goes on below, and then all have as many lines.
    Between pictures side by side there are `gap_px` pixels.
    """
    height, width = tiles[0][1].shape[:2]
    captions = [_lines(caption, width) for caption, _ in tiles]
    most = max(len(lines) for lines in captions)
    cells = [
        _captioned(lines + [""] * (most - len(lines)), _resized(tile, width, height))
        for lines, (_, tile) in zip(captions, tiles, strict=True)
    ]
    while len(cells) % columns:
        cells.append(np.full_like(cells[0], PAPER))
    gap = np.full((cells[0].shape[0], gap_px, 3), PAPER, np.uint8)
    rows: list[Rgb] = []
    for first in range(0, len(cells), columns):
        row = [part for cell in cells[first : first + columns] for part in (gap, cell)]
        rows.append(np.concatenate(row[1:], axis=1))
    return np.concatenate(rows, axis=0)


def _resized(tile: Rgb, width: int, height: int) -> Rgb:
    """The tile within (height, width), its shape kept, on paper."""
    import cv2

    scale = min(width / tile.shape[1], height / tile.shape[0])
    size = (max(1, round(tile.shape[1] * scale)), max(1, round(tile.shape[0] * scale)))
    sheet = np.full((height, width, 3), PAPER, np.uint8)
    method = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    inner = np.asarray(cv2.resize(tile, size, interpolation=method), np.uint8)
    top, left = (height - size[1]) // 2, (width - size[0]) // 2
    sheet[top : top + size[1], left : left + size[0]] = inner
    return sheet


def _lines(caption: str, width: int) -> list[str]:
    """The caption in lines that fit over a picture, broken between words."""
    from PIL import ImageFont

    font = ImageFont.load_default(size=CAPTION_FONT_PX)
    lines: list[str] = []
    for word in caption.split(" "):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and font.getlength(longer) <= width - 2 * CAPTION_MARGIN_PX:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def _captioned(lines: Sequence[str], tile: Rgb) -> Rgb:
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("RGB", (tile.shape[1], CAPTION_PX * len(lines)), PAPER)
    font, draw = ImageFont.load_default(size=CAPTION_FONT_PX), ImageDraw.Draw(image)
    for number, line in enumerate(lines):
        at = (CAPTION_MARGIN_PX, CAPTION_PX * number + CAPTION_PX // 2)
        draw.text(at, line, fill=INK, font=font, anchor="lm")
    return np.concatenate([np.asarray(image), tile], axis=0)
