"""Moments of bright blobs over the sphere of directions, and the sources that they are.

::

    pixels ─pixel_moments▶ Moments of n blobs ─merged▶ fewer blobs ─sources_of▶ Source, an ellipse

All sums are of light, so they may be taken in parts (pixels, tiles) in any order. A uniform ellipse
of semi-axes a, b has the variances a²/4, b²/4 along them (any text on second moments of area); the
outline is the ellipse of the same moments, and the luminance that follows from it the blob's mean.
A pixel is no point: its own variance, ω/12 a side, is part of the blob's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.model import Outline, Source, right_of
from andon.quantities import photometric

__all__ = ["Moments", "ellipse_outline", "pixel_moments", "sources_of"]

Float = NDArray[np.float64]
Labels = NDArray[np.integer]

# Of an ellipse's outline; between them θ0 is linear: 1e-3 of the radius at an axis ratio of 3.
OUTLINE_ANGLES = 96
# Axes that differ by less are one radius.
ROUND = 1.01
# An outline ends before a quarter of the sphere.
LARGEST_RADIANS = np.radians(89.0)


@dataclass(frozen=True, eq=False)
class Moments:
    """Sums over the pixels of n blobs; Y is the photometric value of a pixel's luminance.

    Attributes
    ----------
    illuminance_lux : (n, 3) Σ L·ω.
    first : (n, 3) Σ Y·ω·d, camera frame.
    second : (n, 3, 3) Σ Y·ω·(d dᵀ + ω/12·(1 − d dᵀ)).
    peak_cd_m2 : (n,) the greatest Y.
    """

    illuminance_lux: Float
    first: Float
    second: Float
    peak_cd_m2: Float

    def __len__(self) -> int:
        return len(self.peak_cd_m2)

    def merged(self, labels: Labels, count: int, /) -> Moments:
        """`count` blobs of which blob i goes into number `labels[i]`, −1 into none."""
        kept = labels >= 0
        labels = labels[kept]

        def summed(values: Float) -> Float:
            total = np.zeros((count, *values.shape[1:]))
            np.add.at(total, labels, values[kept])
            return total

        peak = np.zeros(count)
        np.maximum.at(peak, labels, self.peak_cd_m2[kept])
        return Moments(summed(self.illuminance_lux), summed(self.first), summed(self.second), peak)


def pixel_moments(
    directions: Float, luminance_cd_m2: Float, solid_angle_sr: Float, labels: Labels, count: int, /
) -> Moments:
    """The moments of `count` blobs of pixels.

    Parameters
    ----------
    directions : (m, 3) unit, camera frame.
    luminance_cd_m2 : (m, 3) ≥ 0.
    solid_angle_sr : (m,) of each pixel.
    labels : (m,) 0…count − 1, or −1 for none.
    """
    value = photometric(luminance_cd_m2)
    weight = value * solid_angle_sr
    outer = directions[:, :, None] * directions[:, None, :]
    own = (solid_angle_sr / 12)[:, None, None] * (np.eye(3) - outer)
    pixels = Moments(
        luminance_cd_m2 * solid_angle_sr[:, None],
        weight[:, None] * directions,
        weight[:, None, None] * (outer + own),
        value,
    )
    return pixels.merged(labels, count)


def sources_of(moments: Moments, /, *, name: str = "", clipped: bool = False) -> list[Source]:
    """Each blob as an elliptic source, brightest first; blobs without light are left out."""
    lit = np.flatnonzero(photometric(moments.illuminance_lux) > 0)
    order = lit[np.argsort(-photometric(moments.illuminance_lux[lit]), kind="stable")]
    return [_source(moments, int(blob), name, clipped) for blob in order]


def _source(moments: Moments, blob: int, name: str, clipped: bool) -> Source:
    total = float(photometric(moments.illuminance_lux[blob]))
    direction = moments.first[blob] / np.linalg.norm(moments.first[blob])
    right = right_of(direction)
    plane = np.stack([right, np.cross(direction, right)])
    variances, axes = np.linalg.eigh(plane @ moments.second[blob] @ plane.T / total)
    # The tangent plane has sines of angles.
    b, a = np.arcsin(np.minimum(2 * np.sqrt(np.maximum(variances, 1e-16)), 1.0)).tolist()
    outline = ellipse_outline(min(a, LARGEST_RADIANS), min(b, LARGEST_RADIANS))
    along = np.asarray(axes[:, 1] @ plane, np.float64)
    return Source(direction, moments.illuminance_lux[blob], outline, along, name, clipped)


def ellipse_outline(a_radians: float, b_radians: float, /) -> Outline:
    """θ0(φ) = ab/√((b cos φ)² + (a sin φ)²), `a_radians` at φ = 0; a circle where they agree."""
    if max(a_radians, b_radians) <= ROUND * min(a_radians, b_radians):
        return Outline(np.array([np.sqrt(a_radians * b_radians)]))
    phi = np.arange(OUTLINE_ANGLES) * (2 * np.pi / OUTLINE_ANGLES)
    radius = a_radians * b_radians / np.hypot(b_radians * np.cos(phi), a_radians * np.sin(phi))
    return Outline(radius, "ellipse")
