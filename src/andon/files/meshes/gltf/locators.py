"""Places without meshes: named nodes that somebody put down in a modelling program."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.atomic import write_bytes
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.meshes.gltf.container import open_document
from andon.files.meshes.gltf.nodes import place_nodes

__all__ = ["GltfNode", "read_gltf_nodes", "write_gltf_nodes"]

Float = NDArray[np.float64]
GLB_MAGIC, JSON_CHUNK = 0x46546C67, 0x4E4F534A


@dataclass(frozen=True, eq=False)
class GltfNode:
    """A node of the file's scene.

    Attributes
    ----------
    name : as in the file; ``nodes[7]`` where it has none.
    world_from_node : (4, 4) float64, metres, +Y up.
    parent : place of its parent in the list it is in; −1: none.
    """

    name: str
    world_from_node: Float
    parent: int = -1

    @property
    def position(self) -> Float:
        """(3,) its origin, metres, world."""
        return self.world_from_node[:3, 3]


def read_gltf_nodes(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> tuple[GltfNode, ...]:
    """The nodes of the scene of a .gltf or .glb file, parents before children; no mesh is read.

    Raises `InputError` for a file that is missing, damaged, too large, or whose nodes form a cycle
    or lie at no finite place.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused below
        placed = place_nodes(open_document(path, limits))
    at = {node.number: index for index, node in enumerate(placed)}
    parents = [-1] * len(placed)
    for index, node in enumerate(placed):
        for child in node.entry.list_of("children"):
            parents[at[child.integer(0, 2**31)]] = index
    for node in placed:
        if not np.isfinite(node.world_from_node).all():
            raise node.entry.error("must lie at a finite place")
    return tuple(
        GltfNode(node.name, node.world_from_node, parent)
        for node, parent in zip(placed, parents, strict=True)
    )


def write_gltf_nodes(path: str | Path, nodes: Sequence[GltfNode], /, *, generator: str) -> Path:
    """Writes nodes without meshes as a .glb file. Parents stand before their children.

    Only where they are is written, relative to their parents: their turns and scales are not.
    """
    entries: list[dict[str, Any]] = []
    for index, node in enumerate(nodes):
        base = nodes[node.parent].position if node.parent >= 0 else np.zeros(3)
        entries.append({"name": node.name, "translation": (node.position - base).tolist()})
        if node.parent >= 0:
            entries[node.parent].setdefault("children", []).append(index)
    roots = [index for index, node in enumerate(nodes) if node.parent < 0]
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": generator},
        "scene": 0,
        "scenes": [{"nodes": roots}],
        "nodes": entries,
    }
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<IIIII", GLB_MAGIC, 2, 20 + len(text), len(text), JSON_CHUNK)
    return write_bytes(path, head + text)
