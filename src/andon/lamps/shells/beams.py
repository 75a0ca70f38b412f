"""How a lamp shines, without where and how brightly: what a shell's solution depends on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.files.photometry import Distribution
from andon.lamps.distributions import POINT_SOLID_ANGLE_SR, spot_attenuation, spot_solid_angle_sr
from andon.lamps.goniometry import candela, flux_lm, maximum_cd
from andon.lamps.intensity import luminaire_axes
from andon.lamps.model import GoniometricLamp, PointLamp, SpotLamp
from andon.lamps.solids import quarters

__all__ = ["Beam", "beam_flux", "beam_of", "solid_angles"]

Float = NDArray[np.float64]

# Pieces of a facet that a cone crosses are cut until they are this share of the cone's angle.
# The cone's flux is then within 1e-3 of the closed form, which it is scaled to where it can be.
PIECES_PER_CONE = 24
# Measured distributions are smooth over this angle, or have steps that no file resolves.
MEASURED_RADIANS = float(np.radians(2))
MAX_CUTS, MAX_PIECES = 14, 400_000


@dataclass(frozen=True)
class Beam:
    """A distribution of intensity whose stated value is 1 cd; hashable.

    Attributes
    ----------
    direction : unit, the axis; None: equal to all sides.
    inner_radians, outer_radians : of a spot.
    right, distribution : of a luminaire: where C = 0 points, and what was measured.
    """

    direction: tuple[float, float, float] | None = None
    inner_radians: float = 0.0
    outer_radians: float = float(np.pi)
    right: tuple[float, float, float] | None = None
    distribution: Distribution | None = None

    @property
    def flux_lm(self) -> float:
        """Flux of the whole beam at 1 cd."""
        if self.distribution is not None:
            return flux_lm(self.distribution) / maximum_cd(self.distribution)
        if self.direction is None:
            return POINT_SOLID_ANGLE_SR
        return spot_solid_angle_sr(self.inner_radians, self.outer_radians)

    @property
    def feature_radians(self) -> float:
        """Angle within which the intensity changes little."""
        if self.distribution is not None:
            return MEASURED_RADIANS
        return np.inf if self.direction is None else self.outer_radians / PIECES_PER_CONE

    def towards(self, directions: Float, /) -> Float:
        """Intensity (...) in cd towards unit directions (..., 3)."""
        if self.direction is None:
            return np.ones(directions.shape[:-1])
        if self.distribution is not None and self.right is not None:
            axes = luminaire_axes(np.array(self.right), np.array(self.direction))
            relative = candela(self.distribution, directions @ axes.T)
            return relative / maximum_cd(self.distribution)
        return spot_attenuation(
            directions @ np.array(self.direction),
            inner_radians=self.inner_radians,
            outer_radians=self.outer_radians,
        )

    def touches(self, centre: Float, radius: Float, /) -> NDArray[np.bool_]:
        """Whether caps (n, 3), (n,) on the unit sphere get some of the beam."""
        if self.direction is None or self.distribution is not None:
            return np.ones(len(centre), np.bool_)
        angle = np.arccos(np.clip(centre @ np.array(self.direction), -1, 1))
        return angle < self.outer_radians + radius


def beam_of(lamp: PointLamp, /) -> Beam:
    """How `lamp` shines. Raises TypeError for a distribution that is not known here."""
    if isinstance(lamp, SpotLamp):
        x, y, z = np.asarray(lamp.direction, np.float64).tolist()
        return Beam((x, y, z), lamp.inner_radians, lamp.outer_radians)
    if isinstance(lamp, GoniometricLamp):
        x, y, z = np.asarray(lamp.direction, np.float64).tolist()
        u, v, w = np.asarray(lamp.right, np.float64).tolist()
        return Beam((x, y, z), right=(u, v, w), distribution=lamp.distribution)
    if type(lamp) is PointLamp:
        return Beam()
    raise TypeError(f"the distribution of a {type(lamp).__name__} is not known to shells")


def solid_angles(corners: Float, /) -> Float:
    """Signed solid angle (...) in sr of triangles (..., 3, 3), seen from the origin.

    Positive where the triangle runs clockwise as seen from there, that is, where it turns its
    outside away. van Oosterom & Strackee 1983.
    """
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    la, lb, lc = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
    volume = np.einsum("...i,...i", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("...i,...i", p, q) for p, q in ((a, b), (b, c), (c, a)))
    return 2 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)


def beam_flux(corners: Float, beam: Beam, /) -> Float:
    """Signed flux (n,) in lm through triangles (n, 3, 3) by a beam of 1 cd at the origin."""
    if beam.direction is None:
        return solid_angles(corners)
    flux, owner = np.zeros(len(corners)), np.arange(len(corners))
    for cut in range(MAX_CUTS + 1):
        centre, radius = _caps(corners)
        split = beam.touches(centre, radius) & (radius > beam.feature_radians)
        if cut == MAX_CUTS or len(corners) + 3 * np.count_nonzero(split) > MAX_PIECES:
            split[:] = False
        done = ~split
        np.add.at(flux, owner[done], beam.towards(centre[done]) * solid_angles(corners[done]))
        corners, owner = quarters(corners[split]), np.repeat(owner[split], 4)
        if not len(corners):
            break
    return flux


def _caps(corners: Float) -> tuple[Float, Float]:
    """Centre (n, 3) and angular radius (n,) of caps around triangles, seen from the origin."""
    length = np.linalg.norm(corners, axis=-1, keepdims=True)
    directions: Float = corners / np.maximum(length, np.finfo(float).tiny)
    middle: Float = directions.mean(axis=1)
    size = np.linalg.norm(middle, axis=-1, keepdims=True)
    centre: Float = np.where(size > 1e-12, middle / np.maximum(size, 1e-12), directions[:, 0])
    cosine = np.einsum("nij,nj->ni", directions, centre).min(axis=1)
    return centre, np.arccos(np.clip(cosine, -1, 1))
