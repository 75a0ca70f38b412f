"""Steps that all mesh readers share: checks, polygons into triangles, normals, numbers in text."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = [
    "check_geometry",
    "facet_normals",
    "fan_triangles",
    "parse_numbers",
    "unit_normals",
]

Float = NDArray[np.float64]
Int = NDArray[np.int64]


def parse_numbers(text: str, kind: type[np.float64] | type[np.int64]) -> NDArray[Any]:
    """All numbers in `text` (white space between them); ValueError if something else is there."""
    with warnings.catch_warnings():
        # NumPy warns where it stops early; an int64 too large for its type saturates.
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=kind, sep=" ")
        except DeprecationWarning as error:
            raise ValueError("not a number") from error


def fan_triangles(counts: Int) -> tuple[Int, Int]:
    """Polygons with `counts` (f,) ≥ 3 corners, stored one after the other, as fans of triangles.

    Returns the corner numbers (t, 3) and the polygon of each triangle (t,). Fans are right for
    convex polygons, which is what the formats promise; a concave one overlaps itself.
    """
    starts = np.cumsum(counts) - counts
    per_face = counts - 2
    face = np.repeat(np.arange(len(counts)), per_face)
    local = np.arange(len(face)) - np.repeat(np.cumsum(per_face) - per_face, per_face)
    first = starts[face]
    return np.stack([first, first + local + 1, first + local + 2], axis=-1), face


def facet_normals(positions: Float, triangles: NDArray[Any]) -> Float:
    """(m, 3) normals by the right hand, as long as twice the triangles' areas."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def unit_normals(normals: Float, positions: Float, triangles: NDArray[Any], file: str) -> Float:
    """`normals` (n, 3) scaled to length 1.

    Zero or non-finite ones are an error where a triangle with an area uses them; elsewhere they
    become +Y, which nothing ever sees.
    """
    lengths = np.linalg.norm(normals, axis=-1)
    bad = ~(np.isfinite(lengths) & (lengths > 0))
    if bad.any():
        has_area = (facet_normals(positions, triangles) != 0).any(axis=-1)
        count = int(bad[triangles[has_area]].any(axis=-1).sum())
        if count:
            raise InputError(
                f"normals must be finite and not zero, {count} triangles have such corners",
                file=file,
                remedy="recompute the normals, or export without them",
            )
    safe = np.where(bad[:, None], [0.0, 1.0, 0.0], normals)
    return safe / np.where(bad, 1.0, lengths)[:, None]


def check_geometry(positions: Float, triangles: Int, file: str) -> None:
    """Refuse a mesh without faces, with indices out of range or with non-finite positions."""
    if not len(triangles):
        raise InputError("a mesh must have faces, this one has none", file=file)
    if triangles.min() < 0 or triangles.max() >= len(positions):
        wrong = int(triangles.max() if triangles.max() >= len(positions) else triangles.min())
        raise InputError(
            f"vertex indices must be 0…{len(positions) - 1}, one is {wrong}", file=file
        )
    finite = np.isfinite(positions).all(axis=-1)
    if not finite.all():
        raise InputError(
            f"positions must be finite, vertex {int(np.argmin(finite))} is not", file=file
        )


def concatenate(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """The parts one after the other; a single one is not copied."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
