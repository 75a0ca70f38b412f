"""Boxes around boxes around the triangles of closed meshes, as textures that shaders walk through.

Nodes lie in the order in which they are visited, each with where to go on if its box is missed, so
that no stack is needed (Smits 1998). Which child is nearer depends on where a ray goes: there are
eight orders, one for each octant of directions, and the first hits cut off most of the rest::

    node      low x, y, z, next if missed │ high x, y, z, leaf        2 texels
    triangle  corner a, b, c (w: u of each) │ normal a, b, c (w: v)   6 texels

`leaf` is −1 for inner nodes, else 8·(first triangle) + (number of triangles).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.rays import face_normals

__all__ = ["LEAF", "Hierarchy", "Places", "hierarchy", "packed"]

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
Int = NDArray[np.int64]

# Triangles in a leaf, at most.
LEAF = 4
# Nodes of fewer triangles are split along one axis only.
SMALL = 24
OCTANTS = 8
# Nodes and triangles in a row of their textures.
NODES_A_ROW, TRIANGLES_A_ROW = 1024, 256


@dataclass(frozen=True)
class Hierarchy:
    """One mesh.

    Attributes
    ----------
    nodes : (8, n, 2, 4) float32, of each octant: bit 0, 1, 2 is set where x, y, z falls.
    triangles : (m, 6, 4) float32.
    """

    nodes: Float32
    triangles: Float32


@dataclass(frozen=True)
class Places:
    """Where the meshes of a scene lie in the textures.

    Attributes
    ----------
    nodes, triangles : (h, w, 4) float32.
    first_node, node_count, first_triangle : of each mesh.
    """

    nodes: Float32
    triangles: Float32
    first_node: tuple[int, ...]
    node_count: tuple[int, ...]
    first_triangle: tuple[int, ...]


@dataclass
class _Tree:
    """Inner nodes have children, leaves a span of `order`."""

    children: list[tuple[int, int]]
    axis: list[int]
    span: list[tuple[int, int]]
    order: Int


def hierarchy(geometry: Geometry, /) -> Hierarchy:
    """The hierarchy of a mesh; it is split where the surface area heuristic is least.

    Source: Goldsmith and Salmon 1987 (cost: the sum of areas times triangles).
    """
    corners = geometry.positions[geometry.triangles]
    tree = _split(corners.min(axis=1), corners.max(axis=1))
    triangles = _triangles(geometry)[tree.order]
    sorted_corners = corners[tree.order]
    low, high = _boxes(tree, sorted_corners.min(axis=1), sorted_corners.max(axis=1))
    sizes, spans = _sizes(tree), np.array(tree.span)
    is_leaf = np.array(tree.children)[:, 0] < 0
    leaf = np.where(is_leaf, 8 * spans[:, 0] + spans[:, 1] - spans[:, 0], -1)
    orders = [
        _ordered(np.array(_places(tree, sizes, octant)), np.array(sizes), (low, high, leaf))
        for octant in range(OCTANTS)
    ]
    return Hierarchy(np.stack(orders), triangles)


def _split(low: Float, high: Float) -> _Tree:
    tree = _Tree([], [], [], np.arange(len(low)))
    todo = [(0, len(low), -1)]
    while todo:
        start, stop, parent = todo.pop()
        node = len(tree.span)
        tree.children.append((-1, -1))
        tree.axis.append(0)
        tree.span.append((start, stop))
        if parent >= 0:
            first, second = tree.children[parent]
            tree.children[parent] = (node, second) if first < 0 else (first, node)
        if stop - start > LEAF:
            own = tree.order[start:stop]
            axis, order, middle = _best_split(low[own], high[own])
            tree.order[start:stop] = own[order]
            tree.axis[node] = axis
            # The last that is put there is taken first: the lower half becomes the first child.
            todo += [(start + middle, stop, node), (start, start + middle, node)]
    return tree


def _best_split(low: Float, high: Float) -> tuple[int, Int, int]:
    """Axis, order along it, and how many go to the lower half."""
    centre = low + high
    axes = range(3) if len(low) > SMALL else (int(np.ptp(centre, axis=0).argmax()),)
    best, found = np.inf, (0, np.arange(len(low)), len(low) // 2)
    for axis in axes:
        order = np.argsort(centre[:, axis], kind="stable")
        below = _areas(low[order], high[order])[:-1]
        above = _areas(low[order[::-1]], high[order[::-1]])[-2::-1]
        count = np.arange(1, len(low))
        cost = below * count + above * (len(low) - count)
        middle = int(cost.argmin())
        if cost[middle] < best:
            best, found = cost[middle], (axis, order, middle + 1)
    return found


def _areas(low: Float, high: Float) -> Float:
    """(n,) half the surface of the box around the first 1…n boxes."""
    size = np.maximum.accumulate(high) - np.minimum.accumulate(low)
    return np.asarray(size[:, 0] * size[:, 1] + size[:, 1] * size[:, 2] + size[:, 2] * size[:, 0])


def _boxes(tree: _Tree, low: Float, high: Float) -> tuple[Float, Float]:
    """(n, 3) corners of the nodes' boxes, from those of the sorted triangles."""
    # Triangles edge-on to an axis have boxes without a depth: float32 has to round them outwards.
    hair = 1e-6 * float(np.abs([low, high]).max())
    lows = np.array([low[a:b].min(axis=0) for a, b in tree.span]) - hair
    highs = np.array([high[a:b].max(axis=0) for a, b in tree.span]) + hair
    return lows, highs


def _sizes(tree: _Tree) -> list[int]:
    """How many nodes each node is, itself included."""
    sizes = [1] * len(tree.children)
    # Parents were made before their children.
    for node in range(len(sizes) - 1, -1, -1):
        first, second = tree.children[node]
        if first >= 0:
            sizes[node] += sizes[first] + sizes[second]
    return sizes


def _places(tree: _Tree, sizes: list[int], octant: int) -> list[int]:
    """Where each node is in the order of one octant."""
    places = [0] * len(sizes)
    for node, (children, axis) in enumerate(zip(tree.children, tree.axis, strict=True)):
        if children[0] >= 0:
            falls = (octant >> axis) & 1
            near, far = children[falls], children[1 - falls]
            places[near] = places[node] + 1
            places[far] = places[node] + 1 + sizes[near]
    return places


def _ordered(place: Int, sizes: Int, facts: tuple[Float, Float, Int]) -> Float32:
    """(n, 2, 4) nodes in the order of one octant; `facts`: corners of their boxes, and leaves."""
    low, high, leaf = facts
    nodes = np.zeros((len(place), 2, 4), np.float32)
    nodes[place, 0] = np.column_stack([low, place + sizes])
    nodes[place, 1] = np.column_stack([high, leaf])
    return nodes


def _triangles(geometry: Geometry) -> Float32:
    corners = geometry.triangles
    rows = np.zeros((len(corners), 6, 4), np.float32)
    rows[:, :3, :3] = geometry.positions[corners]
    if geometry.normals is None:
        rows[:, 3:, :3] = face_normals(geometry)[:, None]
    else:
        rows[:, 3:, :3] = geometry.normals[corners]
    if geometry.uvs is not None:
        rows[:, :3, 3] = geometry.uvs[corners, 0]
        rows[:, 3:, 3] = geometry.uvs[corners, 1]
    return rows


def packed(meshes: list[Hierarchy], /) -> Places:
    """All meshes of a scene as two pictures; at least one texel each."""
    nodes = [mesh.nodes.reshape(-1, 8) for mesh in meshes]
    triangles = [mesh.triangles.reshape(-1, 24) for mesh in meshes]
    return Places(
        _picture(nodes, NODES_A_ROW, 8),
        _picture(triangles, TRIANGLES_A_ROW, 24),
        _starts(nodes),
        tuple(mesh.nodes.shape[1] for mesh in meshes),
        _starts(triangles),
    )


def _starts(parts: list[Float32]) -> tuple[int, ...]:
    return tuple(int(n) for n in np.cumsum([0, *(len(part) for part in parts)])[:-1])


def _picture(parts: list[Float32], per_row: int, width: int) -> Float32:
    count = sum(len(part) for part in parts)
    rows = np.zeros((max(-(-count // per_row), 1) * per_row, width), np.float32)
    if count:
        rows[:count] = np.concatenate(parts)
    return rows.reshape(-1, per_row * width // 4, 4)
