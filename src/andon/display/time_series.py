"""Curves, points and bars, one panel below the other: over time, or on logarithmic axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.display.dashes import dash_mask

__all__ = ["COLOURS", "Bars", "Curve", "Panel", "Points", "Spans", "drawn", "tick_values"]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]
Colour = tuple[int, int, int]

INK, PAPER, RULE = (32, 32, 32), (250, 249, 246), (222, 220, 214)
# Between the numbers of a logarithmic axis.
FINE_RULE = (238, 236, 231)
COLOURS: tuple[Colour, ...] = ((125, 125, 120), (200, 60, 30), (30, 90, 170), (20, 130, 70))
WIDTH_PX, PANEL_PX = 1200, 340
LEFT_PX, RIGHT_PX, TOP_PX, BOTTOM_PX = 84, 24, 64, 56
# Between the rows of a legend inside.
LEGEND_PX = 19
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
    dash_px: float | None = None


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


@dataclass(frozen=True, eq=False)
class Points:
    """(n,) points as discs, drawn in their order and below the curves; NaN is none."""

    name: str
    colour: Colour
    x: Float
    y: Float
    width_px: float = 2.0


@dataclass(frozen=True)
class Panel:
    """One diagram; `x_range` and `y_range` are its ends, what lies outside is cut off there.

    Axes named in `logarithmic` have ends > 0 and a line for every 1, 2, … 9 × 10ⁿ. The legend is a
    row above, or a column `inside`, at the top right; what has no name is not in it.
    """

    title: str
    x_label: str
    y_label: str
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    curves: Sequence[Curve] = ()
    bars: Sequence[Bars] = ()
    spans: Sequence[Spans] = ()
    points: Sequence[Points] = ()
    logarithmic: Literal["", "x", "y", "xy"] = ""
    legend: Literal["above", "inside", "none"] = "above"
    height_px: int = PANEL_PX


def tick_values(low: float, high: float, most: int = 10) -> list[float]:
    """At most `most` round numbers within low…high: steps of 1, 2, 2.5 or 5 × 10ⁿ."""
    power = 10.0 ** np.floor(np.log10((high - low) / most))
    step = next(s * power for s in STEPS if (high - low) / (s * power) <= most)
    first = int(np.ceil(low / step - 1e-9))
    count = int(np.floor(high / step + 1e-9)) - first + 1
    return [float(f"{(first + i) * step:.10g}") for i in range(count)]


def decade_lines(low: float, high: float) -> list[tuple[float, str]]:
    """Values 1, 2, … 9 × 10ⁿ within low…high, > 0, and what is written at them: powers of 10 only.

    Axes of two decades and less have numbers at 2 and 5 too.
    """
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    written = (1, 2, 5) if high / low <= 100 else (1,)
    return [
        (value, f"{value:g}" if factor in written else "")
        for power in powers
        for factor in range(1, 10)
        if low * (1 - 1e-9) <= (value := float(f"{factor}e{power}")) <= high * (1 + 1e-9)
    ]


def drawn(panels: Sequence[Panel], /, *, width_px: int = WIDTH_PX) -> Rgb:
    """(H, W, 3) uint8: the panels, from above to below, with axes, units and legends."""
    from PIL import Image, ImageDraw

    size = width_px, sum(panel.height_px for panel in panels)
    image = Image.new("RGB", (size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), PAPER)
    pen: Any = ImageDraw.Draw(image)
    top_px = 0
    for panel in panels:
        _Sheet(panel, pen, width_px, top_px).draw()
        top_px += panel.height_px
    return np.asarray(image.resize(size, Image.Resampling.LANCZOS), np.uint8)


class _Sheet:
    """A panel and where it lies on the picture."""

    def __init__(self, panel: Panel, pen: Any, width_px: int, top_px: int) -> None:
        from PIL import ImageFont

        self.panel, self.pen = panel, pen
        self.left, self.right = LEFT_PX, width_px - RIGHT_PX
        self.top, self.bottom = top_px + TOP_PX, top_px + panel.height_px - BOTTOM_PX
        self.font: Any = ImageFont.load_default(size=13 * OVERSAMPLING)
        self.large: Any = ImageFont.load_default(size=16 * OVERSAMPLING)

    def across(self, x: Float | float) -> Float:
        share = self._share("x", x, self.panel.x_range)
        return (self.left + share * (self.right - self.left)) * OVERSAMPLING

    def down(self, y: Float | float) -> Float:
        share = self._share("y", y, self.panel.y_range)
        return (self.bottom - share * (self.bottom - self.top)) * OVERSAMPLING

    def _share(self, axis: str, value: Float | float, ends: tuple[float, float]) -> Float:
        """How far along its axis a value lies, 0…1."""
        place = np.clip(np.asarray(value, float), *ends)
        if axis in self.panel.logarithmic:
            return np.log(place / ends[0]) / np.log(ends[1] / ends[0])
        return (place - ends[0]) / (ends[1] - ends[0])

    def _lines(self, axis: str, ends: tuple[float, float], most: int) -> list[tuple[float, str]]:
        """Values of the grid's lines and what is written at them."""
        if axis in self.panel.logarithmic:
            return decade_lines(*ends)
        return [(value, f"{value:g}") for value in tick_values(*ends, most=most)]

    def draw(self) -> None:
        for spans in self.panel.spans:
            self._shade(spans)
        self._axes()
        for bars in self.panel.bars:
            x, y = np.repeat(bars.edges, 2), np.concatenate([[0], np.repeat(bars.shares, 2), [0]])
            self._line(self.across(x), self.down(y), bars.colour, 2.0)
        for points in self.panel.points:
            known = np.isfinite(points.x) & np.isfinite(points.y)
            places = self.across(points.x[known]), self.down(points.y[known])
            self._discs(*places, points.colour, points.width_px)
        for curve in self.panel.curves:
            self._curve(curve)
        self._legend()

    def _discs(self, x: Float, y: Float, colour: Colour, width_px: float) -> None:
        reach = width_px / 2 * OVERSAMPLING
        for a, b in zip(x.tolist(), y.tolist(), strict=True):
            self.pen.ellipse([a - reach, b - reach, a + reach, b + reach], fill=colour)

    def _shade(self, spans: Spans) -> None:
        top, bottom = self.top * OVERSAMPLING, self.bottom * OVERSAMPLING
        for first, last in spans.intervals:
            # Half a pixel at least, or short blinks vanish.
            x0, x1 = self.across(first), self.across(last)
            self.pen.rectangle([x0, top, max(x1, x0 + 1), bottom], fill=spans.colour)

    def _axes(self) -> None:
        s = OVERSAMPLING
        for value, text in self._lines("x", self.panel.x_range, most=14):
            x = float(self.across(value))
            rule = RULE if text else FINE_RULE
            self.pen.line([(x, self.top * s), (x, self.bottom * s)], rule, s)
            self.pen.text((x, (self.bottom + 6) * s), text, INK, self.font, anchor="mt")
        for value, text in self._lines("y", self.panel.y_range, most=8):
            y = float(self.down(value))
            rule = RULE if text else FINE_RULE
            self.pen.line([(self.left * s, y), (self.right * s, y)], rule, s)
            self.pen.text(((self.left - 6) * s, y), text, INK, self.font, anchor="rm")
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
                self._line(x, y, curve.colour, curve.width_px, curve.dash_px)

    def _line(
        self, x: Float, y: Float, colour: Colour, width_px: float, dash_px: float | None = None
    ) -> None:
        if len(x) == 2 and x[0] == x[1] and y[0] == y[1]:
            x = x + np.array([-1.0, 1.0])
        points = np.stack([x, y], axis=-1)
        pieces = [points]
        if dash_px is not None:
            ink = dash_mask(points, dash_px * OVERSAMPLING)
            pieces = [points[i : i + 2] for i in np.flatnonzero(ink)]
        for piece in pieces:
            places = [(float(a), float(b)) for a, b in piece]
            self.pen.line(places, colour, round(width_px * OVERSAMPLING), joint="curve")

    def _legend(self) -> None:
        panel = self.panel
        entries = [*panel.curves, *panel.points, *panel.bars, *panel.spans]
        entries = [entry for entry in entries if entry.name]
        s = OVERSAMPLING
        if self.panel.legend == "none":
            return
        if self.panel.legend == "inside":
            widest = max((self.font.getlength(entry.name) for entry in entries), default=0.0)
            x = (self.right - 16) * s - widest
            for row, entry in enumerate(entries):
                y = (self.top + 16 + LEGEND_PX * row) * s
                self.pen.text((x, y), entry.name, INK, self.font, anchor="lm")
                self._swatch(entry, x - 44 * s, x - 8 * s, y)
            return
        x, y = self.right * s, (self.top - 14) * s
        for entry in reversed(entries):
            x -= self.font.getlength(entry.name)
            self.pen.text((x, y), entry.name, INK, self.font, anchor="lm")
            x -= 24 * s
            self._swatch(entry, x, x + 18 * s, y)
            x -= 16 * s

    def _swatch(
        self, entry: Curve | Points | Bars | Spans, first: float, last: float, y: float
    ) -> None:
        if isinstance(entry, Spans):
            reach = 5 * OVERSAMPLING
            self.pen.rectangle([first, y - reach, last, y + reach], fill=entry.colour)
            return
        if isinstance(entry, Points):
            middle, width_px = np.array([(first + last) / 2]), max(entry.width_px, 6.0)
            self._discs(middle, np.array([y]), entry.colour, width_px)
            return
        # Pieces short enough for dashes to show.
        x = np.linspace(first, last, 19)
        dash_px = entry.dash_px if isinstance(entry, Curve) else None
        self._line(x, np.full(len(x), y), entry.colour, 3.0, dash_px)
