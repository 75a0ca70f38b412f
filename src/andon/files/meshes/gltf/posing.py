"""Vertices of glTF's primitives in the world: placed by a node, or by joints, and morphed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.files.meshes.assemble import facet_normals
from andon.files.meshes.gltf.primitives import BoundPart

__all__ = ["is_mirrored", "posed_normals", "posed_positions"]

Float = NDArray[np.float64]


def posed_positions(part: BoundPart, placed: Float, weights: Float | None) -> Float:
    """(n, 3) under one (3, 4) or per-vertex (n, 3, 4) transforms; `weights` (k,) of the targets."""
    positions = part.positions
    if part.targets is not None and weights is not None:
        positions = positions + np.tensordot(weights, part.targets.positions, 1)
    if placed.ndim == 2:
        return positions @ placed[:, :3].T + placed[:, 3]
    return np.einsum("nij,nj->ni", placed[..., :3], positions) + placed[..., 3]


def posed_normals(
    part: BoundPart, placed: Float, weights: Float | None, positions: Float
) -> Float | None:
    """(n, 3) normals, not of unit length, of the part at `positions` (n, 3) in the world.

    Normals go by the cofactor matrix, which is the inverse transpose times the determinant and
    exists for flattening transforms too.
    """
    if part.has_facets:
        return np.repeat(facet_normals(positions, part.triangles), 3, axis=0)
    normals = part.normals
    if normals is None:
        return None
    if part.targets is not None and part.targets.normals is not None and weights is not None:
        normals = normals + np.tensordot(weights, part.targets.normals, 1)
    sign = np.where(is_mirrored(placed), -1.0, 1.0)[..., None]
    cofactor = _cofactor(placed[..., :3])
    if placed.ndim == 2:
        return (normals @ cofactor.T) * sign
    return np.einsum("nij,nj->ni", cofactor, normals) * sign


def is_mirrored(placed: Float) -> NDArray[np.bool_]:
    """(...) whether transforms (..., 3, 4) turn triangles round (3.7.4)."""
    a, b, c = np.moveaxis(placed[..., :3], -2, 0)
    return np.einsum("...i,...i->...", a, _cross(b, c)) < 0


def _cofactor(linear: Float) -> Float:
    a, b, c = np.moveaxis(linear, -2, 0)
    return np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=-2)


def _cross(a: Float, b: Float) -> Float:
    """Cross products along the last axis; a third of the time of NumPy's own."""
    x, y, z = (a[..., i - 2] * b[..., i - 1] - a[..., i - 1] * b[..., i - 2] for i in range(3))
    return np.stack([x, y, z], axis=-1)
