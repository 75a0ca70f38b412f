"""Frames of scenes without a photograph: black pictures, and light that is not there.

The picture's white has to be constant over time, cheap and without a choice that moves with the
camera. So it is a white diffuser that faces every distant lamp (directional, sky, hemisphere) at
the start of the session, and E0 if one is stated. Lamps that stand somewhere light every place
differently: where there are only such, the scene states its white.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.reading import ambient_of, response_of, view_names_of, view_of
from andon.errors import InputError
from andon.lamps import DirectionalLamp, HemisphereLamp, Lamp, SkyLamp
from andon.quantities import CameraFrame, photometric
from andon.scene import Scene

__all__ = ["ambient_without_photograph", "black_frames", "white_cd_m2"]


def black_frames(scene: Scene, white: float, /) -> dict[str, CameraFrame]:
    """A black picture for each view of the rig, of the size that its camera states.

    `white` is cd/m² of the linear value 1. Raises `InputError` where a camera states no size.
    """
    frames: dict[str, CameraFrame] = {}
    for name in view_names_of(scene):
        view = view_of(scene, name, None).undistorted()
        black = np.zeros((*view.shape, 3), np.float32)
        frames[name] = CameraFrame(black, view, response_of(scene, None), white)
    return frames


def ambient_without_photograph(scene: Scene, /) -> Ambient:
    """E0 that everything stands in: what [ambient] states, else none.

    Raises `InputError` for what only a photograph has: E0 of each pixel, and lamps that are in it.
    """
    table = scene.ambient
    if table is None:
        return Ambient(np.ones(3), (0.0, 0.0, 0.0))
    for key, remedy in (
        ("map", "state ambient.illuminance_lux"),
        ("probes", "leave it out: without a photograph probes light everything that is drawn"),
        ("source", "make them [[lamp]]: without a photograph they light the scene themselves"),
    ):
        if getattr(table, key):
            raise InputError(
                "belongs to a photograph, and there is none",
                file=scene.file,
                field=f"ambient.{key}",
                remedy=remedy,
            )
    return ambient_of(scene, {})


def white_cd_m2(scene: Scene, ambient: Ambient, lamps: Sequence[Lamp], /) -> float:
    """cd/m² of the linear value 1: as stated, else E/π of the distant lamps of `lamps` and E0."""
    if scene.capture is not None and scene.capture.luminance_per_unit:
        return scene.capture.luminance_per_unit
    total: NDArray[np.float64] = np.asarray(ambient.dimming) * ambient.mean_lux
    for lamp in lamps:
        if isinstance(lamp, DirectionalLamp | SkyLamp):
            total = total + lamp.illuminance_lux
        elif isinstance(lamp, HemisphereLamp):
            total = total + lamp.sky_illuminance_lux
    lux = float(photometric(total))
    if lux > 0:
        return lux / np.pi
    raise InputError(
        "is missing: without a photograph, distant lamps or [ambient] nothing says how bright "
        "white is",
        file=scene.file,
        field="capture.luminance_per_unit",
        remedy="state it in cd/m²: about E/3 for the picture's white in an illuminance of E lx",
    )
