"""How far bounces through probes, and by Radiance, are from the truth: irradiance in free air.

::

    bake ─coefficients▶ E(n) of 24 directions  ── against ──  rtrace -I at the same places

The scenes are a furnace, whose light is a closed form, and a box with a red and a green wall, a
block in it and a lamp below its ceiling (after Goral et al. 1984). The truth asks Radiance at the
probes themselves, not at what they see, with more rays, and has all bands: what nine coefficients
cut off counts as error. A second figure holds against the truth what bounces add, E_k − E_1, since
the first pictures are the same in both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.bake import bake_probes
from andon.bake.tasks import write_bundle
from andon.engines.cubes import cube_setting
from andon.engines.cubes_radiance import LAMPS, light_scenes
from andon.engines.prepared import prepare
from andon.files.radiance_programs import run_radiance
from andon.harmonics import cube_directions, irradiance
from andon.scene import Scene, scene_from_dict
from andon.surface.still import still_geometry
from andon.transport.baked.radiance.scene import OCTREE
from andon.transport.baked.radiance.text import LUMENS_PER_WATT
from andon.transport.probes.placement import place_probes

__all__ = ["BounceErrors", "By", "bounce_errors", "box_scene", "furnace_error", "true_irradiance"]

Float = NDArray[np.float64]
By = Literal["probes", "radiance"]

RHO, EMITTED = 0.6, 2.0
HALF_M = 1.5
# Of each hemisphere of the truth.
RAYS = 4096

# Side: quads of corners (0…1)³, counter-clockwise from outside, and their material.
_WALLS = {
    "left": ("red", "000 001 011 010"),
    "right": ("green", "100 110 111 101"),
    "floor": ("white", "000 100 101 001"),
    "ceiling": ("white", "010 011 111 110"),
    "back": ("white", "000 010 110 100"),
    "front": ("white", "001 101 111 011"),
}
_COLOURS = {"red": (0.63, 0.06, 0.05), "green": (0.14, 0.45, 0.09), "white": (0.73, 0.71, 0.68)}
# The block: its lowest and highest corner, metres, world.
_BLOCK = ((-0.9, -1.5, -0.9), (-0.1, 0.1, -0.2))
# Where light is measured, metres: free air, none of it on a lattice.
_PLACES = ((0.7, -0.6, 0.8), (0.9, 0.5, -0.7), (-0.8, 0.7, 0.6), (-0.2, -0.9, 0.9))
_LAMP = {"kind": "point", "position": [0.1, 0.9, 0.1], "intensity_cd": 100.0}


@dataclass(frozen=True)
class BounceErrors:
    """Of the irradiance around all probes, as shares of its mean.

    Attributes
    ----------
    rms : root of the mean square error.
    bias : mean error, with its sign.
    added_rms, added_bias : of what bounces beyond the first add, as shares of that.
    """

    rms: float
    bias: float
    added_rms: float
    added_bias: float


def _quads(low: Float, high: Float, *, outside: bool, first: int) -> tuple[str, dict[str, str]]:
    """Wavefront text of a box's eight corners, and of its sides."""
    corners = [low + (high - low) * [x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    text = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in np.array(corners).tolist())
    sides: dict[str, str] = {}
    for name, (_, words) in _WALLS.items():
        numbers = [first + int(word, 2) for word in words.split()]
        sides[name] = "f " + " ".join(map(str, numbers if outside else numbers[::-1])) + "\n"
    return text, sides


def _write_box(folder: Path, *, block: bool, emitted: float) -> None:
    walls, sides = _quads(np.full(3, -HALF_M), np.full(3, HALF_M), outside=False, first=1)
    text = "mtllib box.mtl\n" + walls
    for name, (colour, _) in _WALLS.items():
        text += f"usemtl {colour}\n{sides[name]}"
    if block:
        low, high = np.array(_BLOCK)
        more, sides = _quads(low, high, outside=True, first=9)
        text += more + "usemtl white\n" + "".join(sides.values())
    (folder / "box.obj").write_text(text, encoding="ascii")
    lines = [
        f"newmtl {name}\nKd {_row([RHO] * 3 if emitted else rho)}\nKe {_row([emitted] * 3)}\n"
        for name, rho in _COLOURS.items()
    ]
    (folder / "box.mtl").write_text("".join(lines), encoding="ascii")


def _row(values: Any) -> str:
    return " ".join(f"{value:g}" for value in values)


def box_scene(
    folder: Path,
    /,
    *,
    furnace: bool = False,
    side: int = 0,
    reach: float = 0.8,
    **probes: Any,
) -> Scene:
    """The box, or the furnace, with probes where light is measured; its mesh is written.

    Beside them there is a lattice of `side`³ that reaches as far as this share of the way to the
    walls; 0: none. `probes` are keys of [probes] that are otherwise than here.
    """
    _write_box(folder, block=not furnace, emitted=EMITTED if furnace else 0.0)
    lattice = {"kind": "lattice", "counts": [side] * 3, "offset_m": 0.0}
    lattice |= {"low": [-reach * HALF_M] * 3, "high": [reach * HALF_M] * 3}
    table: dict[str, Any] = {
        "volume": "box.glb",
        "cube_size_px": 16,
        "place": [{"position": place} for place in _PLACES],
        "placement": lattice if side else {"kind": "hand"},
    }
    tables: dict[str, Any] = {"surface": {"mesh": "box.obj"}, "probes": table | probes}
    return scene_from_dict(tables | ({} if furnace else {"lamp": [_LAMP]}), folder=folder)


def _baked(scene: Scene, engine: str) -> tuple[Float, Float]:
    """(n, k, 3) coefficients, and where they are, (n, 3)."""
    placed = place_probes(scene, still_geometry(scene))
    volume = bake_probes(scene, placed, engine=engine).volume
    return next(iter(volume.states.values())), volume.capture_positions


def true_irradiance(scene: Scene, places: Float, normals: Float, bounces: int, /) -> Float:
    """(n, d, 3) lux at places (n, 3) that face normals (d, 3), without what lamps give directly.

    Light that was reflected 1 … `bounces` times, and what emits.
    """
    setting = cube_setting(scene, prepare(scene, drawn=False))
    points, facing = np.repeat(places, len(normals), 0), np.tile(normals, (len(places), 1))
    rays = np.concatenate([points, facing], axis=1)
    lux = np.zeros((len(rays), 3))
    # What surfaces show of `bounces` reflections reaches free air after one more of Radiance's.
    for light, files in light_scenes(setting, bounces + 1).items():
        with TemporaryDirectory() as name:
            write_bundle(Path(name), files)
            if light == LAMPS:
                lux += _traced(Path(name), rays, bounces) - _traced(Path(name), rays, 0)
            else:
                lux += _traced(Path(name), rays, bounces + 1)
    return lux.reshape(len(places), len(normals), 3)


def _traced(folder: Path, rays: Float, bounces: int) -> Float:
    """Lux of rays (n, 6), every one by itself: nothing kept for reuse, random numbers that do not
    begin alike (-u+). With those that do, paths that end by chance are 3 % too bright here."""
    words = ["-I", "-h", "-w", "-fdd", "-n", "1", "-u+", "-dt", "0", "-dc", "1", "-dj", "0"]
    words += ["-ab", str(bounces), "-ad", str(RAYS), "-as", "0", "-aa", "0"]
    words += ["-lw", f"{1 / RAYS:g}", "-lr", f"{-(bounces + 8)}", OCTREE]
    answer = run_radiance("rtrace", words, rays.tobytes(), 600.0, cwd=folder)
    return np.frombuffer(answer, np.float64).reshape(-1, 3) * LUMENS_PER_WATT


@cache
def furnace_error(by: By, bounces: int, quality: str = "draft", engine: str = "auto") -> float:
    """Largest relative error of the mean light in the furnace, against its closed form."""
    own: dict[str, Any] = {"bounces_quality": quality} if by == "radiance" else {}
    with TemporaryDirectory() as name:
        scene = box_scene(
            Path(name), furnace=True, bounces=bounces, bounces_by=by, cube_size_px=8, **own
        )
        light, _ = _baked(scene, engine)
    expected = EMITTED * sum(RHO**k for k in range(bounces + 1)) * np.sqrt(4 * np.pi)
    return float(np.abs(light[:, 0] / expected - 1).max())


@cache
def _box_truth(bounces: int) -> Float:
    with TemporaryDirectory() as name:
        scene = box_scene(Path(name))
        places = np.array(_PLACES)
        return true_irradiance(scene, places, _normals(), bounces)


def _normals() -> Float:
    return cube_directions(2).reshape(-1, 3)


@cache
def _box_light(by: By, bounces: int, engine: str, own: tuple[tuple[str, Any], ...]) -> Float:
    """(4, d, 3) lux where light is measured."""
    with TemporaryDirectory() as name:
        scene = box_scene(Path(name), bounces=bounces, bounces_by=by, **dict(own))
        light, places = _baked(scene, engine)
    assert np.allclose(places[: len(_PLACES)], _PLACES)
    return irradiance(light[: len(_PLACES), None], _normals())


def bounce_errors(by: By, bounces: int, /, *, engine: str = "auto", **own: Any) -> BounceErrors:
    """Errors in the box after 2 or more bounces; `own` are other arguments of `box_scene`."""
    # Radiance asks nothing of the other probes.
    keys = tuple(own.items()) if by == "radiance" else tuple(({"side": 2} | own).items())
    light = _box_light(by, bounces, engine, keys)
    first = _box_light("probes", 1, engine, ())
    right, once = (_box_truth(k) for k in (bounces, 1))
    error, added = light - right, right - once
    change = (light - first) - added
    return BounceErrors(
        float(np.sqrt((error**2).mean()) / right.mean()),
        float(error.mean() / right.mean()),
        float(np.sqrt((change**2).mean()) / added.mean()),
        float(change.mean() / added.mean()),
    )
