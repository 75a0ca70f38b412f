"""Light of probes: what leaks through a wall, and one engine against the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.prepared import Prepared
from andon.engines.probes import SceneProbes
from andon.harmonics import irradiance
from andon.pipeline import EngineName, Renderer
from andon.quantities import CameraFrame, Geometry, Material
from andon.spaces import look_at, pinhole_view
from andon.surface.load import surface_of_mesh
from andon.surface.model import ObjectInfo
from andon.surface.objects import joined
from andon.transport.probes.cells import build_cells
from andon.transport.probes.hidden import Walls, hidden_mix, walls_of
from andon.transport.probes.light import ProbeLight, probe_light
from andon.transport.probes.space import Mix, ProbeSpace
from andon.transport.probes.visibility import visible
from andon.verify.probe_rooms import (
    LitRoom,
    coloured_room,
    lattice,
    points_in,
    surfaces_of_dark_room,
    two_rooms,
    volume_of,
)
from andon.verify.registry import Row
from andon.verify.solids import icosphere

__all__ = ["ROWS", "ball_setting", "leaks", "leaks_in", "probe_parity"]

Float = NDArray[np.float64]
Method = Literal["off", "plain", "ours", "rays"]

# Of the wall, metres; and lattices: spacing in metres, turn in degrees, shift in spacings.
THICKNESSES_M = (0.0, 0.1, 0.2)
LATTICES = ((1.0, 17.0, (0.3, 0.1)), (1.3, 30.0, (0.1, 0.4)), (0.8, 8.0, (0.45, 0.2)))
# In each room, of each of the nine scenes.
POINTS = 1000
# What implementations of Majercik et al. 2019 leave to a hidden probe.
USUAL_LEAST = 0.05


def _weights(method: Method, room: LitRoom, walls: Walls, mix: Mix, points: Float, n: Float) -> Mix:
    if method == "off":
        return mix
    if method == "ours":
        return hidden_mix(walls, mix, points, n)
    if method == "plain":
        share = visible(walls.distances, walls.capture_positions, mix.probes, points, n, cut=0)
        share = np.maximum(share, USUAL_LEAST)
    else:
        rays = [room.rays.is_visible(points, walls.positions[mix.probes[:, k]]) for k in range(4)]
        share = np.stack(rays, axis=1).astype(float)
    kept = mix.weights * share
    total = kept.sum(axis=1, keepdims=True)
    return replace(mix, weights=np.where(total > 0, kept / np.where(total > 0, total, 1), 0))


@cache
def _scene(thickness: float, number: int) -> tuple[LitRoom, ProbeSpace, Walls, Float, Float]:
    """Room, space, walls, convolved coefficients, and true coefficients at the lit points."""
    room = two_rooms(thickness)
    volume = volume_of(room, lattice(*LATTICES[number]))
    cells = build_cells(volume.positions, volume.zones)
    volume = replace(volume, cells=cells)
    walls = walls_of(volume, cells)
    assert walls is not None
    truth, _ = room.captured(points_in(thickness, POINTS)[0], 16)
    return room, ProbeSpace(volume), walls, volume.states["default"], truth


def _normals(towards_wall: bool, seed: int) -> tuple[Float, Float]:
    """Of the points in the lit and in the dark room."""
    if towards_wall:
        one = np.tile([1.0, 0, 0], (POINTS, 1))
        return one, -one
    drawn = np.random.default_rng(seed).normal(size=(2, POINTS, 3))
    lit, dark = drawn / np.linalg.norm(drawn, axis=-1, keepdims=True)
    return lit, dark


@cache
def leaks_on_surfaces(method: Method) -> float:
    """% of the lit room's mean that reaches the floor, ceiling and walls of the dark one.

    The worst of all scenes with a wall; the wall itself is the hardest of these.
    """
    worst = 0.0
    for thickness in THICKNESSES_M:
        for number in range(len(LATTICES)):
            room, space, walls, coefficients, truth = _scene(thickness, number)
            lit_normals = _normals(False, number)[0]
            lit_lux = np.maximum(irradiance(truth, lit_normals), 0).mean()
            points, normals = surfaces_of_dark_room(thickness, POINTS)
            mix = _weights(method, room, walls, space.locate(points), points, normals)
            mixed = space.mixed(mix, coefficients)
            leaked = np.maximum(irradiance(mixed, normals), 0).mean()
            worst = max(worst, 100 * float(leaked / lit_lux))
    return worst


@cache
def leaks(method: Method) -> tuple[float, float]:
    """The worst of all scenes: dark room's mean in % of the lit one's; % of error in the lit one.

    The normals of surfaces at the points look anywhere, or all at the wall, which is worse: then
    points are lifted towards it. The error is the root of the mean square in the lit room, in % of
    that without any visibility.
    """
    worst = np.zeros(2)
    for thickness in THICKNESSES_M:
        for number in range(len(LATTICES)):
            for towards_wall in (False, True):
                found = leaks_in(method, thickness, number, towards_wall)
                worst = np.maximum(worst, found)
    return float(worst[0]), float(worst[1])


def leaks_in(
    method: Method, thickness: float, number: int, towards_wall: bool
) -> tuple[float, float]:
    """`leaks` in one scene: the wall's thickness in metres, which lattice, which normals."""
    room, space, walls, coefficients, truth = _scene(thickness, number)
    lit, dark = points_in(thickness, POINTS)
    normals = _normals(towards_wall, number)

    def looked_up(how: Method, points: Float, n: Float) -> Float:
        mix = _weights(how, room, walls, space.locate(points), points, n)
        mixed = space.mixed(mix, coefficients)
        return np.maximum(irradiance(mixed, n), 0)

    true_lux = np.maximum(irradiance(truth, normals[0]), 0)
    ours, plain = (looked_up(how, lit, normals[0]) for how in (method, "off"))
    error, before = (np.sqrt(np.mean((lux - true_lux) ** 2)) for lux in (ours, plain))
    leaked = looked_up(method, dark, normals[1])
    return 100 * float(leaked.mean() / ours.mean()), 100 * float(error / before)


def _balls() -> tuple[Geometry, tuple[ObjectInfo, ...]]:
    """Three white balls on the floor of the coloured room."""
    solid = icosphere(0.35, 12)
    normals = solid.positions / np.linalg.norm(solid.positions, axis=1, keepdims=True)
    triangles = solid.triangles.astype(np.int32)
    parts = [
        Geometry(
            solid.positions + np.array(centre),
            triangles,
            normals,
            materials=(Material("white", (0.9, 0.9, 0.9)),),
        )
        for centre in ((-0.95, -0.9, -0.5), (0.0, -0.9, -0.9), (0.95, -0.9, -0.5))
    ]
    infos = [ObjectInfo(f"ball {n}", n, 1, len(part.triangles)) for n, part in enumerate(parts)]
    return joined(parts), tuple(infos)


@cache
def _coloured_light() -> ProbeLight:
    steps = np.linspace(-1.3, 1.3, 4)
    places = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    return probe_light(volume_of(coloured_room(), places))


def ball_setting(
    lookup: Literal["pixel", "object"] = "pixel",
    *,
    visibility: bool = True,
    width: int = 640,
    height: int = 480,
) -> Prepared:
    """White balls between a red and a green wall, lit by 64 probes alone."""
    room, light = coloured_room(), _coloured_light()
    focal = 0.8 * width
    pose = look_at(np.array([0.0, 0.1, 1.45]), np.array([0.0, -0.25, -1.0]))
    view = pinhole_view(width, height, focal, pose)
    unit = 40.0  # cd/m² of white: the brightest wall has 33
    photo = (room.photographed(view) / unit).astype(np.float32)
    balls, infos = _balls()
    surface = surface_of_mesh(room.geometry, view.position)
    return Prepared(
        frames={view.name: CameraFrame(photo, view, luminance_per_unit=unit)},
        surface=replace(surface, objects=balls, casters=balls, objects_table=infos),
        ambient=Ambient(np.full(3, 100.0)),
        lamps=lambda _: (),
        probes=SceneProbes(light if visibility else replace(light, walls=None), lookup),
    )


@cache
def probe_parity(lookup: Literal["pixel", "object"]) -> tuple[float, float]:
    """Of the pixels that show an object in both engines: % within 5/255; mean difference."""
    setting = ball_setting(lookup)
    engines: tuple[EngineName, EngineName] = ("reference", "gpu")
    slow, fast = (Renderer(setting, engine).render() for engine in engines)
    both = slow.surface.is_object & fast.surface.is_object
    difference = np.abs(slow.image.rgb[both].astype(int) - fast.image.rgb[both])
    return 100 * float((difference.max(axis=1) <= 5).mean()), float(difference.mean())


def _row(name: str, bar: float | None, unit: str, against: str, figure: Callable[[], float]) -> Row:
    return Row(f"probes.{name}", "probes", bar, unit, against, figure)


TWO_ROOMS = "two rooms, one lit: the worst of 3 walls × 3 lattices × 2 kinds of normals"
BALLS = "the reference engine, white balls between coloured walls, pixels of objects"

ROWS: tuple[Row, ...] = (
    _row("leaks", 2, "% of the lit room", TWO_ROOMS, lambda: leaks("ours")[0]),
    _row("leaks.lit_error", 110, "% of that without", TWO_ROOMS, lambda: leaks("ours")[1]),
    _row(
        "leaks.surfaces",
        None,
        "% of the lit room",
        f"{TWO_ROOMS}; on the dark room's own surfaces",
        lambda: leaks_on_surfaces("ours"),
    ),
    _row(
        "leaks.surfaces.off",
        None,
        "% of the lit room",
        f"{TWO_ROOMS}; on the dark room's own surfaces",
        lambda: leaks_on_surfaces("off"),
    ),
    _row("leaks.off", None, "% of the lit room", TWO_ROOMS, lambda: leaks("off")[0]),
    _row(
        "leaks.plain",
        None,
        "% of the lit room",
        f"{TWO_ROOMS}; Majercik et al. 2019, at least 5 %",
        lambda: leaks("plain")[0],
    ),
    _row("leaks.rays", None, "% of the lit room", f"{TWO_ROOMS}; rays", lambda: leaks("rays")[0]),
    _row(
        "leaks.rays.lit_error",
        None,
        "% of that without",
        f"{TWO_ROOMS}; rays",
        lambda: leaks("rays")[1],
    ),
    Row(
        "probes.parity.within_5",
        "probes",
        99.9,
        "% of pixels",
        BALLS,
        lambda: min(probe_parity("pixel")[0], probe_parity("object")[0]),
        at_least=True,
    ),
    _row(
        "parity.mean",
        0.5,
        "1/255",
        BALLS,
        lambda: max(probe_parity("pixel")[1], probe_parity("object")[1]),
    ),
)
