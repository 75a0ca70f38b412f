"""The furnished room as files, baked by `andon.bake`, and Radiance's own answer at its pixels.

A spot, a ball and a disk are direct with a baked bounce, a panel at the ceiling is baked whole. The
truth uses nothing of the bake but the room and its lamps: Radiance is asked anew at the frame's own
points, without its cache of irradiance.

The photograph is made here: ρ·E0/π of each pixel, E0 from Radiance in the light of two other lamps.
What differs between ours and the truth is ΔE alone, and what 8 bits lose.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.lamps import Lamp, PolygonLamp, resolve_lamps
from andon.quantities import Surface
from andon.scene import scene_from_dict
from andon.spaces import View
from andon.surface import reference as surface
from andon.surface.load import surface_of_mesh
from andon.transport.baked.radiance import radiance_bundle
from andon.transport.baked.radiance.quality import QUALITIES, Quality
from andon.transport.baked.radiance.trace import traced_illuminance
from andon.verify.rooms import camera_in
from andon.verify.setting import room

__all__ = ["BOUNCES", "DIMMING", "Truth", "baked_frame", "truth"]

Float = NDArray[np.float64]

WIDTH, HEIGHT = 240, 135
BOUNCES = 3
DIMMING = 0.3
# Pixels at which the truth is asked; converged light of all would take an hour.
ASKED = 1500
# Every point traced, none interpolated.
TRUTH = Quality("truth", 2048, 0, 0.0, 0, 0.05, 1e-5, 0.0, 0.0, 0.0)
# Of the photograph's white above its brightest pixel, and above the brightest relit one.
MARGIN = 1.02

LAMPS: dict[str, dict[str, Any]] = {
    "spot": {
        "kind": "spot",
        "transport": "direct+bounce",
        "position": [-1.8, 2.6, 1.2],
        "direction": [0.6, -0.65, -0.45],
        "inner_degrees": 18.0,
        "outer_degrees": 30.0,
        "intensity_cd": 250.0,
        "rgb": [1.0, 0.8, 0.6],
    },
    "panel": {
        "kind": "rectangle",
        "transport": "baked",
        "position": [-0.4, 2.85, 0.6],
        "direction": [0.0, -1.0, 0.0],
        "up": [0.0, 0.0, -1.0],
        "width_m": 0.8,
        "height_m": 0.5,
        "luminance_cd_m2": 600.0,
        "rgb": [0.7, 0.9, 1.0],
        "drawn": False,
    },
    "ball": {
        "kind": "sphere",
        "transport": "direct+bounce",
        "position": [0.3, 2.6, 0.4],
        "radius_m": 0.12,
        "luminance_cd_m2": 1200.0,
        "rgb": [1.0, 0.75, 0.45],
        "drawn": False,
    },
    "disk": {
        "kind": "disk",
        "transport": "direct+bounce",
        "position": [-2.2, 1.5, -0.5],
        "direction": [0.9, -0.4, 0.0],
        "radius_m": 0.15,
        "luminance_cd_m2": 900.0,
        "rgb": [0.6, 1.0, 0.9],
        "drawn": False,
    },
}


@cache
def _view() -> View:
    return camera_in(room(), WIDTH, HEIGHT)


@cache
def _seen() -> Surface:
    return surface.see(surface_of_mesh(room(), _view().position), _view())


def _captured_lamps() -> tuple[Lamp, ...]:
    """What the photograph was taken in: warm light at the ceiling, cool light from the left."""
    over = np.array([(-0.4, 0, -0.3), (0.4, 0, -0.3), (0.4, 0, 0.3), (-0.4, 0, 0.3)])
    beside = np.array([(0, -0.4, 0.3), (0, -0.4, -0.3), (0, 0.4, -0.3), (0, 0.4, 0.3)])
    warm, cool = np.array([460.0, 330, 200]), np.array([210.0, 280, 400])
    return (
        PolygonLamp("over", warm, over + np.array([-1.3, 2.9, 0.9]), drawn=False),
        PolygonLamp("beside", cool, beside + np.array([-2.45, 1.7, 0.2]), drawn=False),
    )


def _traced(
    lamps: tuple[Lamp, ...], which: NDArray[np.bool_], quality: Quality, bounces: int
) -> Float:
    """(n, 3) lux at the pixels `which` (H, W)."""
    with TemporaryDirectory() as folder:
        for name, contents in radiance_bundle([room()], lamps).items():
            (Path(folder) / name).write_bytes(contents)
        seen = _seen()
        lux = traced_illuminance(
            Path(folder),
            seen.position[which],
            seen.normal[which],
            quality=quality,
            bounces=bounces,
        )
    return lux.astype(np.float64)


@cache
def _e0() -> Float:
    """(H, W, 3) lux: what this is called the photograph's light is, so it need not be exact."""
    lux = np.zeros((HEIGHT, WIDTH, 3))
    lux[_seen().valid] = _traced(_captured_lamps(), _seen().valid, QUALITIES["draft"], BOUNCES)
    return np.maximum(lux, 1e-3 * np.median(lux))


@cache
def _asked() -> NDArray[np.bool_]:
    """(H, W) the pixels at which the truth is known."""
    places = np.flatnonzero(_seen().valid)
    chosen = np.random.default_rng(5).permutation(places)[:ASKED]
    which = np.zeros(HEIGHT * WIDTH, bool)
    which[chosen] = True
    return which.reshape(HEIGHT, WIDTH)


@cache
def _lamps(name: str) -> tuple[Lamp, ...]:
    scene = scene_from_dict({"lamp": [LAMPS[name] | {"name": name, "transport": "direct"}]})
    return resolve_lamps(scene, 0.0)


@cache
def added_lux(name: str, bounces: int) -> Float:
    """(n, 3) lux that one lamp truly adds to the pixels that are asked."""
    return _traced(_lamps(name), _asked(), TRUTH, bounces)
