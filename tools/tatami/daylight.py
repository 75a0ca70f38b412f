"""The light in the room, by Radiance: daylight through the shoji, a lamp at the ceiling.

E0 at a point is the sum of three runs of `rtrace -I`, because no single one is both clean and fast:

============ ============================== ===================================== ============
run          geometry                       lamps                                 bounces
============ ============================== ===================================== ============
sheets       all but paper and lattice      the papers, cut into many rectangles  none
lamp         all                            its faces, cut into many rectangles   none
bounce       all but the lattice            few small ones of the same flux       with − none
============ ============================== ===================================== ============

Each row of rectangles is shifted against the one before, so that the steps of their shadows melt
into each other. The lattice
is too fine to matter for the room, but would throw the pattern of the cuts onto everything.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from dataclasses import dataclass, replace
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.lamps.colour import factors_from_temperature
from andon.quantities import Geometry, Material
from andon.responses import srgb_decode
from tatami.building import SHOJI_HIGH, SHOJI_LOW, shoji_sheets

Float = NDArray[np.float64]

LUMENS_PER_WATT = 179.0  # Radiance's own
SHOJI_CD_M2, LAMP_CD_M2 = 112.0, 3400.0
# The camera's white balance: light of its temperature has equal channels, in the photograph and in
# E0 alike.
WHITE = factors_from_temperature(5600.0)
SHOJI_RGB = factors_from_temperature(6500.0, daylight=True) / WHITE
LAMP_RGB = factors_from_temperature(5200.0) / WHITE
# The lattice covers this share of the paper.
LATTICE_SHARE = 0.09
# The bounced run's lamp shines down only: of its sides' light this share is counted.
SIDES_COUNT = 0.5
LAMP_HALF, LAMP_LOW, LAMP_HIGH = 0.238, 2.125, 2.265
DIRECT = "-u- -ab 0 -ds 0.25 -dj 0.5 -dt 0 -dc 1 -dr 0"
BOUNCE = "-u- -ab {} -ds 0 -dj 0 -dt 0 -dc 1 -dr 0 -ad 800 -as 200 -aa 0.16 -ar 80 -lw 2e-3 -lr 6"
BOUNCES = 3


@dataclass(frozen=True)
class Patch:
    """A flat lamp: a corner and two sides (3,), shining along × up with (3,) cd/m²."""

    corner: Float
    along: Float
    up: Float
    luminance: Float


def illuminance(
    geometry: Geometry, points: Float, normals: Float, order: NDArray[np.int64]
) -> Float:
    """(n, 3) lx at points (n, 3) that face normals (n, 3).

    `order` are the indices of points that are asked first for bounced light, so that the values
    between which Radiance interpolates lie evenly.
    """
    outer = ("paper.shoji", "lattice")
    rays = np.concatenate([points, normals], axis=1)
    sheets = _run(geometry, outer, shoji_patches(6, 5), DIRECT, rays)
    sheets = np.where(_beside_paper(points, normals)[:, None], _BESIDE_LUX, sheets)
    lamp = _run(geometry, (), lamp_patches(5, 4), DIRECT, rays)
    few = [_shrunk(patch) for patch in _few()]
    asked = np.concatenate([rays[order], rays])
    total = _run(geometry, ("lattice",), few, BOUNCE.format(BOUNCES), asked)[len(order) :]
    direct = _run(geometry, ("lattice",), few, BOUNCE.format(0), rays)
    return sheets + lamp + np.maximum(total - direct, 0)


# On a bar that stands on the paper: half of what it sees is paper, less the next bars' share.
_BESIDE_LUX = 0.85 / 2 * np.pi * SHOJI_CD_M2 * SHOJI_RGB


def _beside_paper(points: Float, normals: Float) -> NDArray[np.bool_]:
    """(n,) the sides of lattice and stiles, which are too near the paper to be sampled."""
    inside = (points[:, 1] > SHOJI_LOW - 1e-4) & (points[:, 1] < SHOJI_HIGH + 1e-4)
    inside &= np.abs(normals[:, 0]) < 0.1
    near = np.zeros(len(points), bool)
    for sheet in shoji_sheets():
        along = (points[:, 2] > sheet.north - 1e-4) & (points[:, 2] < sheet.south + 1e-4)
        depth = points[:, 0] - sheet.x
        near |= along & (depth > -1e-4) & (depth < 0.02)
    return inside & near


def _few() -> list[Patch]:
    """The lamps of the run for bounced light."""
    luminance = SHOJI_CD_M2 * SHOJI_RGB * (1 - LATTICE_SHARE)
    patches: list[Patch] = []
    for sheet in shoji_sheets():
        half = np.array([0, (SHOJI_HIGH - SHOJI_LOW) / 2, 0])
        along = np.array([0, 0, sheet.north - sheet.south])
        corner = np.array([sheet.x, SHOJI_LOW, sheet.south])
        patches += [Patch(corner + k * half, along, half, luminance) for k in (0, 1)]
    h = LAMP_HALF
    below = Patch(
        np.array([-h, LAMP_LOW, -h]),
        np.array([2 * h, 0, 0]),
        np.array([0, 0, 2 * h]),
        LAMP_CD_M2 * LAMP_RGB,
    )
    # Its sides have this share of its lower face.
    sides = 4 * (LAMP_HIGH - LAMP_LOW) / (2 * h)
    dim = below.luminance * sides * SIDES_COUNT
    return [*patches, replace(below, luminance=below.luminance + dim)]


def shoji_patches(rows: int, columns: int) -> list[Patch]:
    """Each sheet of paper as rectangles, a little behind the paper's place."""
    luminance = SHOJI_CD_M2 * SHOJI_RGB * (1 - LATTICE_SHARE)
    patches: list[Patch] = []
    for number, sheet in enumerate(shoji_sheets()):
        corner = np.array([sheet.x + 0.0005, SHOJI_LOW, sheet.south])
        along = np.array([0, 0, sheet.north - sheet.south])
        whole = Patch(corner, along, np.array([0, SHOJI_HIGH - SHOJI_LOW, 0]), luminance)
        turned = number % 2
        patches += _cut(_turned(whole), columns, rows) if turned else _cut(whole, rows, columns)
    return patches


def lamp_patches(below: int, sides: int) -> list[Patch]:
    """The lamp's paper: two halves of its lower face, each `below` × `below`, and its sides."""
    h, high = LAMP_HALF, LAMP_HIGH - LAMP_LOW
    luminance = LAMP_CD_M2 * LAMP_RGB
    ring = np.array([(-h, LAMP_LOW, h), (h, LAMP_LOW, h), (h, LAMP_LOW, -h), (-h, LAMP_LOW, -h)])
    patches: list[Patch] = []
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        patches += _cut(Patch(a, b - a, np.array([0, high, 0]), luminance), sides, sides)
    half, deep = np.array([h, 0, 0]), np.array([0, 0, 2 * h])
    patches += _cut(Patch(ring[3], half, deep, luminance), below, below)
    patches += _cut(_turned(Patch(ring[3] + half, half, deep, luminance)), below, below)
    return patches


def _cut(patch: Patch, rows: int, columns: int) -> list[Patch]:
    """Cut into rows along `along`, each into columns that are shifted against the row before."""
    golden = (np.sqrt(5) - 1) / 2
    pieces: list[Patch] = []
    for row in range(rows):
        inner = (np.arange(columns) + np.mod((row + 0.5) * golden, 1)) / columns
        edges = np.concatenate([[0.0], inner, [1.0]])
        corner = patch.corner + patch.up * row / rows
        for left, right in pairwise(edges):
            along = patch.along * (right - left)
            pieces.append(
                Patch(corner + patch.along * left, along, patch.up / rows, patch.luminance)
            )
    return pieces


def _turned(patch: Patch) -> Patch:
    """The same with its sides exchanged, so that it is cut the other way."""
    return Patch(patch.corner + patch.along, patch.up, -patch.along, patch.luminance)


def _shrunk(patch: Patch, side: float = 0.012) -> Patch:
    """A small square in the middle, in front, with the same flux."""
    a, b = (v / np.linalg.norm(v) for v in (patch.along, patch.up))
    facing = np.cross(a, b)
    middle = patch.corner + (patch.along + patch.up) / 2 + 0.02 * facing
    area = np.linalg.norm(np.cross(patch.along, patch.up)) / side**2
    return Patch(middle - (a + b) * side / 2, a * side, b * side, patch.luminance * area)


def _run(
    geometry: Geometry, without: tuple[str, ...], patches: list[Patch], options: str, rays: Float
) -> Float:
    """(n, 3) lx by one run of `rtrace -I` on one core."""
    with tempfile.TemporaryDirectory(prefix="andon-tatami-") as name:
        folder = Path(name)
        text = _surfaces(geometry, without) + "".join(map(_lamp, patches, range(len(patches))))
        (folder / "scene.rad").write_text(text, encoding="ascii")
        octree = _program(["oconv", "-f", str(folder / "scene.rad")], b"")
        (folder / "scene.oct").write_bytes(octree)
        command = ["rtrace", "-h", "-w", "-I", "-fdd", *options.split(), str(folder / "scene.oct")]
        answer = _program(command, np.ascontiguousarray(rays, np.float64).tobytes())
    return np.frombuffer(answer, np.float64).reshape(-1, 3) * LUMENS_PER_WATT


def _program(command: list[str], feed: bytes) -> bytes:
    spec = find_spec("pyradiance")
    if spec is None or spec.origin is None:
        raise SystemExit("Radiance is missing: pip install 'andon[radiance]'")
    folder = Path(spec.origin).parent
    environment = dict(os.environ, RAYPATH=str(folder / "lib"))
    program = str(folder / "bin" / command[0])
    return subprocess.run(
        [program, *command[1:]], input=feed, stdout=subprocess.PIPE, env=environment, check=True
    ).stdout


def mean_reflectance(material: Material) -> Float:
    """(3,) linear, the texture's mean included."""
    factor = np.asarray(material.reflectance, float)
    if material.texture is None:
        return factor
    return factor * srgb_decode(np.asarray(material.texture) / 255.0).mean(axis=(0, 1))


def _surfaces(geometry: Geometry, without: tuple[str, ...]) -> str:
    assert geometry.material_ids is not None
    corners = geometry.positions[geometry.triangles]
    text: list[str] = []
    for number, material in enumerate(geometry.materials):
        if material.name in without:
            continue
        red, green, blue = mean_reflectance(material).tolist()
        text.append(f"void plastic m{number} 0 0 5 {red:.6f} {green:.6f} {blue:.6f} 0 0\n")
        for k in np.flatnonzero(geometry.material_ids == number).tolist():
            numbers = " ".join(f"{value:.9g}" for value in corners[k].reshape(-1).tolist())
            text.append(f"m{number} polygon t{k} 0 0 9 {numbers}\n")
    return "".join(text)


def _lamp(patch: Patch, number: int) -> str:
    red, green, blue = (patch.luminance / LUMENS_PER_WATT).tolist()
    a, b, c = patch.corner, patch.corner + patch.along, patch.corner + patch.along + patch.up
    corners = np.concatenate([a, b, c, patch.corner + patch.up]).tolist()
    numbers = " ".join(f"{value:.9g}" for value in corners)
    return (
        f"void light g{number} 0 0 3 {red!r} {green!r} {blue!r}\n"
        f"g{number} polygon p{number} 0 0 12 {numbers}\n"
    )
