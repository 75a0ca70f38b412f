"""Sources and views that tests of needles share."""

import numpy as np

from andon.glare.model import Outline, Source
from andon.spaces import View, pinhole_view

AHEAD = np.array([0.0, 0.0, 1.0])
# Degrees a pixel of `close_up`.
FINE = 0.03


def unit(*direction):
    return np.array(direction) / np.linalg.norm(direction)


def disc(radius_degrees=0.05):
    return Outline(np.radians([radius_degrees]))


def ellipse(a_degrees, b_degrees, turned_degrees=0.0):
    phi = np.arange(720) * (np.pi / 360) - np.radians(turned_degrees)
    a, b = np.radians([a_degrees, b_degrees])
    return Outline(a * b / np.hypot(b * np.cos(phi), a * np.sin(phi)), "ellipse")


def lamp(lux=1.0, direction=AHEAD, outline=None, **options):
    light = np.broadcast_to(np.asarray(lux, float), 3)
    return Source(direction, light, outline or disc(), **options)


def close_up(size=120, degrees_per_pixel=FINE):
    return pinhole_view(size, size, 1 / np.radians(degrees_per_pixel))


def wide(size=200, degrees=110.0):
    return pinhole_view(size, size // 2, size / 2 / np.tan(np.radians(degrees / 2)))


def fisheye(size=160):
    return View("fisheye", size, size, size / np.pi, size / np.pi, *2 * [(size - 1) / 2])


def latlong(width=240):
    return View("latlong", width, width // 2)


def light_of(picture, view):
    """(3,) lx: the integral of a picture over its solid angle."""
    return (picture * view.solid_angles()[..., None]).sum(axis=(0, 1))
