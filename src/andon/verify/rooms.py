"""The furnished test room: a procedural scene in which shadows, slants and curves all occur.

::

        ┌───────────── 5 m (x) ─────────────┐        y up, 3 m high; the origin is on the floor,
        │  shelf                    pillar  │        under the middle of the ceiling
        │                                   │
        │  boxes   table, three     board   │ 4 m (z)
        │          chairs, vase     torus   │
        │ camera              ball   ramp   │
        └───────────────────────────────────┘

Every object is a closed mesh; the room's shell is six inward-facing panels. Things that stand on
something are *sunk* into it by a few millimetres instead of touching it: contact in one plane
would fight for depth, a gap would let a slit of light through. Layout is fixed, sizes, turns and
reflectances come from the seed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import LUMINANCE_WEIGHTS, Geometry
from andon.spaces import View, look_at, pinhole_view
from andon.verify.furniture import Part, room_parts
from andon.verify.solids import Solid, facet_normals

__all__ = [
    "CLEAR_M",
    "FREE_ZONE",
    "RoomLamp",
    "camera_in",
    "furnished_room",
    "lamps_in",
    "random_view",
]

Float = NDArray[np.float64]

# Lamps keep this distance from every surface.
CLEAR_M = 0.15
# No furniture in here (low corner, high corner, metres): cameras may stand anywhere inside.
FREE_ZONE = ((-1.6, 1.2, -0.9), (1.6, 2.2, 1.5))


@dataclass(frozen=True)
class RoomLamp:
    """A point lamp in free air.

    Attributes
    ----------
    position : (3,) float64 metres, world.
    intensity_cd : > 0, the photometric value.
    colour : (3,) RGB factors with 0.2126 R + 0.7152 G + 0.0722 B = 1.
    """

    position: Float
    intensity_cd: float
    colour: tuple[float, float, float]

    @property
    def intensity_rgb_cd(self) -> Float:
        """(3,) candela per channel."""
        return self.intensity_cd * np.array(self.colour)


def furnished_room(min_triangles: int = 12_000, seed: int = 7, *, smooth: bool = False) -> Geometry:
    """A furnished room of 5 × 3 × 4 m with at least `min_triangles` triangles.

    Parameters
    ----------
    min_triangles : 1 … 1,000,000; curved things and walls are cut finer until there are enough
        (the coarsest room has about 3,800).
    seed : of sizes, turns and reflectances; the layout stays.
    smooth : False gives no normals (flat shading by the geometry); True gives the curved things
        interpolated unit normals and splits the vertices of the angular ones.
    """
    if not 1 <= min_triangles <= 1_000_000:
        raise InputError(f"must be 1…1,000,000, got {min_triangles}", field="min_triangles")
    detail = 0.25
    parts = room_parts(detail, seed)
    while (count := _count(parts)) < min_triangles:
        # Counts grow with detail²; the extra 2 % keeps rounding from stalling the search.
        detail *= max(1.02, float(np.sqrt(min_triangles / count)))
        parts = room_parts(detail, seed)
    return _joined(parts, smooth)


def _count(parts: list[Part]) -> int:
    return sum(len(part.solid.triangles) for part in parts)


def _joined(parts: list[Part], smooth: bool) -> Geometry:
    materials = list({part.material.name: part.material for part in parts}.values())
    number = {material.name: index for index, material in enumerate(materials)}
    pieces = [_with_normals(part.solid) if smooth else (part.solid, None) for part in parts]
    starts = np.cumsum([0, *(len(solid.positions) for solid, _ in pieces)])
    return Geometry(
        positions=np.concatenate([solid.positions for solid, _ in pieces]),
        triangles=np.concatenate(
            [
                solid.triangles + np.int32(start)
                for (solid, _), start in zip(pieces, starts[:-1], strict=True)
            ]
        ),
        normals=np.concatenate([n for _, n in pieces if n is not None]) if smooth else None,
        material_ids=np.concatenate(
            [np.full(len(p.solid.triangles), number[p.material.name], np.int32) for p in parts]
        ),
        materials=tuple(materials),
    )


def _with_normals(solid: Solid) -> tuple[Solid, Float]:
    """The solid and its unit normals: averaged by area where curved, split where angular."""
    facets = facet_normals(solid.positions, solid.triangles)
    if solid.curved:
        normals = np.zeros_like(solid.positions)
        np.add.at(normals, solid.triangles.reshape(-1), np.repeat(facets, 3, axis=0))
    else:
        normals = np.repeat(facets, 3, axis=0)
        corners = np.arange(len(normals), dtype=np.int32).reshape(-1, 3)
        solid = Solid(solid.positions[solid.triangles.reshape(-1)], corners)
    return solid, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def camera_in(room: Geometry, /, width: int = 1280, height: int = 720) -> View:
    """A pinhole camera in the front left corner, looking across the room; it sees nothing else.

    The horizontal angle of view is 75°, the principal point is the picture's centre.
    """
    low, high = room.positions.min(axis=0), room.positions.max(axis=0)
    eye = low + (high - low) * [0.06, 0.55, 0.94]
    target = low + (high - low) * [0.66, 0.24, 0.32]
    focal = width / 2 / np.tan(np.radians(75 / 2))
    return pinhole_view(width, height, focal, look_at(eye, target))


def random_view(seed: int, width: int = 160, height: int = 90) -> View:
    """A pinhole camera at a random place of `FREE_ZONE`, turned anywhere, of 40°…100° of view."""
    generator = np.random.default_rng(seed)
    eye = generator.uniform(*FREE_ZONE)
    heading, rise = generator.uniform(-np.pi, np.pi), generator.uniform(-1.0, 1.0)
    forward = [np.cos(rise) * np.sin(heading), np.sin(rise), -np.cos(rise) * np.cos(heading)]
    focal = width / 2 / np.tan(np.radians(generator.uniform(40, 100) / 2))
    return pinhole_view(width, height, focal, look_at(eye, eye + forward))


def lamps_in(room: Geometry, n: int, /, seed: int = 11) -> list[RoomLamp]:
    """`n` (1…16) point lamps in free air, ≥ `CLEAR_M` from any surface, spread over the room.

    The first lamps of a longer list are those of a shorter one. Intensities are 20…120 cd.
    """
    if not 1 <= n <= 16:
        raise InputError(f"must be 1…16 lamps, got {n}", field="n")
    generator = np.random.default_rng(seed)
    low, high = room.positions.min(axis=0) + CLEAR_M, room.positions.max(axis=0) - CLEAR_M
    candidates = generator.uniform(low, high, (64, 3))
    free = candidates[[_in_free_air(room, point) for point in candidates]]
    if len(free) < 16:
        raise InputError(
            f"room has too little free air for lamps, {len(free)} places found",
            field="room",
            remedy="use furnished_room()",
        )
    return [_lamp(position, generator) for position in _spread(free)[:n]]


def _lamp(position: Float, generator: np.random.Generator) -> RoomLamp:
    factors = generator.uniform(0.4, 1.0, 3)
    red, green, blue = (factors / (factors @ LUMINANCE_WEIGHTS)).tolist()
    return RoomLamp(position, float(generator.uniform(20, 120)), (red, green, blue))


def _spread(points: Float) -> Float:
    """16 of the points, each the farthest from those before it."""
    chosen = [0]
    distance = np.linalg.norm(points - points[0], axis=1)
    while len(chosen) < 16:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return points[chosen]


def _in_free_air(room: Geometry, point: Float) -> bool:
    """Inside the shell (winding −1), in no object (each adds +1) and clear of every surface."""
    corners = room.positions[room.triangles] - point
    near = (corners.min(axis=1) < CLEAR_M).all(axis=1) & (corners.max(axis=1) > -CLEAR_M).all(
        axis=1
    )
    return _distance(corners[near]) >= CLEAR_M and abs(_winding(corners) + 1) < 0.5


def _winding(corners: Float) -> float:
    """How often the triangles (m, 3, 3) wind round the origin: solid angle / 4π.

    Van Oosterom & Strackee 1983, eq. 8.
    """
    a, b, c = corners.transpose(1, 0, 2)
    la, lb, lc = np.linalg.norm(corners, axis=2).T
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = (
        la * lb * lc
        + np.einsum("ij,ij->i", a, b) * lc
        + np.einsum("ij,ij->i", b, c) * la
        + np.einsum("ij,ij->i", c, a) * lb
    )
    return float(2 * np.arctan2(volume, below).sum() / (4 * np.pi))


def _distance(corners: Float) -> float:
    """Metres from the origin to the nearest of the triangles (m, 3, 3)."""
    edges = np.roll(corners, -1, axis=1) - corners
    length2 = np.einsum("ijk,ijk->ij", edges, edges)
    along = np.clip(-np.einsum("ijk,ijk->ij", corners, edges) / length2, 0, 1)
    nearest = np.linalg.norm(corners + along[..., None] * edges, axis=2).min(initial=np.inf)
    normals = np.cross(edges[:, 0], edges[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    height = np.einsum("ij,ij->i", corners[:, 0], normals)
    foot = height[:, None, None] * normals[:, None, :] - corners
    inside = (np.einsum("ijk,ijk->ij", np.cross(edges, foot), normals[:, None, :]) >= 0).all(axis=1)
    return float(min(nearest, np.abs(height[inside]).min(initial=np.inf)))
