"""Figure 7: street lamps without glare, with bloom, halo and needles; and with age."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.cli.examples import example_folder
from andon.cli.figures.model import FINER, Asked, Figure, Panel
from andon.cli.figures.steps import panels_of, seen_in_steps
from andon.pipeline import Renderer
from andon.scene import Scene, load_scene
from andon.spaces import View

__all__ = ["AGES_YEARS", "draw_street", "street_scene"]

Float = NDArray[np.float64]

AGES_YEARS = (20.0, 45.0, 70.0)


def draw_street(scene: Scene, asked: Asked, step: Callable[[], None], /) -> tuple[Figure, ...]:
    """The figure from a scene of one camera, at `asked.width` pixels, and the same at three ages.

    It calls `step` once for the scene, and three times for each eye.
    """
    light, view = _drawn(scene, asked)
    step()
    panels = panels_of(seen_in_steps(light, view, asked, step), "7", finer=FINER, seed=asked.seed)
    ages: list[Panel] = []
    for years in AGES_YEARS:
        steps = seen_in_steps(light, view, replace(asked, age_years=years), step)
        picture = steps.printed(-1, finer=FINER, seed=asked.seed)
        ages.append(Panel(f"7-{years:g}-years", f"{years:g} years", picture))
    return (
        Figure("figure-7", "Figure 7.  Street lamps", "街灯", panels),
        Figure("figure-7-ages", "The same with eyes of 20, 45 and 70 years", "", tuple(ages)),
    )


def _drawn(scene: Scene, asked: Asked) -> tuple[Float, View]:
    """(H, W, 3) cd/m² before the eye, `FINER` pixels for one, and the view."""
    assert scene.rig is not None
    camera = scene.rig.camera
    assert camera is not None
    assert camera.width is not None
    assert camera.height is not None
    width = asked.width
    height = round(width * camera.height / camera.width)
    finer = camera.model_copy(update={"width": FINER * width, "height": FINER * height})
    rig = scene.rig.model_copy(update={"camera": finer})
    renderer = Renderer(scene.model_copy(update={"rig": rig, "glare": None}), asked.engine)
    frame = renderer.render()
    return np.asarray(frame.luminance.cd_m2, np.float64), frame.captured.view


def street_scene() -> Scene:
    """The example's scene."""
    return load_scene(example_folder("street", "street.toml") / "street.toml")
