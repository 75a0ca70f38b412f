"""Photographs of rooms whose light is known: reflectance and E0 of each pixel, and 8-bit codes.

==========  =====================================================================================
room        light, and what makes it hard
==========  =====================================================================================
window      daylight from a window on the left, a weak warm lamp at the ceiling; checked carpet
lamps       two warm bulbs, one close to a wall: E0 spans a factor of 30
mixed       a cool window and a warm floor lamp: the colour of E0 changes over the picture
papered     striped wallpaper, pictures on walls, planks: more edges of reflectance than of light
coloured    a bare room with a red and a green wall, lit from the ceiling: they colour each other
corridor    12 m long, two ceiling lamps, dark doors: light and dark alternate along it
flash       a known lamp close to the camera and little else: E0 falls with the square of distance
==========  =====================================================================================

E0 is Radiance's, three reflections included, on surfaces of one reflectance for each material.
Their textures, which the photograph has on top, are functions of the place and do not reflect.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.bake.tasks import write_bundle
from andon.lamps import Lamp, PointLamp, PolygonLamp
from andon.quantities import Geometry, Material, Surface
from andon.responses import SRGB
from andon.spaces import View, look_at, pinhole_view
from andon.surface import reference as surface
from andon.surface.load import surface_of_mesh
from andon.transport.baked.radiance import radiance_bundle
from andon.transport.baked.radiance.quality import QUALITIES
from andon.transport.baked.radiance.scene import BOUNCE_OCTREE, OCTREE
from andon.transport.baked.radiance.trace import traced_illuminance
from andon.verify.rooms import furnished_room
from andon.verify.solids import Solid, box, panel

__all__ = ["ROOMS", "LitRoom", "Photographed", "photographed"]

Float = NDArray[np.float64]
Texture = Callable[[Float, Float], Float]

WIDTH, HEIGHT = 160, 120
BOUNCES = 3
TILES = 8
# Of the photograph: sensor noise as a share of its white, at white, and what is clipped at the top.
NOISE = 0.004
CLIPPED = 0.003


@dataclass(frozen=True, eq=False)
class LitRoom:
    """A room, where it is photographed from, and what it is lit by.

    Attributes
    ----------
    geometry : with materials.
    eye, target : (3,) metres, of a camera of `hfov_degrees`.
    lamps : what lights the photograph.
    textures : material's name → factor (n,) or (n, 3) on its reflectance at positions (n, 3) with
        normals (n, 3).
    known : names of those lamps that the scene states.
    """

    geometry: Geometry
    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    lamps: tuple[Lamp, ...]
    textures: dict[str, Texture]
    known: tuple[str, ...] = ()
    hfov_degrees: float = 75.0

    @property
    def view(self) -> View:
        """The camera."""
        focal = WIDTH / 2 / np.tan(np.radians(self.hfov_degrees / 2))
        pose = look_at(np.array(self.eye), np.array(self.target))
        return pinhole_view(WIDTH, HEIGHT, focal, pose)


@dataclass(frozen=True, eq=False)
class Photographed:
    """What is known of a photograph.

    Attributes
    ----------
    codes : (H, W, 3) uint8 sRGB.
    e0_lux : (H, W, 3), NaN where nothing is seen.
    reflectance : (H, W, 3).
    seen : the surface.
    known : the lamps that the scene states.
    """

    codes: NDArray[np.uint8]
    e0_lux: Float
    reflectance: Float
    seen: Surface
    known: tuple[Lamp, ...]


# ── textures ──────────────────────────────────────────────────────────────────────────────────


def _hash(*cells: Float) -> Float:
    """(n,) in [0, 1), the same for the same whole numbers."""
    mixed = sum(
        np.round(cell) * step for cell, step in zip(cells, (12.9898, 78.233, 37.719), strict=False)
    )
    found: Float = np.modf(np.abs(np.sin(mixed)) * 43758.5453)[0]
    return found


def _along(points: Float, normals: Float) -> tuple[Float, Float]:
    """(n,) each: metres along the surface, across and up (or along z on what lies flat)."""
    flat = np.abs(normals[:, 1]) > 0.7
    facing_x = np.abs(normals[:, 0]) > np.abs(normals[:, 2])
    across = np.where(flat | ~facing_x, points[:, 0], points[:, 2])
    return across, np.where(flat, points[:, 2], points[:, 1])


def _checks(size: float, dark: tuple[float, float, float]) -> Texture:
    def texture(points: Float, normals: Float) -> Float:
        u, v = _along(points, normals)
        odd = (np.floor(u / size) + np.floor(v / size)) % 2 == 1
        return np.where(odd[:, None], np.array(dark), 1.0)

    return texture


def _stripes(width: float, dark: tuple[float, float, float]) -> Texture:
    def texture(points: Float, normals: Float) -> Float:
        u, _ = _along(points, normals)
        return np.where((np.floor(u / width) % 2 == 1)[:, None], np.array(dark), 1.0)

    return texture


def _planks(width: float, length: float) -> Texture:
    def texture(points: Float, normals: Float) -> Float:
        u, v = _along(points, normals)
        row = np.floor(v / width)
        end = np.floor(u / length + _hash(row))
        return (0.6 + 0.5 * _hash(row, end))[:, None] * np.ones(3)

    return texture


def _pictures(size: float) -> Texture:
    """Every third field of a wall holds a picture of a few colours."""

    def texture(points: Float, normals: Float) -> Float:
        u, v = _along(points, normals)
        a, b = np.floor(u / size), np.floor(v / size)
        hung = (_hash(a, b) < 0.34) & (np.abs(u / size - a - 0.5) < 0.36)
        hung &= np.abs(v / size - b - 0.5) < 0.28
        patch = np.floor(u / size * 7), np.floor(v / size * 9)
        colour = np.stack([_hash(*patch, np.full_like(u, k)) for k in range(3)], axis=1)
        return np.where(hung[:, None], 0.15 + 0.9 * colour, 1.0)

    return texture


def _both(first: Texture, second: Texture) -> Texture:
    return lambda points, normals: first(points, normals) * second(points, normals)


# ── rooms ─────────────────────────────────────────────────────────────────────────────────────


def _panel_lamp(
    name: str,
    middle: tuple[float, float, float],
    half: tuple[tuple[float, float, float], tuple[float, float, float]],
    luminance: tuple[float, float, float],
) -> PolygonLamp:
    """A rectangle that shines towards half[0] × half[1]."""
    along, across = np.array(half[0]), np.array(half[1])
    corners = np.array([-along - across, along - across, along + across, across - along])
    return PolygonLamp(name, np.array(luminance), corners + np.array(middle), drawn=False)


def _window(luminance: tuple[float, float, float], z: float = 0.2) -> PolygonLamp:
    """1 × 1.3 m in the left wall of the furnished room."""
    return _panel_lamp("window", (-2.47, 1.6, z), ((0, 0, -0.5), (0, 0.65, 0)), luminance)


def _ceiling(
    luminance: tuple[float, float, float], at: tuple[float, float] = (0.2, 0.3), y: float = 2.95
) -> PolygonLamp:
    half = ((0.25, 0, 0), (0, 0, 0.25))
    return _panel_lamp(f"ceiling {at}", (at[0], y, at[1]), half, luminance)


def _bulb(
    name: str, at: tuple[float, float, float], intensity_cd: tuple[float, float, float]
) -> PointLamp:
    return PointLamp(name, np.array(at), np.array(intensity_cd))


CARPET = {"boards": _checks(0.4, (0.35, 0.3, 0.5)), "plaster": _pictures(0.9)}
PAPER = {
    "plaster": _both(_stripes(0.18, (0.6, 0.7, 0.8)), _pictures(0.8)),
    "linen": _stripes(0.25, (0.8, 0.6, 0.5)),
    "brick": _planks(0.2, 0.45),
    "sage": _pictures(0.7),
    "boards": _planks(0.12, 1.1),
}


def _window_room() -> LitRoom:
    lamps = (_window((900, 1100, 1400)), _ceiling((300, 220, 130)))
    return LitRoom(furnished_room(4000, 7), (-2.2, 1.65, 1.76), (0.8, 0.72, -0.7), lamps, CARPET)


def _lamps_room() -> LitRoom:
    lamps = (
        _bulb("floor lamp", (1.9, 1.35, 1.5), (322, 231, 131)),
        _bulb("over the table", (0.1, 1.9, -0.3), (181, 139, 84)),
    )
    textures = {"boards": _planks(0.15, 1.0), "brick": _pictures(0.8)}
    return LitRoom(furnished_room(4000, 11), (-1.9, 1.5, 1.7), (1.6, 1.0, -0.2), lamps, textures)


def _mixed_room() -> LitRoom:
    lamps = (
        _window((700, 1000, 1500), -0.6),
        _bulb("floor lamp", (1.95, 1.4, -0.9), (281, 181, 86)),
    )
    textures = {"boards": _checks(0.5, (0.5, 0.4, 0.4)), "plaster": _pictures(0.7)}
    return LitRoom(furnished_room(4000, 3), (0.3, 1.6, 1.85), (-0.1, 1.0, -1.0), lamps, textures)


def _papered_room() -> LitRoom:
    lamps = (
        _ceiling((1500, 1300, 1000), (-1.2, 0.9)),
        _bulb("reading", (1.6, 1.1, 0.4), (100, 76, 44)),
    )
    return LitRoom(furnished_room(4000, 5), (-2.2, 1.65, 1.76), (0.9, 0.9, -0.6), lamps, PAPER)


def _joined(
    parts: list[tuple[Solid, str]], paint: dict[str, tuple[float, float, float]]
) -> Geometry:
    names = list(paint)
    starts = np.cumsum([0, *(len(solid.positions) for solid, _ in parts)])
    return Geometry(
        np.concatenate([solid.positions for solid, _ in parts]),
        np.concatenate(
            [solid.triangles + np.int32(n) for (solid, _), n in zip(parts, starts, strict=False)]
        ),
        material_ids=np.concatenate(
            [np.full(len(solid.triangles), names.index(name), np.int32) for solid, name in parts]
        ),
        materials=tuple(Material(name, paint[name]) for name in names),
    )


def _hall(
    half: tuple[float, float], height: float, names: tuple[str, ...]
) -> list[tuple[Solid, str]]:
    """Floor, ceiling, back, front, left and right of a room of ±half in x and z."""
    x, z = half
    floor, ceiling, back, front, left, right = names
    cut = (8, 8)
    return [
        (panel((-x, 0, z), (2 * x, 0, 0), (0, 0, -2 * z), cut), floor),
        (panel((-x, height, -z), (2 * x, 0, 0), (0, 0, 2 * z), cut), ceiling),
        (panel((-x, 0, -z), (2 * x, 0, 0), (0, height, 0), cut), back),
        (panel((x, 0, z), (-2 * x, 0, 0), (0, height, 0), cut), front),
        (panel((-x, 0, z), (0, 0, -2 * z), (0, height, 0), cut), left),
        (panel((x, 0, -z), (0, 0, 2 * z), (0, height, 0), cut), right),
    ]


def _coloured_room() -> LitRoom:
    paint = {"white": (0.74, 0.73, 0.7), "red": (0.62, 0.08, 0.06), "green": (0.12, 0.45, 0.1)}
    parts = _hall((1.5, 1.5), 2.8, ("white", "white", "white", "white", "red", "green"))
    parts.append((box((0.7, 1.5, 0.7)).moved((-0.5, 0.74, -0.6), yaw_degrees=18), "white"))
    parts.append((box((0.6, 0.6, 0.6)).moved((0.55, 0.29, 0.2), yaw_degrees=-16), "white"))
    lamps = (_ceiling((3200, 2700, 1900), (0.0, -0.1), 2.78),)
    return LitRoom(
        _joined(parts, paint), (0.0, 1.4, 1.45), (0.0, 1.2, -1.5), lamps,
        {"white": _checks(0.02, (0.97, 0.97, 0.97))}, hfov_degrees=82,
    )  # fmt: skip


def _corridor() -> LitRoom:
    paint = {
        "white": (0.7, 0.7, 0.66), "floor": (0.25, 0.2, 0.16), "door": (0.3, 0.16, 0.08),
        "case": (0.2, 0.3, 0.45),
    }  # fmt: skip
    parts = _hall((1.0, 6.0), 2.5, ("floor", "white", "white", "white", "white", "white"))
    for z, side in ((3.2, -1), (0.2, 1), (-2.6, -1)):
        parts.append((box((0.06, 2.0, 0.9)).moved((side * 0.99, 0.99, z)), "door"))
    parts.append((box((0.4, 0.8, 0.9)).moved((0.75, 0.39, -1.6)), "case"))
    lamps = (
        _ceiling((4200, 3700, 3000), (0.0, 2.6), 2.47),
        _ceiling((3200, 3000, 2700), (0.0, -3.4), 2.47),
    )
    textures = {"floor": _checks(0.5, (2.4, 2.4, 2.3)), "white": _pictures(1.1)}
    return LitRoom(_joined(parts, paint), (0.2, 1.6, 5.7), (0.0, 1.2, 0.0), lamps, textures)


def _flash_room() -> LitRoom:
    eye = np.array([-2.2, 1.65, 1.76])
    lamps = (
        PointLamp("flash", eye + np.array([0.12, 0.15, 0.0]), np.array([420.0, 420, 440])),
        _ceiling((160, 120, 70), (1.2, -0.8)),
    )
    return LitRoom(
        furnished_room(4000, 7), (-2.2, 1.65, 1.76), (0.8, 0.72, -0.7), lamps, PAPER, ("flash",)
    )


ROOMS: dict[str, Callable[[], LitRoom]] = {
    "window": _window_room,
    "lamps": _lamps_room,
    "mixed": _mixed_room,
    "papered": _papered_room,
    "coloured": _coloured_room,
    "corridor": _corridor,
    "flash": _flash_room,
}


# ── photographs ───────────────────────────────────────────────────────────────────────────────


@cache
def photographed(name: str) -> Photographed:
    """The photograph of one of `ROOMS`, and its truth."""
    room = ROOMS[name]()
    view = room.view
    seen = surface.see(surface_of_mesh(room.geometry, view.position), view)
    e0 = np.full((*view.shape, 3), np.nan)
    e0[seen.valid] = _traced(room, seen)
    reflectance = _textured(room, seen)
    light = reflectance * e0 / np.pi
    white = np.nanquantile(light.max(axis=-1), 1 - CLIPPED)
    linear: Float = np.nan_to_num(light / white)
    noise: Float = np.random.default_rng(3).normal(size=linear.shape)
    linear = linear + NOISE * np.sqrt(np.clip(linear, 0.01, 1)) * noise
    encoded = np.asarray(SRGB.encode(np.clip(linear, 0, 1)), np.float64)
    codes = np.asarray(encoded * 255 + 0.5, np.uint8)
    known = tuple(lamp for lamp in room.lamps if lamp.name in room.known)
    return Photographed(codes, e0, reflectance, seen, known)


def _traced(room: LitRoom, seen: Surface) -> Float:
    """(n, 3) lux on the pixels that see a surface."""
    with TemporaryDirectory() as folder:
        bundle = radiance_bundle([room.geometry], room.lamps, tiles=TILES)
        write_bundle(Path(folder), dict(bundle) | {BOUNCE_OCTREE: bundle[OCTREE]})
        lux = traced_illuminance(
            Path(folder),
            seen.position[seen.valid],
            seen.normal[seen.valid],
            quality=QUALITIES["draft"],
            bounces=BOUNCES,
        )
    return lux.astype(np.float64)


def _textured(room: LitRoom, seen: Surface) -> Float:
    """(H, W, 3) reflectance, textures included, in [0.01, 0.95]."""
    found = np.array(seen.reflectance)
    for number, material in enumerate(room.geometry.materials):
        texture = room.textures.get(material.name)
        own = seen.valid & (seen.material_id == number)
        if texture is not None and own.any():
            found[own] *= texture(seen.position[own], seen.normal[own])
    return np.clip(found, 0.01, 0.95)
