"""What stands in the test room: parts with a solid and a material, laid out by hand.

Lengths are metres; the seed only changes sizes, turns and reflectances within each thing's place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from andon.quantities import Material
from andon.verify.solids import Solid, box, icosphere, lathe, panel, torus, wedge

__all__ = ["ROOM_SIZE", "Part", "room_parts"]

ROOM_SIZE = (5.0, 3.0, 4.0)
# How deep things stand in what carries them (see rooms.py); shelf boards have half of it, so that
# no two hidden faces share a plane either.
SUNK = 0.004

Generator = np.random.Generator


@dataclass(frozen=True)
class Part:
    """One thing in the room."""

    solid: Solid
    material: Material


def room_parts(detail: float, seed: int) -> list[Part]:
    """All parts; `detail` > 0 scales the subdivision, triangles grow with its square."""
    generator = np.random.default_rng(seed)
    paint = _materials(generator)
    return [
        *_shell(detail, paint),
        *_table(paint),
        *_chair((-0.75, -0.15), 82 + generator.uniform(-8, 8), paint),
        *_chair((0.25, 0.62), 176 + generator.uniform(-8, 8), paint),
        *_chair((1.2, -0.5), -97 + generator.uniform(-8, 8), paint),
        *_shelf(generator, paint),
        *_slanted(generator, paint),
        *_round(detail, generator, paint),
    ]


def _materials(generator: Generator) -> dict[str, Material]:
    base = {
        "plaster": (0.78, 0.76, 0.72),
        "ceiling": (0.85, 0.85, 0.84),
        "boards": (0.42, 0.30, 0.20),
        "brick": (0.58, 0.26, 0.18),
        "sage": (0.30, 0.48, 0.28),
        "oak": (0.52, 0.38, 0.22),
        "slate": (0.12, 0.13, 0.15),
        "clay": (0.62, 0.40, 0.28),
        "ultramarine": (0.10, 0.16, 0.55),
        "linen": (0.70, 0.66, 0.58),
    }
    tints = generator.uniform(0.92, 1.08, (len(base), 3))
    materials: dict[str, Material] = {}
    for (name, reflectance), tint in zip(base.items(), tints, strict=True):
        red, green, blue = (np.array(reflectance) * tint).tolist()
        materials[name] = Material(name=name, reflectance=(red, green, blue))
    return materials


def _shell(detail: float, paint: dict[str, Material]) -> list[Part]:
    x, y, z = ROOM_SIZE
    nx, ny, nz = (max(1, round(4 * detail * length)) for length in ROOM_SIZE)
    left, right, back, front = -x / 2, x / 2, -z / 2, z / 2
    return [
        Part(panel((left, 0, front), (x, 0, 0), (0, 0, -z), (nx, nz)), paint["boards"]),
        Part(panel((left, y, back), (x, 0, 0), (0, 0, z), (nx, nz)), paint["ceiling"]),
        Part(panel((left, 0, back), (x, 0, 0), (0, y, 0), (nx, ny)), paint["plaster"]),
        Part(panel((right, 0, front), (-x, 0, 0), (0, y, 0), (nx, ny)), paint["linen"]),
        Part(panel((left, 0, front), (0, 0, -z), (0, y, 0), (nz, ny)), paint["sage"]),
        Part(panel((right, 0, back), (0, 0, z), (0, y, 0), (nz, ny)), paint["brick"]),
    ]


def _legs(half_x: float, half_z: float, height: float, thick: float) -> list[Solid]:
    """Four legs from just under the floor up into the middle of what they carry."""
    leg = box((thick, height + SUNK, thick), (1, 4, 1))
    middle = (height - SUNK) / 2
    return [leg.moved((sx * half_x, middle, sz * half_z)) for sx in (-1, 1) for sz in (-1, 1)]


def _table(paint: dict[str, Material]) -> list[Part]:
    top = box((1.6, 0.04, 0.8), (8, 1, 4)).moved((0.2, 0.73, -0.2))
    legs = [leg.moved((0.2, 0, -0.2)) for leg in _legs(0.72, 0.32, 0.73, 0.05)]
    return [Part(top, paint["oak"]), *(Part(leg, paint["slate"]) for leg in legs)]


def _chair(at: tuple[float, float], yaw_degrees: float, paint: dict[str, Material]) -> list[Part]:
    seat = box((0.42, 0.04, 0.42), (4, 1, 4)).moved((0, 0.45, 0))
    # The back leans by 9°, so its planes meet no other part's.
    back = box((0.38, 0.52, 0.025), (3, 4, 1)).moved((0, 0.70, -0.21), pitch_degrees=-9)
    place = (at[0], 0.0, at[1])
    wood = [seat, *_legs(0.17, 0.17, 0.45, 0.035)]
    return [
        *(Part(piece.moved(place, yaw_degrees=yaw_degrees), paint["oak"]) for piece in wood),
        Part(back.moved(place, yaw_degrees=yaw_degrees), paint["ultramarine"]),
    ]


def _shelf(generator: Generator, paint: dict[str, Material]) -> list[Part]:
    """Two sides, four boards that end inside them, boxes on three of the boards."""
    back, x0, width = -ROOM_SIZE[2] / 2, -1.35, 1.3
    side = box((0.024, 1.8 + SUNK, 0.30 + SUNK), (1, 6, 1))
    board = box((width, 0.022, 0.28 + SUNK / 2), (6, 1, 2))
    parts = [
        Part(side.moved((x0 + s * width / 2, 0.9 - SUNK / 2, back + 0.15 - SUNK / 2)), paint["oak"])
        for s in (-1, 1)
    ]
    for height in (0.25, 0.75, 1.25, 1.72):
        parts.append(Part(board.moved((x0, height, back + 0.14 - SUNK / 4)), paint["oak"]))
    for height in (0.25, 0.75, 1.25):
        for slot in range(4):
            size = generator.uniform((0.12, 0.14, 0.10), (0.20, 0.34, 0.16))
            at = (
                x0 - width / 2 + width * (slot + 0.5) / 4,
                height + 0.011 + size[1] / 2 - SUNK / 2,
                back + 0.15,
            )
            colour = ("clay", "linen", "ultramarine", "slate")[int(generator.integers(4))]
            thing = box(size, (2, 3, 2)).moved(at, yaw_degrees=generator.uniform(-20, 20))
            parts.append(Part(thing, paint[colour]))
    return parts


def _slanted(generator: Generator, paint: dict[str, Material]) -> list[Part]:
    """A leaning board, a ramp, a tilted picture, a sloping beam, boxes stacked askew."""
    lean = 14 + generator.uniform(-2, 2)
    board = box((0.03, 1.9, 0.45), (1, 10, 3))
    foot = 2.42 - 0.95 * np.sin(np.radians(lean))
    upright = 0.95 * np.cos(np.radians(lean)) - 0.004
    crates = [
        (box((0.5, 0.42, 0.45), (3, 3, 3)), (-2.05, 0.21 - SUNK, -0.45), 12.0),
        (box((0.34, 0.3, 0.3), (2, 2, 2)), (-2.02, 0.57 - 2 * SUNK, -0.47), -23.0),
    ]
    return [
        Part(board.moved((foot, upright, 0.0), roll_degrees=-lean), paint["linen"]),
        Part(
            wedge((0.7, 0.32, 0.5)).moved((1.3, 0.16 - SUNK, 1.55), yaw_degrees=150), paint["slate"]
        ),
        Part(
            box((0.8, 0.55, 0.03), (4, 3, 1)).moved((0.6, 1.75, -1.975), pitch_degrees=4),
            paint["clay"],
        ),
        Part(
            box((3.0, 0.09, 0.11), (12, 1, 1)).moved(
                (0.0, 2.72, -1.0), yaw_degrees=17, roll_degrees=4
            ),
            paint["oak"],
        ),
        *(
            Part(crate.moved(at, yaw_degrees=turn + generator.uniform(-5, 5)), paint["clay"])
            for crate, at, turn in crates
        ),
    ]


def _round(detail: float, generator: Generator, paint: dict[str, Material]) -> list[Part]:
    def cuts(number: float, least: int = 3) -> int:
        return max(least, round(number * detail))

    ball = generator.uniform(0.22, 0.27)
    profile = np.linspace(0, np.pi, cuts(20, 6) + 1)
    vase_radius = np.sin(profile) * (0.075 + 0.03 * np.cos(2.2 * profile))
    pillar_radius = np.sin(profile) ** 0.2 * 0.17
    pillar_radius[[0, -1]] = vase_radius[[0, -1]] = 0.0
    pillar_height = 1.5 - np.cos(profile) * (1.5 + 3 * SUNK)
    ring = torus(0.32, 0.09, (cuts(44, 6), cuts(22, 4)))
    return [
        Part(icosphere(ball, cuts(7, 2)).moved((0.55, ball - SUNK, 1.35)), paint["clay"]),
        Part(icosphere(0.11, cuts(6, 2)).moved((0.72, 0.86 - SUNK, -0.35)), paint["ultramarine"]),
        Part(icosphere(0.16, cuts(7, 2)).moved((-0.9, 2.55, 0.5)), paint["linen"]),
        Part(icosphere(0.20, cuts(7, 2)).moved((-1.5, 0.2 - SUNK, 0.85)), paint["slate"]),
        Part(
            lathe(vase_radius, 0.15 - 0.15 * np.cos(profile), cuts(28, 5)).moved(
                (0.05, 0.75 - SUNK, -0.2)
            ),
            paint["sage"],
        ),
        Part(
            lathe(pillar_radius, pillar_height, cuts(36, 5)).moved((1.8, 0, -1.4)), paint["linen"]
        ),
        Part(
            ring.moved((1.75, 0.26, 0.7), pitch_degrees=33, yaw_degrees=generator.uniform(0, 90)),
            paint["brick"],
        ),
    ]
