"""The building: mats, walls, posts and beams, shoji, fusuma, the alcove, the ceiling.

::

                 z = −1.95  ┌ tokonoma ┐
    z = −1.35  ┌──fusuma────o──────────┤ x = 1.8
               s                       │
               h       6 mats          │ plaster
               o                       │
               j                       │
    z =  1.35  i······ open ···········│
               │        hall   camera  │
    z =  2.75  └───────────────────────┘
             x = −1.8
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.meshes import read_mesh
from tatami.shapes import Part, box, disc, joined, picture, quad

WEST, EAST, NORTH, SOUTH, HALL = -1.8, 1.8, -1.35, 1.35, 2.75
CEILING, LINTEL, POST = 2.40, 1.78, 0.105
ALCOVE_WEST, ALCOVE_NORTH, ALCOVE_FLOOR = 0.06, -1.95, 0.11
# One repeat of the rush texture: the set's own 14 × 30 cm is too coarse beside real rush, whose
# ridges lie 15 mm apart; its true 7 cm is finer than a pixel of the photograph.
RUSH_M = 0.11

# Screens of paper: (z of the south end, z of the north end, x of the paper) and its heights.
SHOJI_TRACKS = (-1.838, -1.808)
SHOJI_LOW, SHOJI_HIGH, STILE = 0.36, 1.70, 0.030


@dataclass(frozen=True)
class Sheet:
    """A sheet of shoji paper at x, between two z (metres): what daylight comes through."""

    x: float
    north: float
    south: float


def shoji_sheets() -> list[Sheet]:
    """The papers of the four screens, from north to south."""
    first, last = NORTH + POST / 2 + 0.01, SOUTH - POST / 2 - 0.01
    overlap = STILE
    width = (last - first + 3 * overlap) / 4
    sheets = []
    for number in range(4):
        start = first + number * (width - overlap)
        track = SHOJI_TRACKS[number in (1, 2)]
        sheets.append(Sheet(track, start + STILE, start + width - STILE))
    return sheets


def building(mat_file: Path) -> list[Part]:
    """All fixed parts; `mat_file` is tatami.obj of the CC0 set."""
    return [
        *_mats(mat_file),
        *_shoji(),
        *_north(),
        *_alcove(),
        *_shelves(),
        *_walls(),
        *_frame(),
        *_above(),
    ]


def _mats(mat_file: Path) -> list[Part]:
    """Six mats so that no four corners meet."""
    mat = read_mesh(mat_file).geometry
    assert mat.uvs is not None
    assert mat.material_ids is not None
    corners = mat.positions[mat.triangles].reshape(-1, 3) * 0.009 - [0, 0, 0.45]  # 1 × 2 m in cm
    uvs = mat.uvs[mat.triangles].reshape(-1, 2)
    names = np.repeat([mat.materials[i].name for i in mat.material_ids], 3)
    places = [(-0.9, -0.9, 1), (0.9, -0.9, 1), (-1.35, 0.45, 0), (1.35, 0.45, 0)]
    places += [(0.0, 0.0, 1), (0.0, 0.9, 1)]
    parts = []
    for x, z, across in places:
        for name in ("tatami", "border"):
            chosen = names == name
            material = ("mat.along", "mat.across")[across] if name == "tatami" else "border"
            points = corners[chosen]
            laid = points[:, [0, 2]] / RUSH_M if name == "tatami" else uvs[chosen]
            order = np.arange(len(points), dtype=np.int32).reshape(-1, 3)
            part = Part(material, points, _with_area(points, order), laid)
            parts.append(part.moved((x, 0, z), yaw_degrees=90.0 * across))
    return parts


def _with_area(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.int32]:
    a, b, c = points[triangles].swapaxes(0, 1)
    return triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-9]


def _shoji() -> list[Part]:
    """Four sliding screens: stiles, rails, a board below, the lattice, and the paper behind it."""
    parts = [
        box("wood.cypress", (WEST - 0.06, -0.05, NORTH), (WEST + 0.01, 0.004, SOUTH)),
        box("wood.cypress", (WEST - 0.06, 1.735, NORTH), (WEST + 0.02, LINTEL, SOUTH)),
    ]
    for sheet in shoji_sheets():
        front, back = sheet.x + 0.018, sheet.x - 0.010
        outer = (sheet.north - STILE, sheet.south + STILE)
        for low, high in ((outer[0], sheet.north), (sheet.south, outer[1])):
            parts.append(box("wood.cypress", (back, 0.004, low), (front, 1.735, high)))
        for low, high in ((0.004, 0.06), (0.325, SHOJI_LOW), (SHOJI_HIGH, 1.735)):
            parts.append(box("wood.cypress", (back, low, sheet.north), (front, high, sheet.south)))
        parts.append(
            box("wood.cedar", (back, 0.06, sheet.north), (sheet.x, 0.325, sheet.south), sides="+x")
        )
        parts.append(
            quad(
                "paper.shoji",
                (sheet.x, SHOJI_LOW, sheet.south),
                (0, 0, sheet.north - sheet.south),
                (0, SHOJI_HIGH - SHOJI_LOW, 0),
            )
        )
        parts += _lattice(sheet)
    return parts


def _lattice(sheet: Sheet) -> list[Part]:
    half, deep = 0.004, 0.013
    bars = []
    for z in np.linspace(sheet.north, sheet.south, 5)[1:-1]:
        low, high = (sheet.x, SHOJI_LOW, z - half), (sheet.x + deep, SHOJI_HIGH, z + half)
        bars.append(box("lattice", low, high, sides="+x +z -z"))
    for y in np.linspace(SHOJI_LOW, SHOJI_HIGH, 8)[1:-1]:
        low, high = (
            (sheet.x, y - half, sheet.north),
            (sheet.x + deep - 0.001, y + half, sheet.south),
        )
        bars.append(box("lattice", low, high, sides="+x +y -y"))
    return bars


def _north(width: float = 1.74) -> list[Part]:
    """Two sliding doors with a painted landscape, in black frames."""
    west, front = WEST + POST / 2, NORTH
    middle = west + width / 2
    parts = [
        box("wood.cypress", (west, -0.05, front - 0.03), (west + width, 0.006, front + 0.02)),
        box("wood.cypress", (west, 1.735, front - 0.03), (west + width, LINTEL, front + 0.02)),
    ]
    for number, (left, right) in enumerate(
        ((west, middle + 0.012), (middle - 0.012, west + width))
    ):
        z = front + (0.0, -0.022)[number]
        door = picture("landscape", (left, 0.006, z), (right - left, 0, 0), (0, 1.729, 0))
        share = np.array([(left - west) / width, (right - west) / width])
        parts.append(replace(door, uvs=np.stack([share[[0, 1, 1, 0]], door.uvs[:, 1]], -1)))
        edge = 0.018
        for low, high in (
            ((left, 0.006, z), (left + edge, 1.735, z + 0.006)),
            ((right - edge, 0.006, z), (right, 1.735, z + 0.006)),
            ((left + edge, 0.006, z), (right - edge, 0.006 + edge, z + 0.006)),
            ((left + edge, 1.735 - edge, z), (right - edge, 1.735, z + 0.006)),
        ):
            parts.append(box("lacquer", low, high))
        pull = (right - 0.075, left + 0.075)[number]
        parts.append(_upright(disc("brass", 0.027, 0.004, 32), (pull, 0.80, z)))
        parts.append(_upright(disc("lacquer", 0.018, 0.005, 32), (pull, 0.80, z)))
    return parts


def _upright(part: Part, at: tuple[float, float, float]) -> Part:
    """A thing that looks up turned to look south."""
    turn = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    normals = None if part.normals is None else part.normals @ turn.T
    return replace(part, positions=part.positions @ turn.T + np.asarray(at), normals=normals)


def _alcove() -> list[Part]:
    west, east, north, floor = ALCOVE_WEST, EAST, ALCOVE_NORTH, ALCOVE_FLOOR
    top = 2.28
    deep, high = NORTH - north, top - floor
    return [
        box("lacquer", (west, 0.0, NORTH - 0.10), (east, floor, NORTH + 0.0)),
        box("wood.zelkova", (west, 0, north), (east, floor, NORTH - 0.10), sides="+y"),
        quad("plaster.moss", (west, floor, north), (east - west, 0, 0), (0, high, 0)),
        quad("plaster.moss", (west, floor, NORTH), (0, 0, -deep), (0, high, 0)),
        quad("plaster.moss", (east, floor, north), (0, 0, deep), (0, high, 0)),
        quad("wood.cedar", (west, top, north), (east - west, 0, 0), (0, 0, deep)),
        box("wood.cypress", (west, 1.94, NORTH - 0.05), (east, 2.02, NORTH + 0.02)),
        quad("plaster.sand", (west, 2.02, NORTH), (east - west, 0, 0), (0, CEILING - 2.02, 0)),
        picture("scroll", (0.42, 0.66, north + 0.006), (0.44, 0, 0), (0, 1.17, 0)),
        box("lacquer", (0.395, 0.645, north + 0.002), (0.885, 0.665, north + 0.022)),
    ]


def _shelves() -> list[Part]:
    """Staggered shelves at the alcove's east end."""
    north = ALCOVE_NORTH
    front = north + 0.30
    return [
        box("wood.zelkova", (1.24, 0.78, north), (EAST, 0.802, front)),
        box("wood.zelkova", (1.02, 0.98, north), (1.50, 1.002, front)),
        box("wood.zelkova", (1.44, 0.802, front - 0.05), (1.465, 0.98, front - 0.025)),
        box("wood.smoked", (1.02, 1.002, north), (1.045, 1.022, front)),
    ]


def _walls() -> list[Part]:
    south, length = HALL, HALL - NORTH
    return [
        quad(
            "plaster.sand", (WEST, LINTEL, SOUTH), (0, 0, NORTH - SOUTH), (0, CEILING - LINTEL, 0)
        ),
        quad("plaster.sand", (WEST, 0, south), (0, 0, SOUTH - south), (0, CEILING, 0)),
        quad("plaster.sand", (EAST, 0, NORTH), (0, 0, length), (0, CEILING, 0)),
        quad("plaster.sand", (EAST, 0, south), (WEST - EAST, 0, 0), (0, CEILING, 0)),
        quad(
            "plaster.sand",
            (WEST, LINTEL, NORTH - 0.02),
            (ALCOVE_WEST - WEST, 0, 0),
            (0, CEILING - LINTEL, 0),
        ),
        box("wood.cypress", (EAST - 0.012, 0.0, NORTH), (EAST, 0.03, SOUTH), sides="-x +y"),
        quad("wood.floor", (WEST, -0.02, south), (EAST - WEST, 0, 0), (0, 0, SOUTH - south)),
        box("wood.cypress", (WEST, -0.05, SOUTH), (EAST, 0.002, SOUTH + 0.10)),
        quad("wood.floor", (WEST, -0.055, SOUTH), (EAST - WEST, 0, 0), (0, 0, NORTH - SOUTH)),
    ]


def _frame() -> list[Part]:
    """Posts and the rails between them; the alcove's post is a round log."""
    half = POST / 2
    posts = [(WEST, NORTH), (EAST, NORTH), (WEST, SOUTH), (EAST, SOUTH), (WEST, HALL), (EAST, HALL)]
    parts = [
        box("wood.cypress", (x - half, -0.05, z - half), (x + half, CEILING, z + half))
        for x, z in posts
    ]
    log = disc("wood.smoked", 0.052, CEILING, 40)
    parts.append(log.moved((ALCOVE_WEST - 0.03, 0, NORTH)))
    low, high = 1.79, 1.885
    parts += [
        box("wood.cypress", (WEST + 0.02, low, NORTH + half), (WEST + 0.055, high, SOUTH - half)),
        box("wood.cypress", (WEST + half, low, NORTH), (ALCOVE_WEST - 0.08, high, NORTH + 0.04)),
        box("wood.cypress", (EAST - 0.035, low, NORTH + half), (EAST, high, SOUTH - half)),
        box("wood.cypress", (WEST + half, LINTEL, SOUTH - 0.05), (EAST - half, 1.90, SOUTH + 0.05)),
        box(
            "plaster.sand", (WEST, 1.90, SOUTH - 0.03), (EAST, CEILING, SOUTH + 0.03), sides="+z -z"
        ),
    ]
    return parts


def _above() -> list[Part]:
    """The ceiling's boards and slats, and the frame of the lamp that hangs from it."""
    parts = [
        quad("wood.cedar", (WEST, CEILING, NORTH), (EAST - WEST, 0, 0), (0, 0, HALL - NORTH)),
        *(
            box("wood.cypress", (x - 0.014, CEILING - 0.03, NORTH), (x + 0.014, CEILING, SOUTH))
            for x in np.linspace(WEST, EAST, 9)[1:-1]
        ),
    ]
    half, low, high, bar = 0.26, 2.12, 2.27, 0.02
    for x in (-half, half - bar):
        for z in (-half, half - bar):
            parts.append(box("wood.smoked", (x, low, z), (x + bar, high, z + bar)))
    parts.append(box("wood.smoked", (-half, high, -half), (half, high + 0.02, half)))
    parts.append(box("wood.smoked", (-0.01, high + 0.02, -0.01), (0.01, CEILING, 0.01)))
    return parts


def assembled(parts: list[Part]) -> list[Part]:
    """One part a material and kind of normals, in the order of the materials' first use."""
    groups: dict[tuple[str, bool], list[Part]] = {}
    for part in parts:
        groups.setdefault((part.material, part.normals is not None), []).append(part)
    return [joined(group) for group in groups.values()]
