"""Rows of the whole picture's veil in the reference: points, energy, real pictures, motion."""

from __future__ import annotations

import math
from functools import cache, partial

import cv2
import numpy as np
from numpy.typing import NDArray

from andon.glare.whole_picture.exact import convolved
from andon.glare.whole_picture.plan import WholePlan, plan_whole
from andon.glare.whole_picture.reference import scattered, veil
from andon.spaces import View, pinhole_view
from andon.verify.glare_points import POINTS, Rings, kernel_of, plan_of, point_veil, rings
from andon.verify.panoramas import panorama
from andon.verify.registry import Row
from andon.verify.rows.glare_whole import cut_out

__all__ = ["ROWS", "energy_error", "motion_change", "profile_error", "real_error"]

Float = NDArray[np.float64]

MODEL = "cie135"
MODELS = (MODEL, "cie146-general", "cie146-small-angle", "ijspeert", "paper")
SPHERE = View("latlong", 192, 96)
NIGHT = "hdri_night_open3d/nightlights_latlong512.hdr"
# Files, and the angle of a pinhole that sees a part of them.
REAL = {
    "interior": ("hdri_blender_cc0/interior.exr", None),
    "sunrise": ("hdri_blender_cc0/sunrise.exr", None),
    "city": ("hdri_blender_cc0/city.exr", None),
    "night": (NIGHT, None),
    "beach": ("hdri_spiaggia/spiaggia_di_mondello_1k.hdr", None),
    "interior_60_degrees": ("hdri_blender_cc0/interior.exr", 60.0),
    "night_60_degrees": (NIGHT, 60.0),
}
# So small, the exact convolution takes seconds.
REAL_SIZE, CUT_SIZE = (128, 64), (80, 45)
FRAMES, STEP_PIXELS, CLEAR_PIXELS = 60, 0.13, 10
LIGHTS_DEGREES = ((-9.0, 4.0, 1.0), (6.0, -3.0, 3.0), (14.0, 8.0, 0.3))


@cache
def _rings(name: str, model: str) -> tuple[Rings, ...]:
    plan = plan_of(name, model)
    return tuple(rings(point_veil(plan, place)) for place in POINTS[name][1])


def profile_error(name: str, model: str = MODEL) -> float:
    """RMS of the rings' relative error, of the worst place."""
    return max(float(np.sqrt(np.mean((r.mean - 1) ** 2))) for r in _rings(name, model))


def roundness_error(name: str) -> float:
    """RMS over rings of the relative spread over eight sectors, of the worst place."""
    return max(float(np.sqrt(np.mean(r.unround**2))) for r in _rings(name, MODEL))


def energy_error() -> float:
    """Light that is seen over light that is there, less 1, of one lit pixel; the largest."""
    plan, solid = plan_whole(SPHERE, kernel_of(MODEL)), SPHERE.solid_angles()[..., None]
    errors: list[float] = []
    for row in (1, 5, 20, 33, 47, 60):
        light = np.zeros((*SPHERE.shape, 3))
        light[row, 100] = 1.0
        seen = scattered(light, plan).picture
        errors.append(abs(float((seen * solid).sum() / (light * solid).sum()) - 1))
    return max(errors)


@cache
def _real(name: str) -> tuple[Float, Float, Float]:
    """Veil and the exact one, (H, W, 3), and solid angles (H, W, 1)."""
    view, light = _picture(name)
    kernel = kernel_of(MODEL)
    seen = scattered(light, plan_whole(view, kernel))
    # What is seen less what stays: the exact one has what a pixel scatters within itself, too.
    glare = seen.picture - (1 - kernel.share) * light
    return glare, convolved(light, view, kernel), view.solid_angles()[..., None]


def _picture(name: str) -> tuple[View, Float]:
    """A panorama made small, or the part of it that a pinhole sees."""
    file, degrees = REAL[name]
    whole = np.maximum(panorama(file).astype(np.float64), 0)
    if degrees is None:
        light = cv2.resize(whole, REAL_SIZE, interpolation=cv2.INTER_AREA)
        return View("latlong", *REAL_SIZE), np.asarray(light, np.float64)
    width, height = CUT_SIZE
    view = pinhole_view(width, height, width / 2 / math.tan(math.radians(degrees / 2)))
    return view, cut_out(whole, view)


def real_error(name: str, *, each: bool = False) -> float:
    """Relative RMS of the veil of a real picture by its light, or of `each` pixel by its own."""
    veil, exact, solid = _real(name)
    if each:
        return float(np.sqrt(np.mean((veil / exact - 1) ** 2)))
    return float(np.sqrt(np.sum(solid * (veil - exact) ** 2) / np.sum(solid * exact**2)))


def motion_change() -> float:
    """Relative change of the veil at fixed directions as the camera turns, RMS over 60 frames."""
    view = pinhole_view(240, 180, 240.0)
    plan = plan_whole(view, kernel_of(MODEL))
    targets = view.directions()[10:-10:9, 30:-30:9].reshape(-1, 3)
    turns = STEP_PIXELS / view.fx * np.arange(FRAMES)
    ratios = np.stack([_ratios(plan, targets, turn) for turn in turns])
    ratios = ratios[:, np.all(np.isfinite(ratios), axis=0)]
    change: Float = ratios.std(0) / ratios.mean(0)
    return float(np.sqrt(np.mean(change**2)))


def _ratios(plan: WholePlan, targets: Float, turn: float) -> Float:
    """(n,) veil over model in directions of the room, NaN near lights; lights as between pixels."""
    view, (cosine, sine) = plan.view, (np.cos(turn), np.sin(turn))
    camera_from_room = np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
    light, solid = np.zeros((*view.shape, 3)), view.solid_angles()
    model, clear = np.zeros(view.shape), np.ones(view.shape, bool)
    for across, down, lux in LIGHTS_DEGREES:
        x, y = np.tan(np.radians([across, down]))
        way = camera_from_room @ (np.array([x, y, 1.0]) / np.sqrt(x * x + y * y + 1))
        column, row = view.project(way)
        for at_x, at_y in np.ndindex(2, 2):
            i, j = int(row) + at_y, int(column) + at_x
            light[i, j] += lux * (1 - abs(row - i)) * (1 - abs(column - j)) / solid[i, j]
        chord = np.linalg.norm(view.directions() - way, axis=-1)
        model += lux * plan.kernel.per_sr(2 * np.arcsin(chord / 2), core=True)
        clear &= np.hypot(*np.moveaxis(view.pixel_grid() - (column, row), -1, 0)) > CLEAR_PIXELS
    ratio = np.where(clear, veil(light, plan)[..., 1] / model, np.nan).astype(np.float32)
    place = view.project(targets @ camera_from_room.T).astype(np.float32)
    border = float("nan")
    across, down = place[None, :, 0], place[None, :, 1]
    found = cv2.remap(ratio, across, down, cv2.INTER_LINEAR, None, cv2.BORDER_CONSTANT, border)
    return found[0].astype(np.float64)


ROWS: tuple[Row, ...] = (
    *(
        Row(
            f"glare.point.{name.replace(' ', '_')}",
            "glare",
            0.03,
            "of the model (RMS)",
            "CIE 135 averaged over pixels, 6 pixels away to 75°, on and off the axis; the worst",
            partial(profile_error, name),
        )
        for name in POINTS
    ),
    *(
        Row(
            f"glare.point.{model}",
            "glare",
            0.03,
            "of the model (RMS)",
            "the model averaged over pixels, 60° pinhole, on and off the axis; the worst",
            partial(profile_error, "pinhole 60", model),
        )
        for model in MODELS[1:]
    ),
    *(
        Row(
            f"glare.round.{name.replace(' ', '_')}",
            "glare",
            0.01,
            "of the veil (RMS)",
            "eight sectors of rings on the sphere, 6 pixels away to 75°; the worst place",
            partial(roundness_error, name),
        )
        for name in POINTS
    ),
    Row(
        "glare.energy",
        "glare",
        0.005,
        "relative",
        "light of the sphere before and after, one lit pixel, six latitudes; the largest",
        energy_error,
    ),
    *(
        Row(
            f"glare.whole.{name}",
            "glare",
            0.02,
            "of the veil (RMS)",
            "exact convolution on the sphere, all pixels: of the veil's own RMS",
            partial(real_error, name),
        )
        for name in REAL
    ),
    *(
        Row(
            f"glare.whole_each.{name}",
            "glare",
            None,
            "of the veil (RMS)",
            "exact convolution on the sphere, all pixels: each by its own veil",
            partial(real_error, name, each=True),
        )
        for name in REAL
    ),
    Row(
        "glare.motion",
        "glare",
        0.01,
        "of the veil (RMS)",
        "itself: three lights, the camera turns by 0.13 pixels a frame, 60 frames",
        motion_change,
    ),
)
