"""The frame out of focus on the GPU against the reference: a slanted plane, something in front."""

import numpy as np
import pytest

from andon.gbuffer import VIEW_RECORD, pack_surface, pack_view
from andon.glass.defocus.frame import frame_blurred
from andon.glass.defocus.frame_stage import FrameDefocusStage
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.quantities import Surface
from andon.spaces import pinhole_view
from comparison import assert_agree
from defocus.pictures import natural

HEIGHT, WIDTH, FOCAL_PX = 216, 288, 1700.0
VIEW = pinhole_view(WIDTH, HEIGHT, FOCAL_PX)
PICTURE = natural(HEIGHT, WIDTH, seed=4)
ROWS, COLUMNS = np.mgrid[:HEIGHT, :WIDTH]
IN_FRONT = (abs(ROWS - 100) < 36) & (abs(COLUMNS - 150) < 45)
PUPIL_M = 0.006
CODE = 1 / 255
# Share of pixels that differ by more than 5/255: beside edges, where texels of a quarter size
# belong to one side, and along the border, whose last texel goes on instead of its last pixel.
BESIDE_EDGES = 0.04


def distances(front):
    """(H, W) dioptres: a plane from 3 to 1 D, and something in front of its middle."""
    return np.where(IN_FRONT, front, 3 - 2 * COLUMNS / WIDTH)


def by_gpu(gpu, picture, dioptres, focus):
    along = np.linalg.norm(VIEW.rays_planar(), axis=-1)
    depth = np.where(dioptres > 0, 1 / np.maximum(dioptres, 1e-9) / along, np.nan)
    shape, none = VIEW.shape, np.zeros((*VIEW.shape, 3))
    up = np.broadcast_to([0, 0, 1.0], none.shape)
    valid, number = np.isfinite(depth), np.zeros(shape, np.int32)
    seen = Surface(none, up, depth, valid, np.zeros(shape, bool), none, number, none, VIEW)
    packed = make_texture(gpu, "rgba32uint", WIDTH, HEIGHT)
    packed.write(pack_surface(seen))
    record = uniform_buffer(gpu, VIEW_RECORD.dtype.itemsize)
    write_buffer(gpu, record, pack_view(VIEW))
    target = make_texture(gpu, "rgba16float", WIDTH, HEIGHT)
    target.write(np.dstack([picture, np.full(shape, 0.25)]))
    stage = FrameDefocusStage(gpu, VIEW, (packed.view, record), target)
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, focus, PUPIL_M)
    gpu.device.queue.submit([encoder.finish()])
    after = target.read().astype(np.float64)
    assert (after[..., 3] == 0.25).all()
    return after[..., :3]


def by_reference(picture, dioptres, focus):
    wide = PUPIL_M * np.abs(dioptres - focus) / np.sqrt(VIEW.solid_angles())
    return frame_blurred(picture, np.minimum(wide, 64), dioptres)


# Discs up to 21 px on the plane and 31 px in front; sharp in front; discs in front of 12 px.
@pytest.mark.parametrize(("front", "focus"), [(4.0, 1.0), (4.0, 4.0), (4.0, 2.8), (4.0, 2.0)])
def test_a_plane_and_something_in_front(gpu, front, focus):
    dioptres = distances(front)
    actual, expected = (
        by_gpu(gpu, PICTURE, dioptres, focus),
        by_reference(PICTURE, dioptres, focus),
    )
    difference = np.abs(actual - expected)
    assert np.isfinite(actual).all()
    assert difference.mean() <= CODE
    assert (difference.max(axis=-1) > 5 * CODE).mean() <= BESIDE_EDGES


def test_a_constant_stays_constant_to_the_border(gpu):
    flat = np.full((HEIGHT, WIDTH, 3), 0.4)
    assert_agree(by_gpu(gpu, flat, distances(4.0), 1.5), flat, atol=1e-3)


def test_in_focus_it_is_itself(gpu):
    half = PICTURE.astype(np.float16).astype(np.float64)
    assert_agree(by_gpu(gpu, PICTURE, np.full(VIEW.shape, 2.0), 2.0), half, atol=1e-3)


def test_holes_are_infinitely_far(gpu):
    holes = np.zeros(VIEW.shape)
    actual, expected = by_gpu(gpu, PICTURE, holes, 1.5), by_reference(PICTURE, holes, 1.5)
    assert np.abs(actual - expected).mean() <= CODE
