"""Rooms for light probes, lit by one lamp whose light is reflected once: with their truth.

::

        ┌───────────────┬───────────────┐  `two_rooms`: y up, 3 m high, each room 4 × 4 m, the wall
        │  lit     ✶    ▌     dark      │  at x = 0. Nothing of the lamp's light gets into the
        │      ·   ·  · ▌ ·   ·   ·     │  right room. The lattice of probes is turned around y and
        └───────────────┴───────────────┘  shifted: no row of it is parallel to the wall.

`coloured_room` is a cube of 3 m, its left wall red, its right one green.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes import Distances, ProbeVolume, plain_volume
from andon.harmonics import cube_directions, project_cube
from andon.quantities import Geometry, Material
from andon.rays import RayScene, face_normals
from andon.spaces import View
from andon.transport.probes.visibility import distance_map

__all__ = [
    "LitRoom",
    "coloured_room",
    "lattice",
    "points_in",
    "surfaces_of_dark_room",
    "two_rooms",
    "volume_of",
]

Float = NDArray[np.float64]
Corner = tuple[float, float, float]

HALF_WIDTH_M, HEIGHT_M, DEPTH_M = 4.0, 3.0, 4.0
# Of the points that are asked, and of probes, to any surface.
CLEAR_M = 0.1
# Longer than the diagonal of both rooms, 9.4 m.
FAR_M = 12.0
# Receivers are lifted off their surface by this before the lamp is looked for.
LIFT_M = 1e-4


@dataclass(frozen=True, eq=False)
class LitRoom:
    """A scene with one point lamp.

    Attributes
    ----------
    geometry : surfaces, seen from both sides; `material_ids` are given.
    lamp_m : (3,) where the lamp is.
    intensity_cd : of the lamp.
    """

    geometry: Geometry
    lamp_m: Float
    intensity_cd: float

    @cached_property
    def rays(self) -> RayScene:
        """For distances and shadows."""
        return RayScene(self.geometry)

    @cached_property
    def _reflectances(self) -> Float:
        """(triangles, 3)."""
        assert self.geometry.material_ids is not None
        table = np.array([material.reflectance for material in self.geometry.materials])
        return table[self.geometry.material_ids]

    def captured(self, places: Float, size: int) -> tuple[Float, NDArray[np.float32]]:
        """Coefficients (n, 9, 3) in cd/m² and distances (n, 6, s, s) in metres at `places`."""
        directions = cube_directions(size).reshape(-1, 3)
        coefficients: list[Float] = []
        distances: list[NDArray[np.float32]] = []
        for place in places:
            light, away = self.seen(np.broadcast_to(place, directions.shape), directions)
            coefficients.append(project_cube(light.reshape(6, size, size, 3), 2))
            distances.append(away.reshape(6, size, size).astype(np.float32))
        return np.stack(coefficients), np.stack(distances)

    def seen(self, origins: Float, directions: Float) -> tuple[Float, Float]:
        """Along rays (q, 3): luminance (q, 3) of the lamp's reflected light, and metres (q,)."""
        hits = self.rays.first_hits(origins, directions)
        hit = hits.triangle >= 0
        light = np.zeros((len(origins), 3))
        triangle, distance = hits.triangle[hit], hits.distance[hit]
        points = origins[hit] + distance[:, None] * directions[hit]
        normals = face_normals(self.geometry)[triangle]
        facing = -np.sign(np.einsum("qi,qi->q", normals, directions[hit]))
        normals = normals * facing[:, None]
        lux = self._direct_lux(points + LIFT_M * normals, normals)
        light[hit] = self._reflectances[triangle] * (lux / np.pi)[:, None]
        return light, hits.distance

    def _direct_lux(self, points: Float, normals: Float) -> Float:
        reach = self.lamp_m - points
        away = np.linalg.norm(reach, axis=1)
        cosine = np.maximum(np.einsum("qi,qi->q", normals, reach) / away, 0)
        return self.rays.is_visible(points, self.lamp_m) * self.intensity_cd * cosine / away**2

    def photographed(self, view: View) -> Float:
        """(H, W, 3) cd/m² of a photograph of the room in its lamp's light."""
        origin, directions = view.rays_world()
        rays = directions.reshape(-1, 3)
        light, _ = self.seen(np.broadcast_to(origin, rays.shape), rays)
        return light.reshape(*view.shape, 3)


def _walls(panels: list[tuple[tuple[float, float, float], list[Corner]]]) -> Geometry:
    """A material and a quadrangle each."""
    corners = np.array([quad for _, quad in panels], np.float64).reshape(-1, 3)
    first = 4 * np.arange(len(panels))[:, None]
    halves = [first + np.array(corner) for corner in ([0, 1, 2], [0, 2, 3])]
    return Geometry(
        corners,
        np.concatenate(halves).astype(np.int32),
        material_ids=np.tile(np.arange(len(panels), dtype=np.int32), 2),
        materials=tuple(Material(f"wall {n}", colour) for n, (colour, _) in enumerate(panels)),
    )


def _shell(
    low: Corner,
    high: Corner,
    sides: Corner,
    floor: Corner,
    ends: Corner,
    right: Corner | None = None,
) -> list[tuple[Corner, list[Corner]]]:
    """The six walls of a box; `right` is the colour of the wall at +X where it is another."""
    (a, b, c), (x, y, z) = low, high
    return [
        (sides, [(a, b, c), (a, y, c), (a, y, z), (a, b, z)]),
        (right or sides, [(x, b, c), (x, y, c), (x, y, z), (x, b, z)]),
        (floor, [(a, b, c), (x, b, c), (x, b, z), (a, b, z)]),
        (floor, [(a, y, c), (x, y, c), (x, y, z), (a, y, z)]),
        (ends, [(a, b, c), (x, b, c), (x, y, c), (a, y, c)]),
        (ends, [(a, b, z), (x, b, z), (x, y, z), (a, y, z)]),
    ]


def two_rooms(thickness_m: float = 0.1) -> LitRoom:
    """Two rooms and a wall of `thickness_m` ≥ 0 between them."""
    x, y, z = HALF_WIDTH_M, HEIGHT_M, DEPTH_M / 2
    panels = _shell((-x, 0, -z), (x, y, z), (0.7, 0.2, 0.2), (0.6, 0.6, 0.6), (0.2, 0.6, 0.25))
    for s in sorted({-thickness_m / 2, thickness_m / 2}):
        panels.append(((0.7, 0.7, 0.65), [(s, 0, -z), (s, y, -z), (s, y, z), (s, 0, z)]))
    return LitRoom(_walls(panels), np.array([-1.4, 1.7, 0.6]), 300.0)


def coloured_room() -> LitRoom:
    """A room of 3 × 3 × 3 m around the origin, open to no side; its lamp is below the ceiling."""
    panels = _shell(
        (-1.5, -1.5, -1.5), (1.5, 1.5, 1.5), (0.75, 0.06, 0.05),
        (0.6, 0.6, 0.6), (0.6, 0.6, 0.6),
        (0.06, 0.6, 0.08),
    )  # fmt: skip
    return LitRoom(_walls(panels), np.array([0.0, 1.1, 0.2]), 150.0)


def points_in(thickness_m: float, count: int, seed: int = 5) -> tuple[Float, Float]:
    """`count` points in each of `two_rooms`: (count, 3) in the lit one, in the dark one."""
    generator = np.random.default_rng(seed)
    low = np.array([thickness_m / 2, 0, -DEPTH_M / 2]) + CLEAR_M
    high = np.array([HALF_WIDTH_M, HEIGHT_M, DEPTH_M / 2]) - CLEAR_M
    lit, dark = generator.uniform(low, high, (2, count, 3))
    return lit * [-1, 1, 1], dark


def surfaces_of_dark_room(thickness_m: float, count: int, seed: int = 6) -> tuple[Float, Float]:
    """`count` points (count, 3) on the walls, floor and ceiling of the dark room; and normals."""
    generator = np.random.default_rng(seed)
    low = np.array([thickness_m / 2, 0, -DEPTH_M / 2])
    high = np.array([HALF_WIDTH_M, HEIGHT_M, DEPTH_M / 2])
    points = generator.uniform(low, high, (count, 3))
    rows, axis = np.arange(count), generator.integers(0, 3, count)
    upper = generator.integers(0, 2, count) == 1
    points[rows, axis] = np.where(upper, high[axis], low[axis])
    normals = np.zeros((count, 3))
    normals[rows, axis] = np.where(upper, -1.0, 1.0)
    return points, normals


def lattice(
    spacing_m: float = 1.0, turn_degrees: float = 17.0, shift: tuple[float, float] = (0.3, 0.1)
) -> Float:
    """(n, 3) places of a lattice turned around y and shifted (shares of the spacing in x and z).

    What lies outside `two_rooms`, or nearer than `CLEAR_M` to their outer walls, is left out.
    """
    steps = np.arange(-8, 9) * spacing_m
    count = max(2, round((HEIGHT_M - 0.4) / spacing_m) + 1)
    heights = np.linspace(0.2, HEIGHT_M - 0.2, count)
    x, y, z = np.meshgrid(steps + shift[0] * spacing_m, heights, steps + shift[1] * spacing_m)
    turn = np.radians(turn_degrees)
    across, along = np.cos(turn) * x + np.sin(turn) * z, np.cos(turn) * z - np.sin(turn) * x
    places = np.stack([across, y, along], axis=-1).reshape(-1, 3)
    inside = np.abs(places[:, 0]) <= HALF_WIDTH_M - CLEAR_M
    return places[inside & (np.abs(places[:, 2]) <= DEPTH_M / 2 - CLEAR_M)]


def volume_of(room: LitRoom, places: Float, *, cube_size: int = 32, side: int = 16) -> ProbeVolume:
    """Probes captured at `places` (n, 3), with distances of `side` texels."""
    coefficients, distances = room.captured(places, cube_size)
    mean, mean_square = distance_map(distances, side, far_m=FAR_M)
    return plain_volume(places, coefficients, distances=Distances(mean, mean_square, FAR_M))
