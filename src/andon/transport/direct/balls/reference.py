"""Light behind glass balls in float64; the same functions as balls.wgsl."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.lamps import DirectionalLamp, Lamp, PointLamp, intensity_cd
from andon.transport.direct.balls.model import GlassBall
from andon.transport.direct.balls.table import CELLS, ROWS, BallTable, ball_table, place_of

__all__ = [
    "is_open",
    "meets",
    "refracted_lux",
    "straight_transmittance",
    "table_of",
    "through_balls",
]

Float = NDArray[np.float64]

# tan χ of a ray that leaves the ball along its surface, with hardly any light.
STEEPEST = 30.0
# Less than this has no direction; half floats end at 4e-6 (6e-8 times LIGHT_SCALE).
LEAST_LIGHT = 1e-5


@dataclass(frozen=True)
class _Place:
    """Receivers relative to a ball: `along` the axis and `off` it, in radii, with unit vectors."""

    along: Float
    off: Float
    outwards: Float
    radial: Float
    vergence: Float


def table_of(ball: GlassBall, lamp: Lamp, /) -> BallTable:
    """The table of `ball` in the light of `lamp`, which is outside of it."""
    r, g, b = (a * ball.radius_m for a in ball.absorption_per_m)
    return ball_table(round(ball.lamp_vergence(lamp), 9), ball.index, (r, g, b))


def through_balls(
    lamp: Lamp, balls: Sequence[GlassBall], position: Float, normal: Float, /
) -> tuple[NDArray[np.bool_], Float]:
    """What `balls`, all of `served_balls`, do to the light of `lamp` at `position` (n, 3).

    Returns (n,) whether the straight line passes beside all of them, and (n, 3) the illuminance in
    lux that they send there refracted, on a surface with unit `normal` (n, 3).
    """
    beside = np.ones(len(position), bool)
    lux = np.zeros((len(position), 3))
    for ball in balls:
        if ball.holds(lamp):
            continue
        beside &= is_open(lamp, ball, position)
        others = [x for x in balls if x is not ball and not x.holds(lamp)]
        lux += refracted_lux(lamp, ball, position, normal, others=others)
    return beside, lux


def is_open(lamp: Lamp, ball: GlassBall, position: Float, /) -> NDArray[np.bool_]:
    """(n,) whether the straight line from `lamp` to `position` (n, 3) passes beside `ball`."""
    if isinstance(lamp, DirectionalLamp):
        return ~meets(position, -lamp.direction, ball, np.inf)
    assert isinstance(lamp, PointLamp)
    reach = lamp.position_m - position
    distance = np.linalg.norm(reach, axis=-1)
    direction = reach / np.maximum(distance, 1e-12)[:, None]
    return ~meets(position, direction, ball, distance)


def meets(
    origin: Float, direction: Float, ball: GlassBall, within: Float | float, /
) -> NDArray[np.bool_]:
    """(n,) whether rays from `origin` (n, 3) along unit `direction` (…, 3) enter `ball` in front of
    `within` metres, or start inside it.
    """
    offset = (ball.centre_m - origin) / ball.radius_m
    along = np.einsum("...i,...i->...", offset, np.broadcast_to(direction, offset.shape))
    square = np.einsum("...i,...i->...", offset, offset)
    ahead = (along > 0) & (along * ball.radius_m < within)
    return (square < 1) | (ahead & (square - along**2 < 1))


def refracted_lux(
    lamp: Lamp, ball: GlassBall, position: Float, normal: Float, /, *, others: Sequence[GlassBall]
) -> Float:
    """Illuminance (n, 3) in lux that reaches `position` (n, 3) with unit `normal` through `ball`.

    `others` are the other balls: before this one they dim its light, behind it they take it.
    """
    place = _place(lamp, ball, position)
    light, tilt = _looked_up(table_of(ball, lamp), place)
    slope = np.clip(tilt * place.vergence, -STEEPEST, STEEPEST)
    impact = np.clip(tilt / np.hypot(1, slope), -1, 1)
    across = (place.along[:, None] * place.outwards) - place.off[:, None] * ball.axis(lamp)
    across = across * place.vergence[:, None]
    # Light per area of the concentric sphere, times the vector that has 1 along the radius.
    leaning = place.radial - across * slope[:, None]
    facing = np.maximum(-np.einsum("ij,ij->i", leaning, normal), 0)
    arriving = leaning / np.hypot(1, slope)[:, None]
    # Where it comes from: the ray of the same impact parameter.
    lamp_sine = impact * ball.lamp_vergence(lamp)
    leaving = (
        ball.axis(lamp) * np.sqrt(1 - lamp_sine**2)[:, None] + place.outwards * lamp_sine[:, None]
    )
    lux = light * (facing * place.vergence**2)[:, None] * _at_centre(lamp, ball, leaving)
    for other in others:
        lux[meets(position, -arriving, other, _distance(ball, position))] = 0
        before = _is_before(lamp, ball, other, leaving)
        lux[before] *= straight_transmittance(other)
    return lux


def straight_transmittance(ball: GlassBall, /) -> Float:
    """(3,) what a ball lets through along its axis."""
    index, absorption = np.asarray(ball.index), np.asarray(ball.absorption_per_m)
    reflected = ((index - 1) / (index + 1)) ** 2
    return (1 - reflected) ** 2 * np.exp(-2 * absorption * ball.radius_m)


def _distance(ball: GlassBall, position: Float) -> Float:
    return np.linalg.norm(ball.centre_m - position, axis=-1)


def _is_before(lamp: Lamp, ball: GlassBall, other: GlassBall, leaving: Float) -> NDArray[np.bool_]:
    """(n,) whether rays from `lamp` along `leaving` (n, 3) meet `other` before `ball`."""
    if isinstance(lamp, DirectionalLamp):
        # Parallel light of one ball: whether the other one stands before its centre.
        at = np.broadcast_to(ball.centre_m, leaving.shape)
        return meets(at, -lamp.direction, other, np.inf)
    assert isinstance(lamp, PointLamp)
    start = np.broadcast_to(lamp.position_m, leaving.shape)
    return meets(start, leaving, other, float(np.linalg.norm(ball.centre_m - lamp.position_m)))


def _at_centre(lamp: Lamp, ball: GlassBall, leaving: Float) -> Float:
    """(n, 3) lux that the lamp would give at the ball's centre, as bright as towards `leaving`."""
    if isinstance(lamp, DirectionalLamp):
        return np.broadcast_to(lamp.illuminance_lux, leaving.shape)
    assert isinstance(lamp, PointLamp)
    reach = ball.centre_m - lamp.position_m
    return intensity_cd(lamp, leaving) / (reach @ reach)


def _place(lamp: Lamp, ball: GlassBall, position: Float) -> _Place:
    axis = ball.axis(lamp)
    offset = (position - ball.centre_m) / ball.radius_m
    along = offset @ axis
    outwards = offset - along[:, None] * axis
    off = np.linalg.norm(outwards, axis=-1)
    outwards = outwards / np.maximum(off, 1e-9)[:, None]
    vergence = 1 / np.maximum(np.hypot(along, off), 1e-9)
    return _Place(along, off, outwards, offset * vergence[:, None], vergence)


def _looked_up(table: BallTable, place: _Place) -> tuple[Float, Float]:
    """Bilinear: E·ρ²/E_centre (n, 3), and tan χ/v of its direction (n,)."""
    # sin ψ/2 without a difference of near numbers ahead; behind the lamp's side 1 at most.
    sine = np.sqrt(np.clip((1 - place.along * place.vergence) / 2, 0, 1))
    ahead = place.along > 0
    double = 2 * (1 / place.vergence) * (1 / place.vergence + place.along)
    sine[ahead] = (place.off / np.sqrt(np.maximum(double, 1e-12)))[ahead]
    column = np.clip(place_of(sine) * CELLS - 0.5, 0, CELLS - 1)
    row = np.clip(place.vergence, 0, 1) * (ROWS - 1)
    left = np.minimum(column.astype(np.int64), CELLS - 2)
    upper = np.minimum(row.astype(np.int64), ROWS - 2)
    found: list[Float] = []
    for values in (table.light, table.lean[..., None]):
        right, lower = (column - left)[:, None], (row - upper)[:, None]
        first = values[upper, left] * (1 - right) + values[upper, left + 1] * right
        second = values[upper + 1, left] * (1 - right) + values[upper + 1, left + 1] * right
        found.append(first * (1 - lower) + second * lower)
    light, lean = found
    return light, lean[:, 0] / np.maximum(light.sum(axis=1), LEAST_LIGHT)
