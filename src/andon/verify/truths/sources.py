"""Lamps as Radiance is told them: what emits, in photometric units, and its scene text.

Radiance has no point lamp: a sphere of 1 mm with the radiance I/(πr²) is one, since it is sampled
by one ray to its centre and weighs πr²/d². Its own *large* spheres have no horizon, so give those
as fine triangles (`AreaSource`). Its spotlights have a hard edge, so the falloff of glTF's
KHR_lights_punctual is a function file on the small sphere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = [
    "LUMENS_PER_WATT",
    "AreaSource",
    "DirectionalSource",
    "PointSource",
    "Source",
    "SpotSource",
    "source_text",
]

Float = NDArray[np.float64]

# Radiance's own luminous efficacy, lm/W, applied channel by channel.
LUMENS_PER_WATT = 179.0
POINT_RADIUS_M = 1e-3
# Full angle of a directional source, degrees: small against any shadow edge, large against the
# rounding of its solid angle.
DIRECTIONAL_DEGREES = 0.01
# KHR_lights_punctual: the cosines' difference never counts as less than this.
SPOT_MIN_COSINE_STEP = 0.001

# Dx, Dy, Dz is the direction of the ray that arrives at the lamp: away from it is the negative.
SPOT_CAL = """
spot_cosine = -(Dx*A1 + Dy*A2 + Dz*A3);
spot_step = (spot_cosine - A5) / A4;
spot_falloff = if(spot_step, if(spot_step - 1, 1, spot_step * spot_step), 0);
"""


@dataclass(frozen=True)
class PointSource:
    """A point lamp: `position` (3,) metres, `intensity_cd` (3,) candela per channel, ≥ 0."""

    position: Float
    intensity_cd: Float


@dataclass(frozen=True)
class SpotSource:
    """A spot with glTF's falloff; `intensity_cd` (3,) is that on the axis.

    `direction` (3,) is where it shines; 0 ≤ inner < outer ≤ 90 degrees, from the axis.
    """

    position: Float
    direction: Float
    intensity_cd: Float
    inner_degrees: float
    outer_degrees: float


@dataclass(frozen=True)
class DirectionalSource:
    """Parallel light along `direction` (3,); `illuminance_lux` (3,) on a facing surface."""

    direction: Float
    illuminance_lux: Float


@dataclass(frozen=True)
class AreaSource:
    """Triangles that emit evenly from the side on which they run counter-clockwise.

    `positions` (n, 3) metres, `triangles` (m, 3), `luminance_cd_m2` (3,) cd/m² per channel.
    """

    positions: Float
    triangles: NDArray[np.int32]
    luminance_cd_m2: Float


Source = PointSource | SpotSource | DirectionalSource | AreaSource


def source_text(source: Source, name: str, spot_cal: str) -> str:
    """Radiance scene text of one lamp; `spot_cal` is the path of a file with `SPOT_CAL`."""
    if isinstance(source, AreaSource):
        corners = source.positions[source.triangles]
        light = _light(name, "void", _triple(source.luminance_cd_m2, name))
        return light + triangles_text(corners, name)
    if isinstance(source, DirectionalSource):
        half = np.radians(DIRECTIONAL_DEGREES) / 2
        solid_angle = 4 * np.pi * np.sin(half / 2) ** 2  # 2π(1 − cos), without cancellation
        light = _light(name, "void", _triple(source.illuminance_lux, name) / solid_angle)
        towards = _join(-_unit(source.direction, name))
        return f"{light}{name} source {name}s 0 0 4 {towards} {DIRECTIONAL_DEGREES!r}\n"
    text, modifier = "", "void"
    if isinstance(source, SpotSource):
        text, modifier = _spot_text(source, name, spot_cal), f"{name}f"
    luminance = _triple(source.intensity_cd, name) / (np.pi * POINT_RADIUS_M**2)
    text += _light(name, modifier, luminance)
    return f"{text}{name} sphere {name}s 0 0 4 {_join(source.position)} {POINT_RADIUS_M!r}\n"


def _spot_text(source: SpotSource, name: str, spot_cal: str) -> str:
    if not 0 <= source.inner_degrees < source.outer_degrees <= 90:
        raise InputError("must have 0 ≤ inner < outer ≤ 90 degrees", field=name)
    inner, outer = np.cos(np.radians([source.inner_degrees, source.outer_degrees]))
    step = max(SPOT_MIN_COSINE_STEP, float(inner - outer))
    axis = _join(_unit(source.direction, name))
    return (
        f"void brightfunc {name}f 2 spot_falloff {spot_cal} 0 5 {axis} {step!r} {float(outer)!r}\n"
    )


def triangles_text(corners: Float, modifier: str) -> str:
    """Polygons of `corners` (m, 3, 3); triangles without area are left out."""
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    rows = corners[area > 0].reshape(-1, 9).tolist()
    return "".join(
        f"{modifier} polygon {modifier}.{number} 0 0 9 {' '.join(map(repr, row))}\n"
        for number, row in enumerate(rows)
    )


def _light(name: str, modifier: str, luminance: Float) -> str:
    return f"{modifier} light {name} 0 0 3 {_join(luminance / LUMENS_PER_WATT)}\n"


def _join(values: NDArray[np.floating]) -> str:  # pyright: ignore[reportMissingTypeArgument]
    return " ".join(repr(value) for value in np.asarray(values, np.float64).tolist())


def _triple(values: Float, name: str) -> Float:
    triple = np.asarray(values, np.float64)
    if triple.shape != (3,) or not np.isfinite(triple).all() or (triple < 0).any():
        raise InputError(f"must be three numbers ≥ 0, got {triple.tolist()}", field=name)
    return triple


def _unit(direction: Float, name: str) -> Float:
    length = float(np.linalg.norm(direction))
    if not (np.isfinite(length) and length > 0):
        raise InputError("must have a direction that is not zero", field=name)
    return np.asarray(direction, np.float64) / length
