"""Small scenes for bakes of illuminance maps, and workers that need no processes."""

from collections import deque
from contextlib import contextmanager

import numpy as np

from andon.bake.maps import bake_maps
from andon.bake.tasks.inputs import inputs_in
from andon.bake.tasks.outcomes import performed
from andon.files.illuminance_maps import read_manifest, read_moment
from andon.quantities import Geometry
from andon.scene import scene_from_dict
from worlds import block, write_glb

__all__ = [
    "CAMERAS",
    "ROOM",
    "Here",
    "artefacts",
    "bake",
    "baked_moment",
    "camera",
    "room_scene",
    "room_tables",
    "write_room",
]

# Across a side, metres: a room around the origin.
ROOM = (4.0, 3.0, 5.0)


class Here:
    """Workers in this process: what counts is which tasks are done. `done` are their names."""

    def __init__(self):
        self.done = []

    @contextmanager
    def started(self, bundles, folder):
        with inputs_in(folder, bundles) as inputs:
            yield _Pool(self, inputs)


class _Pool:
    count = 1

    def __init__(self, owner, inputs):
        self.owner, self.inputs, self.waiting = owner, inputs, deque()

    @property
    def free(self):
        return 1 - len(self.waiting)

    def start(self, task):
        self.waiting.append(task)

    def next(self):
        task = self.waiting.popleft()
        self.owner.done.append(task.name)
        return performed(task, self.inputs.of(task), "here")

    def drop(self, digest):
        self.inputs.drop(digest)


def write_room(folder, *, colour=(0.8, 0.4, 0.2)):
    """room.glb: a closed room of `ROOM` with a box on its floor."""
    room, box = block(ROOM, (0, 0, 0), inwards=True), block((0.6, 0.8, 0.6), (0.7, -1.1, -1.0))
    positions = np.concatenate([room.positions, box.positions])
    triangles = np.concatenate([room.triangles, box.triangles + len(room.positions)])
    write_glb(folder / "room.glb", Geometry(positions, triangles.astype(np.int32)), colour=colour)


def camera(position, look_at, *, width=48, height=36):
    """A [[baked.camera]] table."""
    table = {"position": list(position), "look_at": list(look_at), "hfov_degrees": 90.0}
    return table | {"width": width, "height": height}


CAMERAS = [camera((0, 0.5, 2.2), (0, -0.5, 0)), camera((0, 0.5, -2.2), (0, -0.5, 0))]


def room_tables(*, baked=None, **tables):
    """Tables of a scene with two lamps, the second for its reflected light alone."""
    lamps = [
        {
            "name": "left", "kind": "point", "position": [-1.0, 0.8, -0.7], "intensity_cd": 200.0,
            "transport": "baked",
        },
        {
            "name": "right", "kind": "point", "position": [1.2, 0.5, 0.7], "intensity_cd": 100.0,
            "transport": "direct+bounce",
        },
    ]  # fmt: skip
    own = {
        "folder": "maps", "lamps": ["left", "right"], "quality": "draft", "bounces": 1,
        "camera": CAMERAS,
    }  # fmt: skip
    base = {"surface": {"mesh": "room.glb"}, "lamp": lamps, "baked": own | (baked or {})}
    return base | tables


def room_scene(folder, **changes):
    """The scene of `room_tables` in `folder`, whose room is written if it is not there."""
    if not (folder / "room.glb").exists():
        write_room(folder)
    return scene_from_dict(room_tables(**changes), folder=folder)


def bake(scene, **options):
    """(report, names of the tasks that were done)."""
    workers = Here()
    return bake_maps(scene, workers=workers, **options), workers.done


def baked_moment(folder, moment=0):
    """The maps of a moment."""
    return read_moment(folder, read_manifest(folder), moment)


def artefacts(folder):
    """Name → contents of all that a bake leaves, its journal aside: that has times in it."""
    return {
        path.name: path.read_bytes() for path in folder.iterdir() if path.name != "journal.jsonl"
    }
