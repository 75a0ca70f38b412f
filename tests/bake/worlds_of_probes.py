"""Small scenes for bakes."""

import os
import subprocess
import sys
import time

import numpy as np

from andon.scene import scene_from_dict
from worlds import block, sheet, write_glb

__all__ = ["furnace", "lamp_room", "scene_of"]


def scene_of(folder, *, probes=None, **tables):
    """A scene of tables with a [probes] table of two by two by two probes around (0, 0, 0)."""
    own = {
        "volume": "probes.glb",
        "cube_size_px": 16,
        "placement": {
            "kind": "lattice", "counts": [2, 2, 2], "low": [-0.8] * 3, "high": [0.8] * 3,
        },
    }  # fmt: skip
    return scene_from_dict({"probes": own | (probes or {})} | tables, folder=folder)


def furnace(folder, reflectance, *, emitted=1.0, **tables):
    """A closed box of side 3 m around the origin whose walls all emit the same."""
    write_glb(
        folder / "box.glb",
        block((3, 3, 3), (0, 0, 0), inwards=True),
        colour=[reflectance] * 3,
        emissive=[emitted] * 3,
    )
    return scene_of(folder, surface={"mesh": "box.glb"}, **tables)


def lamp_room(folder, *, colour=(0.8, 0.4, 0.2), **tables):
    """A closed room of 4 × 3 × 5 m with a point lamp and a board that hides some of it."""
    room = block((4, 3, 5), (0, 0, 0), inwards=True)
    board = sheet((-1.5, -0.3, -1), (1.5, 0.1, 0.2), (0.1, 0, 1.3))
    geometry = type(room)(
        np.concatenate([room.positions, board.positions]),
        np.concatenate([room.triangles, board.triangles + len(room.positions)]).astype(np.int32),
    )
    write_glb(folder / "room.glb", geometry, colour=colour)
    lamp = {"kind": "point", "position": [0.5, 1.2, -0.7], "intensity_cd": 200.0}
    return scene_of(folder, **({"surface": {"mesh": "room.glb"}, "lamp": [lamp]} | tables))


def bake_command(folder, *more):
    """A bake of the probes of ``scene.toml`` as a process of its own."""
    arguments = ["-m", "andon", "probes", "bake", str(folder / "scene.toml")]
    return [sys.executable, *arguments, "--engine", "reference", *more]


def stopped(command, how, results, enough):
    """Ends a process by a signal once `results()` are `enough`; returns its exit code."""
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, stdout=quiet, stderr=quiet, env=os.environ)
    deadline = time.monotonic() + 100
    while results() < enough and time.monotonic() < deadline:
        assert process.poll() is None, "it ended before it could be stopped"
        time.sleep(0.01)
    process.send_signal(how)
    return process.wait(60)
