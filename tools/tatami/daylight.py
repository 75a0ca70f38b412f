"""The light in the room, by Radiance: daylight through the shoji, a lamp at the ceiling.

E0 at a point is the sum of three runs of `rtrace -I`, because no single one is both clean and fast:

============ ============================== ===================================== ============
run          geometry                       lamps                                 bounces
============ ============================== ===================================== ============
sheets       all but paper and lattice      the papers, cut into many rectangles  none
lamp         all                            its faces, cut into many rectangles   none
bounce       all but the lattice            few small ones of the same flux       with − none
============ ============================== ===================================== ============

Rectangles are cut unevenly, so that the steps of their shadows melt into each other. The lattice
is too fine to matter for the room, but would throw the pattern of the cuts onto everything.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.lamps.colour import factors_from_temperature
from andon.quantities import Geometry, Material
from andon.responses import srgb_decode
from tatami.building import SHOJI_HIGH, SHOJI_LOW, shoji_sheets

Float = NDArray[np.float64]

LUMENS_PER_WATT = 179.0  # Radiance's own
SHOJI_CD_M2, LAMP_CD_M2 = 180.0, 3400.0
SHOJI_RGB = factors_from_temperature(6300.0, daylight=True)
LAMP_RGB = factors_from_temperature(4300.0)
# The lattice covers this share of the paper.
LATTICE_SHARE = 0.09
LAMP_HALF, LAMP_LOW, LAMP_HIGH = 0.238, 2.125, 2.265
DIRECT = "-ab 0 -ds 0.25 -dj 0 -dt 0 -dc 1 -dr 0"
BOUNCE = "-ab {} -ds 0 -dj 0 -dt 0 -dc 1 -dr 0 -ad 700 -as 200 -aa 0.18 -ar 32 -lw 2e-3 -lr 6"
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
    sheets = _run(geometry, outer, shoji_patches(36), DIRECT, rays)
    lamp = _run(geometry, (), lamp_patches(48, 3), DIRECT, rays)
    few = [_shrunk(patch) for patch in shoji_patches(2) + lamp_patches(1, 1)[:1]]
    asked = np.concatenate([rays[order], rays])
    total = _run(geometry, ("lattice",), few, BOUNCE.format(BOUNCES), asked)[len(order) :]
    direct = _run(geometry, ("lattice",), few, BOUNCE.format(0), rays)
    return sheets + lamp + np.maximum(total - direct, 0)


def shoji_patches(count: int) -> list[Patch]:
    """Each sheet of paper as `count` rectangles, a little behind the paper's place."""
    luminance = SHOJI_CD_M2 * SHOJI_RGB * (1 - LATTICE_SHARE)
    patches: list[Patch] = []
    for number, sheet in enumerate(shoji_sheets()):
        corner = np.array([sheet.x + 0.0005, SHOJI_LOW, sheet.south])
        along, up = (
            np.array([0, 0, sheet.north - sheet.south]),
            np.array([0, SHOJI_HIGH - SHOJI_LOW, 0]),
        )
        whole = Patch(corner, along, up, luminance)
        patches += _cut(whole, count, np.random.default_rng(number))
    return patches


def lamp_patches(below: int, sides: int) -> list[Patch]:
    """The lamp's paper: its lower face as `below` rectangles, each side as `sides`."""
    h, high = LAMP_HALF, LAMP_HIGH - LAMP_LOW
    luminance = LAMP_CD_M2 * LAMP_RGB
    up = np.array([0, high, 0])
    corners = [
        np.array(p, float)
        for p in ((-h, LAMP_LOW, h), (h, LAMP_LOW, h), (h, LAMP_LOW, -h), (-h, LAMP_LOW, -h))
    ]
    around = [
        Patch(a, b - a, up, luminance)
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    floor = Patch(corners[3], np.array([2 * h, 0, 0]), np.array([0, 0, 2 * h]), luminance)
    generator = np.random.default_rng(9)
    patches = _cut(floor, below, generator)
    for side in around:
        patches += _cut(side, sides, generator)
    return patches


def _cut(patch: Patch, count: int, generator: np.random.Generator) -> list[Patch]:
    """Cut into `count` rectangles of nearly one size, never quite in the middle."""
    if count == 1:
        return [patch]
    share = count // 2 / count * generator.uniform(0.88, 1.12)
    a, b = patch.along, patch.up
    if np.linalg.norm(a) > np.linalg.norm(b):
        parts = (Patch(patch.corner, a * share, b, patch.luminance),)
        parts += (Patch(patch.corner + a * share, a * (1 - share), b, patch.luminance),)
    else:
        parts = (Patch(patch.corner, a, b * share, patch.luminance),)
        parts += (Patch(patch.corner + b * share, a, b * (1 - share), patch.luminance),)
    counts = (count // 2, count - count // 2)
    return [
        piece for part, n in zip(parts, counts, strict=True) for piece in _cut(part, n, generator)
    ]


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
