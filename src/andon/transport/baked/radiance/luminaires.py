"""Point-like lamps as Radiance is told them: small balls, with a pattern for what is not round.

A ball of radius r and radiance I/(πr²) is a point lamp: Radiance looks at its middle alone and
weighs πr²/d². What its intensity depends on is a pattern, which is asked with the direction of
the ray: glTF's cone in a function file, a measured distribution as `brightdata`, interpolated
linearly in both angles as `andon.lamps.goniometry` does.

Radiance's own spotlight has a hard edge, and `ies2rad` writes six digits, refuses type A and goes
on outside the angles of the file; so neither is used.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.files.photometry.model import Distribution
from andon.lamps import GoniometricLamp, PointLamp, SpotLamp
from andon.lamps.distributions import spot_coefficients
from andon.lamps.goniometry import EDGE_DEGREES, maximum_cd
from andon.lamps.intensity import luminaire_from_world
from andon.transport.baked.radiance.text import joined, light_text, triple, unit

__all__ = ["POINT_CAL", "POINT_FILE", "POINT_RADIUS_M", "point_text"]

Float = NDArray[np.float64]

# Small against all things, so that it hides none; rays to its middle still meet it in doubles.
POINT_RADIUS_M = 1e-4

# Dx, Dy, Dz is the direction of the ray that arrives at the lamp: away from it is the negative.
# Of a luminaire A1…A9 are its axes C = 0, C = 90 and up; A10…A13 the ends of its angles, A14 how
# far beyond them is rounding.
POINT_FILE = "lamps.cal"
_LUMINAIRES = """{ Intensities of lamps; 1 is the largest. }

spot_ramp = bound(0, A5 - A4*(Dx*A1 + Dy*A2 + Dz*A3), 1);
spot_share = spot_ramp * spot_ramp;

lum_x = -(Dx*arg(1) + Dy*arg(2) + Dz*arg(3));
lum_y = -(Dx*arg(4) + Dy*arg(5) + Dz*arg(6));
lum_z = -(Dx*arg(7) + Dy*arg(8) + Dz*arg(9));
lum_degrees(a) = a * (180/PI);
lum_turn(a) = if(a, a, if(-a, a + 360, 0));
lum_far(x, y) = sqrt(x*x + y*y);

lum_c_h = lum_turn(lum_degrees(atan2(lum_y, lum_x)));
lum_c_v = lum_degrees(atan2(lum_far(lum_x, lum_y), -lum_z));
lum_b_h = lum_degrees(atan2(-lum_y, lum_far(lum_x, lum_z)));
lum_b_v = lum_degrees(atan2(lum_x, -lum_z));
lum_a_h = lum_degrees(atan2(-lum_y, lum_x));
lum_a_v = lum_degrees(atan2(lum_z, lum_far(lum_x, lum_y)));

lum_within(a, low, high) = if(a - low + arg(14), if(high + arg(14) - a, 1, 0), 0);
lum_if(v, h, g) = v * lum_within(h, arg(10), arg(11)) * lum_within(g, arg(12), arg(13));
lum_held_h(a) = bound(arg(10), a, arg(11));
lum_held_v(a) = bound(arg(12), a, arg(13));
"""
# For each photometric type, what Radiance asks for: the two angles, held within those of the
# file, and what becomes of the value that it finds there.
POINT_CAL = _LUMINAIRES + "".join(
    f"""
lum_{kind}_at_h = lum_held_h(lum_{kind}_h);
lum_{kind}_at_v = lum_held_v(lum_{kind}_v);
lum_{kind}(v) = lum_if(v, lum_{kind}_h, lum_{kind}_v);
"""
    for kind in "abc"
)


def point_text(
    lamp: PointLamp, name: str, /, *, hides: bool, radius_m: float
) -> tuple[str, dict[str, bytes]]:
    """Scene text of a lamp with a place, and the data files that it names.

    Parameters
    ----------
    name : of its material and its ball in the scene.
    hides : whether the ball hides what is behind it.
    radius_m : of the ball.
    """
    luminance = triple(lamp.intensity_cd, lamp.name) / (np.pi * radius_m**2)
    text, files, modifier = "", dict[str, bytes](), "void"
    if isinstance(lamp, SpotLamp):
        text, modifier = _spot_text(lamp, name), f"{name}.i"
    elif isinstance(lamp, GoniometricLamp):
        data = f"{name}.dat"
        text, modifier = _luminaire_text(lamp, name, data), f"{name}.i"
        files[data] = _data(lamp.distribution)
    text += light_text(name, luminance, modifier=modifier, hides=hides)
    return f"{text}{name} sphere {name}.s 0 0 4 {joined(lamp.position_m)} {radius_m!r}\n", files


def _spot_text(lamp: SpotLamp, name: str) -> str:
    scale, offset = spot_coefficients(lamp.inner_radians, lamp.outer_radians)
    axis = joined(unit(lamp.direction, lamp.name))
    return f"void brightfunc {name}.i 2 spot_share {POINT_FILE} 0 5 {axis} {scale!r} {offset!r}\n"


def _luminaire_text(lamp: GoniometricLamp, name: str, data: str) -> str:
    form, kind = lamp.distribution, lamp.distribution.photometry.lower()
    h, v = form.horizontal_degrees, form.vertical_degrees
    numbers = [*luminaire_from_world(lamp).ravel(), h[0], h[-1], v[0], v[-1], EDGE_DEGREES]
    angles = f"lum_{kind}_at_h lum_{kind}_at_v"
    return (
        f"void brightdata {name}.i 5 lum_{kind} {data} {POINT_FILE} {angles} "
        f"0 {len(numbers)} {joined(np.array(numbers))}\n"
    )


def _data(form: Distribution) -> bytes:
    """Radiance's data file of two dimensions, angles in degrees, shares of the maximum."""
    lines = ["2"]
    for knots in (form.horizontal_degrees, form.vertical_degrees):
        lines += [f"0 0 {len(knots)}", joined(knots)]
    lines += [joined(row) for row in form.candela / maximum_cd(form)]
    return ("\n".join(lines) + "\n").encode("ascii")
