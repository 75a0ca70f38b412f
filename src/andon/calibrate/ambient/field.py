"""The field that log E0 is drawn from: smooth in place, low-order in the normal.

k(a, b) = Σ amplitude² · exp(−|a − b|²/2ℓ²) · Σ_l c_l P_l(n_a·n_b)

P_l are Legendre's polynomials up to band 2, all that a diffuse surface passes of a light from all
sides (Ramamoorthi & Hanrahan 2001); with c_l ≥ 0 each factor is positive definite (Schoenberg
1942), and so are product and sum. Lengths are in shares of the scene's extent. The field is
spanned by k to m *inducing* points (Rasmussen & Williams 2006, section 8.3): its features Φ have
unit prior.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["CHROMA", "LUMINANCE", "Field", "Term", "spread_points"]

Float = NDArray[np.float64]

# Of the diagonal, so that near inducing points leave the matrix invertible.
JITTER = 1e-6
# Of the distance between normals beside that of places, both of the order of 1.
NORMAL_WEIGHT = 0.7
# Points that are evaluated at once: 80 features of each take 40 MB.
AT_ONCE = 1 << 16


@dataclass(frozen=True)
class Term:
    """One part of the covariance: `variance`, `length` ℓ (inf: everywhere), `bands` c_0…c_2."""

    variance: float
    length: float
    bands: tuple[float, float, float]


# Of log light: a light that is the same in the whole room, what changes across it, and what changes
# around a lamp. Lamps at 1/d² from a wall make E vary by e² over half a room: about two of these
# standard deviations. No constant: the scale is not seen.
LUMINANCE = (
    Term(1.0, np.inf, (0.0, 0.6, 0.3)),
    Term(1.0, 1.5, (0.5, 0.4, 0.2)),
    Term(0.5, 0.5, (0.5, 0.4, 0.1)),
)
# Of log ratios of channels, times their amplitude: colour follows place more than normal.
CHROMA = (Term(1.0, np.inf, (0.0, 0.3, 0.1)), Term(1.0, 1.5, (0.7, 0.3, 0.0)))


class Field:
    """Features of a field: `position` (m, 3) and `normal` (m, 3) of its inducing points.

    Positions are in units of the scene's extent.
    """

    def __init__(self, terms: tuple[Term, ...], position: Float, normal: Float) -> None:
        self._terms, self._position, self._normal = terms, position, normal
        own = self._covariance(position, normal) + JITTER * np.eye(len(position))
        self._from_lower = np.linalg.inv(np.linalg.cholesky(own)).T

    def features(self, position: Float, normal: Float, /) -> Float:
        """Φ (n, m) at n points; a field is Φ·w with w of unit prior."""
        return np.asarray(self._covariance(position, normal) @ self._from_lower, np.float64)

    def values(self, weights: Float, position: Float, normal: Float, /) -> Float:
        """Φ·w (n,) or (n, c) of `weights` (m,) or (m, c), without keeping Φ."""
        alpha = self._from_lower @ weights
        found = np.empty((len(position), *weights.shape[1:]))
        for start in range(0, len(position), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            # float32 is wrong by 1e-4 of log light here, and takes a third of the time.
            place = position[part].astype(np.float32), normal[part].astype(np.float32)
            found[part] = self._covariance(*place) @ alpha.astype(np.float32)
        return found

    def _covariance(self, position: NDArray[Any], normal: NDArray[Any]) -> NDArray[Any]:
        """(n, m), in the precision of what is given."""
        own_position = self._position.astype(position.dtype)
        cosine = normal @ self._normal.astype(normal.dtype).T
        square = (position**2).sum(axis=1)[:, None] + (own_position**2).sum(axis=1)
        square = np.maximum(square - 2 * position @ own_position.T, 0)
        total = np.zeros_like(cosine)
        for term in self._terms:
            c0, c1, c2 = term.bands
            zonal = (c0 - c2 / 2) + cosine * (c1 + 1.5 * c2 * cosine)
            if np.isfinite(term.length):
                zonal *= np.exp(square * (-0.5 / term.length**2))
            total += term.variance * zonal
        return total


def spread_points(position: Float, normal: Float, count: int, /) -> NDArray[np.int64]:
    """Numbers of at most `count` points, each the farthest from those before it."""
    place = np.concatenate([position, NORMAL_WEIGHT * normal], axis=1)
    chosen = [0]
    distance = ((place - place[0]) ** 2).sum(axis=1)
    while len(chosen) < count and distance.max() > 0:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, ((place - place[chosen[-1]]) ** 2).sum(axis=1))
    return np.array(chosen)
