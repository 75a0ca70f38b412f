"""The kernel as a mixture of round bumps over the chord: ``K(θ) ≈ K₀ + ∫ W(σ)·G_σ dlnσ``.

G_σ, of σ radians and unit energy, is the point-spread function of a pyramid's level, averaged over
places and azimuths: all but a Gaussian. W is the share of a point's light per ln σ. All spread
functions fall by powers between −1 and −3, which are such mixtures; W = exp(u) is found by least
squares of ln K with a penalty on the second differences of u, so it is smooth and positive. A
pyramid samples W at a few σ: a ratio of 2 makes a ripple of 0.6 % (θ⁻²) to 1.5 % (θ⁻³).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.splines import level_profile, sigma_cells

__all__ = ["Mixture", "bump"]

Float = NDArray[np.float64]

# σ of the mixture, and how many steps an octave has.
SIGMA_DEGREES = (0.03, 64.0)
PER_OCTAVE = 4
# Angles of the fit; what comes beyond is left to the far part, which has it exactly.
FIT_DEGREES = (0.1, 40.0)
# K₀, in units of the least value within 90°: skirts go over into a constant.
FLOOR = 0.95
# Penalty of a second difference of 1 against a relative error of 1 of the kernel.
SMOOTHNESS = 0.03
ROUNDS = 30
# The bump as a table over chord/σ, to where it ends.
STEPS, REACH_SIGMAS = 512, 7.0


def _table() -> tuple[Float, Float]:
    sigma = sigma_cells(64, 0)
    places = np.linspace(0, REACH_SIGMAS, STEPS + 1)
    return places, level_profile(places * sigma) * sigma**2


PLACES, DENSITY = _table()


def bump(chord: Float, sigma: Float, /) -> Float:
    """(...) sr⁻¹ of a level's bump of σ radians at a chord; its energy in a chart is 1."""
    return np.interp(chord / sigma, PLACES, DENSITY) / sigma**2


@dataclass(frozen=True, eq=False)
class Mixture:
    """W over ln σ.

    Attributes
    ----------
    log_sigma : (n,) evenly spaced, σ in radians.
    share : (n,) W > 0, share of the light per ln σ.
    floor : K₀ in sr⁻¹, the same at all angles.
    """

    log_sigma: Float
    share: Float
    floor: float

    @staticmethod
    def of(kernel: Kernel, /) -> Mixture:
        """The mixture of a kernel."""
        least, most = (math.log2(math.radians(end)) for end in SIGMA_DEGREES)
        count = round((most - least) * PER_OCTAVE)
        log_sigma = (least + np.arange(count + 1) / PER_OCTAVE) * math.log(2)
        theta = np.radians(np.geomspace(*FIT_DEGREES, 4 * count))
        bumps = _bumps(theta, log_sigma)
        skirt = kernel.spread.bloom_per_sr(np.linspace(FIT_DEGREES[1], 90, 51))
        floor = FLOOR * float(skirt.min())
        wanted = kernel.per_sr(theta, core=True) - floor
        return Mixture(log_sigma, _fitted(bumps, wanted, log_sigma), floor)

    def per_sr(self, theta_radians: Float, weight: Float | float = 1.0, /) -> Float:
        """(...) the integral at angles (...), in sr⁻¹, each σ's share times `weight` (n,).

        With weights (m, n) the result is (..., m).
        """
        return _bumps(theta_radians, self.log_sigma) @ (self.share * weight).T


def _bumps(theta: Float, log_sigma: Float) -> Float:
    """(..., n) what a share of 1 per ln σ at each of `log_sigma` alone makes at θ."""
    step = log_sigma[1] - log_sigma[0]
    return step * bump(2 * np.sin(theta / 2)[..., None], np.exp(log_sigma))


def _fitted(bumps: Float, wanted: Float, log_sigma: Float) -> Float:
    # Gauss–Newton on u = ln W from W ~ σ^−½, that of θ^−2.5.
    u = -2 - 0.5 * (log_sigma - log_sigma[0])
    rough = SMOOTHNESS * len(wanted) ** 0.5 * np.diff(np.eye(len(u)), 2, axis=0)
    for _ in range(ROUNDS):
        parts = bumps * np.exp(u)
        value = parts.sum(1)
        slope = np.concatenate([parts / value[:, None], rough])
        miss = np.concatenate([np.log(wanted / value), -rough @ u])
        step = np.linalg.lstsq(slope, miss, rcond=None)[0]
        u = u + np.clip(step, -1, 1)
    return np.exp(u)
