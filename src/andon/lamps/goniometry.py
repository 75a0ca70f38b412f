"""Measured distributions in NumPy: candela in any direction, flux, beams.

The luminaire's own frame, in which all three photometric types are meant here, is right-handed
and the same as Radiance's ies2rad::

                    z up                     x  photometric horizontal: C = 0
                    │   y (C = 90)           y  C = 90
                    │  /                     z  up; −z is photometric zero, the nadir
                    │ /
                    o───────── x (C = 0)     In the world −z is the lamp's `direction`,
                    │                        x its `right`.
                    ▽ nadir: γ = 0

===== ============== ======================================= =========================
type  polar axis     direction of (H, V)                     its beam (H = V = 0)
===== ============== ======================================= =========================
C     z, vertical    sin V·(cos H·x + sin H·y) − cos V·z     −z
B     y, horizontal  cos H·(sin V·x − cos V·z) − sin H·y     −z
A     z, vertical    cos V·(cos H·x − sin H·y) + sin V·z     x
===== ============== ======================================= =========================

These are LM-63's definitions: *photometric horizontal* is (H, V) = (0, 90) of types B and C and
(0, 0) of type A; *photometric zero* is (0, 0) of types B and C and (0, −90) of type A; seen from
above, H runs counter-clockwise for type C and clockwise for types A and B. So a floodlight's V
lifts its beam from the nadir towards x, and a headlight shines along x. The planes of types A and
C share the vertical axis, those of type B a horizontal one: at H = ±90 of type B, and at
V = ±90 of type A, all values of a file are those of one direction.

Radiance's own formulas agree for type C, and for type B in the planes H = 0 and V = 0; off these
they take both angles as tangents (atan2(y, z) for H), where LM-63's H is measured within planes
that turn about y: at (45°, 45°) its H is 54.7°. Type A it refuses.

Between the angles of a file the candela are bilinear in the angles; outside them it is dark.

Sources: ANSI/IES LM-63-19; CIE 121 and EN 13032-1 (C-γ and B-β planes); LM-75 (goniometers).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.files.photometry.model import Distribution

__all__ = [
    "MainPlane",
    "angles_of",
    "beam_degrees",
    "candela",
    "candela_at",
    "directions_of",
    "field_degrees",
    "flux_lm",
    "main_planes",
    "maximum_cd",
    "tilt_factor",
]

Float = NDArray[np.float64]

# Directions this much outside the grid are rounding, not darkness.
EDGE_DEGREES = 1e-6
# Main planes are looked at in steps of this; angles of files are multiples of 0.5° or coarser. A
# crossing is found between two samples, so only a hard edge is off, by half a step.
PLANE_STEP_DEGREES = 0.1


def directions_of(distribution: Distribution, horizontal: Float, vertical: Float, /) -> Float:
    """Unit directions (..., 3) in the luminaire's frame of angles (...) in degrees."""
    h, v = np.radians(horizontal), np.radians(vertical)
    if distribution.photometry == "C":
        parts = (np.sin(v) * np.cos(h), np.sin(v) * np.sin(h), -np.cos(v))
    elif distribution.photometry == "B":
        parts = (np.cos(h) * np.sin(v), -np.sin(h), -np.cos(h) * np.cos(v))
    else:
        parts = (np.cos(v) * np.cos(h), -np.cos(v) * np.sin(h), np.sin(v))
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def angles_of(distribution: Distribution, directions: Float, /) -> tuple[Float, Float]:
    """Angles (H, V), each (...) in degrees, of unit directions (..., 3); C: H in [0, 360).

    atan2 of sine and cosine keeps its digits near the poles, where acos loses half of them.
    """
    x, y, z = np.moveaxis(np.asarray(directions, np.float64), -1, 0)
    if distribution.photometry == "C":
        h, v = np.arctan2(y, x) % (2 * np.pi), np.arctan2(np.hypot(x, y), -z)
    elif distribution.photometry == "B":
        h, v = np.arctan2(-y, np.hypot(x, z)), np.arctan2(x, -z)
    else:
        h, v = np.arctan2(-y, x), np.arctan2(z, np.hypot(x, y))
    return np.degrees(h), np.degrees(v)


def candela(distribution: Distribution, directions: Float, /) -> Float:
    """Luminous intensity (...) in cd towards unit directions (..., 3) in the luminaire's frame.

    Bilinear in the angles, 0 outside the file's.
    """
    return candela_at(distribution, *angles_of(distribution, directions))


def candela_at(distribution: Distribution, h: Float, v: Float, /) -> Float:
    """As `candela`, of angles in degrees that broadcast; at a pole the plane is told apart."""
    column, right, inside_h = _between(distribution.horizontal_degrees, h)
    row, up, inside_v = _between(distribution.vertical_degrees, v)
    table = distribution.candela
    low = (1 - right) * table[column, row] + right * table[column + 1, row]
    high = (1 - right) * table[column, row + 1] + right * table[column + 1, row + 1]
    return np.where(inside_h & inside_v, (1 - up) * low + up * high, 0.0)


def _between(knots: Float, angles: Float) -> tuple[NDArray[np.intp], Float, NDArray[np.bool_]]:
    """The knot before each angle, the share of the way to the next, and whether it is inside."""
    inside = (angles >= knots[0] - EDGE_DEGREES) & (angles <= knots[-1] + EDGE_DEGREES)
    held = np.clip(np.nan_to_num(angles), knots[0], knots[-1])
    before = np.clip(np.searchsorted(knots, held, side="right") - 1, 0, len(knots) - 2)
    share = (held - knots[before]) / (knots[before + 1] - knots[before])
    return before, share, inside


def maximum_cd(distribution: Distribution, /) -> float:
    """The largest intensity in cd; a bilinear interpolant has it at a knot."""
    return float(distribution.candela.max())


def flux_lm(distribution: Distribution, /) -> float:
    """Luminous flux in lm: the integral of the bilinear interpolant over the sphere, exactly.

    Each cell is linear in both angles; with θ the angle from the polar axis its solid angle has
    the weight sin θ dθ, and ∫ sin θ, ∫ θ sin θ are elementary.
    """
    table, around = distribution.candela, distribution.horizontal_degrees
    from_pole = distribution.vertical_degrees
    if distribution.photometry == "B":
        table, around, from_pole = table.T, from_pole, around
    if distribution.photometry != "C":
        from_pole = from_pole + 90
    # Over the angle around the pole the weight is 1: the trapezoid is exact.
    width = np.radians(np.diff(around))
    ring = width @ (table[:-1] + table[1:]) / 2
    return float(_polar_weights(np.radians(from_pole)) @ ring)


def _polar_weights(theta: Float) -> Float:
    """(n,) weights w with Σ w·f = ∫ f(θ) sin θ dθ for f linear between `theta` (n,)."""
    a, b = theta[:-1], theta[1:]
    whole = np.cos(a) - np.cos(b)
    after = (np.sin(b) - np.sin(a)) / (b - a) - np.cos(b)
    weights = np.zeros(len(theta))
    weights[:-1] += whole - after
    weights[1:] += after
    return weights


@dataclass(frozen=True)
class MainPlane:
    """The intensities in a plane through the beam.

    Attributes
    ----------
    name : ``C0-C180``, ``C90-C270``, or ``vertical``, ``horizontal`` for types A and B.
    angles_degrees : (n,) −180…180 from the beam's axis, > 0 to the side named first (C0, C90, up,
        H > 0).
    candela : (n,) cd.
    """

    name: str
    angles_degrees: Float
    candela: Float


def main_planes(distribution: Distribution, /) -> tuple[MainPlane, MainPlane]:
    """The two planes through the beam's axis (see the table above) that diagrams show."""
    angles = np.linspace(-180.0, 180.0, round(360 / PLANE_STEP_DEGREES) + 1)
    if distribution.photometry == "C":
        return (
            MainPlane("C0-C180", angles, _halves(distribution, angles, 0.0)),
            MainPlane("C90-C270", angles, _halves(distribution, angles, 90.0)),
        )
    x, y, z = np.eye(3)
    axis, up = (-z, x) if distribution.photometry == "B" else (x, z)
    theta = np.radians(angles)[:, None]
    profiles = [
        candela(distribution, np.cos(theta) * axis + np.sin(theta) * side) for side in (up, -y)
    ]
    return (
        MainPlane("vertical", angles, profiles[0]),
        MainPlane("horizontal", angles, profiles[1]),
    )


def _halves(distribution: Distribution, angles: Float, c: float) -> Float:
    """Candela of the planes `c` (angles > 0) and `c` + 180 (< 0); at the poles their mean.

    Some files differ by plane even there.
    """
    own = candela_at(distribution, np.full_like(angles, c), np.abs(angles))
    other = candela_at(distribution, np.full_like(angles, c + 180), np.abs(angles))
    near_pole = np.abs(np.abs(angles) - 90) > 90 - PLANE_STEP_DEGREES / 2
    return np.where(near_pole, (own + other) / 2, np.where(angles > 0, own, other))


def beam_degrees(distribution: Distribution, /) -> tuple[float, float]:
    """Full angle in degrees, in each of the main planes, that holds ≥ 50 % of the plane's
    maximum."""
    first, second = main_planes(distribution)
    return _width(first, 0.5), _width(second, 0.5)


def field_degrees(distribution: Distribution, /) -> tuple[float, float]:
    """As `beam_degrees`, for 10 %."""
    first, second = main_planes(distribution)
    return _width(first, 0.1), _width(second, 0.1)


def _width(plane: MainPlane, share: float) -> float:
    """The smallest angle that holds every direction of ≥ `share` of the plane's maximum.

    All but the widest dark gap: for one lobe its width, for two (a street lamp's wings) both with
    what lies between them; 360 where it is dark nowhere.
    """
    values = plane.candela[:-1]  # −180° and 180° are one direction
    limit = share * values.max()
    if not limit > 0:
        return 0.0
    bright = np.flatnonzero(values >= limit)
    after = np.append(bright[1:], bright[0] + len(values))
    gaps = [
        _gap(values, first, last, limit)
        for first, last in zip(bright.tolist(), after.tolist(), strict=True)
        if last - first > 1
    ]
    return 360.0 - PLANE_STEP_DEGREES * max(gaps, default=0.0)


def _gap(values: Float, first: int, last: int, limit: float) -> float:
    """Steps between the two crossings of `limit` among the dark samples from `first` to `last`."""
    count = len(values)
    near, dark = values[first % count], values[(first + 1) % count]
    far, late = values[last % count], values[(last - 1) % count]
    leaves, enters = (near - limit) / (near - dark), (far - limit) / (far - late)
    return last - first - float(leaves + enters)


def tilt_factor(distribution: Distribution, tilt_degrees: float, /) -> float:
    """What the light of the lamps is multiplied by when the luminaire is tilted by this angle.

    LM-63 tabulates it for discharge lamps, whose arc moves; 1 without such a table. The tilt is
    taken as that of the nadir against the world's, whichever way the lamp lies in the luminaire.
    """
    tilt = distribution.tilt
    if tilt is None:
        return 1.0
    return float(np.interp(tilt_degrees, tilt.angles_degrees, tilt.factors))
