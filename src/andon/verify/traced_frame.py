"""The left eye's picture of `glass_frames`' scene, by an engine and by Mitsuba's path tracer."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.lamps import PointLamp
from andon.pipeline import EngineName, Renderer
from andon.verify.glass_frames import E0_LUX, WHITE_CD_M2, write_glass_scene
from andon.verify.glass_setting import BETWEEN_EYES_M, EYE_M, FOCAL_PX, HEIGHT, RADIUS_M, WIDTH
from andon.verify.truths.mitsuba_pictures import Surroundings, path_traced

__all__ = ["SMALLER", "differences", "renderer_of", "traced"]

Float = NDArray[np.float64]

# Mitsuba's picture is smaller by this along both sides; ours is averaged over its pixels.
SMALLER = 8
# Within the ball, off its rim, whose pixels hold more than a small picture shows.
INSIDE = 0.8


def renderer_of(engine: EngineName) -> Renderer:
    """A stereo frame of 2 × 1280×720, looking at the label."""
    with TemporaryDirectory() as folder:
        return Renderer(write_glass_scene(Path(folder), WIDTH, HEIGHT), engine)


def traced(renderer: Renderer, samples: int) -> Float:
    """(90, 160, 3) cd/m², `samples` paths a pixel. Raises `NotShown` without Mitsuba."""
    prepared = renderer.prepared
    glass, frame = prepared.glass, prepared.frames["left"]
    assert glass is not None
    focus = glass.focus(0.0)
    assert focus is not None
    grey = E0_LUX / np.pi
    lamps = tuple(lamp for lamp in prepared.lamps(0.0) if isinstance(lamp, PointLamp))
    return path_traced(
        glass.model.solids,
        frame.view.resized(WIDTH // SMALLER, HEIGHT // SMALLER),
        Surroundings(lamps, WHITE_CD_M2, (grey, grey, grey)),
        pupil_m=glass.model.pupil_m,
        focus_dioptres=focus.dioptres,
        samples=samples,
    )


def differences(ours: Float, truth: Float, /) -> Float:
    """(n, 3) ours less Mitsuba's within the ball, in white's, both cut at white.

    What is brighter is a lamp's mirror image, which has another form in ours.

    Parameters
    ----------
    ours : (720, 1280, 3) cd/m², the left eye's.
    truth : (90, 160, 3) cd/m².
    """
    rows, columns = truth.shape[:2]
    small = ours.reshape(rows, SMALLER, columns, SMALLER, 3).mean(axis=(1, 3))
    focal, distance = FOCAL_PX / SMALLER, float(EYE_M[2])
    y, x = np.mgrid[:rows, :columns]
    # The left eye sees the ball's middle to its right.
    middle = (columns - 1) / 2 + BETWEEN_EYES_M / 2 / distance * focal
    wide = INSIDE * RADIUS_M / distance * focal
    inside = np.hypot(x - middle, y - (rows - 1) / 2) < wide
    cut = [np.minimum(picture / WHITE_CD_M2, 1) for picture in (small, truth)]
    return (cut[0] - cut[1])[inside]
