"""glTF's mesh primitives as they are stored: triangles in the space of their mesh (3.7)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.limits import check_at_most
from andon.files.meshes.assemble import check_geometry
from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.container import Document
from andon.files.meshes.gltf.materials import TextureUse
from andon.files.meshes.gltf.skins import Binding, read_binding
from andon.files.tree import Tree

__all__ = ["BoundPart", "Targets", "read_part", "read_targets", "with_own_corners"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]
TRIANGLES, STRIP, FAN = 4, 5, 6


@dataclass(frozen=True)
class Targets:
    """Morph targets: `positions` (k, n, 3) and `normals` (k, n, 3) or None, added by weight."""

    positions: Float
    normals: Float | None


@dataclass(frozen=True)
class BoundPart:
    """One primitive before its node or skin places it.

    Attributes
    ----------
    positions, normals, uvs : (n, 3), (n, 3) or None, (n, 2) or None.
    triangles : (m, 3) vertex numbers.
    material : number of its material.
    node : place of its node among the placed nodes.
    binding : joints of its vertices; None: its node moves it.
    targets : or None.
    has_facets : every triangle has corners of its own, whose normals are the triangle's.
    """

    positions: Float
    triangles: Int
    normals: Float | None
    uvs: Float | None
    material: int
    node: int
    binding: Binding | None = None
    targets: Targets | None = None
    has_facets: bool = False


def read_part(
    document: Document,
    buffers: BufferStore,
    primitive: Tree,
    use: TextureUse,
    material: int,
    node: int,
    joints: int | None,
) -> BoundPart | None:
    """A primitive; None for points and lines. `joints`: how many its node's skin has, or None."""
    mode = primitive.get("mode")
    shape = mode.integer(0, 6) if mode else TRIANGLES
    if shape < TRIANGLES:
        return None
    attributes = primitive.at("attributes")
    positions = buffers.accessor(attributes.at("POSITION"), ("VEC3",)).astype(np.float64)
    count = len(positions)
    triangles = _triangles(document, buffers, primitive, shape, count)
    check_geometry(positions, triangles, str(document.path))
    normals = buffers.attribute(attributes, "NORMAL", ("VEC3",), count)
    uvs = buffers.attribute(attributes, f"TEXCOORD_{use.coordinates}", ("VEC2",), count)
    if uvs is not None and use.transform is not None:
        matrix = np.array(use.transform)
        uvs = uvs @ matrix[:, :2].T + matrix[:, 2]
    binding = None if joints is None else read_binding(buffers, attributes, joints, count)
    return BoundPart(positions, triangles, normals, uvs, material, node, binding)


def _triangles(
    document: Document, buffers: BufferStore, primitive: Tree, shape: int, count: int
) -> Int:
    """(m, 3) vertex numbers; strips turn every second triangle round (3.7.2.1)."""
    stored = primitive.get("indices")
    if stored is None:
        order = np.arange(count)
    else:
        values = buffers.accessor(stored, ("SCALAR",))
        if values.dtype.kind != "u":
            raise stored.error("must be unsigned integers")
        order = values[:, 0].astype(np.int64)
    check_at_most(len(order), 3 * document.limits.max_triangles, "indices", document.path)
    if shape == TRIANGLES:
        if len(order) % 3:
            raise primitive.error(f"must have a multiple of 3 indices, has {len(order)}")
        return order.reshape(-1, 3)
    if len(order) < 3:
        raise primitive.error(f"must have 3 indices or more, has {len(order)}")
    if shape == FAN:
        first = np.full(len(order) - 2, order[0])
        return np.stack([order[1:-1], order[2:], first], axis=-1)
    odd = np.arange(len(order) - 2) % 2
    i = np.arange(len(order) - 2)
    return np.stack([order[i], order[i + 1 + odd], order[i + 2 - odd]], axis=-1)


def read_targets(buffers: BufferStore, primitive: Tree, count: int) -> Targets | None:
    """The morph targets of a primitive of `count` vertices (3.7.2.2); None without any."""
    entries = primitive.list_of("targets")
    if not entries:
        return None
    stored: dict[str, list[Any]] = {"POSITION": [], "NORMAL": []}
    for entry in entries:
        for name, found in stored.items():
            found.append(buffers.attribute(entry, name, ("VEC3",), count))

    def stacked(name: str) -> Float | None:
        if all(values is None for values in stored[name]):
            return None
        none = np.zeros((count, 3))
        return np.stack([none if values is None else values for values in stored[name]])

    positions = stacked("POSITION")
    if positions is None:
        positions = np.zeros((len(entries), count, 3))
    return Targets(positions, stacked("NORMAL"))


def with_own_corners(part: BoundPart) -> BoundPart:
    """The part with a vertex per corner, for flat normals (3.7.2.1: where none are given)."""
    chosen = part.triangles.ravel()
    binding, targets = part.binding, part.targets
    if binding is not None:
        binding = replace(binding, joints=binding.joints[chosen], weights=binding.weights[chosen])
    if targets is not None:
        targets = Targets(targets.positions[:, chosen], None)
    return replace(
        part,
        positions=part.positions[chosen],
        triangles=np.arange(len(chosen)).reshape(-1, 3),
        uvs=None if part.uvs is None else part.uvs[chosen],
        binding=binding,
        targets=targets,
        has_facets=True,
    )
