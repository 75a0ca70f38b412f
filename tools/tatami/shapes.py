"""Parts of the room: triangles with texture coordinates and one material each."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.verify.solids import Solid, facet_normals

Float = NDArray[np.float64]

# Of the textures that are laid by metres: how much one repeat covers, across and along the grain.
TILE_M = {
    "wood": (0.32, 1.28),
    "plaster": (0.60, 0.60),
    "paper": (0.50, 0.50),
    "cloth": (0.12, 0.12),
}
EVERY_SIDE = "+x -x +y -y +z -z"


@dataclass(frozen=True)
class Part:
    """`positions` (n, 3), `triangles` (m, 3), `uvs` (n, 2), `normals` (n, 3) or None for flat."""

    material: str
    positions: Float
    triangles: NDArray[np.int32]
    uvs: Float
    normals: Float | None = None

    def moved(self, at: ArrayLike, *, yaw_degrees: float = 0.0) -> Part:
        """Turned about y, then moved by `at` (3,)."""
        sine, cosine = np.sin(np.radians(yaw_degrees)), np.cos(np.radians(yaw_degrees))
        turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
        normals = None if self.normals is None else self.normals @ turn.T
        return replace(self, positions=self.positions @ turn.T + np.asarray(at), normals=normals)


def quad(
    material: str, origin: ArrayLike, along: ArrayLike, up: ArrayLike, *, uv: ArrayLike = (0, 0)
) -> Part:
    """A parallelogram that faces along × up; the texture's rows run `along`, laid by metres."""
    a, b = np.asarray(along, float), np.asarray(up, float)
    corners = np.asarray(origin, float) + np.array([0 * a, a, a + b, b])
    size = np.array([np.linalg.norm(a), np.linalg.norm(b)]) / _tile(material)
    uvs = np.asarray(uv) + size * np.array([[0, 1], [1, 1], [1, 0], [0, 0]])
    return Part(material, corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), uvs)


def picture(material: str, origin: ArrayLike, along: ArrayLike, up: ArrayLike) -> Part:
    """A parallelogram that shows its texture once."""
    part = quad(material, origin, along, up)
    return replace(part, uvs=np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float))


def box(material: str, low: ArrayLike, high: ArrayLike, *, sides: str = EVERY_SIDE) -> Part:
    """A box with the grain along its longest side; only `sides` are made."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    grain = int(np.argmax(high - low))
    # Boards from other places of the log: where a thing stands decides, so nothing is random.
    shift = np.modf(np.abs(low @ np.array([[7.13, 3.7], [5.31, 9.1], [8.77, 4.3]])))[0]
    faces = [_side(material, low, high, side, grain, shift) for side in sides.split()]
    return joined(faces)


def _side(
    material: str, low: Float, high: Float, side: str, grain: int, shift: NDArray[np.float64]
) -> Part:
    axis, sign = "xyz".index(side[1]), 1 if side[0] == "+" else -1
    first, second = (axis + 1) % 3, (axis + 2) % 3
    origin, extent = low.copy(), high - low
    origin[axis] = high[axis] if sign > 0 else low[axis]
    if sign < 0:
        first, second = second, first
    along, up = np.eye(3)[first] * extent[first], np.eye(3)[second] * extent[second]
    part = quad(material, origin, along, up, uv=shift)
    if first != grain:
        return part
    # The texture's grain is upright: turn it to the face's other direction.
    size = np.array([extent[second], extent[first]]) / _tile(material)
    uvs = shift + size * np.array([[0, 1], [0, 0], [1, 0], [1, 1]])
    return replace(part, uvs=uvs)


def _tile(material: str) -> Float:
    return np.array(TILE_M.get(material.split(".")[0], (1.0, 1.0)))


def joined(parts: list[Part]) -> Part:
    """Parts of one material as one."""
    starts = np.cumsum([0, *(len(part.positions) for part in parts[:-1])])
    triangles = [part.triangles + start for part, start in zip(parts, starts, strict=True)]
    smooth = parts[0].normals is not None
    return Part(
        parts[0].material,
        np.concatenate([part.positions for part in parts]),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate([part.uvs for part in parts]),
        np.concatenate([part.normals for part in parts if part.normals is not None])
        if smooth
        else None,
    )


def smooth(material: str, solid: Solid) -> Part:
    """A curved solid with its vertices' normals, its texture laid from above."""
    facets = facet_normals(solid.positions, solid.triangles)
    normals = np.zeros_like(solid.positions)
    for corner in range(3):
        np.add.at(normals, solid.triangles[:, corner], facets)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.maximum(length, 1e-30)
    uvs = solid.positions[:, [0, 2]] / _tile(material)
    return Part(material, solid.positions, solid.triangles, uvs, normals)


def disc(material: str, radius: float, thick: float, segments: int = 72) -> Part:
    """A round board about y, from y = 0 up to `thick`: flat faces, smooth rim."""
    turn = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    ring = np.stack([radius * np.cos(turn), 0 * turn, -radius * np.sin(turn)], axis=-1)
    out = ring / radius
    i = np.arange(segments, dtype=np.int32)
    j = (i + 1) % segments
    faces = []
    for height, sign in ((thick, 1), (0.0, -1)):
        centre = np.array([[0.0, height, 0.0]])
        points = np.concatenate([centre, ring + centre])
        fan = np.stack([0 * i, i + 1, j + 1], axis=-1)[:, ::sign]
        normals = np.tile([0.0, sign, 0.0], (len(points), 1))
        faces.append(Part(material, points, fan, points[:, [2, 0]] / _tile(material), normals))
    sides = np.concatenate([ring, ring + np.array([0, thick, 0])])
    rim = np.concatenate(
        [np.stack([i, j, j + segments], -1), np.stack([i, j + segments, i + segments], -1)]
    )
    around = np.stack([sides[:, 1], np.tile(turn * radius, 2)], -1)
    if thick > radius:  # a log: its grain is upright
        around = around[:, ::-1]
    uvs = around / _tile(material)
    faces.append(Part(material, sides, rim, uvs, np.concatenate([out, out])))
    return joined(faces)
