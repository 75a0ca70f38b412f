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

__all__ = ["ROWS", "parity"]

WIDTH, HEIGHT = 640, 360
LAYERS = ("surface", "background")
BYTES = 5


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


ROWS: tuple[Row, ...] = (
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
