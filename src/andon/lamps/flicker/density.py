"""How often the intermittent map is where: its invariant density, solved for and not sampled.

A point x is reached from one state on each branch, g₁(x) by S + S^z and g₂(x) by S + S^z − 1.
The share M(x) of the time below x therefore obeys ::

    M(x) = M(g₁(x)) + M(g₂(x)) − M(c),      c + c^z = 1

which is linear in M. Near 0 M runs as x^(2 − z): times long after the last jump are rare but long.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.lamps.flicker.intermittency import NOISE

__all__ = ["InvariantDensity", "invariant_density"]

Float = NDArray[np.float64]

# From where noise alone drives the state, to 1. Twice as many change means by less than 1e-3.
NODES = 800


@dataclass(frozen=True, eq=False)
class InvariantDensity:
    """Share of the time that the map spends below a state.

    Attributes
    ----------
    states : (n,) rising, 0…1.
    below : (n,) M, 0…1.
    """

    states: Float
    below: Float

    @property
    def mean(self) -> float:
        """⟨S⟩, by which a flicker is divided to have mean 1."""
        above = 1 - self.below
        return float(np.sum((above[1:] + above[:-1]) / 2 * np.diff(self.states)))

    def state(self, shares: Float, /) -> Float:
        """(...) states below which the map is for `shares` (...) of the time, 0…1."""
        return np.interp(shares, self.below, self.states)


@lru_cache(maxsize=64)
def invariant_density(z: float, /) -> InvariantDensity:
    """Of the map with exponent `z`, 1 < z < 2, and the noise of `intermittency`."""
    # Equal steps of log x below, of x above: creeping is a matter of decades, jumps are not.
    small = np.geomspace(NOISE, 0.05, NODES // 2, endpoint=False)
    x = np.concatenate([[0.0], small, np.linspace(0.05, 1, NODES // 2)])
    first, second = _before(x, z), _before(x + 1, z)
    edge = _before(np.array([1.0]), z)
    matrix = np.eye(len(x)) - _weights(x, first, z) - _weights(x, second, z)
    matrix += _weights(x, edge, z)
    # 0 is below 0; all is below 1. The rows of both ends say nothing else.
    matrix[0], matrix[-1] = 0, 0
    matrix[0, 0] = matrix[-1, -1] = 1
    right = np.zeros(len(x))
    right[-1] = 1
    below = np.linalg.solve(matrix, right)
    return InvariantDensity(x, np.maximum.accumulate(np.clip(below, 0, 1)))


def _before(x: Float, z: float) -> Float:
    """The y ≥ 0 with y + y^z + (mean noise) = x, by bisection; 0 where none is."""
    x = x - NOISE / 2
    low, high = np.zeros_like(x), np.maximum(x, 0)
    for _ in range(60):
        middle = (low + high) / 2
        over = middle + middle**z > x
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    return np.minimum((low + high) / 2, 1.0)


def _weights(x: Float, y: Float, z: float) -> Float:
    """(len(y), len(x)) weights of M at the nodes that give M at y: lines in x^(2 − z)."""
    bent, at = x ** (2 - z), y ** (2 - z)
    after = np.clip(np.searchsorted(x, y), 1, len(x) - 1)
    share = (at - bent[after - 1]) / (bent[after] - bent[after - 1])
    weights = np.zeros((len(y), len(x)))
    rows = np.arange(len(y))
    weights[rows, after - 1] = 1 - share
    weights[rows, after] += share
    return weights
