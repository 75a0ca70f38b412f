"""Lamps against closed forms, the horizon included."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps import DirectionalLamp, Lamp, PointLamp, SpotLamp
from andon.pipeline import EngineName, Renderer
from andon.quantities import Geometry
from andon.spaces import View, look_at, pinhole_view
from andon.transport.direct import reference
from andon.verify.setting import prepared_of

__all__ = [
    "GRAZING",
    "floor_error",
    "floor_view",
    "plane_points",
    "point_reference",
    "tilted_floor",
]

Float = NDArray[np.float64]

# Within this of the horizon (cos φ), errors are measured against the light that a surface at this
# angle would get: a direction's error of 3e-5 rad is any relative error at the horizon itself.
GRAZING = 0.05


def _lamp_over_the_origin(cosine: Float, distance: Float, intensity: float) -> tuple[Float, Float]:
    """Positions of lamps whose angle and distance to the origin's +Y are given, and their E."""
    sine = np.sqrt(1 - cosine**2)
    positions = np.stack([sine, cosine, np.zeros_like(cosine)], axis=-1) * distance[:, None]
    return positions, intensity * np.maximum(cosine, 0) / distance**2


def point_reference() -> float:
    """Largest relative error of point, spot and directional lamps from 0° past the horizon."""
    generator = np.random.default_rng(1)
    cosine = np.cos(np.radians(np.concatenate([np.linspace(0, 120, 241), [89.999, 90.001]])))
    distance = generator.uniform(0.05, 20, cosine.size)
    positions, expected = _lamp_over_the_origin(cosine, distance, 60.0)
    origin, up = np.zeros(3), np.array([0.0, 1, 0])
    worst = 0.0
    for position, truth in zip(positions, expected, strict=True):
        direction = -position / np.linalg.norm(position)
        inner, outer = np.radians(20), np.radians(40)
        axis = direction * np.cos(0.5) + _across(direction) * np.sin(0.5)  # 0.5 rad off the axis
        ramp = np.clip((np.cos(0.5) - np.cos(outer)) / (np.cos(inner) - np.cos(outer)), 0, 1) ** 2
        cases: list[tuple[Lamp, float]] = [
            (PointLamp("p", position, np.full(3, 60.0)), truth),
            (
                SpotLamp("s", position, np.full(3, 60.0), None, 0.0, axis, inner, outer),
                truth * ramp,
            ),
            (
                DirectionalLamp("d", direction, np.full(3, 500.0)),
                500 * max(position[1] / float(np.linalg.norm(position)), 0.0),
            ),
        ]
        for lamp, value in cases:
            got = float(reference.illuminance(lamp, origin, up)[0])
            worst = max(worst, abs(got - value) / max(value, 1e-3))
    return worst


def _across(direction: Float) -> Float:
    side = np.cross(direction, [0.0, 0.0, 1.0])
    return side / np.linalg.norm(side)


def tilted_floor() -> tuple[Geometry, Float]:
    """A square of 6 m whose normal is no axis, and that normal."""
    normal = np.array([0.2, 0.9, 0.3])
    normal /= np.linalg.norm(normal)
    right = _across(normal)
    forward = np.cross(right, normal)
    corners = np.array([a * right + b * forward for a, b in ((-3, -3), (3, -3), (3, 3), (-3, 3))])
    return Geometry(corners, np.array([[0, 2, 1], [0, 3, 2]], np.int32)), normal


def floor_view(normal: Float, /) -> View:
    """Straight down on the tilted floor's middle, from 3 m."""
    pose = look_at(normal * 3.0, np.zeros(3), (0.0, 0.0, -1.0))
    return pinhole_view(320, 240, 200.0, pose)


def floor_error(engine: EngineName) -> float:
    """Largest error of three low lamps over a tilted floor, per pixel, against I·cos φ/d²."""
    floor, normal = tilted_floor()
    view = floor_view(normal)
    worst = 0.0
    for height in (0.05, 0.5, 2.0):
        lamp = PointLamp("low", normal * height + 0.3 * _across(normal), np.full(3, 40.0))
        frame = Renderer(prepared_of(floor, view, (lamp,)), engine).render()
        points = plane_points(view, normal)
        reach = lamp.position_m - points
        distance = np.linalg.norm(reach, axis=-1)
        cosine = reach @ normal / distance
        facing = 40 / distance**2
        error = np.abs(np.asarray(frame.illuminance.lux, float)[..., 1] - facing * cosine)
        seen = frame.surface.valid
        worst = max(worst, float((error / (facing * np.maximum(cosine, GRAZING)))[seen].max()))
    return worst


def plane_points(view: View, normal: Float, /) -> Float:
    """Where the rays of `view` meet the plane through the origin, in closed form."""
    origin, rays = view.rays_world()
    return origin + rays * (-(origin @ normal) / (rays @ normal))[..., None]
