"""A moving camera before still lamps: how much the frame's glare changes where nothing does."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from andon.pipeline import EngineName, Renderer
from andon.scene import Scene, scene_from_dict

__all__ = ["STEP_PX", "glare_steps"]

Float = NDArray[np.float64]

WIDTH, HEIGHT, HFOV_DEGREES = 320, 180, 60.0
# The camera turns by so much a frame: never by whole pixels.
STEP_PX = 0.37
# A wall five metres away, before it a bulb and a paper ball.
WALL = "v -9 -5 -5\nv 9 -5 -5\nv 9 5 -5\nv -9 5 -5\nf 1 2 3 4\n"
BULB = {
    "kind": "point", "position": [0.6, 0.3, -3.0], "flux_lm": 800.0, "visible_radius_m": 0.03,
}  # fmt: skip
BALL = {
    "kind": "point", "position": [-0.9, -0.2, -3.5], "flux_lm": 300.0,
    "shell": {"radius_m": 0.15, "transmittance": 0.6},
}  # fmt: skip
# Places on the wall at which the glare is looked at, all in the picture at all times.
COLUMNS, ROWS, REACH_M = 17, 9, (2.0, 1.1)


def glare_steps(frames: int, engine: EngineName = "reference") -> Float:
    """(frames − 1, places) relative change of what glare adds, from frame to frame."""
    with TemporaryDirectory() as folder:
        (Path(folder) / "wall.obj").write_text(WALL, encoding="utf-8")
        seen = np.array([_glare(_scene(folder, frame), engine) for frame in range(frames)])
    return np.abs(np.diff(seen, axis=0)) / seen[:-1]


def _scene(folder: str, frame: int) -> Scene:
    turn = np.radians(frame * STEP_PX * HFOV_DEGREES / WIDTH) / 2
    camera: dict[str, Any] = {"width": WIDTH, "height": HEIGHT, "hfov_degrees": HFOV_DEGREES}
    camera |= {"position": [0, 0, 0], "look_at": [np.sin(turn), 0.3 * np.sin(turn), -np.cos(turn)]}
    return scene_from_dict(
        {
            "rig": {"camera": camera},
            "capture": {"luminance_per_unit": 5.0},
            "ambient": {"illuminance_lux": 3.0},
            "object": [{"mesh": "wall.obj"}],
            "lamp": [BULB, BALL],
            "observer": {"pupil_mm": 6.0},
            "glare": {"model": "cie135", "adaptation": "mesopic"},
        },
        folder=Path(folder),
    )


def _glare(scene: Scene, engine: EngineName) -> Float:
    """(places,) what is added at places of the world."""
    frame = Renderer(scene, engine).render()
    assert frame.glare is not None
    view = frame.captured.view
    x = np.linspace(-REACH_M[0], REACH_M[0], COLUMNS)
    y = np.linspace(-REACH_M[1], REACH_M[1], ROWS)
    places = np.stack([*np.meshgrid(x, y), np.full((ROWS, COLUMNS), -5.0)], axis=-1)
    pixels = view.project(places @ view.camera_from_world[:3, :3].T).astype(np.float32)
    light = np.asarray(frame.glare.cd_m2, np.float32).sum(axis=-1)
    # Cubic: between pixels a straight line would be lower than the light around a lamp.
    found = cv2.remap(light, pixels[..., 0], pixels[..., 1], cv2.INTER_CUBIC)
    return np.asarray(found, np.float64).ravel()
