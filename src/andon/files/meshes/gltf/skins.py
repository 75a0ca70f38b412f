"""glTF's skins: which joints move which vertices (glTF 2.0, section 3.7.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.container import Document
from andon.files.meshes.gltf.nodes import PlacedNode
from andon.files.tree import Tree

__all__ = ["Binding", "Skin", "read_binding", "read_skin"]

Float = NDArray[np.float64]

# Four joints a set; exporters write two sets for faces, and no engine reads more than four.
MAX_SETS = 4


@dataclass(frozen=True)
class Skin:
    """Joints of a mesh.

    Attributes
    ----------
    joints : (j,) places of the joints among the placed nodes.
    joint_from_mesh : (j, 4, 4) the inverse bind matrices.
    """

    joints: NDArray[np.int64]
    joint_from_mesh: Float

    def matrices(self, world: Float, /) -> Float:
        """(j, 4, 4) world_from_mesh of each joint, where `world` (k, 4, 4) places the nodes."""
        return world[self.joints] @ self.joint_from_mesh


@dataclass(frozen=True)
class Binding:
    """Vertices of one primitive on their joints.

    Attributes
    ----------
    joints : (n, c) int, numbers of joints of the skin.
    weights : (n, c) ≥ 0, each row adds up to 1.
    """

    joints: NDArray[np.int64]
    weights: Float

    def blended(self, matrices: Float, /) -> Float:
        """(n, 3, 4) transform of each vertex: linear blend of `matrices` (j, 4, 4)."""
        rows = matrices[:, :3].reshape(len(matrices), 12)
        total = np.zeros((len(self.joints), 12))
        for corner in range(self.joints.shape[1]):
            total += self.weights[:, corner, None] * rows[self.joints[:, corner]]
        return total.reshape(-1, 3, 4)


def read_skin(
    document: Document, buffers: BufferStore, node: PlacedNode, places: dict[int, int]
) -> Skin | None:
    """The skin of a node; `places`: number of a node in the file → its place."""
    reference = node.entry.get("skin")
    if reference is None:
        return None
    skin = document.entry("skins", reference)
    joints = [joint.integer(0, 2**31) for joint in skin.at("joints").elements()]
    if not joints or any(joint not in places for joint in joints):
        raise skin.error("must have joints that are nodes of the scene")
    bind = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
    inverse = skin.get("inverseBindMatrices")
    if inverse is not None:
        stored = buffers.accessor(inverse, ("MAT4",)).astype(np.float64)
        if len(stored) < len(joints) or not np.isfinite(stored).all():
            raise inverse.error(f"must be {len(joints)} finite matrices, has {len(stored)}")
        bind = stored[: len(joints)].reshape(-1, 4, 4).swapaxes(1, 2)
    return Skin(np.array([places[joint] for joint in joints]), bind)


def read_binding(buffers: BufferStore, attributes: Tree, joints: int, count: int) -> Binding:
    """Of `count` vertices on a skin of `joints`; weights in the file need not add up to 1."""
    if "JOINTS_0" not in attributes or "WEIGHTS_0" not in attributes:
        raise attributes.error("a skinned mesh must have JOINTS_0 and WEIGHTS_0")
    chosen: list[Any] = []
    shares: list[Any] = []
    for number in range(MAX_SETS):
        if f"JOINTS_{number}" not in attributes:
            break
        chosen.append(buffers.attribute(attributes, f"JOINTS_{number}", ("VEC4",), count))
        shares.append(buffers.attribute(attributes, f"WEIGHTS_{number}", ("VEC4",), count))
    if any(share is None for share in shares):
        raise attributes.error("must have as many WEIGHTS as JOINTS")
    numbers = np.concatenate(chosen, axis=1).astype(np.int64)
    weights = np.concatenate(shares, axis=1)
    total = weights.sum(axis=1, keepdims=True)
    wrong = numbers.min() < 0 or numbers.max() >= joints or weights.min() < 0
    if wrong or (total <= 0).any():
        raise attributes.error(f"must have joints 0…{joints - 1} and weights that add up to 1")
    used = weights.any(axis=0)
    return Binding(numbers[:, used], (weights / total)[:, used])
