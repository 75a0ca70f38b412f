"""Lamps that stand in one place, so that none hides the other.

Radiance's lamps are things: of two balls in one place the larger hides the smaller.

============================== =============================================================
in one place                   become
============================== =============================================================
points that shine to all sides one ball, with the sum of their light
others                         balls side by side, 5 mm apart: they hide one another in
                               1e-4 of all directions
one in a glowing ball          an *illum* around it, which the ball's light passes
more in a glowing ball         refused: weak light (of an illum) does not pass an illum
============================== =============================================================
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps import Lamp, PointLamp, SphereLamp
from andon.transport.baked.radiance.luminaires import POINT_RADIUS_M

__all__ = ["Ball", "balls_of"]

Float = NDArray[np.float64]

# The ball around a glowing ball is so much wider.
WIDER = 1.02
# Balls side by side, from middle to middle.
BESIDE_M = 50 * POINT_RADIUS_M


@dataclass(frozen=True)
class Ball:
    """A lamp with a place, the radius of its ball in metres, and whether the ball hides others."""

    lamp: PointLamp
    radius_m: float = POINT_RADIUS_M
    hides: bool = True


def balls_of(lamps: Sequence[Lamp], /) -> list[Ball]:
    """The balls of those of `lamps` that have a place and give light.

    Raises `InputError` for several different ones in a glowing ball.
    """
    glowing = [lamp for lamp in lamps if isinstance(lamp, SphereLamp)]
    balls: list[Ball] = []
    places: list[Float] = []  # where they would be alone
    for lamp in lamps:
        if not isinstance(lamp, PointLamp) or not np.any(lamp.intensity_cd):
            continue
        near = [k for k, place in enumerate(places) if _apart(place, lamp) < BESIDE_M]
        same = [k for k in near if type(lamp) is type(balls[k].lamp) is PointLamp]
        if same:
            kept = balls[same[0]]
            whole = kept.lamp.intensity_cd + lamp.intensity_cd
            balls[same[0]] = replace(kept, lamp=replace(kept.lamp, intensity_cd=whole))
            continue
        around = [
            x.radius_m for x in glowing if _apart(x.position_m, lamp) < x.radius_m + POINT_RADIUS_M
        ]
        if around and near:
            raise InputError(
                "stands in a glowing ball with another lamp",
                field=lamp.name,
                remedy="move one of them",
            )
        if around:
            balls.append(Ball(lamp, WIDER * max(around), hides=False))
        else:
            beside = lamp.position_m + BESIDE_M * len(near) * np.array([1.0, 0, 0])
            balls.append(Ball(replace(lamp, position_m=beside)))
        places.append(lamp.position_m)
    return balls


def _apart(place: Float, lamp: PointLamp) -> float:
    return float(np.linalg.norm(place - lamp.position_m))
