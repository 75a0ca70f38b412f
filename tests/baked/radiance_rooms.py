"""Rooms whose light has a closed form, as folders that rtrace reads."""

import numpy as np

from andon.bake.tasks import write_bundle
from andon.lamps import PointLamp, SkyLamp
from andon.lamps.solids import icosphere
from andon.quantities import Geometry, Material
from andon.transport.baked.radiance.scene import radiance_bundle

REFLECTANCE = (0.5, 0.6, 0.2)
CANDELA = np.array([90.0, 70.0, 40.0])
RADIUS_M = 2.0
UP = np.array([0.0, 1.0, 0.0])


def ball_room(folder):
    """Inside of a ball around a point lamp: E = I/r²·Σ ρᵏ everywhere (integrating sphere)."""
    ball = icosphere(3)
    inside = Geometry(
        RADIUS_M * ball.positions,
        np.ascontiguousarray(ball.triangles[:, ::-1]),
        materials=(Material(reflectance=REFLECTANCE),),
    )
    lamp = PointLamp("lamp", np.zeros(3), CANDELA)
    return write_bundle(folder, radiance_bundle([inside], [lamp]))


def ball_points(count, seed=0):
    """(count, 3) positions on the ball, and normals into it."""
    random = np.random.default_rng(seed)
    outwards = random.normal(size=(count, 3))
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    return (RADIUS_M - 0.01) * outwards, -outwards


def ball_lux(bounces, first=0):
    """(3,) lx of light that was reflected `first` to `bounces` times."""
    series = sum(np.array(REFLECTANCE) ** k for k in range(first, bounces + 1))
    return CANDELA / (RADIUS_M - 0.01) ** 2 * series


def floor(folder, lamps):
    """A grey square of 4 m at y = 0 under lamps, and nothing else."""
    corners = np.array([[-2.0, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]])
    grey = (Material(reflectance=(0.5, 0.5, 0.5)),)
    square = Geometry(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), materials=grey)
    return write_bundle(folder, radiance_bundle([square], lamps))


def sky(lux=100.0):
    return SkyLamp("sky", UP, np.full(3, lux))
