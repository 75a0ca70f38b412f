"""Small settings that the tests of conventions share."""

import numpy as np

import andon
from andon.lamps import resolve_lamps
from andon.spaces import View

X, Y, Z = np.eye(3)
ORIGIN = np.zeros(3)
WHITE = np.ones(3)
VIEW = View("pinhole", 5, 3, 4.0, 4.0, 2.0, 1.0)  # the middle pixel looks straight ahead


def close(actual, expected, **tolerance):
    np.testing.assert_allclose(actual, expected, **({"rtol": 1e-12, "atol": 1e-12} | tolerance))


def relit(photo, lamps=(), *, depth=2.0, **options):
    """A white wall, or what `photo` and `depth` are, on the reference engine."""
    depth_m = np.broadcast_to(np.asarray(depth, float), VIEW.shape)
    options = {"ambient_lux": 100.0, "engine": "reference"} | options
    return andon.relight(photo, VIEW, lamps, depth_m=depth_m, **options)


def grey(code=128):
    return np.full((*VIEW.shape, 3), code, np.uint8)


def lamps_of(*tables):
    return resolve_lamps(andon.scene_from_dict({"lamp": list(tables)}), 0.0)
