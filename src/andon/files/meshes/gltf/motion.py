"""glTF's node tree at any time: where every node stands while a clip plays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.files.meshes.gltf.clips import Clip
from andon.files.meshes.gltf.nodes import PlacedNode, local_transform
from andon.quaternions import rotation_matrices

__all__ = ["NodeTree"]

Float = NDArray[np.float64]

# Where a translation, a rotation and a scale stand in a row of numbers.
PATHS = {"translation": slice(0, 3), "rotation": slice(3, 7), "scale": slice(7, 10)}
AT_REST = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0,) * 3}


class NodeTree:
    """The placed nodes of a scene, parents before children.

    Attributes
    ----------
    rest : (k, 4, 4) world_from_node in the pose of the file.
    """

    def __init__(self, nodes: Sequence[PlacedNode]) -> None:
        self._nodes = nodes
        self.rest: Float = np.array([node.world_from_node for node in nodes]).reshape(-1, 4, 4)
        self._local = np.array([local_transform(node.entry) for node in nodes]).reshape(-1, 4, 4)
        self._numbers = np.array([_at_rest(node) for node in nodes]).reshape(-1, 10)
        self._parents = np.array([node.parent for node in nodes], np.int64)
        self._levels = _levels(self._parents)

    def check(self, clips: Sequence[Clip]) -> None:
        """Refuses clips that move a node with a matrix (3.11: it has nothing that could move)."""
        for clip in clips:
            for track in clip.tracks:
                places: list[int] = track.nodes.tolist() if track.path in PATHS else []
                for place in places:
                    entry = self._nodes[place].entry
                    if "matrix" in entry:
                        raise entry.error("must not have a matrix, since an animation moves it")

    def at(self, clip: Clip, seconds: float) -> tuple[Float, dict[int, Float]]:
        """(k, 4, 4) world_from_node at a time of a clip; and place → (n,) weights of targets."""
        numbers = self._numbers.copy()
        weights: dict[int, Float] = {}
        moved = np.zeros(len(numbers), bool)
        for track in clip.tracks:
            values = track.at(seconds)
            if track.path in PATHS:
                numbers[track.nodes, PATHS[track.path]] = values
                moved[track.nodes] = True
            else:
                weights |= dict(zip(track.nodes.tolist(), values, strict=True))
        local = self._local.copy()
        local[moved] = _composed(numbers[moved])
        return self._world(local), weights

    def _world(self, local: Float) -> Float:
        world = local.copy()
        for places in self._levels:
            world[places] = world[self._parents[places]] @ local[places]
        return world


def _at_rest(node: PlacedNode) -> tuple[float, ...]:
    """Translation, rotation and scale of a node, or what stands for them."""
    numbers: list[float] = []
    for path, default in AT_REST.items():
        stored = node.entry.get(path)
        numbers += default if stored is None else stored.numbers(len(default))
    return tuple(numbers)


def _composed(numbers: Float) -> Float:
    """(m, 4, 4) T·R·S of (m, 10) (3.5.2)."""
    local = np.tile(np.eye(4), (len(numbers), 1, 1))
    turn = rotation_matrices(numbers[:, PATHS["rotation"]])
    local[:, :3, :3] = turn * numbers[:, None, PATHS["scale"]]
    local[:, :3, 3] = numbers[:, PATHS["translation"]]
    return local


def _levels(parents: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Nodes by depth, without the roots: a level needs only those above it."""
    depth = np.zeros(len(parents), np.int64)
    for place, parent in enumerate(parents):  # parents come before their children
        if parent >= 0:
            depth[place] = depth[parent] + 1
    ends = np.cumsum(np.bincount(depth))
    return np.split(np.argsort(depth, kind="stable"), ends[:-1])[1:]
