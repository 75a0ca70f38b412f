"""Metric depth of many pixels (LiDAR, points of COLMAP) as one line r = α·x − s.

x is 1/z (``inverse``) or z (``depth``), α = 1/a, s = b/a. Errors are taken to be those of r, which
an estimator guessed, against x, which somebody measured: the other regression would be flattened by
the larger error. The start is the line through two pixels with which most others agree in depth
(Torr & Zisserman 2000, MSAC). The least median of squares is no start: half of a picture may be one
wall, and any line through it is as near to that half. Then come Cauchy's weights.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.depth.model import RelativeDepth
from andon.calibrate.depth.planes import INDEPENDENT
from andon.errors import InputError

__all__ = ["KnownLine", "known_line"]

Float = NDArray[np.float64]

LEAST_PIXELS = 3
PAIRS, MOST_PIXELS, SEED = 600, 4000, 0
CAUCHY, OUTLIER = 2.385, 3.5
# Depths of a start agree within this, relative: what estimators err by where they do well.
AGREEING = 0.1
ROBUST_STEPS = 20


@dataclass(frozen=True)
class KnownLine:
    """The line and how well it is known.

    Attributes
    ----------
    alpha, ratio : of r = α·x − s; α ≤ 0 says that r runs the other way.
    whiten : (2, 2); whiten @ (α − alpha, s − ratio) are two residuals of standard deviation 1.
    metres : (n,) known depths.
    chosen : (H, W) where they are.
    outlier_share : beyond 3.5 standard deviations of the line.
    """

    alpha: float
    ratio: float
    whiten: Float
    metres: Float
    chosen: NDArray[np.bool_]
    outlier_share: float

    def turned(self) -> KnownLine:
        """The line of −r."""
        return replace(self, alpha=-self.alpha, ratio=-self.ratio)


def known_line(relative: RelativeDepth, known_m: Float, /) -> KnownLine:
    """The robust line through all pixels that have both a number and a known depth."""
    with np.errstate(invalid="ignore"):
        chosen = np.isfinite(relative.values) & np.isfinite(known_m) & (known_m > 0)
    count = int(chosen.sum())
    if count < LEAST_PIXELS:
        raise InputError(
            f"has {count} depths where the relative depth has numbers, at least {LEAST_PIXELS} are "
            "needed",
            field="--known",
        )
    r, metres = relative.values[chosen], known_m[chosen]
    x = 1 / metres if relative.kind == "inverse" else metres
    if np.ptp(x) < 1e-6 * x.max() or np.ptp(r) == 0:
        raise InputError("has one depth only, which tells no scale from a shift", field="--known")
    alpha, ratio = _consensus(x, r)
    weight = np.ones(count)
    sigma = 1.0
    for _ in range(ROBUST_STEPS):
        error = r - (alpha * x - ratio)
        sigma = max(1.4826 * float(np.median(np.abs(error))), 1e-12 * np.abs(r).max())
        weight = 1 / (1 + (error / (CAUCHY * sigma)) ** 2)
        root = np.sqrt(weight)
        design = np.stack([x, -np.ones(count)], axis=1)
        alpha, ratio = np.linalg.lstsq(root[:, None] * design, root * r, rcond=None)[0]
    design = np.sqrt(weight)[:, None] * np.stack([x, -np.ones(count)], axis=1) / sigma
    information = design.T @ design * min(1.0, INDEPENDENT / count)
    outliers = float((np.abs(r - (alpha * x - ratio)) > OUTLIER * sigma).mean())
    whiten = np.asarray(np.linalg.cholesky(information).T, np.float64)
    return KnownLine(float(alpha), float(ratio), whiten, metres, chosen, outliers)


def _consensus(x: Float, r: Float) -> tuple[float, float]:
    """(α, s) of the line through two pixels with whose depth most of all pixels agree."""
    generator = np.random.default_rng(SEED)
    if len(x) > MOST_PIXELS:
        kept = generator.choice(len(x), MOST_PIXELS, replace=False)
        x, r = x[kept], r[kept]
    pairs = generator.integers(0, len(x), (PAIRS, 2))
    run, rise = (np.diff(values[pairs], axis=1)[:, 0] for values in (x, r))
    sound = (run != 0) & (rise != 0)
    if not sound.any():
        raise InputError("has no two depths that differ where r does", field="--known")
    alphas = rise[sound] / run[sound]
    ratios = alphas * x[pairs[sound, 0]] - r[pairs[sound, 0]]
    costs: list[float] = []
    for alpha, ratio in zip(alphas, ratios, strict=True):
        agreement = (r + ratio) / (alpha * x)  # 1 where the depth is the known one, or its inverse
        off = np.minimum(np.abs(np.log(np.maximum(agreement, 1e-9))) / AGREEING, 1)
        costs.append(float(off @ off))
    best = int(np.argmin(costs))
    return float(alphas[best]), float(ratios[best])
