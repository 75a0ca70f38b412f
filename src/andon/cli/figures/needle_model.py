"""Figure 6: what the model of needles consists of, drawn from the model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from andon.cli.figures.model import Asked, Figure, Panel
from andon.display.time_series import INK, PAPER, Curve, drawn
from andon.display.time_series import Panel as Plot
from andon.glare.model import Source
from andon.glare.needles import NeedleModel, Needles, needles_of
from andon.glare.needles.determinants import number_of
from andon.glare.needles.model import REFERENCE_NM, WAVELENGTHS_NM
from andon.glare.needles.reference import profile_within, tent_within
from andon.glare.shapes import circle, ellipse
from andon.observer.spread.model import Eye

__all__ = ["draw_model"]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]
Point = tuple[float, float]

# Size of its two halves.
STAR_PX, PLOTS_PX, HEIGHT_PX = 760, 640, 900
# Lines are drawn larger and scaled down, which makes them smooth.
FINER = 3
# Of the star that is shown: semi-axes of the source, how wide the sketch sees, and how much wider
# than they are its needles are drawn, or nobody would see that they taper.
SOURCE_DEGREES, SEEN_DEGREES, WIDER = (0.5, 0.17), 5.2, 1.25
LUX, AMBIENT_CD_M2 = 1.0, 0.1
# The needle that is labelled is the longest within these azimuths.
LABELLED_DEGREES = (-58.0, -15.0)
RAY, MARK, SOURCE = (92, 92, 100), (200, 60, 30), (240, 176, 46)
# Ends of the axis of light along a needle: its tip goes to 0.
ALONG = (0.01, 10.0)
# … and of their number.
NUMBERS = (0.5, 500.0)
CHANNELS = (("red", (200, 60, 30)), ("green", (20, 130, 70)), ("blue", (30, 90, 170)))


def draw_model(asked: Asked, step: Callable[[], None], /) -> tuple[Figure, ...]:
    """The figure, in one size: it has text."""
    model = NeedleModel()
    eye = replace(asked, glasses="none").eye(AMBIENT_CD_M2)
    star = _star(eye, asked.seed, model)
    sheet = np.concatenate([_sketch(star, model), _plots(model, eye)], axis=1)
    step()
    caption = "number, length and angle are the eye's Gaussian noise; a tent across"
    panel = Panel("6-needle-model", caption, sheet)
    return (Figure("figure-6", "Figure 6.  The model of needles", "フレアラインモデル", (panel,)),)


def _star(eye: Eye, seed: int, model: NeedleModel) -> Needles:
    a, b = np.radians(SOURCE_DEGREES)
    source = Source(np.array([0.0, 0.0, 1.0]), np.full(3, LUX), ellipse(float(a), float(b)))
    return needles_of(source, eye, AMBIENT_CD_M2, seed, model=model)


def _sketch(star: Needles, model: NeedleModel) -> Rgb:
    """The star with its needles as wedges, and one of them with its measures."""
    size = STAR_PX * FINER, HEIGHT_PX * FINER
    image = Image.new("RGB", size, PAPER)
    pen: Any = ImageDraw.Draw(image)
    middle, scale = (size[0] / 2, size[1] * 0.46), size[0] / SEEN_DEGREES
    for index in range(len(star)):
        pen.polygon(_wedge(star, index, model, middle, scale), fill=RAY)
    a, b = (degrees * scale for degrees in SOURCE_DEGREES)
    pen.ellipse([middle[0] - a, middle[1] - b, middle[0] + a, middle[1] + b], fill=SOURCE)
    _measures(pen, star, model, middle, scale)
    _legend(pen, size, model)
    return np.asarray(image.resize((STAR_PX, HEIGHT_PX), Image.Resampling.LANCZOS), np.uint8)


def _at(middle: Point, azimuth: float, degrees: float, scale: float, aside: float = 0.0) -> Point:
    """Pixels of a place at an angle from the source, `aside` degrees across."""
    x, y = np.cos(azimuth), np.sin(azimuth)
    return (
        middle[0] + scale * (degrees * x - aside * y),
        middle[1] + scale * (degrees * y + aside * x),
    )


def _wedge(
    star: Needles, index: int, model: NeedleModel, middle: Point, scale: float
) -> list[Point]:
    azimuth = float(star.azimuth_radians[index])
    start, length = np.degrees([star.start_radians[index], star.length_radians[index]])
    foot = WIDER * float(np.degrees(star.half_width_radians[index]))
    tip = foot * model.taper
    return [
        _at(middle, azimuth, start, scale, foot),
        _at(middle, azimuth, start + length, scale, tip),
        _at(middle, azimuth, start + length, scale, -tip),
        _at(middle, azimuth, start, scale, -foot),
    ]


def _measures(pen: Any, star: Needles, model: NeedleModel, middle: Point, scale: float) -> None:
    """Angle, outline and length of one needle."""
    first, last = np.radians(LABELLED_DEGREES)
    turned = np.angle(np.exp(1j * star.azimuth_radians))  # -π…π
    within = (turned > first) & (turned < last)
    if not within.any():
        return
    index = int(np.argmax(np.where(within, star.length_radians, -1)))
    azimuth = float(turned[index])
    start, length = np.degrees([star.start_radians[index], star.length_radians[index]])
    pen.polygon(_wedge(star, index, model, middle, scale), fill=MARK)
    far = 1.9
    pen.line([middle, _at(middle, 0.0, far, scale)], fill=MARK, width=FINER)
    radius = 0.82 * far * scale
    box = [middle[0] - radius, middle[1] - radius, middle[0] + radius, middle[1] + radius]
    pen.arc(box, np.degrees(azimuth), 0, fill=MARK, width=2 * FINER)
    _text(pen, _at(middle, 0.75 * azimuth, 0.82 * far + 0.08, scale), "ang", MARK, "lm")
    pen.line([middle, _at(middle, azimuth, start, scale)], fill=INK, width=2 * FINER)
    aside = -0.16
    ends = [_at(middle, azimuth, at, scale, aside) for at in (start, start + length)]
    pen.line(ends, fill=MARK, width=2 * FINER)
    for at in (start, start + length):
        tick = [_at(middle, azimuth, at, scale, aside + side) for side in (-0.06, 0.06)]
        pen.line(tick, fill=MARK, width=2 * FINER)
    _text(pen, _at(middle, azimuth, start + 0.62 * length, scale, aside - 0.12), "len", MARK, "rb")
    note, edge = (_at(middle, -np.pi / 2, at, scale) for at in (1.5, SOURCE_DEGREES[1]))
    pen.line([note, edge], fill=INK, width=FINER)
    text, beside = "outline, where needles begin", (note[0] + 0.25 * scale, note[1])
    pen.rectangle(pen.textbbox(beside, text, font=_font(20), anchor="rb"), fill=PAPER)
    _text(pen, beside, text, INK, "rb")


def _legend(pen: Any, size: tuple[int, int], model: NeedleModel) -> None:
    lines = (
        "num = k |1 + s g| I G / (S Bl Mg)",
        "len = len0 |g| (I / (Bl Mg))^(1/m) P / P0",
        f"ang: even around a circle, else two lobes of {model.lobe_degrees:g}°",
        "I light at the eye, S size, Bl background, Mg mist, G glasses, P pupil; g Gaussian",
        f"widths are drawn {WIDER:g} times as wide",
    )
    pen.text((FINER * 24, FINER * 20), "Needles of one source", fill=INK, font=_font(22))
    for number, line in enumerate(lines):
        at = (FINER * 24, size[1] - FINER * (28 * (len(lines) - number) + 12))
        _text(pen, at, line, INK, "la", 18)


def _font(size: int) -> Any:
    return ImageFont.load_default(size=size * FINER)


def _text(pen: Any, at: Point, text: str, ink: Any, anchor: str, size: int = 20) -> None:
    pen.text(at, text, fill=ink, font=_font(size), anchor=anchor)


def _plots(model: NeedleModel, eye: Eye) -> Rgb:
    return drawn([_across(model), _along(model), _numbers(model, eye)], width_px=PLOTS_PX)


def _across(model: NeedleModel) -> Plot:
    """The tent at the foot and at the tip, with as much light in each."""
    x = np.linspace(-1.2, 1.2, 241)
    curves: list[Curve] = []
    for name, colour, wide in (
        ("at the outline", INK, 1.0),
        ("half way", RAY, (1 + model.taper) / 2),
        ("at the tip", MARK, model.taper),
    ):
        share = np.gradient(tent_within(x / wide), x)
        curves.append(Curve(name, colour, x * model.width_degrees / 2, share, 2.0))
    half = 1.2 * model.width_degrees / 2
    return Plot(
        "Across: a tent that narrows",
        "angle across the needle, degrees",
        "light per width",
        (-half, half),
        (0.0, 1.1 / model.taper),
        curves,
        height_px=300,
    )


def _along(model: NeedleModel) -> Plot:
    """Light along a needle of len0, by channel."""
    x = np.linspace(0, 1.5 * model.length_degrees, 400)
    curves: list[Curve] = []
    for (name, colour), nm in zip(CHANNELS, WAVELENGTHS_NM, strict=True):
        reach = model.length_degrees * nm / REFERENCE_NM
        light = np.gradient(profile_within(x / reach, model), x)
        shown = np.where(light > ALONG[0], light, np.nan)
        curves.append(Curve(f"{name}, {nm:g} nm", colour, x, shown, 2.0))
    return Plot(
        "Along: red light is thrown farther than blue",
        "angle from the outline, degrees",
        "light per length",
        (0.0, 1.5 * model.length_degrees),
        ALONG,
        curves,
        logarithmic="y",
        height_px=300,
    )


def _numbers(model: NeedleModel, eye: Eye) -> Plot:
    """How many needles, over the light at the eye."""
    lux = np.geomspace(0.01, 10, 200)
    glasses = Eye(eye.age_years, glasses="spectacles", glasses_dioptres=-model.dioptres)
    plain = Eye(eye.age_years)
    curves: list[Curve] = []
    for name, colour, degrees, who in (
        ("a point", INK, 0.01, plain),
        ("a disc of 1°", RAY, 0.5, plain),
        (f"a point, glasses of -{model.dioptres:g} D", MARK, 0.01, glasses),
    ):
        outline = circle(float(np.radians(degrees)))
        forward = np.array([0.0, 0.0, 1.0])
        count = [
            number_of(Source(forward, np.full(3, light), outline), who, AMBIENT_CD_M2, 0.0, model)
            for light in lux
        ]
        shown = np.where(np.array(count) >= NUMBERS[0], count, np.nan)
        curves.append(Curve(name, colour, lux, shown, 2.0))
    return Plot(
        f"How many, against a background of {AMBIENT_CD_M2:g} cd/m2",
        "illuminance at the eye, lx",
        "number",
        (0.01, 10.0),
        NUMBERS,
        curves,
        logarithmic="xy",
        height_px=300,
    )
