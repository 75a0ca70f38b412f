"""Makes examples/basic/room.glb: the paper's scene Basic, walls in red, green and blue, rebuilt.

    python tools/make_basic.py examples/basic

A floor of 8 m × 8 m, a red wall on the left, a green one at the back, a blue one on the right, all
3 m high, open in front and above, and a white column and a block that hide things from each other.
Walls are boxes, so that they are closed and have an inside; what stands on the floor starts at it.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from glb import INDICES, VERTICES, Glb
from numpy.typing import NDArray

Float = NDArray[np.float64]

HALF_M, HEIGHT_M, WALL_M = 4.0, 3.0, 0.2
# Side of the patches that flat surfaces are cut into, metres: light at vertices, and probes off
# vertices, need some.
PATCH_M = 1.0
# Diffuse reflectances, linear: paint of saturated colours, and whitewash.
REFLECTANCES = {
    "floor": (0.48, 0.48, 0.47),
    "red": (0.63, 0.07, 0.06),
    "green": (0.10, 0.48, 0.11),
    "blue": (0.07, 0.13, 0.58),
    "white": (0.75, 0.75, 0.73),
}


def sheet(corner: Float, along: Float, across: Float) -> tuple[Float, NDArray[np.int64]]:
    """Positions (n, 3) and triangles (m, 3) of a parallelogram in patches; its normal is
    along × across."""
    columns, rows = (max(1, round(float(np.linalg.norm(v)) / PATCH_M)) for v in (along, across))
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    positions = corner + u.reshape(-1, 1) * along + v.reshape(-1, 1) * across
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    a, b, c, d = first, first + 1, first + columns + 2, first + columns + 1
    return positions, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def box(low: Float, high: Float) -> tuple[Float, Float, NDArray[np.int64]]:
    """Positions, normals and triangles of a closed box, faces outwards."""
    positions, normals, triangles = [], [], []
    count = 0
    for axis in range(3):
        for side in (0, 1):
            first, second = (axis + 1) % 3, (axis + 2) % 3
            if side == 0:
                first, second = second, first
            corner = low.copy()
            corner[axis] = (low, high)[side][axis]
            along, across = np.zeros(3), np.zeros(3)
            along[first], across[second] = (high - low)[first], (high - low)[second]
            points, faces = sheet(corner, along, across)
            normal = np.zeros(3)
            normal[axis] = 2 * side - 1
            positions.append(points)
            normals.append(np.broadcast_to(normal, points.shape))
            triangles.append(faces + count)
            count += len(points)
    return np.concatenate(positions), np.concatenate(normals), np.concatenate(triangles)


def parts() -> list[tuple[str, str, Float, Float]]:
    """Name, material, lowest and highest corner of each box, metres."""
    h, t, y = HALF_M, WALL_M, HEIGHT_M

    def entry(name: str, material: str, low: Any, high: Any) -> tuple[str, str, Float, Float]:
        return name, material, np.array(low, float), np.array(high, float)

    return [
        entry("floor", "floor", (-h - t, -t, -h - t), (h + t, 0, h)),
        entry("left wall", "red", (-h - t, 0, -h), (-h, y, h)),
        entry("back wall", "green", (-h - t, 0, -h - t), (h + t, y, -h)),
        entry("right wall", "blue", (h, 0, -h), (h + t, y, h)),
        entry("column", "white", (-0.9, 0, -1.0), (-0.1, 2.4, -0.2)),
        entry("block", "white", (2.2, 0, -3.5), (3.2, 0.9, -2.5)),
    ]


def main() -> None:
    """Writes room.glb."""
    parser = argparse.ArgumentParser(description="Makes examples/basic/room.glb.")
    parser.add_argument("out", type=Path, help="folder to write to")
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    file = Glb("Andon tools/make_basic.py", "CC0 1.0: no rights reserved")
    materials = list(REFLECTANCES)
    meshes: list[dict[str, Any]] = []
    count = 0
    for name, material, low, high in parts():
        positions, normals, triangles = box(low, high)
        count += len(triangles)
        primitive = {
            "attributes": {
                "POSITION": file.accessor(positions, "VEC3", target=VERTICES),
                "NORMAL": file.accessor(normals, "VEC3", target=VERTICES),
            },
            "indices": file.accessor(triangles.ravel(), "SCALAR", "<u2", INDICES),
            "material": materials.index(material),
        }
        meshes.append({"name": name, "primitives": [primitive]})
    file.document |= {
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"name": mesh["name"], "mesh": index} for index, mesh in enumerate(meshes)],
        "meshes": meshes,
        "materials": [
            {
                "name": name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*REFLECTANCES[name], 1.0],
                    "metallicFactor": 0.0,
                    "roughnessFactor": 1.0,
                },
            }
            for name in materials
        ],
    }
    file.write(folder / "room.glb")
    print(f"room.glb: {count} triangles")


if __name__ == "__main__":
    main()
