"""The kernel as a mixture of Gaussians of the chord: ``K(θ) ≈ ∫ W(σ)·G_σ dlnσ``.

G_σ has unit energy on the sphere, so W is the share of a point's light per ln σ. All spread
functions fall by powers between −1 and −3, which are such mixtures; W = exp(u) is found by least
squares of ln K over 0.1°…110° with a penalty on the second differences of u, so it is smooth and
positive. A pyramid samples W at a few σ: a ratio of 2 makes a ripple of 0.6 % (θ⁻²) to 1.5 % (θ⁻³).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel

__all__ = ["Mixture", "chord_gaussian", "near_share"]

Float = NDArray[np.float64]

# σ of the mixture, and how many steps an octave has.
SIGMA_DEGREES = (0.03, 64.0)
PER_OCTAVE = 4
# Angles of the fit; what fades beyond 90° is left to the far part, which has it exactly.
FIT_DEGREES = (0.1, 80.0)
# Penalty of a second difference of 1 against a relative error of 1 of the kernel.
SMOOTHNESS = 0.03
ROUNDS = 30


def chord_gaussian(chord: Float, sigma: Float, /) -> Float:
    """Density in sr⁻¹ of a Gaussian of σ radians at a chord; its integral over the sphere is 1."""
    return np.exp(-(chord**2) / (2 * sigma**2)) / (2 * np.pi * sigma**2 * -np.expm1(-2 / sigma**2))


@dataclass(frozen=True, eq=False)
class Mixture:
    """W over ln σ.

    Attributes
    ----------
    log_sigma : (n,) evenly spaced, σ in radians.
    share : (n,) W > 0, share of the light per ln σ.
    """

    log_sigma: Float
    share: Float

    @staticmethod
    def of(kernel: Kernel, /) -> Mixture:
        """The mixture of a kernel."""
        ends = np.log(np.radians(SIGMA_DEGREES))
        count = round((ends[1] - ends[0]) / math.log(2) * PER_OCTAVE)
        log_sigma = ends[0] + np.arange(count + 1) * (math.log(2) / PER_OCTAVE)
        theta = np.exp(np.linspace(*np.log(np.radians(FIT_DEGREES)), 4 * count))
        bumps = _bumps(theta, log_sigma)
        return Mixture(log_sigma, _fitted(bumps, kernel.per_sr(theta, core=True), log_sigma))

    def per_sr(self, theta_radians: Float, /, weight: Float | float = 1.0) -> Float:
        """(...) the mixture at angles (...), in sr⁻¹, each σ's share times `weight` (n,)."""
        return _bumps(theta_radians, self.log_sigma) @ (self.share * weight)


def _bumps(theta: Float, log_sigma: Float) -> Float:
    """(..., n) what a share of 1 per ln σ at each of `log_sigma` alone makes at θ."""
    step = log_sigma[1] - log_sigma[0]
    return step * chord_gaussian(2 * np.sin(theta / 2)[..., None], np.exp(log_sigma))


def _fitted(bumps: Float, wanted: Float, log_sigma: Float) -> Float:
    # Gauss–Newton on u = ln W from W ~ 0.05/σ, near that of θ^−2.5.
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


def near_share(log_sigma: Float, span: tuple[float, float], /) -> Float:
    """(n,) χ: what the pyramid has of each σ, from 1 to 0 between two σ in radians; the rest is far."""
    along = np.clip((log_sigma - math.log(span[0])) / math.log(span[1] / span[0]), 0, 1)
    return 1 - along**2 * (3 - 2 * along)
