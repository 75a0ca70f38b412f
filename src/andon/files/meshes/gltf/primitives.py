"""glTF's mesh primitives as triangles in the world (glTF 2.0, section 3.7)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.limits import check_at_most
from andon.files.meshes.assemble import check_geometry, facet_normals
from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.container import Document
from andon.files.meshes.gltf.materials import TextureUse
from andon.files.meshes.gltf.nodes import PlacedNode
from andon.files.tree import Tree

__all__ = ["Part", "read_part", "skin_matrices", "with_facet_normals"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]
TRIANGLES, STRIP, FAN = 4, 5, 6


@dataclass(frozen=True)
class Part:
    """One primitive in the world: positions (n, 3), triangles (m, 3), normals, uvs, material."""

    positions: Float
    triangles: Int
    normals: Float | None
    uvs: Float | None
    material: int


def read_part(
    document: Document,
    buffers: BufferStore,
    primitive: Tree,
    node: PlacedNode,
    use: TextureUse,
    material: int,
    skin: Float | None,
) -> Part | None:
    """A primitive placed by its node (or its skin); None for points and lines."""
    mode = primitive.get("mode")
    shape = mode.integer(0, 6) if mode else TRIANGLES
    if shape < TRIANGLES:
        return None
    attributes = primitive.at("attributes")
    positions = buffers.accessor(attributes.at("POSITION"), ("VEC3",)).astype(np.float64)
    triangles = _triangles(document, buffers, primitive, shape, len(positions))
    check_geometry(positions, triangles, str(document.path))
    normals = _attribute(buffers, attributes, "NORMAL", ("VEC3",), len(positions))
    uvs = _attribute(buffers, attributes, f"TEXCOORD_{use.coordinates}", ("VEC2",), len(positions))
    if uvs is not None and use.transform is not None:
        matrix = np.array(use.transform)
        uvs = uvs @ matrix[:, :2].T + matrix[:, 2]
    placed = node.world_from_node
    if skin is not None:
        placed = _blended(buffers, attributes, skin, len(positions))
    return _place(Part(positions, triangles, normals, uvs, material), placed)


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


def _attribute(
    buffers: BufferStore, attributes: Tree, name: str, kinds: tuple[str, ...], count: int
) -> Float | None:
    stored = attributes.get(name)
    if stored is None:
        return None
    values = buffers.accessor(stored, kinds)
    if len(values) != count:
        raise stored.error(f"must have {count} elements like POSITION, has {len(values)}")
    values = values.astype(np.float64)
    if not np.isfinite(values).all():
        raise stored.error("must be finite")
    return values


def _place(part: Part, placed: Float) -> Part:
    """The part under one (4, 4) or per-vertex (n, 4, 4) transforms.

    Normals go by the cofactor matrix, which is the inverse transpose times the determinant and
    exists for flattening transforms too. Mirroring turns triangles round (3.7.4).
    """
    linear, shift = placed[..., :3, :3], placed[..., :3, 3]
    positions = np.einsum("...ij,...j->...i", linear, part.positions) + shift
    mirrored = np.linalg.det(linear) < 0
    sign = np.where(mirrored, -1.0, 1.0)[..., None]
    normals = part.normals
    if normals is not None:
        cofactor = np.stack(
            [np.cross(linear[..., (i + 1) % 3, :], linear[..., (i + 2) % 3, :]) for i in range(3)],
            axis=-2,
        )
        normals = np.einsum("...ij,...j->...i", cofactor, normals) * sign
    triangles = part.triangles
    turned = mirrored if placed.ndim == 2 else mirrored[triangles[:, 0]]
    triangles = np.where(np.reshape(turned, (-1, 1)), triangles[:, [0, 2, 1]], triangles)
    return Part(positions, triangles, normals, part.uvs, part.material)


def skin_matrices(
    document: Document, buffers: BufferStore, node: PlacedNode, world: dict[int, Float]
) -> Float | None:
    """(j, 4, 4) world_from_mesh of each joint of the node's skin, in the pose of the file."""
    reference = node.entry.get("skin")
    if reference is None:
        return None
    skin = document.entry("skins", reference)
    joints = [joint.integer(0, 2**31) for joint in skin.at("joints").elements()]
    if not joints or any(joint not in world for joint in joints):
        raise skin.error("must have joints that are nodes of the scene")
    matrices = np.stack([world[joint] for joint in joints])
    inverse = skin.get("inverseBindMatrices")
    if inverse is not None:
        bind = buffers.accessor(inverse, ("MAT4",)).astype(np.float64)
        if len(bind) < len(joints) or not np.isfinite(bind).all():
            raise inverse.error(f"must be {len(joints)} finite matrices, has {len(bind)}")
        matrices = matrices @ bind[: len(joints)].reshape(-1, 4, 4).swapaxes(1, 2)
    return matrices


def _blended(buffers: BufferStore, attributes: Tree, skin: Float, count: int) -> Float:
    """(n, 4, 4) transform of each vertex: joints by weights (3.7.3.3)."""
    if "JOINTS_0" not in attributes or "WEIGHTS_0" not in attributes:
        raise attributes.error("a skinned mesh must have JOINTS_0 and WEIGHTS_0")
    joints: Any = _attribute(buffers, attributes, "JOINTS_0", ("VEC4",), count)
    weights: Any = _attribute(buffers, attributes, "WEIGHTS_0", ("VEC4",), count)
    joints = joints.astype(np.int64)
    total = weights.sum(axis=1)
    if joints.min() < 0 or joints.max() >= len(skin) or (total <= 0).any():
        raise attributes.error(f"must have joints 0…{len(skin) - 1} and weights that add up to 1")
    out = np.zeros((count, 4, 4))
    for corner in range(4):
        out += (weights[:, corner] / total)[:, None, None] * skin[joints[:, corner]]
    return out


def with_facet_normals(part: Part) -> Part:
    """The part with a vertex per corner and flat normals (3.7.2.1: where none are given)."""
    chosen = part.triangles.ravel()
    facets = facet_normals(part.positions, part.triangles)
    return Part(
        part.positions[chosen],
        np.arange(len(chosen)).reshape(-1, 3),
        np.repeat(facets, 3, axis=0),
        None if part.uvs is None else part.uvs[chosen],
        part.material,
    )
