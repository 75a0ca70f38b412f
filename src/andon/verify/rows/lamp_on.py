"""A photograph with its shaded table lamp off, switched on, against the photograph of it on.

All that is known is what `lamp_on_room` states: depth with noise and holes, where the bulb is, what
the shade measures; not the camera's response, not E0's pattern, not how bright or of which colour
the lamp is, which the fit finds. "Gain" is the lamp-off photograph times the number that brings it
nearest to the other one.

``ANDON_SHEETS`` names a folder for a sheet: off, on, ours, and eight times the difference.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps import FitSettings, LampFit, fit_lamps
from andon.pipeline import EngineName, Renderer
from andon.verify.lamp_on_room import photographs, write_lamp_scene
from andon.verify.psnr import psnr_db
from andon.verify.registry import Row

__all__ = ["ROWS", "over_gain_db", "psnr_of"]

Bytes = NDArray[np.uint8]

TRUTH = "Mitsuba, all bounces, 320×240; 8-bit photographs of an unknown response, depth with holes"


@cache
def _fitted(bounce: bool) -> LampFit:
    with TemporaryDirectory() as folder:
        scene = write_lamp_scene(Path(folder))
        settings = FitSettings(engine="reference", bounce=bounce)
        return fit_lamps(scene, photographs()[1], settings=settings)


@cache
def _relit(engine: EngineName, bounce: bool) -> Bytes:
    """The fitted picture; on the GPU the fitted scene drawn there."""
    fit = _fitted(bounce)
    if engine == "reference":
        picture = fit.frame.image.rgb
    else:
        assert fit.scene is not None
        with TemporaryDirectory() as folder:
            write_lamp_scene(Path(folder))
            picture = Renderer(fit.scene.placed_at(Path(folder), "lamp on"), engine).picture()
    _sheet(engine, picture)
    return picture


@cache
def _shade() -> NDArray[np.bool_]:
    shell_id = _fitted(False).frame.surface.shell_id
    assert shell_id is not None
    return shell_id >= 0


def psnr_of(engine: EngineName, bounce: bool, where: str) -> float:
    """PSNR in dB of the codes, of all pixels, those of the ``shade``, or those ``beside`` it."""
    kept = {"all": np.ones_like(_shade()), "shade": _shade(), "beside": ~_shade()}[where]
    return psnr_db(_relit(engine, bounce)[kept] / 255, photographs()[1][kept] / 255)


def trivial_db(name: str) -> float:
    """Of ``unchanged``, ``gain_one`` or ``gain_channels``: the best that no model reaches."""
    return _fitted(False).measures["whole"][name].psnr_db


def over_gain_db(engine: EngineName, bounce: bool) -> float:
    """How much nearer the picture is than the best gain of all channels alike."""
    return psnr_of(engine, bounce, "all") - trivial_db("gain_one")


def _sheet(engine: str, codes: Bytes) -> None:
    folder = os.environ.get("ANDON_SHEETS")
    if not folder:
        return
    from PIL import Image

    Path(folder).mkdir(parents=True, exist_ok=True)
    off, on = photographs()
    difference = np.clip(127.5 + 8 * (codes.astype(float) - on), 0, 255).astype(np.uint8)
    rows = [np.concatenate(pair, axis=1) for pair in ((off, on), (codes, difference))]
    Image.fromarray(np.concatenate(rows)).save(Path(folder) / f"lamp-on-{engine}.png")


def _row(engine: EngineName, bounce: bool, where: str) -> Row:
    name = f"relight.lamp_on.{'bounce' if bounce else 'direct'}.{where}.{engine}"
    light = "its light and a fill for what the room reflects" if bounce else "its light alone"
    if where == "over_gain":
        return Row(
            name,
            "relight",
            8,
            "dB over the best gain",
            f"{TRUTH}; {light} fitted",
            lambda: over_gain_db(engine, bounce),
            at_least=True,
        )
    return Row(
        name, "relight", None, "dB", f"{TRUTH}; {where}", lambda: psnr_of(engine, bounce, where)
    )


WHERE = ("over_gain", "all", "shade", "beside")

ROWS: tuple[Row, ...] = (
    *(_row("reference", bounce, where) for bounce in (False, True) for where in WHERE),
    *(_row("gpu", True, where) for where in WHERE),
    *(
        Row(
            f"relight.lamp_on.{name}",
            "relight",
            None,
            "dB",
            TRUTH,
            lambda name=name: trivial_db(name),
        )
        for name in ("unchanged", "gain_one", "gain_channels")
    ),
)
