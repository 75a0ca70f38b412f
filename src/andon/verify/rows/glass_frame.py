"""Rows of whole frames of glass: both engines, and what a path tracer makes of the same scene."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.pipeline import EngineName, Renderer
from andon.verify.glass_frames import write_glass_scene
from andon.verify.registry import Row
from andon.verify.traced_frame import differences, renderer_of, traced

__all__ = ["ROWS", "off_traced", "parity"]

WIDTH, HEIGHT = 640, 360
LAYERS = ("surface", "background")
BYTES = 5
SAMPLES = 256


@cache
def _pictures(engine: EngineName, layer: str) -> NDArray[np.uint8]:
    """(2, H, W, 3) of both eyes, looking at a layer."""
    with TemporaryDirectory() as folder:
        scene = write_glass_scene(Path(folder), WIDTH, HEIGHT, gaze={"source": layer})
        renderer = Renderer(scene, engine)
    return np.stack([renderer.render(view=eye).image.rgb for eye in ("left", "right")])


def parity() -> tuple[float, float]:
    """% of pixels within 5 of 255 in all channels, and the mean difference, layers and eyes."""
    off = np.concatenate(
        [
            np.abs(_pictures("gpu", layer).astype(int) - _pictures("reference", layer).astype(int))
            for layer in LAYERS
        ]
    )
    return float((off.max(axis=-1) <= BYTES).mean() * 100), float(off.mean())


def off_traced(engine: EngineName, samples: int = SAMPLES) -> float:
    """Median difference from the path traced picture within the ball, % of white, ours less it."""
    renderer = renderer_of(engine)
    truth = traced(renderer, samples)
    ours = np.asarray(renderer.render(view="left").luminance.cd_m2, np.float64)
    return float(np.median(differences(ours, truth)) * 100)


ROWS: tuple[Row, ...] = (
    Row(
        "glass.picture.gpu",
        "glass",
        None,
        "% of white",
        f"Mitsuba's path tracer, {SAMPLES} paths a pixel: the median difference within the ball; "
        "what is mirrored inside it is not in ours",
        lambda: off_traced("gpu"),
    ),
    Row(
        "glass.parity.within",
        "glass",
        99.9,
        "% of pixels within 5/255",
        "the reference engine, 640×360, both eyes, looking at surface and background",
        lambda: parity()[0],
        at_least=True,
    ),
    Row(
        "glass.parity.mean",
        "glass",
        0.5,
        "of 255",
        "the reference engine, the same pictures",
        lambda: parity()[1],
    ),
)
