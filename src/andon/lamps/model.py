"""Lamps as physics wants them: triples in photometric units, unit directions, radians."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.files.photometry.model import Distribution

__all__ = [
    "LIGHT_FIELDS",
    "DirectionalLamp",
    "GoniometricLamp",
    "HemisphereLamp",
    "PointLamp",
    "Shadow",
    "SkyLamp",
    "SpotLamp",
]

Float = NDArray[np.float64]

# Every field that says how much light a lamp gives.
LIGHT_FIELDS = (
    "intensity_cd",
    "illuminance_lux",
    "sky_illuminance_lux",
    "ground_illuminance_lux",
    "luminance_cd_m2",
    "facet_luminance_cd_m2",
)


@dataclass(frozen=True)
class Shadow:
    """How a lamp's shadow is computed.

    Attributes
    ----------
    map_size : texels along a side of the shadow map, 16…8192.
    filter : ``none`` hard, ``linear`` blended over one texel, ``exact`` the triangles' own
        edges (point and spot lamps; sixteen reads instead of one; directional lamps: linear).
    samples : of an area lamp: points on it from which shadows are looked at, 1…64; the penumbra
        is their mean.
    through : names of the caster groups that do not hide this lamp: its own shell, ``real``,
        ``objects``, or the name of another body.
    near_m : nothing nearer than this to the lamp hides it (the bulb itself, its socket), metres.
    """

    map_size: int = 1024
    filter: Literal["none", "linear", "exact"] = "linear"
    samples: int = 1
    through: frozenset[str] = frozenset()
    near_m: float = 0.01


@dataclass(frozen=True)
class PointLamp:
    """Shines equally to all sides: E = I·max(0, cos φ)/d².

    Attributes
    ----------
    name : unique in the scene.
    position_m : (3,) metres, world.
    intensity_cd : (3,) cd per channel.
    shadow : None for a lamp that casts none.
    visible_radius_m : radius of the ball that is drawn, metres; 0: not drawn.
    owner : name of the scene's lamp that this is a part of; "": none.
    glass_m : how far from the middle the real bulb's own surface may be, which does not hide the
        drawn ball; 0: there is no real bulb.
    """

    name: str
    position_m: Float
    intensity_cd: Float
    shadow: Shadow | None = field(default_factory=Shadow)
    visible_radius_m: float = 0.0
    owner: str = field(default="", kw_only=True)
    glass_m: float = field(default=0.0, kw_only=True)


@dataclass(frozen=True)
class SpotLamp(PointLamp):
    """A cone with glTF's soft edge.

    Attributes
    ----------
    intensity_cd : (3,) cd per channel *on the axis*.
    direction : (3,) unit, where the axis points.
    inner_radians, outer_radians : half-angles, 0 ≤ inner < outer ≤ π/2.
    """

    direction: Float = field(default_factory=lambda: np.array([0.0, -1.0, 0.0]))
    inner_radians: float = 0.0
    outer_radians: float = np.pi / 4


@dataclass(frozen=True)
class GoniometricLamp(PointLamp):
    """A luminaire with a measured distribution.

    Attributes
    ----------
    intensity_cd : (3,) cd per channel where the distribution has its *maximum*.
    direction : (3,) unit, the nadir: where γ = 0 (photometric zero of LM-63) points, world.
    right : (3,) unit, ⟂ `direction`: where C = 0 at γ = 90 (photometric horizontal) points, world.
        C runs counter-clockwise as seen against `direction`.
    distribution : only its form counts: candela as a share of their maximum.
    """

    direction: Float = field(kw_only=True)
    right: Float = field(kw_only=True)
    distribution: Distribution = field(kw_only=True)


@dataclass(frozen=True)
class DirectionalLamp:
    """Parallel light.

    Attributes
    ----------
    name : unique in the scene.
    direction : (3,) unit, where the light *travels*.
    illuminance_lux : (3,) lx per channel on a surface that faces the light.
    shadow : None for a lamp that casts none.
    owner : name of the scene's lamp that this is a part of; "": none.
    """

    name: str
    direction: Float
    illuminance_lux: Float
    shadow: Shadow | None = field(default_factory=Shadow)
    owner: str = field(default="", kw_only=True)


@dataclass(frozen=True)
class SkyLamp:
    """A sky of equal luminance above the horizon: E(n) = E_up·(1 + n·up)/2. No shadow.

    Attributes
    ----------
    name : unique in the scene.
    up : (3,) unit, the zenith.
    illuminance_lux : (3,) lx per channel on a surface that faces the zenith.
    owner : name of the scene's lamp that this is a part of; "": none.
    """

    name: str
    up: Float
    illuminance_lux: Float
    owner: str = field(default="", kw_only=True)


@dataclass(frozen=True)
class HemisphereLamp:
    """A sky and a ground of equal luminances:
    E(n) = E_sky·(1 + n·up)/2 + E_ground·(1 − n·up)/2. No shadow.

    Attributes
    ----------
    name : unique in the scene.
    up : (3,) unit, the zenith.
    sky_illuminance_lux : (3,) lx per channel from the sky on a surface that faces up.
    ground_illuminance_lux : (3,) lx per channel from the ground on a surface that faces down.
    owner : name of the scene's lamp that this is a part of; "": none.
    """

    name: str
    up: Float
    sky_illuminance_lux: Float
    ground_illuminance_lux: Float
    owner: str = field(default="", kw_only=True)
