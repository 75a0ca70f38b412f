"""Two rooms with a wall between them, one lit: the scene in which light leaks, and its truth.

::

        ┌───────────────┬───────────────┐  y up, 3 m high; each room 4 × 4 m; the wall at x = 0.
        │  lit     ✶    ▌     dark      │  The lattice of probes is turned around y and shifted:
        │      ·   ·  · ▌ ·   ·   ·     │  no row of it is parallel to the wall.
        └───────────────┴───────────────┘

A point lamp lights the left room; probes see what its surfaces reflect of it, once. Nothing of
that light gets into the right room.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.harmonics import cube_directions, project_cube
from andon.quantities import Geometry
from andon.rays import RayScene, face_normals

__all__ = ["TwoRooms", "lattice"]

Float = NDArray[np.float64]

HALF_WIDTH_M, HEIGHT_M, DEPTH_M = 4.0, 3.0, 4.0
# Of the points that are asked, to any surface.
CLEAR_M = 0.1
_REFLECTANCE = np.array(
    [
        [0.7, 0.2, 0.2],  # outer walls: x = −4, +4
        [0.6, 0.6, 0.6],  # floor, ceiling
        [0.2, 0.6, 0.25],  # z = −2, +2
        [0.7, 0.7, 0.65],  # the wall between
    ]
)


@dataclass(frozen=True)
class TwoRooms:
    """The scene.

    Attributes
    ----------
    thickness_m : of the wall, ≥ 0.
    lamp_m : where the lamp is, in the left room.
    intensity_cd : of the lamp.
    """

    thickness_m: float = 0.1
    lamp_m: tuple[float, float, float] = (-1.4, 1.7, 0.6)
    intensity_cd: float = 300.0

    @cached_property
    def geometry(self) -> Geometry:
        """The shell of both rooms and the wall; `material_ids` are rows of the reflectances."""
        x, y, z, t = HALF_WIDTH_M, HEIGHT_M, DEPTH_M / 2, self.thickness_m / 2
        quads: list[tuple[int, list[tuple[float, float, float]]]] = [
            (0, [(s * x, 0, -z), (s * x, y, -z), (s * x, y, z), (s * x, 0, z)]) for s in (-1, 1)
        ]
        quads += [(1, [(-x, h, -z), (x, h, -z), (x, h, z), (-x, h, z)]) for h in (0, y)]
        quads += [
            (2, [(-x, 0, s * z), (x, 0, s * z), (x, y, s * z), (-x, y, s * z)]) for s in (-1, 1)
        ]
        quads += [(3, [(s, 0, -z), (s, y, -z), (s, y, z), (s, 0, z)]) for s in sorted({-t, t})]
        corners = np.array([quad for _, quad in quads], np.float64).reshape(-1, 3)
        first = 4 * np.arange(len(quads))[:, None]
        triangles = np.concatenate([first + [0, 1, 2], first + [0, 2, 3]]).astype(np.int32)
        ids = np.tile([material for material, _ in quads], 2).astype(np.int32)
        return Geometry(corners, triangles, material_ids=ids)

    @cached_property
    def rays(self) -> RayScene:
        """For distances and shadows."""
        return RayScene(self.geometry)

    def captured(self, places: Float, size: int) -> tuple[Float, NDArray[np.float32]]:
        """Coefficients (n, 9, 3) in cd/m² and distances (n, 6, s, s) in metres at `places`."""
        directions = cube_directions(size).reshape(-1, 3)
        coefficients: list[Float] = []
        distances: list[NDArray[np.float32]] = []
        for place in places:
            origins = np.broadcast_to(place, directions.shape)
            hits = self.rays.first_hits(origins, directions)
            light = self._reflected(origins, directions, hits.triangle, hits.distance)
            coefficients.append(project_cube(light.reshape(6, size, size, 3), 2))
            distances.append(hits.distance.reshape(6, size, size).astype(np.float32))
        return np.stack(coefficients), np.stack(distances)

    def _reflected(
        self, origins: Float, directions: Float, triangle: NDArray[np.int32], distance: Float
    ) -> Float:
        """Luminance (q, 3) that surfaces reflect of the lamp's direct light."""
        assert self.geometry.material_ids is not None
        points = origins + distance[:, None] * directions
        normals = face_normals(self.geometry)[triangle]
        normals = normals * -np.sign(np.einsum("qi,qi->q", normals, directions))[:, None]
        points = points + 1e-4 * normals
        reach = np.array(self.lamp_m) - points
        away = np.linalg.norm(reach, axis=1)
        cosine = np.maximum(np.einsum("qi,qi->q", normals, reach) / away, 0)
        lit = self.rays.is_visible(points, np.array(self.lamp_m))
        lux = np.where(lit, self.intensity_cd * cosine / away**2, 0.0)
        return _REFLECTANCE[self.geometry.material_ids[triangle]] * (lux / np.pi)[:, None]

    def points(self, count: int, seed: int = 5) -> tuple[Float, Float]:
        """`count` points in each room: (count, 3) in the lit one, (count, 3) in the dark one."""
        generator = np.random.default_rng(seed)
        low = np.array([self.thickness_m / 2, 0, -DEPTH_M / 2]) + CLEAR_M
        high = np.array([HALF_WIDTH_M, HEIGHT_M, DEPTH_M / 2]) - CLEAR_M
        lit, dark = generator.uniform(low, high, (2, count, 3))
        return lit * [-1, 1, 1], dark


def lattice(
    spacing_m: float = 1.0, turn_degrees: float = 17.0, shift: tuple[float, float] = (0.3, 0.1)
) -> Float:
    """(n, 3) places of a lattice turned around y and shifted (shares of the spacing in x and z).

    What lies outside the rooms, or nearer than `CLEAR_M` to their outer walls, is left out.
    """
    steps = np.arange(-8, 9) * spacing_m
    count = max(2, round((HEIGHT_M - 0.4) / spacing_m) + 1)
    heights = np.linspace(0.2, HEIGHT_M - 0.2, count)
    x, y, z = np.meshgrid(steps + shift[0] * spacing_m, heights, steps + shift[1] * spacing_m)
    turn = np.radians(turn_degrees)
    places = np.stack(
        [
            np.cos(turn) * x + np.sin(turn) * z,
            y,
            -np.sin(turn) * x + np.cos(turn) * z,
        ],
        axis=-1,
    ).reshape(-1, 3)
    inside = np.abs(places[:, 0]) <= HALF_WIDTH_M - CLEAR_M
    return places[inside & (np.abs(places[:, 2]) <= DEPTH_M / 2 - CLEAR_M)]
