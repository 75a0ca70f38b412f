"""Illuminance of a shell's inside: the inverted normal of the source paper, section 2.1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.shells.beams import Beam
from andon.lamps.triangles import triangle_areas, unit_normals
from andon.quantities import Geometry

__all__ = ["inside_illuminance", "spread", "vertex_normals"]

Float = NDArray[np.float64]

CHUNK = 4096


def vertex_normals(geometry: Geometry, /) -> Float:
    """(n, 3) unit normals outwards; a flat-shaded body has three corners for each triangle."""
    if geometry.normals is not None:
        return geometry.normals
    normals = np.empty_like(geometry.positions)
    normals[geometry.triangles] = unit_normals(geometry.positions[geometry.triangles])[:, None]
    return normals


def inside_illuminance(body: Geometry, beam: Beam, /) -> Float:
    """E (n,) in lx on the inside of each vertex of `body` by a lamp of 1 cd at the origin.

    E = I(ω)·max(0, cos φ)/d², where φ is measured from the *inverted* normal; the shell does not
    hide itself.
    """
    squared = np.einsum("ij,ij->i", body.positions, body.positions)
    squared = np.maximum(squared, np.finfo(float).tiny)
    directions = body.positions / np.sqrt(squared)[:, None]
    cosine = np.einsum("ij,ij->i", directions, vertex_normals(body))
    return beam.towards(directions) * np.maximum(cosine, 0) / squared


def spread(points: Float, normals: Float, facets: Float, values: Float, /) -> Float:
    """`values` (n, c) of facets (n, 3, 3) at `points` (p, 3): a mean of near ones.

    Those that face alike count most; weights fall with the fourth power of the
    distance beyond a facet's own size.
    """
    result = np.zeros((len(points), values.shape[1]))
    if not values.any():
        return result
    middles = facets.mean(axis=1)
    area, unit = triangle_areas(facets), unit_normals(facets)
    for first in range(0, len(points), CHUNK):
        part = slice(first, first + CHUNK)
        squared = (
            (points[part] ** 2).sum(axis=1)[:, None]
            + (middles**2).sum(axis=1)
            - 2 * points[part] @ middles.T
        )
        alike = 1e-3 + np.maximum(normals[part] @ unit.T, 0) ** 2
        weight = alike * area / (np.maximum(squared, 0) + area) ** 2
        result[part] = weight @ values / weight.sum(axis=1, keepdims=True)
    return result
