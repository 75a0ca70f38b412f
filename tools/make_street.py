"""Makes the mesh of examples/street: a street of setts by night, with lamp posts and houses.

    python tools/make_street.py examples/street

``street.glb`` has everything but the light: the road, a pavement of slabs, lamp posts, on the right
a house front with windows, on the left a garden wall and houses. Metres, +Y up, y = 0 on the road,
which runs along −Z.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from glb import INDICES, VERTICES, Glb
from make_water import turned
from numpy.typing import NDArray

Float = NDArray[np.float64]
Solid = tuple[Float, Float, NDArray[np.int64]]

LICENCE = "CC0 1.0: no rights reserved"
SEED = 7
# Across: garden wall, road from kerb to kerb, house front. Along: from behind the eye to its end.
WALL_X, ROAD_X, FRONT_X = -3.9, (-3.0, 1.1), 3.3
NEAR_Z, FAR_Z = 1.0, -46.0
KERB_M = 0.12
# Stones: length along the road, width across, and how much they tilt (standard deviation).
SETT_M, SLAB_M, TILT = (0.22, 0.34), (0.6, 0.73), 0.06
POSTS = ((1.45, -11.5), (-3.35, -21.0), (1.45, -30.5))
POST_M = 3.75
# Windows of the house on the right: their lower edge, height and width; z of their middles.
WINDOWS_Z = (-6.2, -9.4, -13.6, -16.8, -20.0, -24.2, -27.4)
STOREYS = ((1.15, 1.5), (4.35, 1.4))
WINDOW_M = 1.0

# Linear reflectances.
SHADES = {
    "sett dark": (0.070, 0.072, 0.076),
    "sett": (0.10, 0.10, 0.10),
    "sett pale": (0.14, 0.135, 0.125),
    "slab": (0.22, 0.21, 0.195),
    "slab pale": (0.27, 0.26, 0.24),
    "kerb": (0.30, 0.29, 0.27),
    "plaster": (0.46, 0.38, 0.27),
    "plinth": (0.17, 0.16, 0.15),
    "frame": (0.40, 0.39, 0.36),
    "pane": (0.012, 0.014, 0.018),
    "door": (0.045, 0.085, 0.07),
    "iron": (0.020, 0.022, 0.024),
    "brick": (0.19, 0.105, 0.075),
    "roof": (0.045, 0.042, 0.045),
    "night": (0.25, 0.32, 0.48),
}
NAMES = list(SHADES)


def stones(
    x: tuple[float, float], size: tuple[float, float], level: float, shades: list[str]
) -> list[tuple[str, Solid]]:
    """Stones in rows across, every other row shifted: tops alone, each a little tilted."""
    rng = np.random.default_rng(SEED)
    along, across = size
    rows = int((NEAR_Z - FAR_Z) / along)
    parts: dict[str, list[tuple[Float, Float]]] = {shade: [] for shade in shades}
    joint = 0.012
    for row in range(rows):
        z = NEAR_Z - row * along
        edges = np.arange(x[0] - across * 0.5 * (row % 2), x[1] + across, across).clip(*x)
        edges = np.unique(edges)
        for left, right in pairwise(edges):
            tilt = rng.normal(0, TILT, 2)
            normal = np.array([tilt[0], 1, tilt[1]]) / np.hypot(1, np.hypot(*tilt))
            y = level + rng.normal(0, 0.003)
            corners = [(left, z), (right - joint, z), (right - joint, z - along + joint)]
            corners.append((left, z - along + joint))
            points = np.array([(a, y, b) for a, b in corners])
            parts[str(rng.choice(shades))].append((points, np.tile(normal, (4, 1))))
    found: list[tuple[str, Solid]] = []
    for shade, tops in parts.items():
        faces = np.array([[0, 1, 2], [0, 2, 3]])
        found.append(
            (
                shade,
                (
                    np.concatenate([points for points, _ in tops]),
                    np.concatenate([normals for _, normals in tops]),
                    np.concatenate([faces + 4 * number for number in range(len(tops))]),
                ),
            )
        )
    return found


def block(shade: str, low: Any, high: Any) -> tuple[str, Solid]:
    """A box, faces outwards: two triangles a side, however large."""
    corners = np.array([low, high], float)
    sides: list[tuple[Float, Float]] = []
    for axis in range(3):
        for side in (0, 1):
            turn = [(0, 0), (1, 0), (1, 1), (0, 1)]
            picked = np.zeros((4, 3), int)
            picked[:, axis] = side
            picked[:, (axis + 1) % 3], picked[:, (axis + 2) % 3] = np.array(turn).T
            points = np.take_along_axis(corners, picked, axis=0)
            normal = np.zeros(3)
            normal[axis] = 2 * side - 1
            sides.append((points if side else points[::-1], np.tile(normal, (4, 1))))
    faces = np.concatenate([np.array([[0, 1, 2], [0, 2, 3]]) + 4 * n for n in range(6)])
    positions, normals = (np.concatenate(part) for part in zip(*sides, strict=True))
    return shade, (positions, normals, faces)


def ground() -> list[tuple[str, Solid]]:
    """Road, pavements, kerbs and what lies below the joints."""
    first, last = ROAD_X
    return [
        block("plinth", (WALL_X - 20, -0.3, FAR_Z), (FRONT_X, -0.02, NEAR_Z)),
        *stones(ROAD_X, SETT_M, 0.0, ["sett dark", "sett", "sett pale"]),
        block("kerb", (last, -0.1, FAR_Z), (last + 0.16, KERB_M, NEAR_Z)),
        block("kerb", (first - 0.16, -0.1, FAR_Z), (first, KERB_M, NEAR_Z)),
        block("plinth", (last + 0.16, -0.1, FAR_Z), (FRONT_X, KERB_M - 0.015, NEAR_Z)),
        block("slab", (WALL_X, -0.1, FAR_Z), (first - 0.16, KERB_M, NEAR_Z)),
        *stones((last + 0.17, FRONT_X), SLAB_M, KERB_M, ["slab", "slab pale"]),
    ]


def window(z: float, low: float, height: float) -> list[tuple[str, Solid]]:
    """Pane, sill, lintel and bars of a window of the house on the right."""
    x, half, high = FRONT_X, WINDOW_M / 2, low + height
    bar = 0.035
    return [
        block("pane", (x - 0.01, low, z - half), (x + 0.02, high, z + half)),
        block("frame", (x - 0.09, low - 0.1, z - half - 0.1), (x + 0.02, low, z + half + 0.1)),
        block("frame", (x - 0.06, high, z - half - 0.1), (x + 0.02, high + 0.14, z + half + 0.1)),
        *(
            block("frame", (x - 0.05, low, z + s - 0.05), (x + 0.02, high, z + s + 0.05))
            for s in (-half, half)
        ),
        block("frame", (x - 0.04, low, z - bar), (x - 0.005, high, z + bar)),
        *(
            block(
                "frame",
                (x - 0.04, low + height * share - bar / 2, z - half),
                (x - 0.005, low + height * share + bar / 2, z + half),
            )
            for share in (1 / 3, 2 / 3)
        ),
    ]


def houses() -> list[tuple[str, Solid]]:
    """The front on the right, the garden wall and houses on the left, the night behind."""
    x, w = FRONT_X, WALL_X
    parts = [
        block("plaster", (x, 0, -29.5), (x + 4, 7.2, NEAR_Z)),
        block("plinth", (x - 0.05, 0, -29.5), (x, 0.7, NEAR_Z)),
        block("frame", (x - 0.07, 3.55, -29.5), (x, 3.75, NEAR_Z)),
        block("roof", (x - 0.45, 7.2, -29.9), (x + 4.5, 7.5, NEAR_Z)),
        block("door", (x - 0.03, 0.2, -11.95), (x + 0.02, 2.45, -11.0)),
        block("frame", (x - 0.08, 2.45, -12.1), (x + 0.02, 2.62, -10.85)),
        *(
            block("frame", (x - 0.06, 0.12, z - 0.07), (x + 0.02, 2.45, z + 0.07))
            for z in (-10.92, -12.03)
        ),
        block("plinth", (x - 0.4, 0, -12.1), (x, 0.22, -10.85)),
        block("brick", (x, 0, -46), (x + 5, 5.4, -31.5)),
        block("brick", (w - 0.3, 0, FAR_Z), (w, 1.55, NEAR_Z)),
        block("kerb", (w - 0.36, 1.55, FAR_Z), (w + 0.06, 1.66, NEAR_Z)),
        block("brick", (w - 12, 0, -38), (w - 3.5, 6.0, -27)),
        block("roof", (w - 12.4, 6.0, -38.4), (w - 3.1, 6.35, -26.6)),
        block("plaster", (w - 8, 0, -60), (w - 0.5, 8.5, -48)),
        block("roof", (w - 8.4, 8.5, -60.4), (w - 0.1, 8.9, -47.6)),
        block("plaster", (-2.5, 0, -64), (9, 6.8, -56)),
        block("roof", (-2.9, 6.8, -64), (9.4, 7.2, -55.6)),
        block("night", (-90, -1, -96), (90, 70, -95)),
    ]
    for z in WINDOWS_Z:
        for low, height in STOREYS:
            parts += window(z, low, height)
    return parts


def post(x: float, z: float) -> tuple[str, Solid]:
    """A cast-iron post under a globe: a foot, a shaft with rings, a cup."""
    profile = [
        (0.16, 0.0), (0.16, 0.25), (0.11, 0.32), (0.10, 0.75), (0.13, 0.80), (0.13, 0.86),
        (0.055, 0.95), (0.048, 2.6), (0.075, 2.64), (0.075, 2.69), (0.042, 2.75),
        (0.036, POST_M - 0.28), (0.05, POST_M - 0.24), (0.035, POST_M - 0.18),
        (0.06, POST_M - 0.09), (0.001, POST_M - 0.085),
    ]  # fmt: skip
    # Doubled rings keep the edges of the profile.
    radius, height = np.repeat(np.array(profile), 2, axis=0).T
    height = height + np.tile([-1e-3, 1e-3], len(profile))
    positions, normals, faces = turned(radius, height, 20)
    level = KERB_M
    return "iron", (positions + np.array([x, level, z]), normals, faces)


def write(path: Path, solids: list[tuple[str, Solid]]) -> None:
    """One mesh, a primitive for each material."""
    file = Glb("Andon tools/make_street.py", LICENCE)
    primitives: list[dict[str, Any]] = []
    for shade in NAMES:
        mine = [solid for name, solid in solids if name == shade]
        firsts = np.cumsum([0, *(len(solid[0]) for solid in mine)])
        faces = np.concatenate(
            [solid[2] + first for solid, first in zip(mine, firsts[:-1], strict=True)]
        )
        primitives.append(
            {
                "attributes": {
                    "POSITION": file.accessor(
                        np.concatenate([solid[0] for solid in mine]), "VEC3", target=VERTICES
                    ),
                    "NORMAL": file.accessor(
                        np.concatenate([solid[1] for solid in mine]), "VEC3", target=VERTICES
                    ),
                },
                "indices": file.accessor(faces.ravel(), "SCALAR", "<u2", INDICES),
                "material": NAMES.index(shade),
            }
        )
    file.document |= {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": path.stem, "mesh": 0}],
        "meshes": [{"name": path.stem, "primitives": primitives}],
        "materials": [
            {
                "name": name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*SHADES[name], 1.0],
                    "metallicFactor": 0.0,
                    "roughnessFactor": 1.0,
                },
            }
            for name in NAMES
        ],
    }
    file.write(path)


def main() -> None:
    """Writes street.glb."""
    parser = argparse.ArgumentParser(description="Makes the mesh of examples/street.")
    parser.add_argument("out", type=Path, help="folder to write to")
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / "street.glb", [*ground(), *houses(), *(post(x, z) for x, z in POSTS)])


if __name__ == "__main__":
    main()
