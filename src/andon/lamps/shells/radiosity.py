"""What becomes of the light that meets an open shell's inside: through, lost, or out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Balance", "balance"]

Float = NDArray[np.float64]

# Halvings of an interval of 1: the last is at the end of double precision.
BISECTIONS = 52
HIGHEST_REFLECTANCE = 1 - 1e-9


@dataclass(frozen=True)
class Balance:
    """One channel's light in a shell, for an incident flux of 1.

    Attributes
    ----------
    received : (n,) flux that meets each facet in the end, reflections included.
    passes, reflects : τ₀ and ρ₀, shares per hit.
    """

    received: Float
    passes: float
    reflects: float


def balance(incident: Float, shares: Float, /, *, t: float, a: float) -> Balance:
    """The light inside such that shares t and a of it end in the paper, and the rest leaves.

    At every hit the paper lets τ₀ through, keeps α₀ and reflects ρ₀ diffusely, τ₀ : α₀ = t : a.
    What is received is H = e + ρ₀·Fᵀ·H, so that (τ₀ + α₀)·ΣH = t + a, which rises from 0 to 1 as
    ρ₀ falls from 1 to 0: there is one solution. Net shares t and a are what people measure and
    state; ρ₀ follows from them and from how open the shell is.

    Parameters
    ----------
    incident : (n,) flux from the lamp on each facet, ≥ 0, sum 1; or all 0.
    shares : (n, n) form factors; rows sum to at most 1, the rest leaves.
    t, a : ≥ 0, t + a ≤ 1.
    """
    kept = t + a
    if kept >= 1 or not incident.any():
        passes = t / kept if kept > 0 else 0.0
        return Balance(incident / max(kept, 1.0), passes, 0.0)
    low, high = 0.0, HIGHEST_REFLECTANCE
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if (1 - middle) * _received(incident, shares, middle).sum() > kept:
            low = middle
        else:
            high = middle
    reflects = high
    received = _received(incident, shares, reflects)
    ends = (1 - reflects) * received.sum()
    if ends > 0 and kept > 0:
        received *= kept / ends  # the last digits; and where hardly anything is open, all of it
    passes = (1 - reflects) * t / kept if kept > 0 else 0.0
    return Balance(received, passes, reflects)


def _received(incident: Float, shares: Float, reflects: float) -> Float:
    system = np.eye(len(incident)) - reflects * shares.T
    return np.asarray(np.linalg.solve(system, incident), np.float64)
