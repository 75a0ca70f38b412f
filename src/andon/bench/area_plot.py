"""Error against cost of area lamps' soft shadows, as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from andon.bench.areas import KINDS, costs_and_errors

__all__ = ["draw_plot", "write_plot"]

COUNTS = (0, 1, 4, 9, 16, 36, 64)
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 900, 560, 90, 40, 50, 70
# Drawn larger and scaled down: Pillow's lines have no smooth edges of their own.
OVERSAMPLING = 2
INK, PAPER, RULE = (32, 32, 32), (250, 249, 246), (215, 213, 208)
COLOURS = ((200, 60, 30), (30, 90, 170), (20, 130, 70), (140, 70, 160))
Series = dict[str, list[tuple[int, float, float]]]


def write_plot(path: Path, quick: bool) -> None:
    """Measures, prints a table and draws it: milliseconds a lamp at 1280×720 against RMS error."""
    from andon.files.pictures import write_picture

    counts, repeats = ((0, 4, 16), 2) if quick else (COUNTS, 5)
    truth = 64 if quick else 256
    series: Series = {}
    print("lamp       samples   ms a lamp   RMS error")
    for kind in KINDS:
        series[kind] = costs_and_errors(kind, counts, truth_samples=truth, repeats=repeats)
        for count, cost_ms, error in series[kind]:
            print(f"{kind:10} {count:7}   {cost_ms:9.1f}   {error:9.2%}", flush=True)
    write_picture(path, draw_plot(series))
    print(path)


def draw_plot(series: Series, /) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """(H, W, 3) uint8: one line a kind, one dot a count of samples; both axes logarithmic."""
    from PIL import Image, ImageDraw, ImageFont

    scale = OVERSAMPLING
    image = Image.new("RGB", (WIDTH * scale, HEIGHT * scale), PAPER)
    draw: Any = ImageDraw.Draw(image)
    font: Any = ImageFont.load_default(size=15 * scale)
    points = [(ms, error) for rows in series.values() for count, ms, error in rows if count]
    x_low, x_high = _decades([max(ms, 0.5) for ms, _ in points])
    y_low, y_high = _decades([error * 100 for _, error in points])

    def place(ms: float, percent: float) -> tuple[float, float]:
        x = (np.log10(max(ms, 0.5)) - x_low) / (x_high - x_low)
        y = (np.log10(percent) - y_low) / (y_high - y_low)
        across = LEFT + x * (WIDTH - LEFT - RIGHT)
        down = HEIGHT - BOTTOM - y * (HEIGHT - TOP - BOTTOM)
        return float(across * scale), float(down * scale)

    for value in _ticks(x_low, x_high):
        low, high = place(value, 10**y_low), place(value, 10**y_high)
        draw.line([low, high], RULE, scale)
        draw.text((low[0], low[1] + 8 * scale), f"{value:g}", INK, font, anchor="mt")
    for value in _ticks(y_low, y_high):
        left, right = place(10**x_low, value), place(10**x_high, value)
        draw.line([left, right], RULE, scale)
        draw.text((left[0] - 8 * scale, left[1]), f"{value:g} %", INK, font, anchor="rm")
    for (kind, rows), colour in zip(series.items(), COLOURS, strict=False):
        spots = [place(ms, error * 100) for count, ms, error in rows if count]
        draw.line(spots, colour, 2 * scale, joint="curve")
        for (x, y), (count, _, _) in zip(spots, [row for row in rows if row[0]], strict=True):
            radius = 4 * scale
            draw.ellipse([x - radius, y - radius, x + radius, y + radius], colour)
            if kind == KINDS[0]:  # the others' dots stand for the same counts
                draw.text((x, y + 8 * scale), f"{count}", colour, font, anchor="mt")
        row = TOP + 20 * list(series).index(kind)
        plain = next((f"{error:.0%}" for count, _, error in rows if not count), "")
        words = f"{kind} (no shadow: {plain})" if plain else kind
        draw.text(((WIDTH - RIGHT) * scale, row * scale), words, colour, font, anchor="rm")
    title = "Soft shadows of area lamps: error against cost, by samples"
    draw.text((LEFT * scale, 14 * scale), title, INK, font)
    x_title = "ms a lamp, 1280 x 720 pixels"  # Pillow's own font has no ×
    draw.text((WIDTH * scale / 2, (HEIGHT - 16) * scale), x_title, INK, font, anchor="mb")
    return np.asarray(image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS), np.uint8)


def _decades(values: list[float]) -> tuple[float, float]:
    """Ends of an axis, as powers of ten: fifths of a decade around the values."""
    low, high = np.log10(min(values)), np.log10(max(values))
    return float(np.floor(5 * low - 0.5) / 5), float(np.ceil(5 * high + 0.5) / 5)


def _ticks(low: float, high: float) -> list[float]:
    steps = [factor * 10.0**power for power in range(-4, 6) for factor in (1, 1.5, 2, 3, 5, 7)]
    return [value for value in steps if 10**low <= value <= 10**high * 1.001]
