"""Golden pictures of the surface: depth and normals of one small room in three projections."""

from dataclasses import replace

import numpy as np
import pytest

from andon.display.false_colour import depth_picture, normal_picture
from andon.quantities import Material
from andon.spaces import View, look_at
from andon.surface import reference
from andon.surface.load import surface_of_depth
from andon.surface.model import SurfaceModel
from andon.surface.objects import joined
from andon.surface.stage import SurfaceStage
from comparison import assert_golden
from worlds import ball, block

POSE = look_at(np.array([0.7, 1.5, 1.9]), np.array([-0.1, 0.6, 0.0]))
VIEWS = {
    "pinhole": View("pinhole", 160, 120, 110.0, 110.0, 79.5, 59.5, world_from_camera=POSE),
    "fisheye": View("fisheye", 160, 120, 60.0, 60.0, 79.5, 59.5, world_from_camera=POSE),
    "latlong": View("latlong", 160, 80, world_from_camera=POSE),
}


def room():
    walls = block((4, 2.4, 5), (0, 1.2, 0), inwards=True)
    things = [ball(0.35, (0.3, 0.35, -0.2), 6), block((0.5, 0.9, 0.5), (-0.8, 0.45, -0.6))]
    return joined([replace(part, materials=(Material(),)) for part in (walls, *things)])


def pictures(surface):
    depth = depth_picture(surface.depth, surface.valid)
    return np.concatenate([depth, normal_picture(surface.normal, surface.valid)])


@pytest.mark.parametrize("name", VIEWS)
def test_a_room(name, tmp_path):
    surface = reference.see(SurfaceModel(real=room()), VIEWS[name])
    assert_golden(pictures(surface), f"surface-{name}", tmp_path)


def test_the_same_room_on_the_gpu(gpu, tmp_path):
    """One golden picture for both engines. Pixels on edges take either side: 1 % may."""
    stage = SurfaceStage(gpu, SurfaceModel(real=room()), VIEWS["pinhole"])
    encoder = gpu.device.create_command_encoder()
    seen = stage.encode(encoder)
    gpu.device.queue.submit([encoder.finish()])
    assert_golden(pictures(seen.read()), "surface-pinhole", tmp_path, written=False, share=0.01)


def test_a_noisy_depth_image_with_holes(tmp_path):
    """What a sensor gives: ±0.3 % and holes; normals stay calm, creases sharp."""
    view = VIEWS["pinhole"].resized(120, 90)
    generator = np.random.default_rng(7)
    depth = reference.see(SurfaceModel(real=room()), view).depth
    depth = depth * (1 + 0.003 * generator.normal(size=depth.shape))
    depth[generator.random(depth.shape) < 0.05] = np.nan
    depth[15:25, 75:100] = np.nan
    surface = reference.see(surface_of_depth(depth, view), view)
    assert_golden(normal_picture(surface.normal, surface.valid), "surface-noisy", tmp_path)
