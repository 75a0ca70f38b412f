"""Every kind of lamp as Radiance is told it.

=================== ======================================================================
kind                Radiance
=================== ======================================================================
point               `light` ball of 0.1 mm, I/(πr²)
spot                the same with glTF's falloff in a function file
luminaire           the same with the file's candela as `brightdata`
directional         `light` source of 0.01°: small against any edge of a shadow
sky, hemisphere     `glow` source of 180°: found by rays of the hemisphere alone
area lamps          tiles, see `andon.transport.baked.radiance.emitters`
=================== ======================================================================

What is drawn hides what is behind it (`light`); what is not, and the light that leaves the openings
of a shell, are *illum*, which the light of other lamps passes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.lamps import (
    AnyAreaLamp,
    DirectionalLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    SkyLamp,
)
from andon.transport.baked.radiance.emitters import Tiles, tiles_of
from andon.transport.baked.radiance.few import thinned
from andon.transport.baked.radiance.luminaires import point_text
from andon.transport.baked.radiance.places import balls_of
from andon.transport.baked.radiance.text import (
    LUMENS_PER_WATT,
    joined,
    light_text,
    polygons_text,
    triple,
    unit,
)

__all__ = ["LampText", "is_distant_glow", "lamps_text"]

Float = NDArray[np.float64]

# Full angle of a directional source, degrees: small against any shadow edge, large against the
# rounding of its solid angle.
DIRECTIONAL_DEGREES = 0.01


@dataclass(frozen=True)
class LampText:
    """Scene text, and the files that it names."""

    text: str
    files: dict[str, bytes]


def is_distant_glow(lamp: Lamp, /) -> bool:
    """Radiance's ``-ab 0`` has none of its light: a sky, which rays of the first bounce find.

    Its own light is that of ``-ab 1`` among black surfaces, and is hidden by them, where
    `andon.transport.direct` has a sky without shadows.
    """
    return isinstance(lamp, SkyLamp | HemisphereLamp)


def lamps_text(
    lamps: Sequence[Lamp],
    /,
    *,
    tiles: int,
    opaque: frozenset[str] = frozenset(),
    most: int | None = None,
) -> LampText:
    """All of `lamps`: those with a place first, then the others, in their order.

    Parameters
    ----------
    tiles : about how many of them stand for each area lamp.
    opaque : names of lamps that hide what is behind them although they are not drawn.
    most : no more tiles than this stand for each area lamp, see `few`; None: all of them.
    """
    text, files = "", dict[str, bytes]()
    for number, ball in enumerate(balls_of(lamps)):
        more, data = point_text(
            ball.lamp, f"lamp{number}", hides=ball.hides, radius_m=ball.radius_m
        )
        text, files = text + more, files | data
    for number, lamp in enumerate(lamps):
        name = f"light{number}"
        if isinstance(lamp, AnyAreaLamp):
            hides = lamp.drawn or lamp.name in opaque
            parts = tiles_of(lamp, tiles)
            parts = parts if most is None else thinned(parts, most)
            text += _area_text(parts, lamp.name, name, hides)
        elif not isinstance(lamp, PointLamp):
            text += _distant_text(lamp, name)
    return LampText(text, files)


def _area_text(parts: list[Tiles], field: str, name: str, hides: bool) -> str:
    text = ""
    for number, part in enumerate(parts):
        material = f"{name}.{number}"
        text += light_text(material, triple(part.luminance_cd_m2, field), hides=hides)
        text += polygons_text(part.corners, material)
    return text


def _distant_text(lamp: DirectionalLamp | SkyLamp | HemisphereLamp, name: str) -> str:
    if isinstance(lamp, DirectionalLamp):
        half = np.radians(DIRECTIONAL_DEGREES) / 2
        solid_angle = 4 * np.pi * np.sin(half / 2) ** 2  # 2π(1 − cos), without cancellation
        luminance = triple(lamp.illuminance_lux, lamp.name) / solid_angle
        light = light_text(name, luminance, hides=True)
        towards = joined(-unit(lamp.direction, lamp.name))
        return f"{light}{name} source {name}.s 0 0 4 {towards} {DIRECTIONAL_DEGREES!r}\n"
    up = unit(lamp.up, lamp.name)
    if isinstance(lamp, SkyLamp):
        return _dome_text(f"{name}.sky", triple(lamp.illuminance_lux, lamp.name), up)
    sky, ground = lamp.sky_illuminance_lux, lamp.ground_illuminance_lux
    return _dome_text(f"{name}.sky", triple(sky, lamp.name), up) + _dome_text(
        f"{name}.ground", triple(ground, lamp.name), -up
    )


def _dome_text(name: str, lux: Float, towards: Float) -> str:
    """Half of all directions, of the luminance E/π."""
    watts = joined(lux / np.pi / LUMENS_PER_WATT)
    return f"void glow {name} 0 0 4 {watts} 0\n{name} source {name}.s 0 0 4 {joined(towards)} 180\n"
