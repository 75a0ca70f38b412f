"""Makes examples/basic/walker.glb: a mannequin of 1.75 m that walks on the spot.

    PYTHONPATH=tools python tools/make_walker.py examples/basic

One skinned mesh, 17 joints, one animation "walk". It stands on y = 0 and faces +Z.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from glb import INDICES, VERTICES, Glb
from walker.bones import NAMES, REST, parent_of
from walker.gait import gait
from walker.skin import skin

# Linear; brighter than a plaster cast would be too bright beside sunlit walls.
REFLECTANCE = (0.68, 0.67, 0.65)


def nodes() -> list[dict[str, Any]]:
    """The figure, its mesh, and its joints: joint k is node k + 2."""
    entries: list[dict[str, Any]] = [
        {"name": "walker", "children": [1, 2]},
        {"name": "skin", "mesh": 0, "skin": 0},
    ]
    for number, name in enumerate(NAMES):
        parent = parent_of(name)
        place = REST[number] - (REST[parent] if parent >= 0 else 0)
        entry: dict[str, Any] = {"name": name, "translation": place.tolist()}
        children = [k + 2 for k, other in enumerate(NAMES) if parent_of(other) == number]
        if children:
            entry["children"] = children
        entries.append(entry)
    return entries


def animation(file: Glb) -> tuple[dict[str, Any], float]:
    """The animation "walk", and the speed in m/s at which its feet do not slide."""
    times, turns, hips, speed = gait()
    clock = file.accessor(times, "SCALAR")
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []

    def add(name: str, path: str, values: Any, kind: str) -> None:
        channels.append(
            {
                "sampler": len(samplers),
                "target": {"node": NAMES.index(name) + 2, "path": path},
            }
        )
        samplers.append(
            {"input": clock, "output": file.accessor(values, kind), "interpolation": "LINEAR"}
        )

    add("hips", "translation", hips, "VEC3")
    for name in NAMES:
        if name in turns:
            add(name, "rotation", turns[name], "VEC4")
    return {"name": "walk", "samplers": samplers, "channels": channels}, speed


def main() -> None:
    """Writes walker.glb."""
    parser = argparse.ArgumentParser(description="Makes examples/basic/walker.glb.")
    parser.add_argument("out", type=Path, help="folder to write to")
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    file = Glb("Andon tools/make_walker.py", "CC0 1.0: no rights reserved")
    body = skin()
    primitive = {
        "attributes": {
            "POSITION": file.accessor(body.positions, "VEC3", target=VERTICES),
            "NORMAL": file.accessor(body.normals, "VEC3", target=VERTICES),
            "JOINTS_0": file.accessor(body.joints, "VEC4", "|u1", VERTICES),
            "WEIGHTS_0": file.accessor(body.weights, "VEC4", target=VERTICES),
        },
        "indices": file.accessor(body.triangles.ravel(), "SCALAR", "<u2", INDICES),
        "material": 0,
    }
    inverse = np.tile(np.eye(4), (len(NAMES), 1, 1))
    inverse[:, :3, 3] = -REST
    stored = np.transpose(inverse, (0, 2, 1)).reshape(-1, 16)  # by columns
    walk, speed = animation(file)
    surface = {"metallicFactor": 0.0, "roughnessFactor": 0.9}
    file.document |= {
        "scenes": [{"nodes": [0]}],
        "nodes": nodes(),
        "meshes": [{"name": "mannequin", "primitives": [primitive]}],
        "skins": [
            {
                "name": "bones",
                "skeleton": 2,
                "joints": [number + 2 for number in range(len(NAMES))],
                "inverseBindMatrices": file.accessor(stored, "MAT4"),
            }
        ],
        "animations": [walk],
        "materials": [
            {
                "name": "plaster",
                "pbrMetallicRoughness": {"baseColorFactor": [*REFLECTANCE, 1.0], **surface},
            }
        ],
    }
    file.write(folder / "walker.glb")
    print(f"walker.glb: {len(body.triangles)} triangles, {len(NAMES)} joints, {speed:.3f} m/s")


if __name__ == "__main__":
    main()
