"""Glare in the frame: both engines on a real photograph, what each adds and what is shown."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import photometric
from andon.verify.glare_frames import frame_of
from andon.verify.glare_motion import STEP_PX, glare_steps
from andon.verify.registry import Row

__all__ = ["ROWS", "glare_difference", "shown_difference"]

Float = NDArray[np.float64]
BYTES = 5
FRAMES = 60


def _added(engine: str) -> Float:
    glare = frame_of(engine).glare  # type: ignore[arg-type]
    assert glare is not None
    return photometric(np.asarray(glare.cd_m2, np.float64))


def glare_difference() -> float:
    """Relative RMS in % of what both engines add."""
    gpu, truth = _added("gpu"), _added("reference")
    return float(np.sqrt(np.mean((gpu - truth) ** 2) / np.mean(truth**2)) * 100)


def shown_difference() -> float:
    """% of pixels within 5 of 255 in all channels."""
    off = frame_of("gpu").image.rgb.astype(int) - frame_of("reference").image.rgb.astype(int)
    return float((np.abs(off).max(axis=-1) <= BYTES).mean() * 100)


def motion() -> float:
    """RMS in % of the change from frame to frame."""
    return float(np.sqrt(np.mean(glare_steps(FRAMES) ** 2)) * 100)


ROWS: tuple[Row, ...] = (
    Row(
        "glare.frame.added",
        "glare",
        1.0,
        "% RMS",
        "the reference engine: veil and needles in the photographed garage by night",
        glare_difference,
    ),
    Row(
        "glare.frame.shown",
        "glare",
        None,
        "% of pixels within 5/255",
        "the reference engine, the same picture; edges of shadows are in it",
        shown_difference,
    ),
    Row(
        "glare.frame.motion",
        "glare",
        1.0,
        "% RMS from frame to frame",
        f"no change: {FRAMES} frames, the camera turning by {STEP_PX} px in each, at fixed places "
        "of the world; halo and needles are in it",
        motion,
    ),
)
