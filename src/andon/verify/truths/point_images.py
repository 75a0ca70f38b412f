"""The image of a point, seen through glass by a thin lens: where on the film it falls.

A path tracer would wait for paths that happen to meet the point. Here, for each place of the
pupil, the film is searched for the ray that meets it (Newton's method on where rays land), so that
the image's second moment is an integral over the pupil and not a histogram. Any function that says
where rays land can be asked: Mitsuba's own thin lens and interfaces, or ours.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["PointImage", "film_place", "image_of_point", "pupil_points"]

Float = NDArray[np.float64]
# Places on the film (n, 2) in pixels and of the pupil (n, 2) in [−1, 1] → on the backdrop (n, 2)
# in metres, and the share of light that comes through (n,).
Lands = Callable[[Float, Float], tuple[Float, Float]]

# Of a derivative on the film: small beside what curves an image, large beside float32's noise.
STEP_PX = 0.25
# Newton's method ends below this, or after so many steps.
CLOSE_PX = 0.01
STEPS = 12


@dataclass(frozen=True)
class PointImage:
    """The image of one point.

    Attributes
    ----------
    middle_px : (2,) its centroid on the film.
    covariance_px2 : (2, 2), its second moment about the centroid.
    found : share of the pupil's places whose ray was found.
    """

    middle_px: Float
    covariance_px2: Float
    found: float

    @property
    def disc_px(self) -> float:
        """Diameter of the uniform disc of the same second moment: D²/8 is its trace."""
        return float(np.sqrt(8 * np.trace(self.covariance_px2)))


def pupil_points(count: int) -> Float:
    """(n, 2) places that cover the unit disc evenly: a spiral by the golden angle."""
    index = np.arange(count) + 0.5
    radius, turn = np.sqrt(index / count), index * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)


def image_of_point(lands: Lands, target: Float, near_px: Float, /, *, places: int) -> PointImage:
    """The image of the backdrop's point `target` (2,) around `near_px` (2,) on the film.

    A small spot there has the luminance of the spot times what the interfaces let through, on as
    much film as it covers: that weighs each place of the pupil.
    """
    pupil = pupil_points(places)
    found, jacobians, share = film_place(lands, target, np.tile(near_px, (places, 1)), pupil)
    good = np.isfinite(found[:, 0]) & np.isfinite(found[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = np.where(good, share / np.abs(np.linalg.det(jacobians)), 0.0)
    weight = np.where(np.isfinite(weight), weight, 0.0)
    weight /= weight.sum()
    found = np.where(good[:, None], found, 0.0)
    middle = weight @ found
    off = found - middle
    covariance = (weight[:, None, None] * off[:, :, None] * off[:, None, :]).sum(axis=0)
    return PointImage(middle, covariance, float(good.mean()))


def film_place(
    lands: Lands, target: Float, start_px: Float, pupil: Float, /
) -> tuple[Float, Float, Float]:
    """Where on the film (n, 2) rays through `pupil` (n, 2) meet `target`: (2,) or (n, 2).

    Returns the places (NaN where none was found), the derivatives (n, 2, 2) of where rays land by
    the place on the film, and the share of light (n,).
    """
    place = np.array(start_px, np.float64)
    jacobian, share = np.full((len(place), 2, 2), np.nan), np.full(len(place), np.nan)
    left = np.full(len(place), np.inf)
    for _ in range(STEPS):
        open_ = np.nonzero(left > CLOSE_PX)[0]
        if not len(open_):
            break
        here, share[open_] = lands(place[open_], pupil[open_])
        sides = [
            (
                lands(place[open_] + step, pupil[open_])[0]
                - lands(place[open_] - step, pupil[open_])[0]
            )
            / (2 * STEP_PX)
            for step in STEP_PX * np.eye(2)
        ]
        jacobian[open_] = np.stack(sides, axis=-1)
        wanted = np.broadcast_to(target, place.shape)[open_] - here
        move = _solved(jacobian[open_], wanted)
        place[open_] += move
        left[open_] = np.linalg.norm(move, axis=1)
        left[~np.isfinite(left)] = 0.0  # nothing to go on from; the place is NaN
    place[left > CLOSE_PX] = np.nan
    return place, jacobian, share


def _solved(matrix: Float, right: Float) -> Float:
    """x (n, 2) of `matrix` (n, 2, 2) x = `right` (n, 2); NaN where it is singular."""
    (a, b), (c, d) = np.moveaxis(matrix, 0, -1)
    u, v = right.T
    with np.errstate(divide="ignore", invalid="ignore"):
        solved = np.stack([d * u - b * v, a * v - c * u], axis=1) / (a * d - b * c)[:, None]
    return np.where(np.isfinite(solved), solved, np.nan)
