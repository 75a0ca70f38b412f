"""From photographs in known light to the curve of one surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.surface.channel import ChannelFit, fit_channel
from andon.calibrate.surface.model import KnownLight, Samples, SurfaceFit
from andon.calibrate.surface.monotone import LEAST_STEP, smooth_between, strictly_rising
from andon.errors import InputError
from andon.responses import SurfaceCurve

__all__ = ["fit_surface"]

Float = NDArray[np.float64]

CHANNELS = "red", "green", "blue"
# Pixels that are fitted, drawn evenly over the surface.
PIXELS = 6000
# Illuminances closer together are one level.
SAME_LEVEL = 1.01
# A surface lit between two illuminances closer than this says nothing of a curve.
LEAST_RANGE = 1.2
# Knots of a curve over illuminances that vary, denser in the dark, and values that each needs.
KNOTS, LEAST_VALUES = 12, 30
# Rows of the curve from knot to knot; straight lines between them stand for a smooth curve.
ROWS_BETWEEN = 4
# Of the largest illuminance: below, stray light decides the exponent.
EXPONENT_FROM = 0.05
# A fall of so many standard errors and of this share of the range is none of noise.
FALL_ERRORS, LEAST_FALL = 4.0, 0.02


def fit_surface(
    photographs: Sequence[KnownLight], mask: NDArray[np.bool_] | None = None, /, *, name: str = "*"
) -> SurfaceFit:
    """The illuminance–RGB curve of the surface that `mask` (H, W) selects; default: everywhere.

    Robust: highlights, moving shadows and clipped values get no weight. Where no photograph is
    dark, f(0) = 0 is added: no light, no signal.

    Raises
    ------
    InputError
        if photographs differ in size, the mask selects nothing, all its pixels are clipped, all
        have one illuminance, or more light makes a surface darker beyond noise.
    """
    samples = _samples(photographs, mask, name)
    knots = _knots(samples, name)
    fits = [
        fit_channel(samples.linear[..., c], samples.lux[..., c], samples.known[..., c], knots)
        for c in range(3)
    ]
    fall = max(_fall(fit, knots, CHANNELS[c], name) for c, fit in enumerate(fits))
    rising = np.stack([strictly_rising(knots, fit.values, fit.weights) for fit in fits], axis=-1)
    curve, is_assumed = _from_zero(knots, rising)
    relative = np.stack([fit.relative for fit in fits], axis=-1)
    outliers = np.stack([fit.outliers for fit in fits], axis=-1)
    kept = np.where(outliers, np.nan, relative)
    return SurfaceFit(
        name,
        curve,
        tuple(photograph.name for photograph in photographs),
        samples,
        np.stack([fit.texture for fit in fits], axis=-1),
        relative,
        np.array([fit.rms for fit in fits]),
        np.array([_rms(kept[:, k]) for k in range(len(photographs))]),
        float(outliers[samples.known].mean()),
        float(1 - samples.known.mean()),
        fall,
        is_assumed,
        *_shape(knots, rising),
    )


def _rms(values: Float) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")


def _samples(
    photographs: Sequence[KnownLight], mask: NDArray[np.bool_] | None, name: str
) -> Samples:
    """The surface's pixels. Raises `InputError`."""
    if not photographs:
        raise InputError("are missing", field="PHOTO=LUX")
    shape = photographs[0].linear.shape[:2]
    for photograph in photographs:
        _check_size(photograph.linear.shape[:2], shape, photograph.name, photographs[0].name)
    if mask is not None and mask.shape != shape:
        _check_size(mask.shape, shape, f"mask of {name!r}", photographs[0].name)
    inside = np.flatnonzero(np.ones(shape, bool) if mask is None else mask)
    if not len(inside):
        raise InputError(
            f"selects no pixel of {name!r}", field="--mask", remedy="white is the surface"
        )
    inside = inside[np.linspace(0, len(inside) - 1, min(PIXELS, len(inside))).astype(int)]

    def of_all(*planes: NDArray[np.generic]) -> Float:
        wide = (np.broadcast_to(plane, (*shape, 3)).reshape(-1, 3)[inside] for plane in planes)
        return np.stack([np.asarray(part, float) for part in wide], axis=1)

    linear = of_all(*(photograph.linear for photograph in photographs))
    lux = of_all(*(photograph.illuminance_lux for photograph in photographs))
    clipped = of_all(*(photograph.clipped for photograph in photographs)) > 0
    known = ~clipped & np.isfinite(lux) & np.isfinite(linear)
    _check_known(known, clipped, name)
    return Samples(linear, lux, known)


def _check_size(came: tuple[int, ...], wanted: tuple[int, ...], file: str, first: str) -> None:
    if came != wanted:
        raise InputError(
            f"is {came[1]}×{came[0]} px but {first} is {wanted[1]}×{wanted[0]}",
            file=file,
            remedy="photographs, maps and masks are of one view",
        )


def _check_known(known: NDArray[np.bool_], clipped: NDArray[np.bool_], name: str) -> None:
    """Some pixels must say something in every channel, in two photographs if there are two."""
    least = min(2, known.shape[1])
    for c, channel in enumerate(CHANNELS):
        if not (known[..., c].sum(axis=1) >= least).any():
            raise InputError(
                f"{clipped[..., c].mean():.0%} of the {channel} values of {name!r} are clipped; no "
                f"pixel is left that {least} photograph{'s' if least > 1 else ''} show",
                field="PHOTO=LUX",
                remedy="shorter exposures, all with the same one",
            )


def _knots(samples: Samples, name: str) -> Float:
    """Rising illuminances (n,) in lx: the levels there are, or steps of √E.

    Raises `InputError`.
    """
    lux = np.sort(samples.lux[samples.known])
    low, high = float(lux[0]), float(lux[-1])
    if high <= low * LEAST_RANGE or high <= 0:
        raise InputError(
            f"all of {name!r} has about one illuminance, {low:.4g} to {high:.4g} lx: a curve needs "
            "two at least",
            field="PHOTO=LUX",
            remedy="photographs in weaker and stronger light",
        )
    starts = np.concatenate([[0], np.flatnonzero(np.diff(lux) > (SAME_LEVEL - 1) * lux[:-1]) + 1])
    if len(starts) <= KNOTS and _are_levels(lux, starts):
        return np.array([float(part.mean()) for part in np.split(lux, starts[1:])])
    wanted = np.linspace(low**0.5, high**0.5, KNOTS, dtype=np.float64) ** 2
    inside = [
        e
        for e in wanted[1:-1]
        if LEAST_VALUES <= np.searchsorted(lux, e) <= len(lux) - LEAST_VALUES
    ]
    return _with_values(lux, np.array([low, *inside, high]))


def _are_levels(lux: Float, starts: NDArray[np.intp]) -> bool:
    """Each part is one level, and no stretch of many."""
    ends = np.append(starts[1:], len(lux)) - 1
    return bool((lux[ends] <= lux[starts] * SAME_LEVEL).all())


def _with_values(lux: Float, knots: Float) -> Float:
    """The knots that have enough values since the last one that was kept."""
    kept = [float(knots[0])]
    for knot in knots[1:-1]:
        if np.searchsorted(lux, knot) - np.searchsorted(lux, kept[-1]) >= LEAST_VALUES:
            kept.append(float(knot))
    return np.array([*kept, float(knots[-1])])


def _fall(fit: ChannelFit, knots: Float, channel: str, name: str) -> float:
    """Deepest fall as a share of the range. Raises `InputError` where it is none of noise."""
    depth = np.maximum.accumulate(fit.values) - fit.values
    low = int(np.argmax(depth))
    top = int(np.argmax(fit.values[: low + 1]))
    noise = float(np.hypot(fit.errors[low], fit.errors[top]))
    share = float(depth[low] / np.abs(fit.values).max())
    if share > LEAST_FALL and depth[low] > FALL_ERRORS * noise:
        raise InputError(
            f"the {channel} of {name!r} is darker in more light: {fit.values[low]:.4g} in "
            f"{knots[low]:.4g} lx against {fit.values[top]:.4g} in {knots[top]:.4g} lx "
            f"(noise {noise:.2g})",
            field="PHOTO=LUX",
            remedy="check the illuminances, and that all photographs have one exposure",
        )
    return share


def _from_zero(knots: Float, rising: Float) -> tuple[SurfaceCurve, bool]:
    """The curve from 0 lx on, and whether its beginning is assumed."""
    is_assumed = bool(knots[0] > 0)
    if is_assumed:
        rising = np.maximum(rising, LEAST_STEP * rising[-1] * np.arange(1, len(knots) + 1)[:, None])
        knots, rising = np.append(0.0, knots), np.vstack([np.zeros(3), rising])
    else:
        # Less than nothing is noise of the darkest pixels.
        rising = np.maximum(rising, LEAST_STEP * rising[-1] * np.arange(len(knots))[:, None])
    parts = [smooth_between(knots, rising[:, c], ROWS_BETWEEN) for c in range(3)]
    return SurfaceCurve(parts[0][0], np.stack([values for _, values in parts], axis=-1)), is_assumed


def _shape(knots: Float, rising: Float) -> tuple[Float, Float]:
    """Exponent (3,) and distance from a straight line (3,), see `SurfaceFit`."""
    lit = (knots >= EXPONENT_FROM * knots[-1])[:, None] & (rising > 0)
    exponents: list[float] = []
    for c in range(3):
        x: Float = np.log(knots[lit[:, c]])
        y: Float = np.log(rising[lit[:, c], c])
        exponents.append(float(np.polyfit(x, y, 1)[0]) if len(x) > 1 else float("nan"))
    gain = (knots @ rising) / (knots @ knots)
    distance = np.abs(rising - knots[:, None] * gain).max(axis=0) / rising.max(axis=0)
    return np.array(exponents), distance
