"""A small room with things in it, and one lamp of every kind."""

import numpy as np

from andon.files.photometry import Distribution
from andon.lamps import (
    DirectionalLamp,
    DiskLamp,
    GoniometricLamp,
    HemisphereLamp,
    MeshLamp,
    PointLamp,
    PolygonLamp,
    Shadow,
    SkyLamp,
    SphereLamp,
    SpotLamp,
    TubeLamp,
)
from andon.spaces import View, look_at
from worlds import ball, unit

POSE = look_at(np.array([1.6, 1.7, 2.1]), np.array([-0.2, 0.6, -0.3]))
VIEW = View("pinhole", 240, 180, 150.0, 150.0, 119.5, 89.5, world_from_camera=POSE)


def lamps(shadow):
    """name → lamp."""
    warm, at = np.array([90.0, 70.0, 40.0]), np.array([0.9, 1.6, 0.9])
    aim = unit(np.array([-0.3, 0.4, -0.6]) - at)
    return {
        "point": PointLamp("point", at, warm, shadow),
        "spot": SpotLamp("spot", at, 3 * warm, shadow, 0.0, aim, 0.2, 0.6),
        "wide spot": SpotLamp("wide spot", at, 2 * warm, shadow, 0.0, aim, 0.5, 1.45),
        "directional": DirectionalLamp("sun", unit([-0.5, -0.8, -0.4]), 10 * warm, shadow),
        "sky": SkyLamp("sky", np.array([0.0, 1, 0]), warm),
        "hemisphere": HemisphereLamp("both", unit([0.1, 1, 0]), warm, 0.2 * warm[::-1]),
    }


def area_lamps(shadow):
    """name → lamp with an area."""
    warm, at = np.array([900.0, 700.0, 400.0]), np.array([0.9, 1.7, 0.9])
    aim = unit(np.array([-0.3, 0.2, -0.6]) - at)
    square = np.array([[-0.3, 1.9, 0.2], [0.5, 1.9, 0.2], [0.5, 1.5, 0.8], [-0.3, 1.5, 0.8]])
    tile = ball(0.2, (0.2, 1.8, 0.4), 3)
    return {
        "sphere": SphereLamp("sphere", warm, at, 0.15, shadow=shadow),
        "disk": DiskLamp("disk", warm, at, aim, 0.25, shadow=shadow),
        "disk of two sides": DiskLamp("disk", warm, at, -aim, 0.25, True, shadow=shadow),
        "tube": TubeLamp("tube", warm, np.array([[-1, 2, 0.5], [1, 2, 0.7]]), 0.04, shadow=shadow),
        "polygon": PolygonLamp("polygon", warm, square, shadow=shadow),
        "polygon of two sides": PolygonLamp("polygon", warm, square[::-1], True, shadow=shadow),
        "picture": PolygonLamp("picture", warm, square, False, PICTURE, shadow=shadow),
        "mesh": MeshLamp("mesh", warm, tile.positions, tile.triangles, shadow=shadow),
    }


def luminaire(shadow):
    """A lopsided distribution that hangs askew."""
    degrees = np.arange(0, 181, 5.0)
    around = np.arange(0, 361, 30.0)
    lobe = np.maximum(np.cos(np.radians(degrees)), 0) ** 2
    candela = lobe * (1.2 + np.cos(np.radians(around)))[:, None]
    measured = Distribution("C", around, degrees, candela)
    direction = unit([0.3, -1, 0.1])
    right = unit(np.cross(direction, [0.0, 0.0, 1.0]))
    at = np.array([0.3, 2.2, 0.4])
    return GoniometricLamp(
        "luminaire", at, np.array([90.0, 70, 40]), shadow,
        direction=direction, right=right, distribution=measured,
    )  # fmt: skip


PICTURE = np.random.default_rng(3).uniform(0, 2, (8, 8, 3))
PICTURE /= PICTURE.mean(axis=(0, 1))
HARD, SOFT = Shadow(1024, "none"), Shadow(1024, "linear")
