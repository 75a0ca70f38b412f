"""Small views of every projection, places in them, and the model's mean over pixels."""

import numpy as np

from andon.glare.kernel import Kernel
from andon.observer.spread.family import spread_function
from andon.spaces import View, pinhole_view

KERNEL = Kernel(spread_function("cie146-general"))


def unit(*vector):
    return np.asarray(vector) / np.linalg.norm(vector)


def pinhole(hfov_degrees, width=240, height=160):
    return pinhole_view(width, height, width / 2 / np.tan(np.radians(hfov_degrees) / 2))


def fisheye(size=200):
    focal = size / np.pi
    return View("fisheye", size, size, focal, focal, (size - 1) / 2, (size - 1) / 2)


VIEWS = {
    "20": pinhole(20),
    "60": pinhole(60),
    "120": pinhole(120),
    "fisheye": fisheye(),
    "latlong": View("latlong", 360, 180),
}
CORNER = {
    name: view.directions_at([view.width * 0.1, view.height * 0.12]) for name, view in VIEWS.items()
}
PLACES = [
    *((name, unit(0.011, 0.02, 1)) for name in VIEWS),
    *CORNER.items(),
    ("latlong", unit(0.01, 0.1, -1)),
    ("latlong", unit(0.02, -1, 0.05)),
]


def angles(directions, towards):
    return 2 * np.arcsin(np.linalg.norm(directions - towards, axis=-1) / 2)


def pixel_means(view, pixels, towards, core, kernel=KERNEL):
    """The model over squares of pixels, by Gauss–Legendre of 12 × 12."""
    u, weight = np.polynomial.legendre.leggauss(12)
    offsets = np.stack(np.meshgrid(u / 2, u / 2), axis=-1).reshape(-1, 2)
    theta = angles(view.directions_at(pixels[:, None] + offsets), towards)
    return kernel.per_sr(theta, core=core) @ (np.outer(weight, weight).ravel() / 4)
