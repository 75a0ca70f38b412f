"""Maps of known light, projected into other views, against the closed form."""

import numpy as np
import pytest

from andon.surface.reference import trace
from andon.transport.baked import illuminance_at
from baked.scenes import baked_map, candles, fisheye, latlong, pinhole, still
from worlds import block

ROOM = block((4, 2.4, 4), (0, 1.2, 0), inwards=True)
VIEW = pinhole(160, 120, (-1.2, 1.5, 1.5), (0.5, 0.6, -1))
CAMERAS = {
    "pinhole": lambda size: pinhole(size, size * 3 // 4, (1.5, 1.7, 1.7), (-0.5, 0.8, -1), 1.5),
    "fisheye": lambda size: fisheye(size, (1.5, 1.7, 1.7), (-0.5, 0.8, -1)),
    "latlong": lambda size: latlong(size, (0.3, 1.2, 0.2)),
}


def points(geometry, view):
    surface = trace(geometry, view, is_object=False)
    return surface.position[surface.valid], surface.normal[surface.valid]


@pytest.mark.parametrize("camera", CAMERAS)
def test_second_order(camera):
    """Twice the texels, a quarter of the error, where light is smooth."""
    position, normal = points(ROOM, VIEW)
    truth = candles(position, normal)
    errors = []
    for size in (64, 128, 256):
        seen = baked_map(ROOM, CAMERAS[camera](size))
        lux, covered = illuminance_at(still(seen), 0.0, position, normal)
        assert covered.mean() > 0.7
        errors.append(np.median(np.abs(lux / truth - 1).max(axis=1)[covered]))
    assert errors[-1] < 2e-4
    assert errors[0] / errors[1] > 3.5
    assert errors[1] / errors[2] > 3.5
