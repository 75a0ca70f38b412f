"""Golden pictures of the composite: the same scene relit, dimmed, and dimmed the paper's way."""

from dataclasses import replace

import numpy as np
import pytest

from andon.composite.model import Ambient
from andon.engines.prepared import Prepared
from andon.lamps import PointLamp
from andon.pipeline import Renderer
from andon.quantities import CameraFrame, Material
from andon.responses import SRGB
from andon.spaces import View, look_at
from andon.surface import reference
from andon.surface.load import surface_of_depth
from andon.surface.model import SurfaceModel
from andon.surface.objects import joined
from comparison import assert_golden
from worlds import ball, block, unit

POSE = look_at(np.array([0.7, 1.5, 1.9]), np.array([-0.1, 0.6, 0.0]))
VIEW = View("pinhole", 160, 120, 110.0, 110.0, 79.5, 59.5, world_from_camera=POSE)
E0 = np.array([180.0, 200.0, 220.0])
AMBIENTS = {
    "relit": Ambient(E0),
    "dimmed": Ambient(E0, (0.15, 0.15, 0.2)),
    "paper": Ambient(E0, (0.15, 0.15, 0.2), "paper"),
}


def scene(ambient):
    """A room photographed under a window's light; a warm lamp and a blue ball are put into it."""
    walls = block((4, 2.4, 5), (0, 1.2, 0), inwards=True)
    box = block((0.5, 0.9, 0.5), (-0.8, 0.45, -0.6))
    room = joined([replace(part, materials=(Material(),)) for part in (walls, box)])
    seen = reference.see(SurfaceModel(real=room), VIEW)
    stripes = np.floor(seen.position[..., 0] * 4 + seen.position[..., 2] * 4) % 2
    paint = np.where(stripes[..., None] > 0, [0.6, 0.5, 0.4], [0.4, 0.42, 0.45])
    shading = 0.25 + 0.5 * np.clip(seen.normal @ unit([0.5, 0.8, 0.4]), 0, 1)
    codes = np.rint(SRGB.encode(paint * shading[..., None]) * 255)
    linear = SRGB.decode(codes / 255).astype(np.float32)
    blue = Material("blue", (0.1, 0.2, 0.7))
    model = surface_of_depth(seen.depth, VIEW, occluder_triangles=0)
    things = replace(ball(0.3, (0.35, 0.3, 0.1), 6), materials=(blue,))
    lamp = PointLamp(
        "lantern",
        np.array([-0.3, 0.75, -1.3]),
        np.array([130.0, 80.0, 30.0]),
        visible_radius_m=0.09,
    )
    return Prepared(
        frames={"mono": CameraFrame(linear, VIEW, SRGB, 200 / np.pi)},
        surface=replace(model, objects=things, casters=things),
        ambient=ambient,
        lamps=lambda _: (lamp,),
    )


@pytest.mark.parametrize("name", AMBIENTS)
def test_a_room_by_a_lantern(name, tmp_path):
    frame = Renderer(scene(AMBIENTS[name]), "reference").render()
    assert_golden(frame.image.rgb, f"composite-{name}", tmp_path)


def test_the_same_room_on_the_gpu(gpu, tmp_path):
    """Shadow edges and edges of things may take either side of a pixel: 2 % of them."""
    frame = Renderer(scene(AMBIENTS["dimmed"]), "gpu").render()
    assert_golden(frame.image.rgb, "composite-dimmed", tmp_path, written=False, share=0.02)
