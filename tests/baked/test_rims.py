"""Rims that no map sees take the light beside them; gaps stay dark."""

from dataclasses import replace

import numpy as np
import pytest

from andon.spaces import pinhole_view
from andon.surface import reference as surface
from andon.surface.load import surface_of_mesh
from andon.transport.baked.rims import REACH, with_rims
from worlds import sheet

TOLERANCE_M = 0.02


def wall(width=24, height=16):
    """A wall that fills the picture."""
    mesh = sheet((-3, -3, -2), (6, 0, 0), (0, 6, 0))
    return surface.see(surface_of_mesh(mesh, np.zeros(3)), pinhole_view(width, height, 20.0))


def two_sides(width=24, height=16):
    """An edge in the middle of the picture: left faces the camera, right faces left."""
    seen = wall(width, height)
    normal = seen.normal.copy()
    normal[:, width // 2 :] = [-1, 0, 0]
    return replace(seen, normal=normal)


def test_an_even_wall_is_even_again():
    seen = wall()
    covered = np.ones(seen.view.shape, bool)
    covered[5:9, 3] = covered[2, 10:20] = False
    lux = np.where(covered[..., None], [30.0, 20.0, 10.0], 0.0)
    filled = with_rims(lux, covered, seen, TOLERANCE_M)
    assert np.allclose(filled, [30.0, 20.0, 10.0], rtol=1e-12)


def test_the_middle_of_a_gap_stays_dark():
    seen = wall()
    covered = np.ones(seen.view.shape, bool)
    covered[4:13, 4:13] = False
    lux = np.where(covered[..., None], np.full(3, 50.0), 0.0)
    filled = with_rims(lux, covered, seen, TOLERANCE_M)
    inner = slice(4 + REACH, 13 - REACH)
    assert np.all(filled[inner, inner] == 0)
    filled[inner, inner] = 50
    assert np.allclose(filled, 50)


def test_what_faces_alike_counts():
    seen = two_sides()
    covered = np.ones(seen.view.shape, bool)
    middle = seen.view.width // 2
    covered[:, middle] = False
    lux = np.where(np.arange(seen.view.width)[:, None] < middle, 100.0, 1.0)
    lux = np.broadcast_to(lux, (*seen.view.shape, 3)) * covered[..., None]
    filled = with_rims(lux, covered, seen, TOLERANCE_M)[8, middle]
    assert (filled < 12).all(), "that of the right side, which is as near"


def test_covered_pixels_and_holes_stay():
    seen = wall()
    valid = seen.valid.copy()
    valid[3:6, 3:6] = False
    seen = replace(seen, valid=valid, position=np.where(valid[..., None], seen.position, np.nan))
    covered = valid.copy()
    covered[8, 8] = False
    lux = np.random.default_rng(0).uniform(0, 9, (*valid.shape, 3)) * covered[..., None]
    filled = with_rims(lux, covered, seen, TOLERANCE_M)
    assert np.array_equal(filled[covered], lux[covered])
    assert np.all(filled[~valid] == 0)
    assert np.isfinite(filled).all()
    assert (filled[8, 8] > 0).all()


def test_nothing_is_covered():
    seen = wall()
    nothing = np.zeros(seen.view.shape, bool)
    assert not with_rims(np.zeros((*nothing.shape, 3)), nothing, seen, TOLERANCE_M).any()


@pytest.mark.parametrize("seed", [1, 2])
def test_the_shader_does_the_same(gpu, seed):
    from andon import gbuffer
    from andon.gpu.bindings import bind_group
    from andon.gpu.passes import FullscreenPass
    from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
    from andon.transport.baked.records import BAKED_SETTINGS, STRUCTS
    from andon.transport.baked.stage import BAKED_RIMS

    seen = two_sides()
    random = np.random.default_rng(seed)
    covered = random.uniform(size=seen.view.shape) < 0.4
    covered[:, :7] = False
    lux = random.uniform(0, 80, (*covered.shape, 3)) * covered[..., None]
    truth = with_rims(lux, covered, seen, TOLERANCE_M)

    height, width = covered.shape
    packed = make_texture(gpu, "rgba32uint", width, height, label="gbuffer")
    packed.write(gbuffer.pack_surface(seen))
    picture = make_texture(gpu, "rgba32float", width, height, label="picture")
    picture.write(np.concatenate([lux, covered[..., None]], axis=-1).astype(np.float32))
    out = make_texture(gpu, "rgba32float", width, height, label="out")
    view = uniform_buffer(gpu, gbuffer.pack_view(seen.view).nbytes, "view")
    write_buffer(gpu, view, gbuffer.pack_view(seen.view))
    settings = BAKED_SETTINGS.pack(
        earlier_scale=1.0, later_scale=1.0, later_share=0.0, depth_tolerance_m=TOLERANCE_M
    )
    own = uniform_buffer(gpu, BAKED_SETTINGS.dtype.itemsize, "settings")
    write_buffer(gpu, own, settings)
    resources = {
        0: ("uint", packed.view),
        1: ("uniform", view),
        2: ("float", picture.view),
        3: ("uniform", own),
    }
    stage = FullscreenPass(
        gpu,
        BAKED_RIMS,
        "baked_rims",
        [out.format],
        [bind_group(gpu, resources)],
        structs=gbuffer.STRUCTS | STRUCTS,
        variants=gbuffer.projection_variant(seen.view),
    )
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, [out.view])
    gpu.device.queue.submit([encoder.finish()])
    values = out.read()
    assert np.array_equal(values[..., 3] > 0.5, covered)
    assert np.allclose(values[..., :3], truth, rtol=2e-3, atol=1e-3)
    assert truth[~covered].any()
