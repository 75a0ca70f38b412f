"""Rows of the light behind glass balls: a ball over a floor, seen straight from above.

::

       ● lamp of 1 cd              The camera looks down from under the ball, at a floor that
        ╲                          has the shadow and the caustic on it.
         ◯  ball, n = 1.51
      ────∗──── floor
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.lamps import PointLamp, Shadow
from andon.pipeline import EngineName, Renderer
from andon.quantities import Geometry
from andon.spaces import look_at, pinhole_view
from andon.transport.direct import reference as direct
from andon.transport.direct.balls import GlassBall
from andon.verify.registry import Row
from andon.verify.setting import prepared_of
from andon.verify.truths import photons

__all__ = [
    "ROWS",
    "Floor",
    "ball_at",
    "caustic",
    "floor_under",
    "flux_error",
    "map_error",
    "shadow_error",
]

Float = NDArray[np.float64]

RADIUS_M, INDEX, ABSORPTION_PER_M = 0.05, 1.51, 2.0
LAMP = np.array([0.25, 0.9, 0.15])
# Touching the floor, with the floor in the focus, and beyond it.
HEIGHTS_M = (0.0505, 0.075, 0.15)
FOCUS_M = HEIGHTS_M[1]
# Pixels of the floor, and what is looked at: 0.24 m.
SIZE, HALF_M = 600, 0.12
PHOTONS = 1_000_000
# Cells of the comparison: 4 mm, where photons are counted, and pixels are averaged.
CELLS, CELL_PX = 60, 10
UP = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Floor:
    """What one engine and the photons make of a floor, lx in cells.

    Attributes
    ----------
    ours, truth : (CELLS, CELLS) means over cells.
    dark : (CELLS, CELLS) share of a cell that the straight line to the lamp does not reach.
    pixels_dark : (SIZE, SIZE) the same as bool, of the middles of pixels.
    pixels : (SIZE, SIZE) what our pixels have.
    beside : (SIZE, SIZE) what they had without the ball.
    cell_m2 : area of a cell.
    landed : the photons themselves.
    """

    ours: Float
    truth: Float
    dark: Float
    pixels_dark: NDArray[np.bool_]
    pixels: Float
    beside: Float
    cell_m2: float
    landed: photons.Landed


def ball_at(height_m: float, /) -> GlassBall:
    """The ball of these rows over the origin."""
    index, absorption = (
        (INDEX, INDEX, INDEX),
        (ABSORPTION_PER_M, ABSORPTION_PER_M, ABSORPTION_PER_M),
    )
    return GlassBall(np.array([0.0, height_m, 0.0]), RADIUS_M, index, absorption)


def floor_under(ball: GlassBall, lamp: PointLamp, engine: EngineName, /) -> Floor:
    """The floor y = 0 under `ball`, around where the lamp's straight line through it ends."""
    down = ball.centre_m - lamp.position_m
    middle = ball.centre_m - down * (ball.centre_m[1] / down[1])
    eye = np.array([middle[0], 1.0, middle[2]])
    pose = look_at(eye, middle, (0.0, 0.0, -1.0))
    view = pinhole_view(SIZE, SIZE, 0.5 * SIZE / HALF_M, pose)
    wide = 2.0
    corners = middle + wide * np.array([(-1.0, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1)])
    corners[:, 1] = 0
    floor = Geometry(corners, np.array([(0, 1, 2), (0, 2, 3)], np.int32))
    prepared = replace(prepared_of(floor, view, (lamp,)), balls=(ball,))
    frame = Renderer(prepared, engine).render()
    place = np.asarray(frame.surface.position, np.float64)
    beside = direct.illuminance(lamp, place, np.broadcast_to(UP, place.shape))[..., 1]
    solid = ball.centre_m, ball.radius_m
    dark = ~photons.is_open(lamp.position_m, *solid, place)
    landed = photons.through_ball(
        lamp.position_m, *solid, ball.index[1], ball.absorption_per_m[1], photons=PHOTONS
    )
    pixels = np.asarray(frame.illuminance.lux, np.float64)[..., 1]
    step: Float = CELL_PX * (place[1, 1] - place[0, 0])[[0, 2]]
    first: Float = place[:CELL_PX, :CELL_PX].reshape(-1, 3).mean(axis=0)[[0, 2]]
    bent = photons.illuminance_map(landed, first, step, (CELLS, CELLS))
    return Floor(
        ours=_in_cells(pixels),
        truth=bent + _in_cells(beside * ~dark),
        dark=_in_cells(dark.astype(np.float64)),
        pixels_dark=dark,
        pixels=pixels,
        beside=beside,
        cell_m2=abs(float(np.prod(step))),
        landed=landed,
    )


def _in_cells(pixels: Float) -> Float:
    return pixels.reshape(CELLS, CELL_PX, CELLS, CELL_PX).mean(axis=(1, 3))


@cache
def caustic(height_m: float, engine: EngineName) -> Floor:
    """The floor under the ball at `height_m`."""
    lamp = PointLamp("lamp", LAMP, np.ones(3), Shadow(filter="exact"))
    return floor_under(ball_at(height_m), lamp, engine)


def map_error(engine: EngineName, /) -> float:
    """Mean |ours − photons| over the light that went through the ball; the worst of three heights.

    Over cells that the ball's shadow fills; those on its edge are the pixels' affair.
    """
    worst = 0.0
    for height in HEIGHTS_M:
        floor = caustic(height, engine)
        inside = floor.dark == 1
        gap = np.abs(floor.ours - floor.truth)[inside].sum()
        worst = max(worst, float(gap / floor.truth[inside].sum()))
    return worst


def flux_error(engine: EngineName, heights_m: Sequence[float], /) -> float:
    """Relative error of all the light on the floor that went through the ball; the worst height."""
    worst = 0.0
    for height in heights_m:
        floor = caustic(height, engine)
        straight = _in_cells(floor.beside * ~floor.pixels_dark).sum()
        bent, truth = floor.ours.sum() - straight, floor.truth.sum() - straight
        worst = max(worst, abs(float(bent / truth) - 1))
    return worst


def shadow_error(engine: EngineName, /) -> float:
    """Share of pixels that are dark (less than half lit) where the lamp is seen, or the reverse.

    Of the ball on the floor, whose light is in a bright spot; that is lit and in the shadow.
    """
    floor = caustic(HEIGHTS_M[0], engine)
    ours = floor.pixels < 0.5 * floor.beside
    wrong = ours != floor.pixels_dark
    bright = floor.pixels > 0.5 * floor.beside
    return float((wrong & ~(bright & floor.pixels_dark)).mean())


def _rows(engine: EngineName) -> tuple[Row, ...]:
    photons_of = "10⁶ photons by Snell and Fresnel, a ball of 50 mm"
    beside_focus = [height for height in HEIGHTS_M if height != FOCUS_M]
    return (
        Row(
            f"glass.caustic.flux.{engine}",
            "glass",
            2e-3,
            "relative",
            f"{photons_of} on the floor and 100 mm over it: what 0.24 m of floor get",
            lambda: flux_error(engine, beside_focus),
        ),
        Row(
            f"glass.caustic.flux_focus.{engine}",
            "glass",
            None,
            "relative",
            f"{photons_of} 25 mm over the floor: the focus is smaller than a pixel of 0.4 mm",
            lambda: flux_error(engine, [FOCUS_M]),
        ),
        Row(
            f"glass.caustic.map.{engine}",
            "glass",
            0.03,
            "relative",
            f"{photons_of} at three heights: mean difference in cells of 4 mm in the shadow",
            lambda: map_error(engine),
        ),
        Row(
            f"glass.caustic.shadow.{engine}",
            "glass",
            1e-3,
            "share",
            "the line from the lamp to the pixel meets the ball or not",
            lambda: shadow_error(engine),
        ),
    )


ROWS: tuple[Row, ...] = (*_rows("reference"), *_rows("gpu"))
