"""The skin: tubes of elliptic rings, each ring bound to one joint or blended between two."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from walker.bones import NAMES, REST

__all__ = ["Skin", "skin"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Profile = list[tuple[float, ...]]

# Half of the length over which two joints share the skin, metres.
BLEND_M = 0.055

# Rings from below: height, middle z, radius across, radius along z.
TORSO: Profile = [
    (0.840, 0.000, 0.050, 0.055), (0.860, 0.000, 0.098, 0.085), (0.895, -0.004, 0.140, 0.108),
    (0.940, -0.006, 0.157, 0.116), (0.990, -0.004, 0.151, 0.108), (1.045, 0.000, 0.136, 0.097),
    (1.105, 0.003, 0.127, 0.092), (1.170, 0.005, 0.133, 0.097), (1.240, 0.006, 0.147, 0.106),
    (1.310, 0.004, 0.162, 0.111), (1.370, -0.002, 0.174, 0.105), (1.415, -0.008, 0.176, 0.090),
    (1.447, -0.011, 0.146, 0.072), (1.472, -0.012, 0.092, 0.060), (1.490, -0.012, 0.050, 0.046),
]  # fmt: skip
HEAD: Profile = [
    (1.430, -0.014, 0.058, 0.056), (1.465, -0.012, 0.053, 0.053), (1.505, -0.008, 0.050, 0.052),
    (1.535, 0.002, 0.052, 0.062), (1.556, 0.012, 0.058, 0.078), (1.585, 0.016, 0.067, 0.090),
    (1.620, 0.014, 0.074, 0.096), (1.655, 0.010, 0.077, 0.098), (1.688, 0.006, 0.074, 0.094),
    (1.716, 0.002, 0.064, 0.082), (1.735, 0.000, 0.046, 0.060), (1.746, 0.000, 0.023, 0.030),
]  # fmt: skip
# Share of the way along thigh and shin (0 … 1 … 2), radius.
LEG: Profile = [
    (-0.10, 0.060), (-0.04, 0.080), (0.06, 0.088), (0.20, 0.086), (0.36, 0.080), (0.54, 0.072),
    (0.70, 0.065), (0.82, 0.060), (0.90, 0.057), (0.96, 0.056), (1.00, 0.055), (1.04, 0.053),
    (1.10, 0.052), (1.20, 0.056), (1.32, 0.057), (1.48, 0.052), (1.64, 0.044), (1.78, 0.038),
    (1.90, 0.035), (1.98, 0.035), (2.06, 0.030), (2.10, 0.018),
]  # fmt: skip
# Along upper arm, forearm and hand (0 … 1 … 2 … 3): radius across and along z.
ARM: Profile = [
    (-0.17, 0.026, 0.030), (-0.12, 0.044, 0.048), (-0.03, 0.054, 0.058), (0.10, 0.052, 0.056),
    (0.30, 0.046, 0.048), (0.55, 0.041, 0.043), (0.78, 0.037, 0.039), (0.92, 0.035, 0.037),
    (1.00, 0.034, 0.036), (1.10, 0.036, 0.038), (1.28, 0.037, 0.038), (1.55, 0.032, 0.033),
    (1.80, 0.025, 0.028), (1.96, 0.022, 0.027), (2.08, 0.022, 0.033), (2.28, 0.022, 0.041),
    (2.55, 0.020, 0.040), (2.80, 0.016, 0.033), (2.95, 0.010, 0.021),
]  # fmt: skip
HAND_M = 0.175
# Along the foot: z from the ankle, height of the top, half width.
FOOT: Profile = [
    (-0.062, 0.040, 0.014), (-0.054, 0.062, 0.030), (-0.030, 0.084, 0.038), (0.005, 0.092, 0.040),
    (0.045, 0.078, 0.041), (0.090, 0.060, 0.045), (0.130, 0.047, 0.047), (0.165, 0.038, 0.042),
    (0.188, 0.030, 0.029), (0.197, 0.020, 0.014),
]  # fmt: skip


@dataclass(frozen=True)
class Skin:
    """One mesh: positions, normals (n, 3), triangles (m, 3), joints, weights (n, 4)."""

    positions: Float
    normals: Float
    triangles: Int
    joints: Int
    weights: Float


def _tube(rings: Float) -> tuple[Float, Int]:
    """Vertices and triangles of rings (r, s, 3), closed by a point at either end.

    Rings run counter-clockwise as seen from the end where they go to.
    """
    count, sides = rings.shape[:2]
    vertices = np.concatenate([rings.reshape(-1, 3), rings[[0, -1]].mean(axis=1)])
    ring, side = np.meshgrid(np.arange(count - 1), np.arange(sides), indexing="ij")
    a, b = ring * sides + side, ring * sides + (side + 1) % sides
    c, d = b + sides, a + sides
    first, last = np.arange(sides), (count - 1) * sides + np.arange(sides)
    start, end = count * sides, count * sides + 1
    faces = [
        np.stack([a, b, c], -1).reshape(-1, 3),
        np.stack([a, c, d], -1).reshape(-1, 3),
        np.stack([np.roll(first, -1), first, np.full(sides, start)], -1),
        np.stack([last, np.roll(last, -1), np.full(sides, end)], -1),
    ]
    return vertices, np.concatenate(faces)


def _normals(vertices: Float, triangles: Int) -> Float:
    """Unit (n, 3): of the triangles around, by their areas."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normals = np.zeros_like(vertices)
    for side in range(3):
        np.add.at(normals, triangles[:, side], np.cross(b - a, c - a))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _circle(sides: int) -> tuple[Float, Float]:
    turn = np.arange(sides) / sides * 2 * np.pi
    return np.cos(turn), np.sin(turn)


def _upright(profile: Profile, sides: int) -> Float:
    """Horizontal rings (r, s, 3) of heights, middles and radii, from below."""
    height, middle, across, along = np.array(profile).T[:, :, None]
    cos, sin = _circle(sides)
    x, z = across * cos, middle - along * sin
    return np.stack([x, np.broadcast_to(height, x.shape), z], axis=-1)


def _limb(path: Float, profile: Profile, sides: int) -> Float:
    """Rings (r, s, 3) along a path of joints (j, 3) that hangs down, from below."""
    table = np.array(profile)[::-1]
    share, radii = table[:, 0], table[:, 1:]
    bone = np.clip(share.astype(int), 0, len(path) - 2)
    middle = path[bone] + (share - bone)[:, None] * (path[bone + 1] - path[bone])
    cos, sin = _circle(sides)
    across = radii[:, :1] * cos
    along = -radii[:, -1:] * sin
    flat = np.stack([across, np.zeros_like(across), along], axis=-1)
    return middle[:, None] + flat


def _sole(ankle: Float, sides: int) -> Float:
    """Rings (r, s, 3) from heel to toe, flat below."""
    z, top, half = np.array(FOOT).T[:, :, None]
    cos, sin = _circle(sides)
    x = half * np.sign(cos) * np.abs(cos) ** 0.8
    y = np.maximum(top * (0.42 + 0.58 * sin), 0.0)
    return np.stack([ankle[0] + x, y, np.broadcast_to(ankle[2] + z, x.shape)], axis=-1)


def _bound(heights: Float, names: list[str], rising: bool) -> tuple[Int, Float]:
    """Joints and weights (n, 4) of vertices at `heights` along joints that rise, or descend.

    Around the height of each joint after the first its skin is shared with the one before, evenly
    at the joint itself.
    """
    numbers = [NAMES.index(name) for name in names]
    joints = np.zeros((len(heights), 4), np.int64)
    weights = np.zeros((len(heights), 4))
    joints[:, 0], weights[:, 0] = numbers[0], 1.0
    for before, after in pairwise(numbers):
        beyond = (heights - REST[after, 1]) * (1 if rising else -1)
        share = np.clip(beyond / BLEND_M / 2 + 0.5, 0, 1)
        share = share * share * (3 - 2 * share)
        mine = share > 0
        joints[mine, 0], joints[mine, 1] = before, after
        weights[mine, 0], weights[mine, 1] = 1 - share[mine], share[mine]
    # Whole vertices have one joint, in the first place.
    done = weights[:, 1] >= 1
    joints[done, 0], weights[done, 0], weights[done, 1] = joints[done, 1], 1.0, 0.0
    joints[weights == 0] = 0
    return joints, weights


def skin() -> Skin:
    """All of it as one mesh."""
    at = dict(zip(NAMES, REST, strict=True))
    pieces: list[tuple[Float, Int, Int, Float]] = []

    def add(rings: Float, bound: tuple[Int, Float] | None, joints: list[str], rising: bool) -> None:
        vertices, triangles = _tube(rings)
        pieces.append((vertices, triangles, *(bound or _bound(vertices[:, 1], joints, rising))))

    add(_upright(TORSO, 18), None, ["hips", "spine", "chest"], True)
    add(_upright(HEAD, 16), None, ["chest", "neck", "head"], True)
    for side in ("left", "right"):
        thigh, shin, foot = (at[f"{side} {name}"] for name in ("thigh", "shin", "foot"))
        legs = ["hips", f"{side} thigh", f"{side} shin", f"{side} foot"]
        add(_limb(np.array([thigh, shin, foot]), LEG, 14), None, legs, False)
        upper, fore, hand = (at[f"{side} {name}"] for name in ("upper arm", "forearm", "hand"))
        down = (hand - fore) / np.linalg.norm(hand - fore)
        tip = hand + HAND_M * down
        arms = ["chest", f"{side} upper arm", f"{side} forearm", f"{side} hand"]
        add(_limb(np.array([upper, fore, hand, tip]), ARM, 12), None, arms, False)
        rings = _sole(foot, 12)
        count = rings.shape[0] * rings.shape[1] + 2
        joints, weights = np.zeros((count, 4), np.int64), np.zeros((count, 4))
        joints[:, 0], weights[:, 0] = NAMES.index(f"{side} foot"), 1.0
        add(rings[::-1], (joints, weights), [], False)
    starts = np.cumsum([0, *(len(vertices) for vertices, *_ in pieces)])
    return Skin(
        np.concatenate([vertices for vertices, *_ in pieces]),
        np.concatenate([_normals(vertices, triangles) for vertices, triangles, *_ in pieces]),
        np.concatenate([p[1] + start for p, start in zip(pieces, starts, strict=False)]),
        np.concatenate([p[2] for p in pieces]),
        np.concatenate([p[3] for p in pieces]),
    )
