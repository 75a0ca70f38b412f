"""Golden pictures: a room in the light that two maps hold, and what neither of them sees."""

import numpy as np
import pytest

from andon.display.false_colour import false_colour
from andon.quantities import photometric
from andon.rays import RayScene
from andon.transport.baked import illuminance_at
from baked.scenes import LAMP, baked_map, candles, pinhole, still
from baked.test_parity import ROOM, Frame
from comparison import assert_golden

VIEW = pinhole(160, 120, (-1.5, 1.6, 1.7), (0.3, 0.5, -0.8), 1.3)
CAMERAS = (
    pinhole(320, 240, (1.7, 1.9, 1.6), (-0.3, 0.4, -0.6), 1.4),
    pinhole(320, 240, (-1.7, 1.2, -0.6), (0.8, 0.6, -1.2), 1.3),
)


def shadowed(position, normal):
    """A point lamp with hard shadows."""
    flat = (position + 1e-4 * normal).reshape(-1, 3)
    seen = np.isfinite(flat).all(axis=1)
    seen[seen] = RayScene(ROOM).is_visible(flat[seen], LAMP)
    return candles(position, normal) * seen.reshape(*position.shape[:-1], 1)


@pytest.fixture(scope="module")
def light():
    return still(*[baked_map(ROOM, view, shadowed) for view in CAMERAS])


def picture(lux, covered):
    return false_colour(photometric(lux), "lx", valid=covered)


def test_two_maps(light, tmp_path):
    from andon.surface.reference import trace

    surface = trace(ROOM, VIEW, is_object=False)
    lux, covered = illuminance_at(
        light, 0.0, surface.position.reshape(-1, 3), surface.normal.reshape(-1, 3)
    )
    shape = VIEW.shape
    assert_golden(
        picture(lux.reshape(*shape, 3), covered.reshape(shape)), "baked-two-maps", tmp_path
    )


def test_two_maps_on_the_gpu(light, tmp_path, gpu):
    frame = Frame(light, VIEW)
    frame.draw()
    lux = frame.picture.lux.read()
    # Silhouettes of the ball are triangles in one engine and pixels' rays in the other.
    assert_golden(
        picture(lux[..., :3].astype(float), lux[..., 3] > 0),
        "baked-two-maps",
        tmp_path,
        written=False,
        share=0.01,
    )
