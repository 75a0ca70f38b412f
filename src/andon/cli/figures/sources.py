"""Figures 4 and 5: a point and an ellipse in the dark, with bloom; with needles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from andon.cli.figures.model import FINER, Asked, Figure, Panel
from andon.display.eye_response import printed
from andon.glare.kernel import Kernel
from andon.glare.model import Outline, Source
from andon.glare.needles import needles_of
from andon.glare.needles.reference import draw
from andon.glare.per_source.reference import veil_of_sources, veil_share
from andon.glare.shapes import circle, cylinder, ellipse
from andon.lamps.colour import rgb_factors
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye
from andon.spaces import View, pinhole_view

__all__ = ["draw_blooms", "draw_needles"]

Float = NDArray[np.float64]

# All of these sources give the eye as much light, as a street lamp at some 12 m does; the eye is
# adapted to a dark street.
LUX, AMBIENT_CD_M2, TEMPERATURE_K = 5.0, 0.1, 4200.0
# A point is a small disc: 0.1° across.
POINT_DEGREES = 0.05
# How wide the panels see: the bloom reaches far, needles are fine.
BLOOM_HFOV, NEEDLE_HFOV = 12.0, 9.0
# Height of a panel in widths.
ASPECT = 0.75
# Luminance at which the printed curve is at its middle.
BLOOM_HALF_CD_M2, NEEDLE_HALF_CD_M2 = 60.0, 60.0
# Samples along a side of a pixel on a source's edge.
SAMPLES = 4


def draw_blooms(asked: Asked, step: Callable[[], None], /) -> tuple[Figure, ...]:
    """Figure 4."""
    shapes = (
        (
            "4-point",
            f"point source: a disc of {2 * POINT_DEGREES:g}°",
            circle(_radians(POINT_DEGREES)),
        ),
        ("4-ellipse", "elliptic source, 2° by 0.6°", ellipse(_radians(1.0), _radians(0.3))),
    )
    view, eye = _view(asked, BLOOM_HFOV), asked.eye(AMBIENT_CD_M2)
    panels: list[Panel] = []
    for name, caption, outline in shapes:
        light = _bloomed(_source(outline), view, eye, asked.model)
        panels.append(Panel(name, caption, printed(light, BLOOM_HALF_CD_M2, finer=FINER)))
        step()
    return (
        Figure(
            "figure-4",
            "Figure 4.  Bloom of a point source and of an elliptic source",
            "ブルーム",
            tuple(panels),
        ),
    )


def draw_needles(asked: Asked, step: Callable[[], None], /) -> tuple[Figure, ...]:
    """Figure 5."""
    shapes = (
        ("5-circle", "circle: to all sides", circle(_radians(0.25)), 0.0),
        ("5-ellipse", "ellipse: in two lobes", ellipse(_radians(0.6), _radians(0.15)), 0.0),
        ("5-tube", "tube, tilted", cylinder(_radians(0.7), _radians(0.05)), 35.0),
    )
    view, eye = _view(asked, NEEDLE_HFOV), asked.eye(AMBIENT_CD_M2)
    panels: list[Panel] = []
    for name, caption, outline, turn in shapes:
        source = _source(outline, turn)
        star = needles_of(source, eye, AMBIENT_CD_M2, asked.seed)
        light = _bloomed(source, view, eye, asked.model, kept=1 - star.share)
        panels.append(
            Panel(
                name,
                caption,
                printed(light + draw([star], view), NEEDLE_HALF_CD_M2, finer=FINER),
            )
        )
        step()
    return (
        Figure(
            "figure-5",
            "Figure 5.  Needles of an elliptic source, and of others",
            "フレアライン",
            tuple(panels),
        ),
    )


def _radians(degrees: float) -> float:
    return float(np.radians(degrees))


def _view(asked: Asked, hfov_degrees: float) -> View:
    width = FINER * asked.width
    focal = width / 2 / np.tan(np.radians(hfov_degrees) / 2)
    return pinhole_view(width, FINER * round(asked.width * ASPECT), float(focal))


def _source(outline: Outline, turn_degrees: float = 0.0) -> Source:
    """Straight ahead, its long axis turned clockwise from the horizontal."""
    turn = np.radians(-turn_degrees)
    right = np.array([np.cos(turn), np.sin(turn), 0.0])
    lux = LUX * rgb_factors(temperature_k=TEMPERATURE_K)
    return Source(np.array([0.0, 0.0, 1.0]), lux, outline, right)


def _bloomed(source: Source, view: View, eye: Eye, model: str, kept: float = 1.0) -> Float:
    """(H, W, 3) cd/m² of a source and its bloom; `kept` of its light is not made something else."""
    kernel = Kernel(spread_function(model, eye))
    body = _cover(source, view)[..., None] * source.luminance_cd_m2
    return (1 - veil_share(view, kernel)) * kept * body + veil_of_sources([source], view, kernel)


def _cover(source: Source, view: View) -> Float:
    """(H, W) share of each pixel that the source covers."""
    right, down = source.axes
    places = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
    grid, widest = view.pixel_grid(), float(source.outline.radii_radians.max())
    near = np.linalg.norm(view.directions() - source.direction, axis=-1) < widest + 2 / view.fx
    inside = np.zeros(np.count_nonzero(near))
    for x in places:
        for y in places:
            towards = view.directions_at(grid[near] + np.array([x, y]))
            across, along = towards @ right, towards @ down
            theta = np.arctan2(np.hypot(across, along), towards @ source.direction)
            inside += theta < source.outline.radius(np.arctan2(along, across))
    cover = np.zeros(view.shape)
    cover[near] = inside / SAMPLES**2
    return cover
