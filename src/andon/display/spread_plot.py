"""Spread functions as a picture: over the angle, beside the CIE's standard, and as points look."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.display.false_colour import contact_sheet
from andon.display.reference import tone_curve
from andon.display.time_series import INK, LEFT_PX, PAPER, Curve, Panel, drawn
from andon.errors import InputError
from andon.observer.spread.cie135 import cie135
from andon.observer.spread.model import SpreadFunction
from andon.responses import srgb_encode

__all__ = ["MOST_CURVES", "spread_plot"]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]
Spread = tuple[SpreadFunction, float]

MOST_CURVES = 12
THETA_DEGREES = np.geomspace(0.01, 100, 1601)
LEAST_PER_SR, MOST_PER_SR = 1e-4, 1e7
RATIO = (0.1, 10.0)
# One a model, or where there is one model one an age.
COLOURS = (
    (32, 32, 32),
    (200, 60, 30),
    (230, 150, 20),
    (150, 120, 90),
    (30, 90, 170),
    (20, 130, 70),
    (150, 60, 160),
)
# Of the ages of one model among several, of which there are six at most.
DASHES_PX = (None, 9.0, 4.0, 16.0, 2.5, 26.0)

WIDTH_PX, TILE_COLUMNS = 1200, 4
# Half of a tile, and what is white on it for a point that gives 1 lx at the eye.
TILE_DEGREES, TILE_PX, MARGIN_PX = 5.0, 300, 4
HEADING_PX = 48
WHITE_PER_SR = 60.0
# Of a pixel to a side, over which the model is averaged; even, so that none is the point itself.
SAMPLES = 4


def spread_plot(spreads: Sequence[Spread], /) -> Rgb:
    """(H, W, 3) uint8: three diagrams of 1…12 models, each with the age that it is of.

    Above the bloom in sr⁻¹; in the middle its ratio to CIE 135 at 25 years with brown eyes; below
    how a point of light looks, bloom and halo, in linear light encoded as sRGB. Outside the angles
    that a model is valid for its line is thin.

    Raises `InputError` for more models than the picture has room for.
    """
    if not 0 < len(spreads) <= MOST_CURVES:
        raise InputError(
            f"{len(spreads)} curves asked for, 1 to {MOST_CURVES} can be told apart",
            field="--model",
            remedy="fewer models or ages",
        )
    charts = drawn([_functions(spreads), _ratios(spreads)], width_px=WIDTH_PX)
    tiles = [(_label(spread, age, spreads), _point(spread)) for spread, age in spreads]
    while len(tiles) % TILE_COLUMNS:
        tiles.append(("", np.full_like(tiles[0][1], PAPER)))
    return np.concatenate([charts, _heading(), contact_sheet(tiles, columns=TILE_COLUMNS)])


def _label(spread: SpreadFunction, age: float, spreads: Sequence[Spread]) -> str:
    ages = {years for _, years in spreads}
    return spread.name if ages == {25.0} else f"{spread.name}, {age:g} years"


def _curves(spreads: Sequence[Spread], reference: Float, ends: tuple[float, float]) -> list[Curve]:
    """Bloom over `reference` (n,) where it is within `ends`, a line for each model."""
    names = list(dict.fromkeys(spread.name for spread, _ in spreads))
    ages = list(dict.fromkeys(age for _, age in spreads))
    curves: list[Curve] = []
    for spread, age in spreads:
        model, years = names.index(spread.name), ages.index(age)
        alone = len(names) == 1
        colour = COLOURS[(years if alone else model) % len(COLOURS)]
        dash_px = DASHES_PX[years // len(COLOURS) if alone else years]
        y = _within(spread.bloom_per_sr(THETA_DEGREES) / reference, ends)
        least, most = spread.valid_degrees
        valid = np.clip(THETA_DEGREES, least, most) == THETA_DEGREES
        curves.append(
            Curve(
                _label(spread, age, spreads),
                colour,
                THETA_DEGREES,
                np.where(valid, y, np.nan),
                2.5,
                dash_px=dash_px,
            )
        )
        curves.append(Curve("", colour, THETA_DEGREES, np.where(valid, np.nan, y), 0.75))
    return curves


def _within(y: Float, ends: tuple[float, float]) -> Float:
    return np.where((y >= ends[0]) & (y <= ends[1]), y, np.nan)


def _functions(spreads: Sequence[Spread]) -> Panel:
    ends = LEAST_PER_SR, MOST_PER_SR
    curves = _curves(spreads, np.ones(len(THETA_DEGREES)), ends)
    return Panel(
        "The eye's spread function: light seen at an angle from a point",
        "angle from the point, degrees",
        "1/sr: cd/m2 per lx at the eye",
        (float(THETA_DEGREES[0]), float(THETA_DEGREES[-1])),
        ends,
        curves,
        logarithmic="xy",
        legend="inside",
        height_px=640,
    )


def _ratios(spreads: Sequence[Spread]) -> Panel:
    return Panel(
        "Beside the CIE's standard observer",
        "angle from the point, degrees",
        "ratio to CIE 135, 25 years, pigment 0.5",
        (float(THETA_DEGREES[0]), float(THETA_DEGREES[-1])),
        RATIO,
        _curves(spreads, cie135(THETA_DEGREES), RATIO),
        logarithmic="xy",
        legend="none",
        height_px=400,
    )


def _heading() -> Rgb:
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("RGB", (WIDTH_PX, HEADING_PX), PAPER)
    font = ImageFont.load_default(size=16)
    text = (
        f"A point that gives 1 lx at the eye, {2 * TILE_DEGREES:g}° x {2 * TILE_DEGREES:g}°, "
        f"white: {WHITE_PER_SR:g} cd/m2"  # Pillow's own font has no × and no ²
    )
    ImageDraw.Draw(image).text((LEFT_PX, HEADING_PX / 2), text, fill=INK, font=font, anchor="lm")
    return np.asarray(image)


def _point(spread: SpreadFunction) -> Rgb:
    """A tile with a point of 1 lx in its middle, and a margin of paper."""
    fine = TILE_PX * SAMPLES
    across = ((np.arange(fine) + 0.5) / fine - 0.5) * 2 * TILE_DEGREES
    theta = np.geomspace(1e-4, 2 * TILE_DEGREES, 2000)
    values = spread.per_sr(theta)
    away = np.hypot(across[:, None], across)
    light = np.stack([np.interp(away, theta, values[:, c]) for c in range(3)], axis=-1)
    light = light.reshape(TILE_PX, SAMPLES, TILE_PX, SAMPLES, 3).mean(axis=(1, 3))
    encoded = srgb_encode(tone_curve(light / WHITE_PER_SR, "hue"))
    tile = np.full((TILE_PX, TILE_PX, 3), PAPER, np.uint8)
    tile[:, MARGIN_PX:-MARGIN_PX] = (np.clip(encoded, 0, 1) * 255 + 0.5).astype(np.uint8)[
        :, MARGIN_PX:-MARGIN_PX
    ]
    return tile
