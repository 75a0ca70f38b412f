"""Needles in float64: every pixel within their reach.

::

                     s  across: angle from the needle's great circle
        outline      │
    ●────┤━━━━━━━━━━━┷━━━━━━━━╸        luminance = E·profile(ρ)·tent(s)
    source            ρ  along: angle from the outline

Both factors are means, over a pixel across and some pixels along: differences of their integrals.
So all pixels together hold a needle's light, however thin it is and wherever it lies between them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.glare.needles.model import REFERENCE_NM, WAVELENGTHS_NM, NeedleModel, Needles
from andon.spaces import View, perpendicular

__all__ = ["EXTENT", "LEAST_HALF_WIDTH", "MARGIN", "draw", "profile_within", "tent_within"]

Float = NDArray[np.float64]

# In pixels: no tent is narrower to each side, and light is the mean over so much along a needle.
# With 1, and the mean over the pixel across, needles neither flicker nor show steps when they move
# by fractions of a pixel. Along it is the foot, where all of them begin at once, that needs more:
# with 1 px the light of a star varied by 3 % with where it lay between pixels, with 3 by 0.7 %.
LEAST_HALF_WIDTH, EXTENT = 1.0, 3.0
# No light is farther than this from a needle, in pixels.
MARGIN = 1.5
# Pixels nearer to a source than so many half-widths of its needles are looked at by all of them.
WIDTHS_AROUND = 8.0


def profile_within(along: ArrayLike, model: NeedleModel, /) -> Float:
    """(...) share of a needle's light within ρ = `along` (...) lengths of its foot: 0 at 0, 1 at 1.

    The integral of ``(1 + ρ/knee)^−m − (1 + 1/knee)^−m``, which falls like the bloom, to 0 at 1.
    """
    place = np.clip(np.asarray(along, np.float64), 0, 1)
    m, knee = model.power, model.knee
    end = (1 + 1 / knee) ** -m

    def integral(x: Float) -> Float:
        return knee / (m - 1) * (1 - (1 + x / knee) ** (1 - m)) - end * x

    return integral(place) / integral(np.ones(()))


def tent_within(across: ArrayLike, /) -> Float:
    """(...) share of a tent's light below `across` (...), in half-widths: 0 at −1, 1 at 1."""
    place = np.clip(np.asarray(across, np.float64), -1, 1)
    return 0.5 + place - 0.5 * place * np.abs(place)


def draw(needles: Sequence[Needles], view: View, /) -> Float:
    """(H, W, 3) cd/m² of needles alone, pixel by pixel the mean over it."""
    directions = view.directions()
    steps = _steps(view)
    margin = MARGIN * float(np.max(np.linalg.norm(steps, axis=(-2, -1))))
    picture = np.zeros((*view.shape, 3))
    for star in needles:
        inside = directions @ star.direction > np.cos(min(np.pi, star.reach_radians + margin))
        seen, footprint = directions[inside], steps[inside]
        light = np.zeros((len(seen), 3))
        beside = _beside(star, seen, margin)
        for index in range(len(star)):
            candidates = beside(index)
            near = candidates[_near(star, index, seen[candidates], margin)]
            light[near] += _needle(star, index, seen[near], footprint[near])
        picture[inside] += light
    return picture


def _beside(star: Needles, directions: Float, margin: float) -> Callable[[int], NDArray[np.int64]]:
    """Needle → indices of the `directions` (n, 3) in a sector around it, and near the source.

    Sorted by azimuth once, so that no needle looks at all pixels.
    """
    right, down = perpendicular(star.direction)
    x, y = directions @ right, directions @ down
    widest = float(np.max(star.half_width_radians, initial=0.0)) + margin
    close = np.hypot(x, y) <= WIDTHS_AROUND * widest
    middle, others = np.flatnonzero(close), np.flatnonzero(~close)
    turn = np.arctan2(y, x)[others]
    order = np.argsort(turn)
    sector = np.arcsin(1 / WIDTHS_AROUND)
    # Twice round, so that a sector never goes over the seam.
    turn = np.concatenate([turn[order], turn[order] + 2 * np.pi])
    others = np.tile(others[order], 2)
    azimuths = np.mod(np.arctan2(star.along @ down, star.along @ right) + np.pi, 2 * np.pi) - np.pi

    def candidates(index: int) -> NDArray[np.int64]:
        azimuth = azimuths[index] + (2 * np.pi if azimuths[index] < sector - np.pi else 0)
        first, last = np.searchsorted(turn, [azimuth - sector, azimuth + sector])
        return np.concatenate([middle, others[first:last]])

    return candidates


def _near(star: Needles, index: int, directions: Float, margin: float) -> NDArray[np.int64]:
    """Indices of the `directions` (n, 3) that may hold light of one needle."""
    along = star.along[index]
    across = np.abs(directions @ np.cross(star.direction, along))
    return np.flatnonzero(
        (across < star.half_width_radians[index] + margin) & (directions @ along > -margin)
    )


def _needle(star: Needles, index: int, directions: Float, steps: Float) -> Float:
    """(n, 3) cd/m² of one needle at `directions` (n, 3) of pixels that step by (n, 2, 3)."""
    along = star.along[index]
    normal = np.cross(star.direction, along)
    x, y, s = directions @ star.direction, directions @ along, directions @ normal
    # How much θ changes over what is averaged, and s over a pixel.
    outwards = (x[:, None] * along - y[:, None] * star.direction) / (x**2 + y**2)[:, None]
    length = EXTENT * np.linalg.norm(np.einsum("nka,na->nk", steps, outwards), axis=-1)
    width = np.linalg.norm(steps @ normal, axis=-1)
    rho = np.arctan2(y, x) - star.start_radians[index]
    reach = star.length_radians[index] * WAVELENGTHS_NM / REFERENCE_NM
    model = star.model
    ends = (rho[:, None] + 0.5 * length[:, None] * np.array([-1, 1]))[..., None] / reach
    held = np.diff(profile_within(ends, model), axis=1)[:, 0] / length[:, None]
    tapered = 1 - (1 - model.taper) * np.clip(rho / star.length_radians[index], 0, 1)
    half = np.maximum(star.half_width_radians[index] * tapered, LEAST_HALF_WIDTH * width)
    tent = (tent_within((s + width / 2) / half) - tent_within((s - width / 2) / half)) / width
    return star.illuminance_lux[index] * held * tent[:, None]


def _steps(view: View) -> Float:
    """(H, W, 2, 3) how the direction changes from one side of a pixel to the other."""
    grid = view.pixel_grid()
    sides = [view.directions_at(grid + 0.5 * np.array(way)) for way in ((1, 0), (0, 1))]
    others = [view.directions_at(grid - 0.5 * np.array(way)) for way in ((1, 0), (0, 1))]
    return np.stack(sides, axis=-2) - np.stack(others, axis=-2)
