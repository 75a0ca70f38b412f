"""Where the photograph is taken from."""

from __future__ import annotations

import numpy as np

from andon.spaces import View, look_at

WIDTH, HEIGHT, HFOV_DEGREES = 1280, 720, 64.0
POSITION, LOOK_AT = (1.10, 1.46, 2.60), (-0.17, 0.64, -0.60)


def view() -> View:
    """The camera of the photograph."""
    focal = WIDTH / 2 / np.tan(np.radians(HFOV_DEGREES / 2))
    pose = look_at(np.array(POSITION), np.array(LOOK_AT), (0.0, 1.0, 0.0))
    centre = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    return View("pinhole", WIDTH, HEIGHT, focal, focal, *centre, world_from_camera=pose)
