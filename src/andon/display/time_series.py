"""Curves over time, one panel below the other, and bars: what a report of a recording shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["COLOURS", "Bars", "Curve", "Panel", "Spans", "drawn", "tick_values"]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]
Colour = tuple[int, int, int]

INK, PAPER, RULE = (32, 32, 32), (250, 249, 246), (222, 220, 214)
COLOURS: tuple[Colour, ...] = ((125, 125, 120), (200, 60, 30), (30, 90, 170), (20, 130, 70))
WIDTH_PX, PANEL_PX = 1200, 340
LEFT_PX, RIGHT_PX, TOP_PX, BOTTOM_PX = 84, 24, 64, 56
# Drawn larger and scaled down: Pillow's lines have no smooth edges of their own.
OVERSAMPLING = 2
STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through (n,) points; it is broken where `y` is NaN and where `x` jumps."""

    name: str
    colour: Colour
    x: Float
    y: Float
    width_px: float = 1.5
    longest_step: float = np.inf


@dataclass(frozen=True, eq=False)
class Spans:
    """(k, 2) intervals on the x axis, shaded over the whole height."""

    name: str
    colour: Colour
    intervals: Float


@dataclass(frozen=True, eq=False)
class Bars:
    """(n,) shares of a whole over (n + 1,) edges, as a stepped outline."""

    name: str
    colour: Colour
    edges: Float
    shares: Float


@dataclass(frozen=True)
class Panel:
    """One diagram; `x_range` and `y_range` are its ends, what lies outside is cut off there."""

    title: str
    x_label: str
    y_label: str
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    curves: Sequence[Curve] = ()
    bars: Sequence[Bars] = ()
    spans: Sequence[Spans] = ()


def tick_values(low: float, high: float, most: int = 10) -> list[float]:
    """At most `most` round numbers within low…high: steps of 1, 2, 2.5 or 5 × 10ⁿ."""
    power = 10.0 ** np.floor(np.log10((high - low) / most))
    step = next(s * power for s in STEPS if (high - low) / (s * power) <= most)
    first = int(np.ceil(low / step - 1e-9))
    count = int(np.floor(high / step + 1e-9)) - first + 1
    return [float(f"{(first + i) * step:.10g}") for i in range(count)]


def drawn(panels: Sequence[Panel], /, *, width_px: int = WIDTH_PX) -> Rgb:
    """(H, W, 3) uint8: the panels, from above to below, with axes, units and legends."""
    from PIL import Image, ImageDraw

    size = width_px, PANEL_PX * len(panels)
    image = Image.new("RGB", (size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), PAPER)
    pen: Any = ImageDraw.Draw(image)
    for index, panel in enumerate(panels):
        _Sheet(panel, pen, width_px, index * PANEL_PX).draw()
    return np.asarray(image.resize(size, Image.Resampling.LANCZOS), np.uint8)


class _Sheet:
    """A panel and where it lies on the picture."""

    def __init__(self, panel: Panel, pen: Any, width_px: int, top_px: int) -> None:
        from PIL import ImageFont

        self.panel, self.pen = panel, pen
        self.left, self.right = LEFT_PX, width_px - RIGHT_PX
        self.top, self.bottom = top_px + TOP_PX, top_px + PANEL_PX - BOTTOM_PX
        self.font: Any = ImageFont.load_default(size=13 * OVERSAMPLING)
        self.large: Any = ImageFont.load_default(size=16 * OVERSAMPLING)

    def across(self, x: Float | float) -> Float:
        low, high = self.panel.x_range
        share = np.clip((np.asarray(x, float) - low) / (high - low), 0, 1)
        return (self.left + share * (self.right - self.left)) * OVERSAMPLING

    def down(self, y: Float | float) -> Float:
        low, high = self.panel.y_range
        share = np.clip((np.asarray(y, float) - low) / (high - low), 0, 1)
        return (self.bottom - share * (self.bottom - self.top)) * OVERSAMPLING

    def draw(self) -> None:
        for spans in self.panel.spans:
            self._shade(spans)
        self._axes()
        for bars in self.panel.bars:
            x, y = np.repeat(bars.edges, 2), np.concatenate([[0], np.repeat(bars.shares, 2), [0]])
            self._line(self.across(x), self.down(y), bars.colour, 2.0)
        for curve in self.panel.curves:
            self._curve(curve)
        self._legend()

    def _shade(self, spans: Spans) -> None:
        top, bottom = self.top * OVERSAMPLING, self.bottom * OVERSAMPLING
        for first, last in spans.intervals:
            # Half a pixel at least, or short blinks vanish.
            x0, x1 = self.across(first), self.across(last)
            self.pen.rectangle([x0, top, max(x1, x0 + 1), bottom], fill=spans.colour)

    def _axes(self) -> None:
        s = OVERSAMPLING
        for value in tick_values(*self.panel.x_range, most=14):
            x = float(self.across(value))
            self.pen.line([(x, self.top * s), (x, self.bottom * s)], RULE, s)
            self.pen.text((x, (self.bottom + 6) * s), f"{value:g}", INK, self.font, anchor="mt")
        for value in tick_values(*self.panel.y_range, most=8):
            y = float(self.down(value))
            self.pen.line([(self.left * s, y), (self.right * s, y)], RULE, s)
            self.pen.text(((self.left - 6) * s, y), f"{value:g}", INK, self.font, anchor="rm")
        middle = (self.left + self.right) / 2 * s
        below = (self.bottom + 42) * s
        self.pen.text((middle, below), self.panel.x_label, INK, self.font, anchor="mb")
        self.pen.text((self.left * s, (self.top - 8) * s), self.panel.y_label, INK, self.font, "lb")
        self.pen.text((self.left * s, (self.top - 30) * s), self.panel.title, INK, self.large, "lb")

    def _curve(self, curve: Curve) -> None:
        ends = np.flatnonzero(
            np.isnan(curve.y[1:]) | np.isnan(curve.y[:-1]) | (np.diff(curve.x) > curve.longest_step)
        )
        for part in np.split(np.arange(len(curve.x)), ends + 1):
            part = part[np.isfinite(curve.y[part])]
            if len(part) == 1:  # a sample alone
                part = np.repeat(part, 2)
            if len(part):
                x, y = self.across(curve.x[part]), self.down(curve.y[part])
                self._line(x, y, curve.colour, curve.width_px)

    def _line(self, x: Float, y: Float, colour: Colour, width_px: float) -> None:
        if len(x) == 2 and x[0] == x[1] and y[0] == y[1]:
            x = x + np.array([-1.0, 1.0])
        places = list(zip(x.tolist(), y.tolist(), strict=True))
        self.pen.line(places, colour, round(width_px * OVERSAMPLING), joint="curve")

    def _legend(self) -> None:
        s = OVERSAMPLING
        x, y = self.right * s, (self.top - 14) * s
        entries = [*self.panel.curves, *self.panel.bars, *self.panel.spans]
        for entry in reversed(entries):
            x -= self.font.getlength(entry.name)
            self.pen.text((x, y), entry.name, INK, self.font, anchor="lm")
            x -= 24 * s
            thick = 5 if isinstance(entry, Spans) else 1.5
            box = [x, y - thick * s, x + 18 * s, y + thick * s]
            self.pen.rectangle(box, fill=entry.colour)
            x -= 16 * s
