"""Places around a source in which its veil is smooth: along its edge, and away from it.

About a narrow source polar coordinates are bad: a ray from the middle leaves its flank at a slant.
*Confocal* ones follow it. In the plane of Lambert's chart (|p| = 2·sin(θ/2), the distance of unit
vectors, precise at small angles and defined to the antipode) ellipses around foci at ±f on the
long axis and the hyperbolas across them: x = m·cos ν, y = √(m² − f²)·sin ν. The mean distance m
from the foci is far away that from the middle; f = 0 is polar.

::

                  ╭───────── m
              ╭───┼───────╮ ╲
          ────│──f┼──────f│──╲── long axis, ν = 0
              ╰───┼───────╯
                  ν = 90°
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.model import Outline

__all__ = ["Confocal", "chord", "confocal_of"]

Float = NDArray[np.float64]

# On the long axis between the foci: so far beside it, where ν still has a value.
BESIDE = 1e-12
# Foci stay this share of the half width away from the ends.
END_SHARE = 0.5
# Outlines of a less unequal pair of axes than this are polar.
ROUND = 1.05


def chord(theta: Float | float, /) -> Float:
    """2·sin(θ/2): the distance of two unit vectors θ apart."""
    return 2 * np.sin(np.asarray(theta, np.float64) / 2)


@dataclass(frozen=True)
class Confocal:
    """The coordinates of one outline.

    Attributes
    ----------
    axis_radians : φ of the long axis.
    focus : f, chord from the direction to a focus; 0: polar.
    """

    axis_radians: float
    focus: float

    def of(self, x: Float, y: Float, /) -> tuple[Float, Float]:
        """m and ν (...) of places (...) in the chart, x along the long axis."""
        f2, y = self.focus**2, np.where(np.abs(y) < BESIDE, BESIDE, y)
        a = x * x + y * y - f2
        root = np.sqrt(a * a + 4 * f2 * y * y)
        # Without the difference of large numbers near the foci.
        inner = 2 * f2 * y * y / np.maximum(root - a, np.finfo(float).tiny)
        w2 = np.where(a >= 0, (a + root) / 2, inner)
        m = np.sqrt(f2 + w2)
        return m, np.arctan2(y * m, x * np.sqrt(w2))

    def places(self, m: Float, nu: Float, /) -> tuple[Float, Float]:
        """x and y (...) in the chart."""
        width = np.sqrt(np.maximum(m * m - self.focus**2, 0))
        return m * np.cos(nu), width * np.sin(nu)

    def directions(self, m: Float, nu: Float, /) -> Float:
        """(..., 3) unit vectors in the source's frame (right, down, direction)."""
        x, y = self.places(m, nu)
        square = np.minimum(x * x + y * y, 4.0)
        scale = np.sqrt(1 - square / 4)
        cosine, sine = np.cos(self.axis_radians), np.sin(self.axis_radians)
        right, down = (cosine * x - sine * y) * scale, (sine * x + cosine * y) * scale
        return np.stack([right, down, 1 - square / 2], axis=-1)

    def edge(self, outline: Outline, steps: int, /) -> Float:
        """(steps,) m of the outline at ν = 2π·i/steps."""
        phi = np.linspace(0, 2 * np.pi, 8 * steps, endpoint=False)
        at = chord(outline.radius(phi + self.axis_radians))
        m, nu = self.of(at * np.cos(phi), at * np.sin(phi))
        return np.interp(2 * np.pi * np.arange(steps) / steps, nu, m, period=2 * np.pi)


def confocal_of(outline: Outline, /) -> Confocal:
    """Coordinates along the principal axis of `outline`."""
    phi = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    r4 = outline.radius(phi) ** 4
    axis = 0.5 * np.arctan2(np.sum(r4 * np.sin(2 * phi)), np.sum(r4 * np.cos(2 * phi)))
    ends = chord(outline.radius(axis + np.pi * np.arange(4) / 2))
    long, wide = float(ends[::2].min()), float(ends[1::2].min())
    if long < ROUND * wide:
        return Confocal(0.0, 0.0)
    return Confocal(float(axis), min(np.sqrt(long**2 - wide**2), long - END_SHARE * wide))
