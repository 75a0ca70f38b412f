"""Frames of scenes without a photograph: pictures of the sky alone, and light that is not there.

The picture's white has to be constant over time, cheap and without a choice that moves with the
camera. So it is a white diffuser that faces every distant lamp (directional, sky, hemisphere) at
the start of the session, and E0 if one is stated. Lamps that stand somewhere light every place
differently: where there are only such, the scene states its white.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from andon.composite.model import Ambient
from andon.engines.ambient_light import stated_ambient
from andon.engines.reading import response_of, view_names_of, view_of
from andon.errors import InputError
from andon.lamps import DirectionalLamp, HemisphereLamp, Lamp, SkyLamp
from andon.quantities import CameraFrame, photometric
from andon.scene import Scene
from andon.transport.probes.capture import sky_luminance

__all__ = ["ambient_without_photograph", "sky_frames", "white_cd_m2"]

# E0 where there is none, lx: what lamps add is divided by it, and multiplied by a black picture.
NO_LUX = 1e-30


def sky_frames(scene: Scene, lamps: Sequence[Lamp], white: float, /) -> dict[str, CameraFrame]:
    """For each view of the rig a picture of what is behind everything: the sky of sky lamps.

    Black without such, or below their horizon. The sky stands still: it is that of the start.

    Parameters
    ----------
    lamps : of the start.
    white : cd/m² of the linear value 1.

    Raises `InputError` where a camera states no size.
    """
    skies = [lamp for lamp in lamps if isinstance(lamp, SkyLamp | HemisphereLamp)]
    frames: dict[str, CameraFrame] = {}
    for name in view_names_of(scene):
        view = view_of(scene, name, None).undistorted()
        _, directions = view.rays_world()
        sky = sky_luminance(skies, directions.reshape(-1, 3)).reshape(*view.shape, 3)
        frames[name] = CameraFrame(
            (sky / white).astype(np.float32), view, response_of(scene, None), white
        )
    return frames


def ambient_without_photograph(scene: Scene, /) -> Ambient:
    """E0 that everything stands in: what [ambient] states, else none.

    Raises `InputError` for what only a photograph has: E0 of each pixel, and lamps that are in it.
    """
    table = scene.ambient
    if table is None:
        return Ambient(np.full(3, NO_LUX))
    for key, remedy in (
        ("map", "state ambient.illuminance_lux"),
        ("probes", "leave it out: without a photograph probes light everything that is drawn"),
        ("harmonics", "state ambient.illuminance_lux"),
        ("rest_lux", "state ambient.illuminance_lux"),
        ("source", "make them [[lamp]]: without a photograph they light the scene themselves"),
    ):
        if getattr(table, key):
            raise InputError(
                "belongs to a photograph, and there is none",
                file=scene.file,
                field=f"ambient.{key}",
                remedy=remedy,
            )
    return stated_ambient(scene)


def white_cd_m2(scene: Scene, ambient: Ambient, lamps: Sequence[Lamp], /) -> float:
    """cd/m² of the linear value 1: as stated, else E/π of the distant lamps of `lamps` and E0."""
    if scene.capture is not None and scene.capture.luminance_per_unit:
        return scene.capture.luminance_per_unit
    total = np.zeros(3)
    if scene.ambient is not None:
        total = np.asarray(ambient.dimming) * ambient.mean_lux
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
