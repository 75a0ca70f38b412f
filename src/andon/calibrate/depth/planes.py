"""What flat pixels say: their plane for any scale and shift, and of ``depth`` its shift as well.

A plane is m·P = 1: its unit normal times the inverse distance of the camera, pointing away from it.
With P = z·ray, 1/z = m·ray.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.depth.least_squares import minimise
from andon.calibrate.depth.model import Plane, RelativeDepth
from andon.errors import InputError

__all__ = ["INDEPENDENT", "FlatPixels", "flat_pixels", "shifts_to_try"]

Float = NDArray[np.float64]

# As how many measurements a group of pixels counts at most: an estimator's errors bend over some
# tenth of the picture, so ten by ten of them are independent.
INDEPENDENT = 100
LEAST_PIXELS, MOST_PIXELS = 12, 4000
# Shifts are looked for from where the farthest pixel is 1e-3 of the relief away from the zero of
# the model, to where it is 1e3 of it: there the relief is lost in any estimator's error.
SHIFTS = np.geomspace(1e-3, 1e3, 97)
ROBUST_STEPS = 10


@dataclass(frozen=True)
class FlatPixels:
    """The flat pixels of one plane, at most `MOST_PIXELS` of them.

    Attributes
    ----------
    values : (n,) r.
    rays : (n, 3) with z = 1.
    affine : (3,) of ``inverse``: r = affine·ray.
    shift : of ``depth``: s = b/a that makes it flat, and its standard error; None where it does not
        matter (``inverse``).
    """

    name: str
    values: Float
    rays: Float
    affine: Float | None = None
    shift: tuple[float, float] | None = None

    def plane(self, log_scale: float, ratio: float, /) -> Float:
        """m (3,) in 1/m at scale exp(log_scale) and shift ratio s = b/a."""
        scale = np.exp(log_scale)
        if self.affine is not None:
            return scale * (self.affine + np.array([0, 0, ratio]))
        return self._moments.plane(ratio) / scale

    @cached_property
    def middle(self) -> float:
        """The median of `values`."""
        return float(np.median(self.values))

    @cached_property
    def _moments(self) -> _Moments:
        return _Moments.of(self.values, self.rays)

    def turned(self) -> FlatPixels:
        """The same pixels with −r."""
        affine = None if self.affine is None else -self.affine
        shift = None if self.shift is None else (-self.shift[0], self.shift[1])
        return replace(self, values=-self.values, affine=affine, shift=shift)

    def departure(self, depth: Float, m: Float, /) -> Float:
        """(n,) relative distance along the ray of `depth` (n,) in metres from the plane m."""
        return depth * (self.rays @ m) - 1


def shifts_to_try(values: Float, /) -> Float:
    """Shift ratios s at which all but the farthest 1 % of `values` (n,) are before the camera."""
    low, high = np.percentile(values, [1, 99])
    relief = max(high - low, 1e-9 * max(abs(low), abs(high)))
    return np.sort(np.concatenate([SHIFTS * relief - low, [0.0] if low > 0 else []]))


def flat_pixels(relative: RelativeDepth, plane: Plane, /) -> FlatPixels:
    """A plane's pixels, summarised. Raises `InputError` where they are too few or on one line."""
    chosen = plane.mask & np.isfinite(relative.values)
    count = int(chosen.sum())
    if count < LEAST_PIXELS:
        raise InputError(
            f"selects {count} pixels with a depth, at least {LEAST_PIXELS} are needed",
            field=plane.name,
        )
    values, rays = relative.values[chosen], relative.rays[chosen]
    if count > MOST_PIXELS:  # evenly, so that the same picture gives the same fit
        kept = np.linspace(0, count - 1, MOST_PIXELS).astype(np.intp)
        values, rays = values[kept], rays[kept]
    if np.linalg.svd(rays - rays.mean(axis=0), compute_uv=False)[1] < 1e-9 * len(rays):
        raise InputError("selects pixels on one line, which spans no plane", field=plane.name)
    flat = FlatPixels(plane.name, values, rays)
    if relative.kind == "inverse":
        return replace(flat, affine=_affine(values, rays))
    return replace(flat, shift=_flattening_shift(values, rays))


def _affine(values: Float, rays: Float) -> Float:
    """(3,) of values = affine·rays, by Cauchy's weights: what stands before a wall tilts it not."""
    weight = np.ones(len(values))
    found = np.zeros(3)
    for _ in range(ROBUST_STEPS):
        root = np.sqrt(weight)
        solved = np.linalg.lstsq(root[:, None] * rays, root * values, rcond=None)[0]
        found = np.asarray(solved, np.float64)
        error = values - rays @ found
        weight = _cauchy(error, np.abs(values).max())
    return found


def _cauchy(error: Float, size: float) -> Float:
    """Weights 1/(1 + (e/2.385σ)²), σ by the median (Holland & Welsch 1977); floor at rounding."""
    sigma = max(1.4826 * float(np.median(np.abs(error))), 1e-12 * size)
    return 1 / (1 + (error / (2.385 * sigma)) ** 2)


@dataclass(frozen=True)
class _Moments:
    """Sums over pixels with which the plane of z = a·(r + s) is a 3×3 system for every s."""

    constant: Float
    linear: Float
    square: Float
    ray: Float
    value_ray: Float

    @classmethod
    def of(cls, values: Float, rays: Float) -> _Moments:
        weighted = values[:, None] * rays
        return cls(
            weighted.T @ weighted,
            2 * weighted.T @ rays,
            rays.T @ rays,
            rays.sum(axis=0),
            weighted.sum(axis=0),
        )

    def plane(self, ratio: float) -> Float:
        """(3,) m·a: least squares of (r + s)·(m·ray) = 1."""
        normal = self.constant + ratio * (self.linear + ratio * self.square)
        try:
            solved = np.linalg.solve(normal, self.value_ray + ratio * self.ray)
        except np.linalg.LinAlgError:  # r + s is 0 wherever it counts: no plane at all
            return np.full(3, np.nan)
        return np.asarray(solved, np.float64)


def _flattening_shift(values: Float, rays: Float) -> tuple[float, float]:
    """(s, its standard error) that makes z = r + s a plane; the error is infinite if none does.

    Errors are those of r: r + s − 1/(m·ray). Relative errors of z would vanish at s → ∞.
    """

    def errors(unknowns: Float) -> Float:
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = rays @ unknowns[1:]
            return np.where(inverse > 0, values + unknowns[0] - 1 / inverse, np.nan)

    moments = _Moments.of(values, rays)
    starts = [np.array([s, *moments.plane(s)]) for s in shifts_to_try(values)]
    sizes = [float(np.median(np.abs(errors(start)))) for start in starts]
    if not np.isfinite(sizes).any():
        return 0.0, float("inf")
    best = starts[int(np.nanargmin(sizes))]
    sigma = max(1.4826 * min(s for s in sizes if np.isfinite(s)), 1e-12 * np.abs(values).max())
    found = minimise(lambda unknowns: errors(unknowns) / sigma, best)
    sigma *= 1.4826 * float(np.median(np.abs(found.residuals)))
    sigma = max(sigma, 1e-12 * np.abs(values).max())
    found = minimise(lambda unknowns: errors(unknowns) / sigma, found.values)
    scaled = found.jacobian / np.linalg.norm(found.jacobian, axis=0)
    information = scaled.T @ scaled * min(1.0, INDEPENDENT / len(values))
    if np.linalg.cond(information) > 1e13:
        return float(found.values[0]), float("inf")
    variance = float(np.diag(np.asarray(np.linalg.inv(information), np.float64))[0])
    error = float(np.sqrt(variance) / np.linalg.norm(found.jacobian[:, 0]))
    return float(found.values[0]), error
