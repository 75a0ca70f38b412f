"""Rows of what an eye makes of refracted light: how much it blurs, and what the other eye sees.

The truth is a thin lens of Mitsuba whose rays its dielectric refracts: the image of a point of the
backdrop is an integral over the pupil (`truths.point_images`). Ours is the vergence that a pencil
of rays has along the one ray through the pupil's middle.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Solid
from andon.glass.pencils import blur_radians
from andon.pipeline import EngineName
from andon.spaces import View
from andon.verify.glass_rays import seen_through
from andon.verify.glass_setting import (
    BACKDROP,
    EYE_M,
    FOCAL_PX,
    PUPIL_M,
    PX_M,
    body,
    eye_views,
    rays_of,
    view_along,
)
from andon.verify.registry import Row
from andon.verify.truths.mitsuba_glass import GlassScene, lens_landing
from andon.verify.truths.point_images import PointImage, film_place, image_of_point

__all__ = [
    "ROWS",
    "blur_error",
    "disparity_error_px",
    "own_image",
    "point_image",
    "predicted_moment_px2",
]

Float = NDArray[np.float64]
Lands = Callable[[Float, Float], tuple[Float, Float]]

ENGINES: tuple[EngineName, ...] = ("reference", "gpu")
# Gaze depths, metres from the eye: near, the ball's front, the paper's background, far.
FOCI_M = (0.25, 0.325, 0.6, 2.0)
# Where on the ball: how far off its middle, as a share of what is seen of its radius, and which way
# round. The eye looks there.
POINTS = ((0.0, 0.0), (0.25, 0.4), (0.4, 2.1), (0.55, 3.9), (0.7, 5.5), (0.9, 1.0))
# The ball's rim is seen this far off its middle.
RIM_RADIANS = float(np.arcsin(0.075 / 0.4))
PLACES = 200
MIDDLE = np.array([[639.5, 359.5]])
# The backdrop's own right and up, unit.
AXES = np.stack([v / np.linalg.norm(v) for v in (BACKDROP.right_m, BACKDROP.up_m)])
# Pixels between the rays whose disparity is compared.
STEP = 32


def direction_of(point: tuple[float, float], /) -> Float:
    """(3,) unit, from the eye to a point of `POINTS`."""
    off, turn = point[0] * RIM_RADIANS, point[1]
    sine = np.sin(off)
    return np.array([sine * np.cos(turn), sine * np.sin(turn), -np.cos(off)])


def _own_lens(engine: EngineName, solids: Sequence[Solid], view: View, focus_m: float) -> Lands:
    """`lens_landing` by our rays: a thin lens of the pupil, sharp at `focus_m` along the axis."""
    right, down, forward = view.world_from_camera[:3, :3].T

    def lands(film_px: Float, pupil: Float) -> tuple[Float, Float]:
        x, y = ((film_px - (view.cx, view.cy)) / (view.fx, view.fy)).T[..., None]
        # Mitsuba's lens has x to the left and y up.
        start = -PUPIL_M / 2 * (pupil[:, :1] * right + pupil[:, 1:] * down)
        way = focus_m * (x * right + y * down + forward) - start
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        found = seen_through(engine, solids, view.position + start, way)
        return (found.points - BACKDROP.centre_m) @ AXES.T, np.ones(len(way))

    return lands


@cache
def _truth_scene(interfaces: int) -> GlassScene:
    return GlassScene(body("ball", interfaces))


@cache
def point_image(point: tuple[float, float], focus_m: float, places: int = PLACES) -> PointImage:
    """By Mitsuba: what is in the middle of the eye's picture, through the ball."""
    view = view_along(direction_of(point))
    lands = lens_landing(_truth_scene(2), view, PUPIL_M, focus_m)
    return _image(lands, places)


@cache
def own_image(point: tuple[float, float], focus_m: float, places: int = PLACES) -> PointImage:
    """`point_image` by the reference's rays, pupil place by pupil place."""
    view = view_along(direction_of(point))
    return _image(_own_lens("reference", body("ball"), view, focus_m), places)


def _image(lands: Lands, places: int) -> PointImage:
    target = lands(MIDDLE, np.zeros((1, 2)))[0][0]
    return image_of_point(lands, target, MIDDLE[0], places=places)


def predicted_moment_px2(engine: EngineName, point: tuple[float, float], focus_m: float) -> float:
    """Trace of the second moment of the blur disc that the ray's pencil predicts, D²/8."""
    way = direction_of(point)[None]
    found = seen_through(engine, body("ball"), EYE_M, way)
    diameter = blur_radians(found.vergence, 1 / focus_m, PUPIL_M) * FOCAL_PX
    return float(diameter[0] ** 2 / 8)


def blur_error(engine: EngineName, places: int = PLACES) -> float:
    """Largest relative error of the second moment, all points and gaze depths."""
    errors = [
        predicted_moment_px2(engine, point, focus)
        / float(np.trace(point_image(point, focus, places).covariance_px2))
        - 1
        for point in POINTS
        for focus in FOCI_M
    ]
    return float(np.abs(errors).max())


def oracle_error(places: int = PLACES) -> float:
    """Largest relative difference of the second moments by our rays and by Mitsuba's."""
    errors = [
        np.trace(own_image(point, focus, places).covariance_px2)
        / np.trace(point_image(point, focus, places).covariance_px2)
        - 1
        for point in POINTS
        for focus in FOCI_M
    ]
    return float(np.abs(errors).max())


@cache
def disparities_px(engine: EngineName | None, step: int = STEP) -> Float:
    """(n, 2) by how much a point of the backdrop moves from the left eye's picture to the right's.

    `engine` None: Mitsuba. The points are those that rays of the left picture find through the
    ball; NaN where the right eye does not see the same point through it.
    """
    left, right = eye_views()
    origins, directions = rays_of(left, step)
    landing = _truth_scene(2).land(origins, directions)
    kept = landing.glass & np.isfinite(landing.points[:, 0])
    targets = (landing.points[kept] - BACKDROP.centre_m) @ AXES.T
    grid = left.pixel_grid()[step // 2 :: step, step // 2 :: step].reshape(-1, 2)[kept]
    # Where the ball itself goes: its middle moves by f·b/d.
    ball = np.array([-FOCAL_PX * np.linalg.norm(right.position - left.position) / EYE_M[2], 0])
    starts = (grid, grid + ball)
    places: list[Float] = []
    for view, start in zip((left, right), starts, strict=True):
        lands = _pinhole(engine, view)
        places.append(film_place(lands, targets, start, np.zeros_like(start))[0])
    return places[1] - places[0]


def _pinhole(engine: EngineName | None, view: View) -> Lands:
    if engine is None:
        # A lens without width is a pinhole; Mitsuba wants some.
        return lens_landing(_truth_scene(2), view, 1e-9, 1.0)
    lens = _own_lens(engine, body("ball"), view, 1.0)
    return lambda film, pupil: lens(film, 0 * pupil)


def disparity_error_px(engine: EngineName, step: int = STEP) -> float:
    """Largest difference of `disparities_px` from Mitsuba's."""
    off = np.linalg.norm(disparities_px(engine, step) - disparities_px(None, step), axis=1)
    return float(np.nanmax(off))


@cache
def one_interface() -> tuple[float, float]:
    """What the exit changes: median shift on the backdrop in pixels, and dioptres on the axis."""
    origins, directions = (
        np.concatenate(parts) for parts in zip(*(rays_of(v, 8) for v in eye_views()), strict=True)
    )
    both = [seen_through("reference", body("ball", n), origins, directions) for n in (1, 2)]
    shift = np.linalg.norm(both[0].points - both[1].points, axis=1)[both[0].glass] / PX_M
    ahead = direction_of((0.0, 0.0))[None]
    one, two = (
        np.trace(seen_through("reference", body("ball", n), EYE_M, ahead).vergence[0]) / 2
        for n in (1, 2)
    )
    return float(np.nanmedian(shift)), float(two - one)


LENS = "Mitsuba's thin lens of 6 mm through the ball"


def _rows(engine: EngineName) -> tuple[Row, ...]:
    return (
        Row(
            f"glass.blur.{engine}",
            "glass",
            0.05,
            "relative",
            f"{LENS}: second moment of a point's image, 4 gaze depths × 6 places up to 0.9 of the "
            "ball's radius; the largest",
            partial(blur_error, engine),
        ),
        Row(
            f"glass.disparity.{engine}",
            "glass",
            0.5,
            "px",
            "Mitsuba's rays of both eyes to the same points of the backdrop; the largest",
            partial(disparity_error_px, engine),
        ),
    )


ROWS: tuple[Row, ...] = (
    *(row for engine in ENGINES for row in _rows(engine)),
    Row(
        "glass.blur.oracle.reference",
        "glass",
        0.01,
        "relative",
        f"{LENS}; ours is an integral over the pupil, too",
        oracle_error,
    ),
    Row(
        "glass.interfaces.shift",
        "glass",
        None,
        "px",
        "two interfaces; one is the paper's. How far the backdrop moves, median",
        lambda: one_interface()[0],
    ),
    Row(
        "glass.interfaces.vergence",
        "glass",
        None,
        "dioptres",
        "two interfaces less one, of the backdrop on the axis",
        lambda: one_interface()[1],
    ),
)
