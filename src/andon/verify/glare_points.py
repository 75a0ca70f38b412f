"""A point's veil against the model: profile, roundness, steadiness, energy.

The model is averaged over the pixel that is lit and the one that is read, by three points an axis
of the tent that both make together.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.plan import WholePlan, plan_whole
from andon.glare.whole_picture.reference import veil
from andon.observer.spread.family import spread_function
from andon.spaces import View, perpendicular, pinhole_view

__all__ = ["POINTS", "PointVeil", "Rings", "kernel_of", "plan_of", "point_veil", "rings"]

Float = NDArray[np.float64]
Place = tuple[int, int]

# Pixels from the source within which nothing is claimed.
LEAST_PIXELS = 6.0
# Abscissae (± and 0) and weights with the second and fourth moments of a tent of base ±1 pixel.
TENT_AT, TENT_WEIGHTS = math.sqrt(0.4), (1 / 4.8, 1 - 2 / 4.8, 1 / 4.8)
RING_RATIO, SECTORS, MOST_DEGREES = 1.1, 8, 75.0


def _pinhole(degrees: float) -> View:
    return pinhole_view(320, 240, 160 / math.tan(math.radians(degrees / 2)))


# Views and lit pixels, on and off the axis.
POINTS: dict[str, tuple[View, tuple[Place, ...]]] = {
    "pinhole 20": (_pinhole(20), ((162, 121), (262, 184))),
    "pinhole 60": (_pinhole(60), ((162, 121), (262, 184))),
    "pinhole 120": (_pinhole(120), ((162, 121), (262, 184))),
    "fisheye 180": (
        View("fisheye", 240, 240, 240 / math.pi, 240 / math.pi, 119.5, 119.5),
        ((122, 121), (196, 184)),
    ),
    "latlong": (View("latlong", 384, 192), ((195, 97), (115, 57), (268, 23))),
}


def kernel_of(model: str, /) -> Kernel:
    """The kernel of a model's bloom for the eye of 25 years."""
    return Kernel(spread_function(model, halo=False))


@dataclass(frozen=True, eq=False)
class PointVeil:
    """What one lit pixel makes, per lux.

    Attributes
    ----------
    ratio : (H, W) veil over model.
    theta : (H, W) angle to the source, radians.
    azimuth : (H, W) about the source, radians.
    counts : (H, W) whether it is far enough from the source.
    """

    ratio: Float
    theta: Float
    azimuth: Float
    counts: NDArray[np.bool_]


def point_veil(plan: WholePlan, place: Place, /) -> PointVeil:
    """The veil of the pixel (column, row) of `plan`'s view."""
    view, (column, row) = plan.view, place
    light = np.zeros((*view.shape, 3))
    light[row, column] = 1 / view.solid_angles()[row, column]
    directions, source = view.directions(), view.directions_at(np.array(place))
    theta = _angle(directions, source)
    right, down = perpendicular(source)
    pixels = view.pixel_grid() - place
    if view.projection == "latlong":
        counts = theta * view.height / np.pi >= LEAST_PIXELS
    else:
        counts = np.hypot(pixels[..., 0], pixels[..., 1]) >= LEAST_PIXELS
    model = np.zeros(view.shape)
    offsets = (-TENT_AT, 0.0, TENT_AT)
    for x, across in zip(offsets, TENT_WEIGHTS, strict=True):
        for y, along in zip(offsets, TENT_WEIGHTS, strict=True):
            seen = view.directions_at(view.pixel_grid() + np.array([x, y]))
            model += across * along * plan.kernel.per_sr(_angle(seen, source), core=True)
    counts &= model > 0
    ratio = np.divide(veil(light, plan)[..., 1], model, where=counts, out=np.ones(view.shape))
    return PointVeil(ratio, theta, np.arctan2(directions @ down, directions @ right), counts)


def _angle(directions: Float, source: Float) -> Float:
    chord = np.linalg.norm(directions - source, axis=-1)
    return 2 * np.arcsin(np.minimum(chord / 2, 1))


@dataclass(frozen=True, eq=False)
class Rings:
    """Rings about the source, a tenth wider each: (n,) radius, mean ratio, spread over sectors."""

    degrees: Float
    mean: Float
    unround: Float


def rings(seen: PointVeil, /) -> Rings:
    """The rings from 0.1° to 75° of which there are pixels in half the sectors."""
    found: list[tuple[float, float, float]] = []
    for degrees in 0.1 * RING_RATIO ** np.arange(math.log(MOST_DEGREES / 0.1, RING_RATIO)):
        with np.errstate(divide="ignore"):
            off = np.abs(np.log(seen.theta / math.radians(degrees)))
        ring = seen.counts & (off < math.log(RING_RATIO) / 2)
        sector = ((seen.azimuth[ring] / (2 * np.pi) + 0.5) * SECTORS).astype(int) % SECTORS
        count = np.bincount(sector, minlength=SECTORS)
        if (count >= 2).sum() < SECTORS / 2:
            continue
        sums = np.bincount(sector, seen.ratio[ring], SECTORS)
        means = sums[count >= 2] / count[count >= 2]
        found.append((degrees, float(seen.ratio[ring].mean()), float(means.std())))
    degrees, mean, unround = np.array(found).T
    return Rings(degrees, mean, unround)


def plan_of(name: str, model: str, /) -> WholePlan:
    """The plan of a view of `POINTS`."""
    return plan_whole(POINTS[name][0], kernel_of(model))
