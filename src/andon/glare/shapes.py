"""Outlines of sources: θ0 over φ, the angle from a source's direction to its edge.

Plane figures in the azimuthal equidistant plane about the direction, so that a distance from the
middle is an angle: the circle is a circle on the sphere, and what is some degrees wide is what a
plane figure of that size looks like. The paper's forms are the ellipse ``ab/√((b cos φ)² + (a sin
φ)²)``, the cylinder (a segment with caps), the hemisphere (a cut circle), the pear and any table.
φ = 0 is `Source.right`, φ = 90° down.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.glare.model import Outline

__all__ = [
    "circle",
    "cylinder",
    "ellipse",
    "hemisphere",
    "pear",
    "polygon",
    "spherical_hull",
    "spherical_outline",
    "table",
]

Float = NDArray[np.float64]

# Samples of an outline per unit of its length over its width: the round end of a narrow one is
# seen from the middle within an angle of that ratio.
SAMPLES_PER_ASPECT = 180
MOST_SAMPLES = 2880


def circle(radius_radians: float, /) -> Outline:
    """A disc; radius in (0, π/2)."""
    return Outline(np.array([radius_radians]))


def ellipse(a_radians: float, b_radians: float, /) -> Outline:
    """Semi-axes a along φ = 0 and b along φ = 90°. Source: the glare paper."""
    cosine, sine = _around(a_radians, b_radians)
    root = np.hypot(b_radians * cosine, a_radians * sine)
    return Outline(a_radians * b_radians / root, "ellipse")


def cylinder(half_length_radians: float, radius_radians: float, /) -> Outline:
    """All points within `radius` of a segment of ±`half_length` along φ = 0: a tube."""
    _positive(half_length=half_length_radians, radius=radius_radians)
    h, r = half_length_radians, radius_radians
    cosine, sine = _around(h + r, r)
    cap = h * np.abs(cosine) + np.sqrt(np.maximum(r * r - (h * sine) ** 2, 0))
    with np.errstate(divide="ignore"):
        side = r / np.abs(sine)
    return Outline(np.where(np.abs(cosine) * side <= h, side, cap), "cylinder")


def hemisphere(radius_radians: float, /) -> Outline:
    """The upper half of a disc about its centroid, flat below: a dome."""
    _positive(radius=radius_radians)
    r = radius_radians
    below = 4 * r / (3 * np.pi)  # from the half disc's centroid to its flat side
    cosine, sine = _around(r, r)
    # Where the ray leaves the circle, whose centre is `below` down.
    arc = below * sine + np.sqrt(r * r - (below * cosine) ** 2)
    with np.errstate(divide="ignore"):
        flat = np.where(sine > 0, below / sine, np.inf)
    return Outline(np.minimum(arc, flat), "hemisphere")


def pear(radius_radians: float, neck_radians: float, distance_radians: float, /) -> Outline:
    """A bulb with a neck upwards, about its centroid.

    The hull of a circle of `radius` and one of `neck` < `radius` whose centre is `distance` above.
    """
    r, n, d = radius_radians, neck_radians, distance_radians
    _positive(radius=r, neck=n, distance=d)
    if not n < r < n + d:
        raise InputError("neck < radius < neck + distance", field="outline.pear")
    # Both tangents touch the circles at this angle from the axis.
    touch = np.arccos((r - n) / d)
    turn = np.linspace(-1, 1, 181)
    neck = n * np.stack([np.sin(touch * turn), -np.cos(touch * turn)], axis=-1) - [0, d]
    rest = np.pi + (np.pi - touch) * turn
    bulb = r * np.stack([np.sin(rest), -np.cos(rest)], axis=-1)
    return polygon(np.vstack([neck, bulb]), "pear")


def table(radii_radians: ArrayLike, /) -> Outline:
    """Any θ0 (n,) at φ = 2π·i/n."""
    return Outline(np.asarray(radii_radians, np.float64), "table")


def polygon(corners_radians: ArrayLike, name: str = "polygon", /) -> Outline:
    """A polygon (k, 2) of (right, down) about its centroid, from which all of it must be seen.

    Raises `InputError` where it is not: such an outline is no function of φ.
    """
    corners = np.asarray(corners_radians, np.float64)
    following = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
    centroid = (corners + following).T @ cross / (3 * np.sum(cross))
    about, ahead = corners - centroid, following - centroid
    turned = about[:, 0] * ahead[:, 1] - about[:, 1] * ahead[:, 0]
    turned *= np.sign(np.sum(turned))
    if not np.all(turned > -1e-9 * np.sum(turned)):
        raise InputError("must be seen whole from its centroid", field=f"outline.{name}")
    width = np.ptp(corners, axis=0)
    count = _count(float(width.max()), float(width.min()))
    return Outline(_reach(about, ahead, _turns(count)), name)


def spherical_outline(corners: Float, /) -> Outline:
    """A polygon of great circles through unit vectors (k, 3) of (right, down, direction).

    In order; of what is not seen from the direction the farthest edge counts. Within 90°.
    """
    flat = corners[:, :2] / corners[:, 2:]  # great circles are straight in the gnomonic plane
    width = np.ptp(flat, axis=0)
    count = _count(float(width.max()), max(float(width.min()), 1e-9))
    phi = _turns(count)
    reach = np.arctan(_reach(flat, np.roll(flat, -1, axis=0), phi))
    # A direction from which the polygon is all to one side sees nothing to the other.
    return Outline(np.maximum(reach, 1e-3 * reach.max()), "polygon")


def spherical_hull(points: Float, /) -> Outline:
    """Outline of the hull of unit vectors (n, 3) of (right, down, direction), within 90°."""
    flat = points[:, :2] / points[:, 2:]
    flat = np.unique(flat, axis=0)
    chains: list[list[Float]] = []
    for run in (flat, flat[::-1]):  # Andrew's monotone chain
        chain: list[Float] = []
        for point in run:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        chains.append(chain[:-1])
    corners = np.array(chains[0] + chains[1])
    return spherical_outline(np.concatenate([corners, np.ones((len(corners), 1))], axis=1))


def _turn(a: Float, b: Float, c: Float) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _reach(start: Float, end: Float, phi: Float) -> Float:
    """(m,) distances from 0 along φ (m,) to the farthest of the segments `start` → `end` (k, 2)."""
    cosine, sine = np.cos(phi)[:, None], np.sin(phi)[:, None]
    across = [cosine * p[:, 1] - sine * p[:, 0] for p in (start, end)]
    along = [cosine * p[:, 0] + sine * p[:, 1] for p in (start, end)]
    with np.errstate(invalid="ignore", divide="ignore"):
        where = across[0] / (across[0] - across[1])
    met = np.where(across[0] * across[1] <= 0, along[0] + where * (along[1] - along[0]), 0.0)
    return np.max(np.nan_to_num(met), axis=1)


def _around(a: float, b: float) -> tuple[Float, Float]:
    """cos φ and sin φ at equal steps."""
    _positive(a=a, b=b)
    count = _count(max(a, b), min(a, b))
    phi = _turns(count)
    return np.cos(phi), np.sin(phi)


def _turns(count: int) -> Float:
    return 2 * np.pi * np.arange(count, dtype=np.float64) / count


def _count(long: float, short: float) -> int:
    wanted = SAMPLES_PER_ASPECT * long / short
    return int(4 * np.ceil(min(wanted, MOST_SAMPLES) / 4))


def _positive(**lengths: float) -> None:
    for name, value in lengths.items():
        if not 0 < value < np.pi / 2:
            raise InputError(f"must be in (0, π/2), got {value:g}", field=f"outline.{name}")
