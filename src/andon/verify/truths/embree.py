"""Shadow truth: Embree decides whether a point sees a lamp."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.quantities import Geometry

__all__ = ["OFFSET_M", "Visibility", "visible"]

# Rays start this far above the surface and end this far before the lamp. Embree works in float32,
# whose steps are 5e-7 m at 5 m: 1e-4 m clears them 200 times over, and moves a shadow's edge by
# no more than 0.1 mm / tan(elevation of the lamp).
OFFSET_M = 1e-4


class Visibility:
    """A geometry that is asked many times; building it sorts the triangles once.

    Parameters
    ----------
    geometry : triangles block light from both sides.
    """

    def __init__(self, geometry: Geometry) -> None:
        if len(geometry.triangles) == 0:
            raise InputError("must have at least one triangle", field="geometry")
        # embreex is compiled and brings no types.
        scene: Any = import_module("embreex.rtcore_scene").EmbreeScene(robust=True)
        positions = np.ascontiguousarray(geometry.positions, np.float32)
        # The mesh has to outlive the queries: the scene only borrows its buffers.
        self._mesh: Any = import_module("embreex.mesh_construction").TriangleMesh(
            scene, positions, np.ascontiguousarray(geometry.triangles, np.int32)
        )
        self._scene: Any = scene

    def visible(
        self, points: NDArray[Any], normals: NDArray[Any], lamp_position: ArrayLike, /
    ) -> NDArray[np.bool_]:
        """(n,) bool: the lamp stands above the point's horizon and nothing is in between.

        Parameters
        ----------
        points, normals : (n, 3) metres and unit normals; rays start `OFFSET_M` along the normal.
        lamp_position : (3,) metres.
        """
        origins, facing = _checked(points, "points"), _checked(normals, "normals")
        if origins.shape != facing.shape:
            raise InputError(f"must have the shape of points {origins.shape}", field="normals")
        to_lamp = np.asarray(lamp_position, np.float64) - origins
        seen = np.einsum("ij,ij->i", to_lamp, facing) > 0
        origins = origins[seen] + OFFSET_M * facing[seen]
        to_lamp = np.asarray(lamp_position, np.float64) - origins
        distance = np.linalg.norm(to_lamp, axis=1)
        seen[seen] = ~self._blocked(origins, to_lamp / distance[:, None], distance - OFFSET_M)
        return seen

    def _blocked(
        self, origins: NDArray[Any], directions: NDArray[Any], lengths: NDArray[Any]
    ) -> NDArray[np.bool_]:
        hits: NDArray[np.int32] = self._scene.run(
            np.ascontiguousarray(origins, np.float32),
            np.ascontiguousarray(directions, np.float32),
            np.ascontiguousarray(lengths, np.float32),
            query="OCCLUDED",
        )
        return hits != -1


def _checked(vectors: NDArray[Any], field: str) -> NDArray[np.float64]:
    values = np.asarray(vectors, np.float64)
    if values.ndim != 2 or values.shape[1] != 3 or not np.isfinite(values).all():
        raise InputError(f"must be finite (n, 3), got shape {values.shape}", field=field)
    return values


def visible(
    geometry: Geometry,
    points: NDArray[Any],
    normals: NDArray[Any],
    lamp_position: ArrayLike,
    /,
) -> NDArray[np.bool_]:
    """(n,) bool, see `Visibility.visible`; builds the geometry anew at every call."""
    return Visibility(geometry).visible(points, normals, lamp_position)
