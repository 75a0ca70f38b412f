"""All primitives of a glTF scene, ready to be posed: one geometry, whatever its nodes do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.limits import check_at_most
from andon.files.meshes.assemble import check_geometry, concatenate, unit_normals
from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.container import Document
from andon.files.meshes.gltf.materials import MaterialReader, TextureUse
from andon.files.meshes.gltf.nodes import PlacedNode
from andon.files.meshes.gltf.posing import is_mirrored, posed_normals, posed_positions
from andon.files.meshes.gltf.primitives import (
    BoundPart,
    read_part,
    read_targets,
    with_own_corners,
)
from andon.files.meshes.gltf.skins import Skin, read_skin
from andon.files.tree import Tree
from andon.quantities import Geometry, Material

__all__ = ["BoundMesh", "bind"]

Float = NDArray[np.float64]

# glTF 2.0, 3.7.2.1: a primitive without material has the values of an empty one.
DEFAULT_MATERIAL = Material("default", (1.0, 1.0, 1.0), metallic=1.0, two_sided=False)


@dataclass(frozen=True)
class BoundMesh:
    """What the nodes of a scene draw.

    Attributes
    ----------
    parts : primitives; all of them have normals (or facets), or none has.
    skins : place of a node → its skin.
    weights : place of a node → (k,) weights of its morph targets at rest.
    materials : of all parts.
    """

    parts: tuple[BoundPart, ...]
    skins: dict[int, Skin]
    weights: dict[int, Float]
    materials: tuple[Material, ...]

    def posed(self, world: Float, weights: dict[int, Float]) -> tuple[Float, Float | None]:
        """(n, 3) positions and normals (not of unit length) of all vertices.

        `world` (k, 4, 4) places the nodes; `weights` of morph targets win over those at rest.
        """
        positions: list[Float] = []
        normals: list[Float] = []
        weights = self.weights | weights
        for part, placed in zip(self.parts, self._placements(world), strict=True):
            shares = weights.get(part.node)
            points = posed_positions(part, placed, shares)
            turned = posed_normals(part, placed, shares, points)
            positions.append(points)
            normals += [] if turned is None else [turned]
        return concatenate(positions), concatenate(normals) if normals else None

    def _placements(self, world: Float) -> list[Float]:
        """(3, 4) of each part, or (n, 3, 4) of each vertex of one with a skin."""
        joints = {place: skin.matrices(world) for place, skin in self.skins.items()}
        return [
            world[part.node, :3]
            if part.binding is None
            else part.binding.blended(joints[part.node])
            for part in self.parts
        ]

    def wound(self, world: Float) -> BoundMesh:
        """The same, its triangles counter-clockwise from outside where the nodes stand so."""
        parts = [
            _wound(part, placed)
            for part, placed in zip(self.parts, self._placements(world), strict=True)
        ]
        return replace(self, parts=tuple(parts))

    def geometry(self, world: Float, file: str) -> Geometry:
        """Everything at rest, where `world` (k, 4, 4) places the nodes; refuses what is broken."""
        positions, normals = self.posed(world, {})
        parts = self.parts
        starts = np.cumsum([0, *(len(part.positions) for part in parts)])
        triangles = concatenate(
            [part.triangles + start for part, start in zip(parts, starts, strict=False)]
        )
        check_geometry(positions, triangles, file)
        if normals is not None:
            normals = unit_normals(normals, positions, triangles, file)
        uvs = None
        if any(part.uvs is not None for part in parts):
            none = [np.zeros((len(part.positions), 2)) for part in parts]
            uvs = concatenate(
                [z if p.uvs is None else p.uvs for p, z in zip(parts, none, strict=True)]
            )
        ids = concatenate([np.full(len(p.triangles), p.material, np.int32) for p in parts])
        return Geometry(positions, triangles.astype(np.int32), normals, uvs, ids, self.materials)


def _wound(part: BoundPart, placed: Float) -> BoundPart:
    """Mirroring turns triangles round (3.7.4)."""
    mirrored, triangles = is_mirrored(placed), part.triangles
    turned = mirrored if placed.ndim == 2 else mirrored[triangles[:, 0]]
    if not turned.any():
        return part
    swapped = np.where(np.reshape(turned, (-1, 1)), triangles[:, [0, 2, 1]], triangles)
    return replace(part, triangles=swapped)


def bind(
    document: Document, buffers: BufferStore, nodes: Sequence[PlacedNode], *, moving: bool
) -> BoundMesh:
    """What the placed nodes draw; with `moving`, morph targets are kept that weigh nothing."""
    mesh = _Collector(document, buffers, nodes, moving).collect()
    if any(part.normals is not None for part in mesh.parts):
        parts = [p if p.normals is not None else with_own_corners(p) for p in mesh.parts]
        mesh = replace(mesh, parts=tuple(parts))
    count = sum(len(part.positions) for part in mesh.parts)
    check_at_most(count, document.limits.max_vertices, "vertices", document.path)
    world = np.array([node.world_from_node for node in nodes]).reshape(-1, 4, 4)
    return mesh.wound(world)


class _Collector:
    """Gathers the primitives of all placed nodes, and the materials that they use."""

    def __init__(
        self,
        document: Document,
        buffers: BufferStore,
        nodes: Sequence[PlacedNode],
        moving: bool,
    ) -> None:
        self._document, self._buffers, self._nodes = document, buffers, nodes
        self._moving = moving
        self._places = {node.number: place for place, node in enumerate(nodes)}
        self._reader = MaterialReader(document, buffers)
        self._numbers: dict[str, int] = {}
        self._materials: list[Material] = []
        self._uses: list[TextureUse] = []
        self._skins: dict[int, Skin] = {}
        self._weights: dict[int, Float] = {}
        self._counts: dict[str, int] = {}

    def collect(self) -> BoundMesh:
        parts: list[BoundPart] = []
        for place, node in enumerate(self._nodes):
            reference = node.entry.get("mesh")
            if reference is not None:
                parts += self._parts(place, node, self._document.entry("meshes", reference))
        return BoundMesh(tuple(parts), self._skins, self._weights, tuple(self._materials))

    def _parts(self, place: int, node: PlacedNode, mesh: Tree) -> list[BoundPart]:
        parts: list[BoundPart] = []
        skin = read_skin(self._document, self._buffers, node, self._places)
        if skin is not None:
            self._skins[place] = skin
        weights = node.entry.get("weights") or mesh.get("weights")
        if weights is not None:
            self._weights[place] = np.array(weights.numbers())
        for primitive in mesh.at("primitives").elements():
            self._count("primitives", 1, self._document.limits.max_nodes)
            number = self._material(primitive)
            joints = None if skin is None else len(skin.joints)
            part = read_part(
                self._document, self._buffers, primitive, self._uses[number], number, place, joints
            )
            if part is not None:
                parts.append(self._checked(self._with_targets(part, primitive)))
        return parts

    def _with_targets(self, part: BoundPart, primitive: Tree) -> BoundPart:
        weights = self._weights.get(part.node)
        if not self._moving and (weights is None or not weights.any()):
            return part
        count = len(part.positions) * len(primitive.list_of("targets"))
        self._count("vertices of morph targets", count, self._document.limits.max_vertices)
        targets = read_targets(self._buffers, primitive, len(part.positions))
        if weights is not None and len(weights) != (
            0 if targets is None else len(targets.positions)
        ):
            raise primitive.error(f"must have {len(weights)} targets, as there are weights")
        return replace(part, targets=targets)

    def _checked(self, part: BoundPart) -> BoundPart:
        # Instances share bytes in the file but not here: count what they add up to.
        limits = self._document.limits
        self._count("vertices", len(part.positions), limits.max_vertices)
        self._count("triangles", len(part.triangles), limits.max_triangles)
        return part

    def _count(self, what: str, more: int, most: int) -> None:
        self._counts[what] = self._counts.get(what, 0) + more
        check_at_most(self._counts[what], most, what, self._document.path)

    def _material(self, primitive: Tree) -> int:
        reference = primitive.get("material")
        entry = self._document.entry("materials", reference) if reference else None
        key = entry.place if entry else ""
        if key not in self._numbers:
            found: Any = self._reader.read(entry) if entry else (DEFAULT_MATERIAL, TextureUse())
            self._numbers[key] = len(self._materials)
            self._materials.append(found[0])
            self._uses.append(found[1])
        return self._numbers[key]
