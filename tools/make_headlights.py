"""Makes the road, the car and the beam of examples/headlights.

    python tools/make_headlights.py examples/headlights

The observer stands in the right lane of a country road and looks along −Z; the car comes in the
other lane, along +Z. The low beam is made up in the manner of European ones (UN Regulation 112,
right-hand traffic): some 300 cd towards the eyes of who comes towards it, half a degree above the
horizon and 3.4° to the left, a cut-off that rises on the kerb's side by 15°, and its maximum just
below the cut-off.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from glb import INDICES, VERTICES, Glb
from make_basic import box
from numpy.typing import NDArray

Float = NDArray[np.float64]
Part = tuple[str, Float, Float, NDArray[np.int64]]

# Diffuse reflectances, linear.
REFLECTANCES = {
    "asphalt": (0.09, 0.09, 0.095),
    "paint": (0.62, 0.62, 0.58),
    "grass": (0.035, 0.07, 0.02),
    "post": (0.75, 0.75, 0.75),
    "black": (0.03, 0.03, 0.03),
    "bark": (0.10, 0.075, 0.05),
    "leaves": (0.05, 0.11, 0.03),
    "body": (0.10, 0.02, 0.02),
    "glass": (0.02, 0.025, 0.03),
    "tyre": (0.025, 0.025, 0.025),
}
NEAR_M, FAR_M = 8.0, -140.0
SEED = 4
# Of the beam: its maximum, what an oncoming eye gets, and how soft the cut-off is.
PEAK_CD, GLARE_CD, SOFT_DEGREES = 22_000.0, 300.0, 0.35


def main() -> None:
    """Writes road.glb, car.glb and low_beam.ies."""
    parser = argparse.ArgumentParser(description="Makes examples/headlights.")
    parser.add_argument("out", type=Path, help="folder to write to")
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    for name, parts in (("road", road()), ("car", car())):
        write(folder / f"{name}.glb", parts)
    (folder / "low_beam.ies").write_text(low_beam(), encoding="ascii")


# ── shapes ──────────────────────────────────────────────────────────────────────────────────────


def flat(material: str, corner: Any, along: Any, across: Any) -> Part:
    """A parallelogram whose normal is along × across."""
    along, across = np.array(along, float), np.array(across, float)
    points = np.array(corner, float) + np.array([0 * along, along, along + across, across])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    normal = np.cross(along, across)
    return (
        material,
        points,
        np.broadcast_to(normal / np.linalg.norm(normal), points.shape),
        triangles,
    )


def block(material: str, low: Any, high: Any) -> Part:
    """A box."""
    return material, *box(np.array(low, float), np.array(high, float))


def ball(material: str, centre: Any, radii: Any, draws: np.random.Generator) -> Part:
    """A lumpy ellipsoid."""
    rows, columns = 9, 14
    v, u = np.meshgrid(np.linspace(0, np.pi, rows), np.linspace(0, 2 * np.pi, columns + 1))
    unit = np.stack([np.sin(v) * np.cos(u), np.cos(v), np.sin(v) * np.sin(u)], -1)
    lumps = 1 + 0.14 * draws.standard_normal((columns, rows))
    lumps[:, [0, -1]] = 1
    lumps = np.concatenate([lumps, lumps[:1]])
    points = np.array(centre) + (unit * lumps[..., None] * np.array(radii)).reshape(-1, 3)
    a = (np.arange(columns)[:, None] * rows + np.arange(rows - 1)).ravel()
    triangles = np.concatenate(
        [np.stack([a, a + rows, a + 1], 1), np.stack([a + 1, a + rows, a + rows + 1], 1)]
    )
    normals = unit.reshape(-1, 3) / np.array(radii)
    return material, points, normals / np.linalg.norm(normals, axis=1, keepdims=True), triangles


def prism(material: str, profile: Any, low: float, high: float) -> Part:
    """A convex profile of (z, y), counter-clockwise seen from +x, between x = low and high."""
    corners = np.array(profile, float)
    count = len(corners)
    points, normals, triangles = [], [], []
    for x, side in ((high, 1.0), (low, -1.0)):
        start = sum(map(len, points))
        points.append(np.column_stack([np.full(count, x), corners[:, 1], corners[:, 0]]))
        normals.append(np.tile([side, 0, 0], (count, 1)))
        fan = [(0, k, k + 1) if side < 0 else (0, k + 1, k) for k in range(1, count - 1)]
        triangles.append(np.array(fan) + start)
    for k in range(count):
        (z0, y0), (z1, y1) = corners[k], corners[(k + 1) % count]
        outwards = np.array([0, z1 - z0, -(y1 - y0)])
        if outwards @ [0, (y0 + y1) / 2, (z0 + z1) / 2] < outwards @ [0, *corners.mean(0)[::-1]]:
            outwards = -outwards
        start = sum(map(len, points))
        quad = np.array([[low, y0, z0], [high, y0, z0], [high, y1, z1], [low, y1, z1]])
        points.append(quad)
        normals.append(np.tile(outwards / np.linalg.norm(outwards), (4, 1)))
        turned = np.cross(quad[1] - quad[0], quad[2] - quad[0]) @ outwards < 0
        faces = [[0, 2, 1], [0, 3, 2]] if turned else [[0, 1, 2], [0, 2, 3]]
        triangles.append(np.array(faces) + start)
    return material, np.concatenate(points), np.concatenate(normals), np.concatenate(triangles)


def road() -> list[Part]:
    """Asphalt with lines, verges, posts and trees."""
    draws = np.random.default_rng(SEED)
    length = NEAR_M - FAR_M
    back = (0, 0, -length)
    parts = [
        flat("asphalt", (-3.6, 0, NEAR_M), (7.2, 0, 0), back),
        flat("grass", (-40, -0.05, NEAR_M), (36.4, 0.04, 0), back),
        flat("grass", (3.6, -0.01, NEAR_M), (36.4, -0.04, 0), back),
    ]
    parts += [flat("paint", (x - 0.06, 0.004, NEAR_M), (0.12, 0, 0), back) for x in (-3.35, 3.35)]
    parts += [
        flat("paint", (-0.06, 0.004, z), (0.12, 0, 0), (0, 0, -3.0))
        for z in np.arange(NEAR_M, FAR_M + 3, -9.0)
    ]
    for z in np.arange(-6.0, FAR_M, -18.0):
        for x in (-4.3, 4.3):
            parts += [
                block("post", (x - 0.06, 0, z - 0.06), (x + 0.06, 0.72, z + 0.06)),
                block("black", (x - 0.062, 0.72, z - 0.062), (x + 0.062, 0.9, z + 0.062)),
                block("post", (x - 0.06, 0.9, z - 0.06), (x + 0.06, 1.0, z + 0.06)),
            ]
    for z in np.arange(-14.0, FAR_M, -11.0):
        for side in (-1, 1):
            x = side * draws.uniform(6.5, 10.5)
            parts += tree((x, z + draws.uniform(-3, 3)), draws)
    return parts


def tree(place: tuple[float, float], draws: np.random.Generator) -> list[Part]:
    """A trunk and a crown of some lumps."""
    x, z = place
    height, radius = draws.uniform(5, 9), draws.uniform(0.14, 0.25)
    parts = [block("bark", (x - radius, -0.1, z - radius), (x + radius, 0.6 * height, z + radius))]
    for _ in range(5):
        off = draws.normal(0, 0.13 * height, 3) * (1, 0.8, 1)
        centre = np.array([x, 0.68 * height, z]) + off
        parts.append(ball("leaves", centre, height * draws.uniform(0.14, 0.24, 3), draws))
    return parts


def car() -> list[Part]:
    """A saloon, 4.4 m long, its nose at z = 0 and its wheels on y = 0; it drives along +z."""
    body = [
        (0, 0.35),
        (-0.05, 0.62),
        (-0.9, 0.9),
        (-4.2, 0.98),
        (-4.4, 0.6),
        (-4.35, 0.25),
        (-0.1, 0.22),
    ]
    cabin = [(-0.95, 0.88), (-1.75, 1.38), (-3.3, 1.42), (-4.15, 0.95)]
    parts = [prism("body", body, -0.86, 0.86), prism("glass", cabin, -0.7, 0.7)]
    roof = [(-1.7, 1.375), (-1.8, 1.41), (-3.25, 1.45), (-3.35, 1.41)]
    parts.append(prism("body", roof, -0.66, 0.66))
    turn = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    for z in (-0.85, -3.5):
        wheel = np.column_stack([z + 0.32 * np.cos(turn), 0.32 + 0.32 * np.sin(turn)])
        for low, high in ((-0.88, -0.66), (0.66, 0.88)):
            parts.append(prism("tyre", wheel, low, high))
    parts.append(block("post", (-0.25, 0.34, -0.03), (0.25, 0.44, 0.02)))
    return parts


def write(path: Path, parts: list[Part]) -> None:
    """One mesh with a primitive for each material."""
    file = Glb("Andon tools/make_headlights.py", "CC0 1.0: no rights reserved")
    names = list(dict.fromkeys(material for material, *_ in parts))
    primitives: list[dict[str, Any]] = []
    for index, name in enumerate(names):
        own = [part for part in parts if part[0] == name]
        starts = np.cumsum([0, *(len(points) for _, points, _, _ in own)])
        triangles = [t + start for (*_, t), start in zip(own, starts, strict=False)]
        primitives.append(
            {
                "attributes": {
                    "POSITION": file.accessor(
                        np.concatenate([p for _, p, _, _ in own]), "VEC3", target=VERTICES
                    ),
                    "NORMAL": file.accessor(
                        np.concatenate([n for _, _, n, _ in own]), "VEC3", target=VERTICES
                    ),
                },
                "indices": file.accessor(
                    np.concatenate(triangles).ravel(), "SCALAR", "<u4", INDICES
                ),
                "material": index,
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
                    "baseColorFactor": [*REFLECTANCES[name], 1.0],
                    "metallicFactor": 0.0,
                    "roughnessFactor": 1.0,
                },
            }
            for name in names
        ],
    }
    file.write(path)
    print(f"{path.name}: {sum(len(part[3]) for part in parts)} triangles")


# ── the beam ────────────────────────────────────────────────────────────────────────────────────


def intensity(kerb_degrees: Float, up_degrees: Float) -> Float:
    """Candela towards angles to the kerb's side and above the horizon."""
    # The cut-off: level on the other side, rising at 15° on the kerb's.
    edge = np.where(kerb_degrees > 0, np.minimum(np.tan(np.radians(15)) * kerb_degrees, 2.5), 0.0)
    below = 1 / (1 + np.exp((up_degrees - edge + 0.6) / (SOFT_DEGREES / 2)))
    down = edge - 0.6 - up_degrees
    spot = np.exp(-((kerb_degrees - 2.5) ** 2) / (2 * 6.0**2)) * np.exp(-np.maximum(down, 0) / 2.6)
    wide = 0.11 * np.exp(-((kerb_degrees / 26.0) ** 2)) * np.exp(-np.maximum(down, 0) / 7.0)
    stray = GLARE_CD * np.exp(-((kerb_degrees**2 + up_degrees**2) / 45.0**2))
    return PEAK_CD * (spot + wide) * below + stray * (1 - below)


def low_beam() -> str:
    """IES LM-63-2002, type C: γ from the axis; C = 0 to the car's left, C = 90 downwards.

    That is `lamps.luminaire_axes` for a lamp that looks along +Z and hangs as in the scene.
    """
    steps = ((0, 4, 0.25), (4, 10, 0.5), (10, 20, 1.0), (20, 46, 2.5))
    gamma = np.concatenate([*(np.arange(*step) for step in steps), [50.0, 60.0, 75.0, 90.0]])
    planes = np.concatenate([np.arange(0, 361, 4.0), [2, 178, 182, 358, 346, 350, 354, 198, 194]])
    planes = np.unique(planes)
    c, g = np.meshgrid(np.radians(planes), np.radians(gamma), indexing="ij")
    left, down, ahead = np.sin(g) * np.cos(c), np.sin(g) * np.sin(c), np.cos(g)
    kerb = -np.degrees(np.arctan2(left, np.maximum(ahead, 1e-9)))
    up = -np.degrees(np.arcsin(down))
    values = intensity(kerb, up) * np.clip((90 - np.degrees(g)) / 30, 0, 1)
    lines = ["IESNA:LM-63-2002", "[TEST] none", "[TESTLAB] none", "[ISSUEDATE] 2026-11-22"]
    lines += ["[MANUFAC] Andon", "[LUMINAIRE] low beam, made up after UN R112", "TILT=NONE"]
    lines += [f"1 -1 1 {len(gamma)} {len(planes)} 1 2 0 0 0", "1 1 55"]
    for row in (gamma, planes, *values):
        texts = [f"{value:.4g}" if value < 1000 else f"{value:.0f}" for value in row]
        lines += [" ".join(texts[k : k + 12]) for k in range(0, len(texts), 12)]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
