"""The skeleton: where its joints are while it stands, and where a pose takes them.

Metres; +Y up; it faces +Z, so its left side is +X. At rest nothing is turned.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["JOINTS", "NAMES", "REST", "parent_of", "posed", "quaternion", "rotation"]

Float = NDArray[np.float64]

# Name: (parent, place). Sides are mirrored below.
_MIDDLE = {
    "hips": (None, (0.0, 0.93, 0.0)),
    "spine": ("hips", (0.0, 1.06, 0.0)),
    "chest": ("spine", (0.0, 1.24, -0.005)),
    "neck": ("chest", (0.0, 1.48, -0.012)),
    "head": ("neck", (0.0, 1.56, 0.0)),
}
_LEFT = {
    "upper arm": ("chest", (0.178, 1.415, -0.012)),
    "forearm": ("upper arm", (0.218, 1.135, -0.018)),
    "hand": ("forearm", (0.240, 0.885, 0.006)),
    "thigh": ("hips", (0.092, 0.925, 0.0)),
    "shin": ("thigh", (0.098, 0.500, 0.010)),
    "foot": ("shin", (0.102, 0.085, -0.012)),
}


def _joints() -> dict[str, tuple[str | None, tuple[float, float, float]]]:
    joints = dict(_MIDDLE)
    for side, sign in (("left", 1), ("right", -1)):
        for name, (parent, (x, y, z)) in _LEFT.items():
            above = parent if parent in _MIDDLE else f"{side} {parent}"
            joints[f"{side} {name}"] = (above, (sign * x, y, z))
    return joints


JOINTS = _joints()
NAMES = tuple(JOINTS)
REST: Float = np.array([place for _, place in JOINTS.values()])


def parent_of(name: str) -> int:
    """Number of the parent; −1: none."""
    parent = JOINTS[name][0]
    return -1 if parent is None else NAMES.index(parent)


def quaternion(axis: str, angle_degrees: Float | float) -> Float:
    """(..., 4) x, y, z, w of turns around one axis."""
    half = np.radians(np.asarray(angle_degrees, float)) / 2
    turns = np.zeros((*half.shape, 4))
    turns[..., "xyz".index(axis)] = np.sin(half)
    turns[..., 3] = np.cos(half)
    return turns


def rotation(turns: Float) -> Float:
    """(..., 3, 3) of unit quaternions (..., 4)."""
    x, y, z, w = np.moveaxis(turns, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def posed(turns: dict[str, Float], hips: Float) -> Float:
    """(k, j, 4, 4) world_from_joint of k poses: turns (k, 4) of some joints, hips (k, 3)."""
    count = len(hips)
    world = np.tile(np.eye(4), (count, len(NAMES), 1, 1))
    for number, name in enumerate(NAMES):
        parent = parent_of(name)
        local = np.tile(np.eye(4), (count, 1, 1))
        if name in turns:
            local[:, :3, :3] = rotation(turns[name])
        local[:, :3, 3] = hips if parent < 0 else REST[number] - REST[parent]
        world[:, number] = local if parent < 0 else world[:, parent] @ local
    return world
