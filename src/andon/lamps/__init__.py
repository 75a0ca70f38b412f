"""What emits: lamps in photometric units, resolved for one moment of a scene.

One lamp is one thing for every stage: relighting's illuminance, glass's highlight and glare's
source are the same candela. So lamps are resolved once per frame, from the scene, into frozen
values without any choice of unit or colour left: three linear Rec.709 channels in cd (lamps with
a place) or lx (light from afar), whose photometric value is the one that was stated.

=============== ============================== ==========================================
choice          taken                          instead of
=============== ============================== ==========================================
falloff         inverse square, no cut-off     a range with a smooth end, which loses flux
spot            glTF's cone                    Phong's cosⁿ: never ends, no second angle
flux            integral of the actual cone    the "4π" or "π" that engines assume
colour          keeps the photometric value    RGB × intensity, where blue means darker
colour temp.    Planck's law, one rule         a fit with a seam between two families
luminaire       the file's candela, bilinear   smoothing, or a cone fitted to them
shells          area lamps, energy balanced    one point lamp of t·I (kept as a mode)
=============== ============================== ==========================================

Sources: KHR_lights_punctual (Khronos); ISO/CIE 11664-1; ITU-R BT.709-6.
"""

from __future__ import annotations

from andon.lamps.areas import AreaLamp, DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.bodies import Body
from andon.lamps.colour import rgb_factors
from andon.lamps.drawn import body_of
from andon.lamps.intensity import intensity_cd
from andon.lamps.kinds import AnyAreaLamp, Lamp
from andon.lamps.model import (
    DirectionalLamp,
    GoniometricLamp,
    HemisphereLamp,
    PointLamp,
    Shadow,
    SkyLamp,
    SpotLamp,
)
from andon.lamps.parse import parse_lamp_option
from andon.lamps.resolve import resolve_bodies, resolve_lamps
from andon.lamps.shells import Shell, expand

__all__ = [
    "AnyAreaLamp",
    "AreaLamp",
    "Body",
    "DirectionalLamp",
    "DiskLamp",
    "GoniometricLamp",
    "HemisphereLamp",
    "Lamp",
    "MeshLamp",
    "PointLamp",
    "PolygonLamp",
    "Shadow",
    "Shell",
    "SkyLamp",
    "SphereLamp",
    "SpotLamp",
    "TubeLamp",
    "body_of",
    "expand",
    "intensity_cd",
    "parse_lamp_option",
    "resolve_bodies",
    "resolve_lamps",
    "rgb_factors",
]
