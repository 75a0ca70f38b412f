"""Makes the meshes of examples/water: a pool by night, a steel ball and a brushed bowl.

    python tools/make_water.py examples/water

``pool.glb`` is the stone around the water, with a wall, two posts and two plinths; ``water.glb``
one level rectangle; ``ball.glb`` and ``bowl.glb`` are surfaces of revolution with smooth normals.
Metres, +Y up, y = 0 on the paving.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from glb import INDICES, VERTICES, Glb
from make_basic import box, sheet
from numpy.typing import NDArray

Float = NDArray[np.float64]
Solid = tuple[Float, Float, NDArray[np.int64]]

LICENCE = "CC0 1.0: no rights reserved"
# Half the pool's width, its ends along z, the water's level, and the depth of its basin.
HALF_M, FAR_M, NEAR_M, LEVEL_M, FLOOR_M = 3.0, -5.0, 2.6, -0.12, -0.8
STONE = {
    "name": "stone",
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.34, 0.31, 0.27, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 1.0,
    },
}
PLASTER = {
    "name": "plaster",
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 0.42, 0.33, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 1.0,
    },
}
IRON = {
    "name": "iron",
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.06, 0.06, 0.06, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 1.0,
    },
}
# What scatters in the water itself: little.
WATER = {
    "name": "water",
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.012, 0.025, 0.022, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.0,
    },
}
# Reflectances straight ahead: steel and brass (Rec.709 from their optical constants, rounded).
STEEL = {
    "name": "polished steel",
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.58, 0.56, 0.54, 1.0],
        "metallicFactor": 1.0,
        "roughnessFactor": 0.12,
    },
}
BRASS = {
    "name": "brushed brass",
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.89, 0.71, 0.34, 1.0],
        "metallicFactor": 1.0,
        "roughnessFactor": 0.32,
    },
}


def boxes() -> list[tuple[int, Float, Float]]:
    """Material, lowest and highest corner of the stone around the water."""
    w, far, near = HALF_M, FAR_M, NEAR_M

    def entry(material: int, low: Any, high: Any) -> tuple[int, Float, Float]:
        return material, np.array(low, float), np.array(high, float)

    return [
        entry(0, (-w - 5, FLOOR_M, far), (-w, 0, near)),
        entry(0, (w, FLOOR_M, far), (w + 5, 0, near)),
        entry(0, (-w - 5, FLOOR_M, far - 3), (w + 5, 0, far)),
        entry(0, (-w - 5, FLOOR_M, near), (w + 5, 0, near + 4)),
        entry(1, (-w - 5, 0, far - 2.2), (w + 5, 1.6, far - 1.9)),
        *(entry(2, (x - 0.03, 0, far - 0.53), (x + 0.03, 2.1, far - 0.47)) for x in (-1.7, 1.5)),
        *(entry(0, (x - 0.22, 0, 3.0), (x + 0.22, 0.5, 3.44)) for x in (-0.8, 0.82)),
    ]


def turned(radius: Float, height: Float, sides: int) -> Solid:
    """A surface of revolution about +Y from its profile (n,), outwards, with smooth normals."""
    turn = np.arange(sides + 1) * (2 * np.pi / sides)
    around = np.stack([np.sin(turn), 0 * turn, np.cos(turn)], axis=1)
    up = np.array([0.0, 1, 0])
    positions = radius[:, None, None] * around + (height[:, None] * up)[:, None]
    slope = np.gradient(radius), np.gradient(height)
    normals = slope[1][:, None, None] * around - slope[0][:, None, None] * up
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    row = np.arange(len(radius) - 1)[:, None] * (sides + 1)
    a = (row + np.arange(sides)).ravel()
    b, c, d = a + 1, a + sides + 2, a + sides + 1
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return positions.reshape(-1, 3), normals.reshape(-1, 3), faces


def ball(radius: float) -> Solid:
    """A ball that stands on y = 0."""
    turn = np.linspace(0, np.pi, 49)
    return turned(radius * np.sin(turn), radius * (1 - np.cos(turn)), 72)


def bowl() -> Solid:
    """A round vase on y = 0, from its foot over its belly to its lip and down inside."""
    turn = np.linspace(0.12 * np.pi, 0.80 * np.pi, 33)
    outside = 0.27 * np.sin(turn), 0.25 - 0.25 * np.cos(turn)
    low = outside[1][0]
    inside = 0.97 * outside[0][::-1], outside[1][::-1]
    radius = np.concatenate([outside[0], inside[0]])
    height = np.concatenate([outside[1], inside[1]]) - low
    return turned(radius, height, 72)


def write(path: Path, materials: list[Any], solids: list[tuple[int, Solid]]) -> None:
    """One mesh with a primitive for each solid."""
    file = Glb("Andon tools/make_water.py", LICENCE)
    primitives = [
        {
            "attributes": {
                "POSITION": file.accessor(positions, "VEC3", target=VERTICES),
                "NORMAL": file.accessor(normals, "VEC3", target=VERTICES),
            },
            "indices": file.accessor(faces.ravel(), "SCALAR", "<u2", INDICES),
            "material": material,
        }
        for material, (positions, normals, faces) in solids
    ]
    file.document |= {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": path.stem, "mesh": 0}],
        "meshes": [{"name": path.stem, "primitives": primitives}],
        "materials": materials,
    }
    file.write(path)


def main() -> None:
    """Writes the four files."""
    parser = argparse.ArgumentParser(description="Makes the meshes of examples/water.")
    parser.add_argument("out", type=Path, help="folder to write to")
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    stone = [(material, box(low, high)) for material, low, high in boxes()]
    write(folder / "pool.glb", [STONE, PLASTER, IRON], stone)
    corner = np.array([-HALF_M, LEVEL_M, NEAR_M])
    along, across = np.array([2 * HALF_M, 0, 0]), np.array([0, 0, FAR_M - NEAR_M])
    points, faces = sheet(corner, along, across)
    level = points, np.broadcast_to([0.0, 1, 0], points.shape), faces
    write(folder / "water.glb", [WATER], [(0, level)])
    write(folder / "ball.glb", [STEEL], [(0, ball(0.3))])
    write(folder / "bowl.glb", [BRASS], [(0, bowl())])


if __name__ == "__main__":
    main()
