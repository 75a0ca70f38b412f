"""A room with its table lamp off and on: two photographs, a depth image, and a scene of them.

The photographs are Mitsuba's pictures of `mitsuba_lamp_room` through a camera that nobody
measured: a gamma of 2.0 with a shoulder, noise, 8 bits. The depth has 3 mm of noise, and holes at
the rims of things (the shade's among them) and where the room is dark. `make_pictures` made the
files that stand beside this module; the scene of them states what somebody with a ruler knows:
where the bulb is and what the shade measures. Light is relative: E0 = 1 is that of the photograph,
the same everywhere.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.scene import Scene, scene_from_dict
from andon.verify.truths.mitsuba_lamp_room import BULB_M, BULB_RADIUS_M, SHADE, LampRoom, camera

__all__ = ["DATA", "lamp_tables", "make_pictures", "photographs", "write_lamp_scene"]

Float = NDArray[np.float64]
Bytes = NDArray[np.uint8]

DATA = Path(__file__).parent / "lamp_on"
FILES = ("off.png", "on.png", "depth.png")
# The camera: cd/m² that it calls white, the strength of its shoulder, and noise of its codes.
WHITE_CD_M2, SHOULDER, GAMMA, CODE_NOISE = 140.0, 0.3, 2.0, 0.004
# The depth: noise in metres; a jump that may leave a hole, and how often it does; of the darkest
# pixels so many are asked, and so many of these fail.
DEPTH_NOISE_M, JUMP_M, LOST_AT_RIMS = 0.003, 0.08, 0.8
DARKEST_PERCENT, LOST_IN_THE_DARK = 12, 0.35


def photographs() -> tuple[Bytes, Bytes]:
    """(240, 320, 3) codes with the lamp off, and on."""
    from andon.files.pictures import read_picture

    off, on = (np.asarray(read_picture(DATA / name).values, np.uint8) for name in FILES[:2])
    return off, on


def lamp_tables() -> dict[str, Any]:
    """The scene; paths are those of `FILES`."""
    view = camera()
    return {
        "scene": {"name": "lamp on", "photometry": "relative"},
        "rig": {
            "camera": {
                "width": view.width,
                "height": view.height,
                "fx": view.fx,
                "fy": view.fy,
                "cx": view.cx,
                "cy": view.cy,
                "world_from_camera": view.world_from_camera.tolist(),
            }
        },
        "capture": {"source": "off.png"},
        "surface": {"depth": {"file": "depth.png", "scale_to_m": 0.001, "fill_px": 32}},
        "ambient": {"illuminance_lux": 1.0},
        "lamp": [
            {
                "name": "lamp",
                "kind": "point",
                "position": list(BULB_M),
                "flux_lm": 10.0,
                "temperature_k": 2700.0,
                "visible_radius_m": BULB_RADIUS_M,
                "shell": {
                    "drum": {
                        "radius_m": SHADE.radius_m,
                        "top_radius_m": SHADE.top_radius_m,
                        "height_m": SHADE.height_m,
                        "drop_m": BULB_M[1] - SHADE.lower_rim_m,
                    },
                    "real": True,
                    "transmittance": 0.4,
                    "absorptance": 0.25,
                },
            }
        ],
    }


def write_lamp_scene(folder: Path, /) -> Scene:
    """Copies the files into `folder`; the scene of them."""
    for name in FILES:
        shutil.copyfile(DATA / name, folder / name)
    return scene_from_dict(lamp_tables(), folder=folder)


def make_pictures(
    folder: Path, /, *, samples: int = 512, bulb_samples: int = 768, seed: int = 1
) -> None:
    """Traces the room and writes `FILES`: some eight minutes on two cores.

    Raises `NotShown` where Mitsuba is not installed.
    """
    from PIL import Image

    view, random = camera(), np.random.default_rng(seed)
    dark, lit = LampRoom(bulb=False), LampRoom(bulb=True)
    off = dark.traced(view, samples=samples)
    on = off + lit.traced_from_bulb(view, samples=bulb_samples)
    depth = _measured(dark.depth(view), off, random)
    for name, luminance in zip(FILES, (off, on), strict=False):
        Image.fromarray(_codes(luminance, random)).save(folder / name)
    Image.fromarray(np.rint(1000 * depth).astype(np.uint16)).save(folder / FILES[2])


def _codes(luminance: Float, random: np.random.Generator) -> Bytes:
    light = luminance / WHITE_CD_M2
    light = np.clip(light * (1 + SHOULDER) / (1 + SHOULDER * light), 0, 1)
    values = light ** (1 / GAMMA) + random.normal(0, CODE_NOISE, light.shape)
    return np.clip(np.rint(255 * values), 0, 255).astype(np.uint8)


def _measured(depth: Float, seen_cd_m2: Float, random: np.random.Generator) -> Float:
    """(H, W) metres with noise; 0 in holes."""
    rim = np.zeros(depth.shape, bool)
    for axis in (0, 1):
        step = np.abs(np.diff(depth, axis=axis, prepend=np.take(depth, [0], axis))) > JUMP_M
        rim |= step | np.roll(step, -1, axis)
    light = seen_cd_m2.mean(axis=-1)
    dark = light < np.percentile(light, DARKEST_PERCENT)
    lost = rim & (random.random(depth.shape) < LOST_AT_RIMS)
    lost |= dark & (random.random(depth.shape) < LOST_IN_THE_DARK)
    noisy = depth + random.normal(0, DEPTH_NOISE_M, depth.shape)
    return np.where(lost | ~np.isfinite(depth), 0.0, noisy)
