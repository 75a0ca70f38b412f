"""Curved objects do not shadow themselves between the texels of a map, and contacts hold."""

from dataclasses import replace

import numpy as np
import pytest

from andon.lamps import DirectionalLamp, PointLamp, Shadow, SphereLamp, SpotLamp
from andon.pipeline import Renderer
from andon.quantities import Material
from andon.spaces import View, look_at
from andon.surface.model import ObjectInfo, ShadowBias
from andon.surface.objects import joined
from andon.verify.edges import near_change
from andon.verify.setting import prepared_of
from worlds import ball, block, unit

pytestmark = pytest.mark.usefixtures("gpu")

FLOOR = block((12, 0.2, 12), (0, -0.1, 0))
# What lies farther than this from a true shadow's edge is no question of texels.
EDGE_PX = 3


def smooth(geometry):
    """With normals that are interpolated over the facets."""
    corners = geometry.positions[geometry.triangles]
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(geometry.positions)
    for corner in range(3):
        np.add.at(normals, geometry.triangles[:, corner], facets)
    return replace(geometry, normals=unit(normals))


def lamps(shadow):
    at = np.array([1.2, 2.2, 1.5])
    aim = unit(np.array([0, 0.2, 0]) - at)
    white = np.full(3, 1000.0)
    return {
        "directional": DirectionalLamp("sun", unit([-0.5, -0.8, -0.4]), white, shadow),
        "point": PointLamp("point", at, white, shadow),
        "spot": SpotLamp("spot", at, white, shadow, 0.0, aim, 0.5, 0.9),
        "wide spot": SpotLamp("wide", at, white, shadow, 0.0, aim, 0.5, 1.4),
        "sphere": SphereLamp("sphere", white, at, 0.06, shadow=replace(shadow, samples=4)),
    }


def seen_by_both(thing, lamp, eye, at):
    """`thing` as a virtual object on a floor: ΔE relative to the brightest, GPU − rays, and the
    reference's surface and shadow."""
    pose = look_at(np.array(eye, float), np.array(at, float))
    view = View("pinhole", 320, 200, 250.0, 250.0, 159.5, 99.5, world_from_camera=pose)
    prepared = prepared_of(FLOOR, view, (lamp,))
    thing = replace(joined([thing]), materials=(Material(),), material_ids=None)
    surface = replace(
        prepared.surface,
        objects=thing,
        casters=thing,
        objects_table=(ObjectInfo("thing", 0, 1, len(thing.triangles)),),
        bias=ShadowBias(2e-4, 2e-4),
    )
    prepared = replace(prepared, surface=surface)
    fast, slow = (Renderer(prepared, engine).render() for engine in ("gpu", "reference"))
    truth = np.asarray(slow.illuminance.lux)[..., 0]
    error = (np.asarray(fast.illuminance.lux)[..., 0] - truth) / truth.max()
    with np.errstate(invalid="ignore"):
        same = np.abs(fast.surface.depth - slow.surface.depth) < 2e-3 * slow.surface.depth
    return np.where(same, error, 0.0), slow.surface, truth > 1e-3 * truth.max()


@pytest.mark.parametrize("name", ["none", "linear"])
@pytest.mark.parametrize("kind", lamps(Shadow()))
def test_a_curved_object_has_no_acne(kind, name):
    """320 facets under normals of a ball: with float32 rounding as the only lift, a third and more
    of the ball is dotted."""
    lamp = lamps(Shadow(1024, name))[kind]
    thing = smooth(ball(0.25, (0, 0.25, 0), 4))
    error, surface, lit = seen_by_both(thing, lamp, (0.8, 0.9, 1.6), (0, 0.2, 0))
    open_places = surface.is_object & lit & ~near_change(lit, EDGE_PX)
    assert np.count_nonzero(open_places) > 1500
    assert (error[open_places] < -0.05).mean() < 1e-3


@pytest.mark.parametrize("kind", lamps(Shadow()))
def test_a_contact_keeps_its_shadow(kind):
    """The shadow of a plate of 30 mm on a table. Under the sun a texel is 8 mm wide: receivers
    lifted by four of them lose 83 % of it, by one 6 %, which are texels at its edge."""
    table, plate = block((0.6, 0.1, 0.6), (0, 0.05, 0)), block((0.2, 0.03, 0.2), (0, 0.115, 0))
    lamp = lamps(Shadow(2048))[kind]
    error, surface, lit = seen_by_both(joined([table, plate]), lamp, (-0.6, 0.7, -0.6), (0, 0.1, 0))
    on_top = np.abs(surface.position[..., 1] - 0.1) < 1e-3
    shadow = surface.is_object & on_top & ~lit
    assert np.count_nonzero(shadow) > 300
    assert (error[shadow] > 0.3).mean() < 0.1
