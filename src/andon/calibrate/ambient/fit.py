"""The field that explains the differences of light within materials: robust least squares."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.ambient.field import CHROMA, LUMINANCE, Field, spread_points
from andon.calibrate.ambient.model import AmbientSettings
from andon.calibrate.ambient.observed import Observed
from andon.calibrate.ambient.pairs import Pairs

__all__ = ["Fitted", "fit"]

Float = NDArray[np.float64]

# Log light and two log ratios of channels, red and blue to green, from logs of three channels.
_PARTS = np.array([[1 / 3, 1 / 3, 1 / 3], [1, -1, 0], [0, -1, 1]])
_CHANNELS = np.linalg.inv(_PARTS)


@dataclass(frozen=True, eq=False)
class Fitted:
    """Both fields with their weights: `light` (m,), `chroma` (m, 2); and how sure light is.

    `covariance` (m, m) is that of the weights of light; `cost` is minus the log posterior, but for
    a constant.
    """

    light_field: Field
    chroma_field: Field
    light: Float
    chroma: Float
    covariance: Float
    cost: float

    def log_illuminance(self, position: Float, normal: Float, /) -> Float:
        """(n, 3) log E0 but for a constant."""
        light = self.light_field.values(self.light, position, normal)
        chroma = self.chroma_field.values(self.chroma, position, normal)
        return np.column_stack([light, chroma]) @ _CHANNELS.T

    def log_error(self, position: Float, normal: Float, /) -> Float:
        """(n,) standard deviation of log light at n points, beside the best known part of them.

        Only differences are seen, so it is that from a mean; of the mean over all points those
        that hang together with none would make all uncertain.
        """
        features = self.light_field.features(position, normal)
        sigma = np.ones(len(features))
        for _ in range(ROUNDS_OF_MEAN):
            middle = np.average(features, axis=0, weights=sigma**-2)
            off = features - middle
            sigma = np.sqrt(((off @ self.covariance) * off).sum(axis=1))
        return sigma


class _Problem:
    """Features of both fields at both ends of all pairs, made once."""

    def __init__(self, observed: Observed, pairs: Pairs, settings: AmbientSettings) -> None:
        place = observed.position, observed.normal
        chosen = spread_points(*place, settings.inducing)
        inducing = observed.position[chosen], observed.normal[chosen]
        self.light, self.chroma = (Field(terms, *inducing) for terms in (LUMINANCE, CHROMA))
        self.pairs, self.settings = pairs, settings
        # In float32, which halves the time; noise is five decades above what that rounds.
        self.of_light, self.of_chroma = (
            (features[pairs.a] - features[pairs.b]).astype(np.float32)
            for features in (field.features(*place) for field in (self.light, self.chroma))
        )
        # 1/σ² of a pair; there are more pairs than independent facts.
        self.precision = settings.independent / len(pairs.a) / settings.noise**2

    def solved(self, seen: Float) -> Fitted:
        """The fields for what is `seen`, (pairs, 3) differences of log light of the channels."""
        wanted, settings = seen @ _PARTS.T, self.settings
        count = self.of_light.shape[1]
        light, chroma = np.zeros(count), np.zeros((count, 2))
        covariance, explained = np.eye(count), np.zeros(len(wanted))
        for width in np.geomspace(settings.widest, settings.narrowest, settings.rounds):
            left = wanted[:, 0] - self.of_light @ light.astype(np.float32)
            gate = self._one_material(wanted[:, 1:] - self.of_chroma @ chroma.astype(np.float32))
            # Geman & McClure's loss as weights of least squares.
            weight = gate / (1 + (left / width) ** 2) ** 2
            light, covariance = self._step(self.of_light, weight, wanted[:, 0], 1.0)
            near = weight * self.pairs.near
            amplitude = settings.chroma_amplitude
            chroma, _ = self._step(self.of_chroma, near, wanted[:, 1:], amplitude)
            explained = gate * left**2 / (1 + (left / width) ** 2)
        cost = self.precision * explained.sum() / 2 + (light**2).sum() / 2
        cost += (chroma**2).sum() / 2 / settings.chroma_amplitude**2
        return Fitted(self.light, self.chroma, light, chroma, covariance, float(cost))

    def _one_material(self, ratios: Float) -> Float:
        """(pairs,) 0…1, how much two pixels look like one material under this light."""
        return np.exp(-0.5 * (ratios**2).sum(axis=1) / self.settings.same_chromaticity**2)

    def _step(
        self, features: NDArray[np.float32], weight: Float, wanted: Float, amplitude: float
    ) -> tuple[Float, Float]:
        """Weights of the field, and their covariance (Rasmussen & Williams 2006, eq. 2.8)."""
        root = np.sqrt(self.precision * weight).astype(np.float32)
        weighted = features * root[:, None]
        information = (weighted.T @ weighted).astype(np.float64)
        information += np.eye(len(information)) / amplitude**2
        covariance: Float = np.asarray(np.linalg.inv(information), np.float64)
        rows = wanted.astype(np.float32).reshape(len(wanted), -1) * root[:, None]
        found = covariance @ (weighted.T @ rows).astype(np.float64)
        return found.reshape(-1, *wanted.shape[1:]), covariance


# Of the mean that errors are counted from: the first is the plain one.
ROUNDS_OF_MEAN = 4

# Of the mean light of a source to that of the rest: shares of 0, 9 … 94 % of all light. They are
# tried with every fourth pair and in fewer rounds.
SHARES = (0.0, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 16.0)
SEARCHED, SEARCH_ROUNDS = 4, 5


def fit(
    observed: Observed, pairs: Pairs, settings: AmbientSettings, /
) -> tuple[Fitted, tuple[float, ...]]:
    """The fields, and for each known source how strong it is beside all else (one by one).

    E0 = exp(field) · (1 + Σ strength · pattern), a pattern being the source's light over its mean.
    """
    strengths = _strengths(observed, pairs.some(SEARCHED), settings)
    return _solved(_Problem(observed, pairs, settings), observed, strengths), strengths


def _strengths(observed: Observed, pairs: Pairs, settings: AmbientSettings) -> tuple[float, ...]:
    strengths = [0.0] * len(observed.sources)
    if not strengths:
        return ()
    problem = _Problem(observed, pairs, replace(settings, rounds=SEARCH_ROUNDS))
    for index in range(len(strengths)):
        tried = [[*strengths[:index], share, *strengths[index + 1 :]] for share in SHARES]
        costs = [_solved(problem, observed, tuple(each)).cost for each in tried]
        strengths = tried[int(np.argmin(costs))]
    return tuple(strengths)


def _solved(problem: _Problem, observed: Observed, strengths: tuple[float, ...]) -> Fitted:
    light = observed.log_light - np.log(lit_by(strengths, observed.sources))
    return problem.solved(light[problem.pairs.a] - light[problem.pairs.b])


def lit_by(strengths: tuple[float, ...], sources: tuple[Float, ...], /) -> Float:
    """(n, 3) or (1,) factor 1 + Σ strength · pattern of sources (n, 3) in lux."""
    total: Float = np.ones(1)
    for strength, source in zip(strengths, sources, strict=True):
        if strength > 0:
            total = total + strength * source / mean_of(source)
    return total


def mean_of(source: Float, /) -> float:
    """What a pattern is measured by: the mean of all channels, lux."""
    return max(float(source.mean()), np.finfo(float).tiny)
