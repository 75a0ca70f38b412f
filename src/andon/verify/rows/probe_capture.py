"""Rows of captures: closed forms, bounces, both engines, and what 8 bits lose."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.bake import bake_probes
from andon.composite.model import Ambient
from andon.engines.cubes import CubeSetting, cube_engine, cube_setting
from andon.engines.prepared import Prepared
from andon.harmonics import convolved, cube_directions, irradiance, project_cube
from andon.pipeline import EngineName
from andon.scene import Scene, scene_from_dict
from andon.surface.model import SurfaceModel
from andon.surface.virtual import with_mesh_as_object
from andon.transport.probes.capture import Capture, captured, quantised
from andon.transport.probes.placement import place_probes
from andon.verify.registry import Row
from andon.verify.setting import room, room_lamps

__all__ = ["ROWS"]

Float = NDArray[np.float64]

# Faces of the captures, as in the capture paper's experiments.
SIZE = 128
# Free air of the furnished room.
PLACES = np.array([[0.0, 1.5, 0.3], [-1.2, 1.9, 1.1], [1.3, 1.4, -0.5], [0.4, 2.1, -0.8]])
# ρ and ε of the furnace, and how often its light is reflected.
REFLECTANCE, EMITTED, BOUNCES = 0.6, 2.0, 5

# A cube of side 3 m that shows its inside, and emits.
_BOX = """\
mtllib box.mtl
usemtl wall
v -1.5 -1.5 -1.5
v 1.5 -1.5 -1.5
v 1.5 1.5 -1.5
v -1.5 1.5 -1.5
v -1.5 -1.5 1.5
v 1.5 -1.5 1.5
v 1.5 1.5 1.5
v -1.5 1.5 1.5
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 4 3 7 8
f 1 4 8 5
f 2 6 7 3
"""


@cache
def _furnace(engine: EngineName, bounces: int) -> Float:
    """(n, k, 3) light in a closed box whose walls emit and reflect evenly."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "box.obj").write_text(_BOX)
        rho, emitted = f"{REFLECTANCE} " * 3, f"{EMITTED} " * 3
        (folder / "box.mtl").write_text(f"newmtl wall\nKd {rho}\nKe {emitted}\n")
        placement = {"kind": "lattice", "counts": [2, 2, 2], "low": [-0.9] * 3, "high": [0.9] * 3}
        probes = {
            "volume": "box.glb", "cube_size_px": 32, "bounces": bounces, "placement": placement,
        }  # fmt: skip
        scene = scene_from_dict({"surface": {"mesh": "box.obj"}, "probes": probes}, folder=folder)
        from andon.surface.still import still_geometry

        baked = bake_probes(scene, place_probes(scene, still_geometry(scene)), engine=engine)
    return next(iter(baked.volume.states.values()))


def _uniform(engine: EngineName) -> float:
    """Largest relative error of the irradiance in uniform light L, against πL."""
    normals = cube_directions(4).reshape(-1, 3)
    lux = irradiance(_furnace(engine, 0)[:, None], normals)
    return float(np.abs(lux / (np.pi * EMITTED) - 1).max())


def _series(engine: EngineName) -> float:
    """Largest relative error of the mean light after five reflections."""
    expected = EMITTED * sum(REFLECTANCE**k for k in range(BOUNCES + 1)) * np.sqrt(4 * np.pi)
    return float(np.abs(_furnace(engine, BOUNCES)[:, 0] / expected - 1).max())


@cache
def _room_setting() -> CubeSetting:
    model = with_mesh_as_object(SurfaceModel(), room())
    lamps = room_lamps(4)
    prepared = Prepared({}, model, Ambient(np.ones(3), (0.0, 0.0, 0.0)), lambda _: lamps)
    return cube_setting(Scene(), prepared)


@cache
def _captures(engine: EngineName) -> tuple[Capture, ...]:
    setting = _room_setting()
    taker = cube_engine(setting, SIZE, engine)
    found: list[Capture] = []
    for place in PLACES:
        seen, lux = taker.look(place)
        assert lux is not None
        found.append(captured(seen, cube_directions(SIZE), setting.lighting, lux=lux))
    return tuple(found)


def _difference(a: Float, b: Float) -> float:
    """RMS over the sphere of the difference of two lights' irradiances, relative to their mean."""
    # By Parseval: the coefficients of irradiance are those of luminance times A_l.
    wrong, right = convolved(a - b), convolved(b)
    return float(np.sqrt((wrong**2).sum() / (right[..., 0, :] ** 2).sum()))


def _projected(captures: tuple[Capture, ...]) -> Float:
    return np.stack([project_cube(capture.luminance_cd_m2, 2) for capture in captures])


def _engines() -> float:
    return _difference(_projected(_captures("gpu")), _projected(_captures("reference")))


def _eight_bits() -> float:
    """The paper's cube maps: white is where one texel in a hundred of the first clips."""
    captures = _captures("reference")
    white = float(np.percentile(captures[0].luminance_cd_m2.max(axis=-1), 99))
    codes = [quantised(capture.luminance_cd_m2, white)[0] for capture in captures]
    return _difference(np.stack([project_cube(code, 2) for code in codes]), _projected(captures))


def _rows(engine: EngineName) -> tuple[Row, ...]:
    return (
        Row(
            f"probes.capture.uniform.{engine}",
            "probes",
            1e-6,
            "relative",
            "E = πL in uniform light, closed box that emits, 32² faces",
            lambda: _uniform(engine),
        ),
        Row(
            f"probes.capture.furnace.{engine}",
            "probes",
            1e-6,
            "relative",
            f"ε·(1 + ρ + … + ρ⁵) with ρ = {REFLECTANCE}, closed box, five bounces through probes",
            lambda: _series(engine),
        ),
    )


ROWS: tuple[Row, ...] = (
    *_rows("reference"),
    *_rows("gpu"),
    Row(
        "probes.capture.engines",
        "probes",
        0.01,
        "relative RMS",
        f"GPU against reference, irradiance, furnished room, 4 lamps, {SIZE}² faces",
        _engines,
    ),
    Row(
        "probes.capture.srgb8",
        "probes",
        None,
        "relative RMS",
        "8-bit sRGB cube maps against HDR ones, irradiance, 1 % of the first one's texels clipped",
        _eight_bits,
    ),
)
