"""glTF's node tree: what stands where (glTF 2.0, sections 3.5 and 3.8)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.files.limits import check_at_most
from andon.files.meshes.gltf.container import Document
from andon.files.meshes.model import MeshLight
from andon.files.tree import Tree
from andon.quaternions import rotation_matrices

__all__ = ["PlacedNode", "local_transform", "place_nodes", "read_light"]

Float = NDArray[np.float64]
LIGHTS = "KHR_lights_punctual"
LightKind = Literal["point", "spot", "directional"]
KINDS: tuple[LightKind, ...] = ("point", "spot", "directional")


@dataclass(frozen=True)
class PlacedNode:
    """A node of the scene: its entry, name, number in the file and world transform (4, 4).

    `parent` is the place of its parent among the placed nodes, −1 for none.
    """

    entry: Tree
    name: str
    number: int
    world_from_node: Float
    parent: int = -1


def place_nodes(document: Document) -> list[PlacedNode]:
    """The nodes of the default scene (or the first, or all roots), parents before children.

    A node that is reached twice is an error: the standard asks for strict trees, and a cycle
    would have no end.
    """
    nodes = document.root.list_of("nodes")
    check_at_most(len(nodes), document.limits.max_nodes, "nodes", document.path)
    placed: list[PlacedNode] = []
    seen: set[int] = set()
    stack = [(number, np.eye(4), 1, -1) for number in reversed(_roots(document, nodes))]
    while stack:
        number, world_from_parent, depth, parent = stack.pop()
        entry = nodes[number]
        if number in seen:
            raise entry.error("must have one parent, is reached twice")
        check_at_most(depth, document.limits.max_nodes, "levels of nodes", document.path)
        seen.add(number)
        world = world_from_parent @ local_transform(entry)
        name, own = entry.get("name"), len(placed)
        title = name.text() if name else entry.place
        placed.append(PlacedNode(entry, title, number, world, parent))
        children = [child.integer(0, len(nodes) - 1) for child in entry.list_of("children")]
        stack.extend((child, world, depth + 1, own) for child in reversed(children))
    return placed


def _roots(document: Document, nodes: list[Tree]) -> list[int]:
    root = document.root
    if root.list_of("scenes"):
        scene = document.entry("scenes", root.get("scene") or Tree(0, "scene", root.file))
        return [item.integer(0, len(nodes) - 1) for item in scene.list_of("nodes")]
    children = {
        child.integer(0, len(nodes) - 1) for node in nodes for child in node.list_of("children")
    }
    return [number for number in range(len(nodes)) if number not in children]


def local_transform(entry: Tree) -> Float:
    """``parent_from_node`` of one node: its matrix (stored by columns), or T·R·S."""
    matrix = entry.get("matrix")
    if matrix is not None:
        return np.array(matrix.numbers(16)).reshape(4, 4).T
    local = np.eye(4)
    turn, size, shift = (entry.get(key) for key in ("rotation", "scale", "translation"))
    if turn is not None:
        local[:3, :3] = _rotation(turn)
    if size is not None:
        local[:3, :3] *= np.array(size.numbers(3))
    if shift is not None:
        local[:3, 3] = shift.numbers(3)
    return local


def _rotation(turn: Tree) -> Float:
    """(3, 3) of a quaternion x, y, z, w, which is normalised first."""
    quaternion = np.array(turn.numbers(4))
    length = float(np.linalg.norm(quaternion))
    if not 1e-6 < length < 1e6:
        raise turn.error(f"must be a unit quaternion, has length {length:g}")
    return rotation_matrices(quaternion)


def read_light(document: Document, node: PlacedNode) -> MeshLight | None:
    """The KHR_lights_punctual light at a node, or None."""
    extensions = node.entry.get("extensions")
    reference = extensions.get(LIGHTS) if extensions else None
    if reference is None:
        return None
    lists = document.root.at("extensions").at(LIGHTS).at("lights").elements()
    light = lists[reference.at("light").integer(0, len(lists) - 1)]
    kind = light.at("type").text()
    found: LightKind | None = next((known for known in KINDS if known == kind), None)
    if found is None:
        raise light.error(f"must have a type of {', '.join(KINDS)}, has {kind[:20]!r}")
    colour = light.get("color")
    red, green, blue = colour.numbers(3) if colour else (1.0, 1.0, 1.0)
    if min(red, green, blue) < 0:
        raise light.error("must have a color ≥ 0")
    inner, outer = _cone(light) if found == "spot" else (0.0, math.pi / 2)
    name = light.get("name")
    reach = light.get("range")
    intensity = light.get("intensity")
    return MeshLight(
        name.text() if name else node.name,
        found,
        (red, green, blue),
        intensity.number(0.0) if intensity else 1.0,
        reach.number(0.0) if reach else None,
        inner,
        outer,
        node.world_from_node,
        node.name if "name" in node.entry or name is None else name.text(),
    )


def _cone(light: Tree) -> tuple[float, float]:
    """Inner and outer half angle of a spot in radians; defaults are the extension's."""
    spot = light.get("spot") or Tree({}, light.place, light.file)
    inner, outer = spot.get("innerConeAngle"), spot.get("outerConeAngle")
    # A hair above π/2 is rounding of a float32 in the file.
    outer_value = min(outer.number(0.0, math.pi / 2 + 1e-6), math.pi / 2) if outer else math.pi / 4
    inner_value = inner.number(0.0, math.pi / 2 + 1e-6) if inner else 0.0
    if inner_value >= outer_value:
        raise spot.error("must have innerConeAngle < outerConeAngle")
    return inner_value, outer_value
