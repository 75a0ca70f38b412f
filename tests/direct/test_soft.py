"""Soft shadows: samples, penumbrae that can be drawn with a ruler, and both engines alike."""

from dataclasses import replace

import numpy as np
import pytest

from andon.lamps import PolygonLamp, Shadow, SphereLamp
from andon.pipeline import Renderer
from andon.quantities import Geometry
from andon.transport.direct.casters import OBJECTS, REAL, Casters, ShadowRays
from andon.transport.direct.reference import illuminance, visible_share
from andon.transport.direct.soft import sample_points, sample_weights
from andon.verify.edges import near_change
from andon.verify.setting import prepared_of
from comparison import assert_agree
from direct.rooms import HARD, VIEW, area_lamps, luminaire
from worlds import open_room

UP = np.array([0.0, 1.0, 0.0])


@pytest.mark.parametrize("count", [1, 7, 16, 64])
@pytest.mark.parametrize("kind", area_lamps(None))
def test_samples_lie_on_the_lamp_and_around_its_middle(kind, count):
    lamp = area_lamps(None)[kind]
    samples = sample_points(lamp, count)
    assert samples.points.shape == samples.normals.shape == samples.light.shape == (count, 3)
    if isinstance(lamp, SphereLamp):
        assert (
            np.linalg.norm(samples.points - lamp.position_m, axis=1) <= 1.000001 * lamp.radius_m
        ).all()
    if isinstance(lamp, PolygonLamp):
        middle = lamp.vertices_m.mean(axis=0)
        if lamp.texture is None:
            np.testing.assert_allclose(samples.points.mean(axis=0), middle, atol=1e-9)
        np.testing.assert_allclose((samples.points - middle) @ samples.normals[0], 0, atol=1e-12)
    np.testing.assert_array_equal(samples.points, sample_points(lamp, count).points)


def test_samples_of_a_ball_are_even_from_every_side():
    """Their projection on any plane is an even disk: half of them within r/√2 of its middle."""
    lamp = SphereLamp("s", np.ones(3), np.zeros(3), 2.0)
    points = sample_points(lamp, 4096).points
    for axis in np.random.default_rng(0).normal(size=(5, 3)):
        axis /= np.linalg.norm(axis)
        radius = np.linalg.norm(points - np.outer(points @ axis, axis), axis=1)
        assert np.mean(radius < 2 / np.sqrt(2)) == pytest.approx(0.5, abs=0.03)
        assert np.mean(radius < 1) == pytest.approx(0.25, abs=0.03)


def test_weights_add_up_to_the_closed_form():
    """Σ wᵢ·(area/n) is the lamp's illuminance, the midpoint rule of its integral."""
    lamp = area_lamps(None)["polygon"]
    position = np.array([[0.0, 0, 0], [0.7, 0.1, 1.0], [-1.0, 0.3, 0.4]])
    normal = np.broadcast_to(UP, (3, 3))
    weights = sample_weights(sample_points(lamp, 1024), position, normal)
    edges = lamp.vertices_m[1:3] - lamp.vertices_m[:2]
    area = np.linalg.norm(np.cross(*edges))
    expected = illuminance(lamp, position, normal) / lamp.luminance_cd_m2
    np.testing.assert_allclose(weights.mean(axis=0) * area, expected, rtol=5e-3)


def test_samples_of_a_picture_and_of_a_mesh_lie_where_they_are_bright():
    """None is wasted on the dark, and their light is the picture's colour."""
    texture = np.zeros((4, 4, 3))
    texture[0, 3] = [16.0, 8.0, 0.0]  # the top right corner
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    samples = sample_points(PolygonLamp("p", np.ones(3), square, texture=texture), 16)
    assert (samples.points[:, :2] > 0.75 - 1e-9).all()
    np.testing.assert_allclose(samples.light[:, 0], 2 * samples.light[:, 1])
    assert not samples.light[:, 2].any()
    lamp = area_lamps(None)["mesh"]
    facets = np.zeros((len(lamp.triangles), 3))
    facets[5] = [0, -3.0, 0]  # light that is taken away
    samples = sample_points(replace(lamp, facet_luminance_cd_m2=facets), 9)
    corners = lamp.positions_m[lamp.triangles[5]]
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    np.testing.assert_allclose((samples.points - corners[0]) @ normal, 0, atol=1e-12)
    assert (samples.light >= 0).all()


def test_a_channel_without_light_is_no_nan():
    lamp = area_lamps(Shadow(64, samples=4))["picture"]
    red = replace(lamp, texture=np.ones((2, 2, 3)) * [3.0, 0, 0])
    rays = ShadowRays(Casters(((REAL, open_room()),)))
    points = np.array([[0.0, 0.01, 0.5], [1.0, 0.01, 1.0]])
    share = visible_share(red, points, np.broadcast_to(UP, (2, 3)), points, rays)
    assert np.isfinite(share).all()


def test_the_order_of_the_samples_moves_with_the_lamp():
    lamp = area_lamps(None)["disk"]
    here = sample_points(lamp, 16).points - lamp.position_m
    for shift in np.random.default_rng(0).normal(0, 3, (20, 3)):
        moved = replace(lamp, position_m=lamp.position_m + shift)
        there = sample_points(moved, 16).points - moved.position_m
        np.testing.assert_allclose(there, here, atol=1e-9)


def test_the_penumbra_of_a_straight_edge_is_the_share_of_the_lamp_above_it():
    """A wide lamp above a half-plane: what is seen grows evenly through the penumbra."""
    side = np.array([[-0.1, 2, 1], [0.1, 2, 1], [0.1, 2, -1], [-0.1, 2, -1.0]])
    lamp = PolygonLamp("strip", np.ones(3), side, shadow=Shadow(256, samples=256))
    edge = np.array([[0, 1, -50], [50, 1, -50], [50, 1, 50], [0, 1, 50.0]])
    rays = ShadowRays(
        Casters(((REAL, Geometry(edge, np.array([[0, 1, 2], [0, 2, 3]], np.int32))),))
    )
    x = np.linspace(-0.099, 0.099, 50)
    points = np.stack([x, np.zeros(50), np.zeros(50)], axis=1)
    share = visible_share(lamp, points, np.broadcast_to(UP, (50, 3)), points, rays)[:, 0]
    # A point at x sees the strip where lamp_x < −x: halfway between edge and lamp, so mirrored.
    assert np.abs(share - (0.5 - 5 * x)).max() < 0.02
    assert (np.diff(share) <= 1e-9).all()


def test_a_lamp_shines_through_the_groups_that_it_passes():
    wall = Geometry(
        np.array([[-9, 1, -9], [9, 1, -9], [9, 1, 9], [-9, 1, 9.0]]),
        np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )
    casters = Casters(((REAL, Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))),
                       (OBJECTS, wall), ("shell", wall)))  # fmt: skip
    rays = ShadowRays(casters)
    origin = np.zeros((1, 3))
    assert not rays.through(()).is_visible(origin, 2 * UP)[0]
    assert not rays.through(["shell"]).is_visible(origin, 2 * UP)[0]
    assert rays.through(["shell", OBJECTS]).is_visible(origin, 2 * UP)[0]
    assert casters.hiding(()) is None
    np.testing.assert_array_equal(casters.hiding(["shell"]), [True, True, False, False])


def both(*lamps):
    scene = prepared_of(open_room(), VIEW, lamps)
    return [Renderer(scene, engine).render() for engine in ("gpu", "reference")]


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("kind", area_lamps(None))
def test_unshadowed_light_agrees(kind):
    fast, slow = both(area_lamps(None)[kind])
    truth = np.asarray(slow.illuminance.lux)
    kept = slow.surface.valid & ~near_change(slow.surface.valid, 1)
    kept &= np.abs(slow.surface.depth - fast.surface.depth) < 1e-3 * slow.surface.depth
    ours = np.asarray(fast.illuminance.lux, float)
    assert_agree(ours[kept], truth[kept], rtol=1e-3, atol=1e-4 * truth.max(), share=1e-3, what=kind)


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("kind", ["sphere", "disk", "tube", "polygon", "picture", "mesh"])
def test_soft_shadows_agree(kind):
    """The same samples on both: what differs is the texel at each sample's own edge."""
    fast, slow = both(area_lamps(Shadow(512, samples=16))[kind])
    truth, ours = (np.asarray(f.illuminance.lux, float).max(axis=-1) for f in (slow, fast))
    error = np.abs(ours - truth)[slow.surface.valid] / truth.max()
    assert np.percentile(error, 50) < 1e-4
    assert np.percentile(error, 95) < 0.02
    assert np.sqrt(np.mean(error**2)) < 0.01


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("shadow", [None, HARD], ids=["no shadow", "shadow"])
def test_a_luminaire_agrees(shadow):
    fast, slow = both(luminaire(shadow))
    truth, ours = (np.asarray(f.illuminance.lux, float) for f in (slow, fast))
    lit = truth.max(axis=-1) > 1e-3 * truth.max()
    kept = slow.surface.valid & ~near_change(lit, 4) & ~near_change(slow.surface.valid, 1)
    assert_agree(ours[kept], truth[kept], rtol=2e-3, atol=1e-4 * truth.max(), share=5e-3)
    assert lit.mean() > 0.3


@pytest.mark.usefixtures("gpu")
def test_soft_maps_are_kept_until_the_lamp_moves():
    lamp = area_lamps(Shadow(64, samples=4))["sphere"]

    def at(seconds):
        return (replace(lamp, position_m=lamp.position_m + np.array([0.1 * seconds, 0, 0])),)

    scene = replace(prepared_of(open_room(), VIEW, at(0.0)), lamps=at)
    renderer = Renderer(scene, "gpu")
    assert [renderer.render(t).report.maps_redrawn for t in (0.0, 0.0, 1.0, 1.0)] == [4, 0, 4, 0]
    fresh = Renderer(replace(scene, lamps=lambda _: at(1.0)), "gpu").render()
    np.testing.assert_array_equal(renderer.render(1.0).illuminance.lux, fresh.illuminance.lux)


@pytest.mark.usefixtures("gpu")
def test_more_samples_than_an_adapter_holds_are_refused():
    from andon.errors import InputError

    lamps = [
        SphereLamp(f"{i}", np.ones(3), np.array([0, 1.0, i]), 0.1, shadow=Shadow(16, samples=1024))
        for i in range(2)
    ]
    with pytest.raises(InputError, match="2048 samples"):
        Renderer(prepared_of(open_room(), VIEW, lamps), "gpu")
