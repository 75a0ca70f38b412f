"""Radiance, as we ask it, against closed forms: a truth is only as good as the question."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest

from andon.errors import InputError, MachineError
from andon.files import radiance_programs
from andon.lamps import DirectionalLamp, MeshLamp, PointLamp, Shadow, SpotLamp
from andon.quantities import Geometry, Material
from andon.spaces import View, look_at
from andon.verify.rooms import furnished_room, lamps_in
from andon.verify.solids import icosphere, panel
from andon.verify.truths.embree import Visibility
from andon.verify.truths.radiance import (
    RadianceScene,
    irradiance,
    time_view,
)
from requirements import required

required("pyradiance")

UP = np.array([0.0, 1.0, 0.0])


def quad(half, height):
    """A square of 2·half metres at `height`, facing up."""
    square = panel((-half, height, half), (2 * half, 0, 0), (0, 0, -2 * half), (1, 1))
    return square.positions, square.triangles


FLOOR = Geometry(*quad(5.0, 0.0))


def floor_with_shade():
    """A floor and a square of ±0.5 m, one metre above it."""
    floor, faces = quad(5.0, 0.0)
    shade, more = quad(0.5, 1.0)
    return Geometry(np.concatenate([floor, shade]), np.concatenate([faces, more + 4]))


def spot_lamp(position, direction, intensity, inner, outer):
    angles = np.radians([inner, outer]).tolist()
    return SpotLamp("s", position, intensity, Shadow(), 0.0, direction, *angles)


def floor_points(count, seed=0):
    points = np.random.default_rng(seed).uniform(-3, 3, (count, 3)) * (1, 0, 1)
    return points, np.tile(UP, (count, 1))


def point_lux(points, normals, position, intensity):
    to_lamp = np.asarray(position) - points
    distance = np.linalg.norm(to_lamp, axis=1)
    cosine = np.maximum(np.einsum("ij,ij->i", to_lamp, normals) / distance, 0)
    return (cosine / distance**2)[:, None] * np.asarray(intensity)


def test_a_point_lamp_over_a_floor_is_the_closed_form_per_channel():
    points, normals = floor_points(500)
    position, intensity = np.array([0.3, 1.7, -0.2]), np.array([100.0, 40.0, 5.0])
    lux = irradiance(FLOOR, [PointLamp("p", position, intensity)], points, normals, threads=1)
    expected = point_lux(points, normals, position, intensity)
    np.testing.assert_allclose(lux, expected, rtol=5e-5)


def test_several_lamps_add_up():
    points, normals = floor_points(50)
    generator = np.random.default_rng(5)
    lamps = [
        PointLamp(str(n), generator.uniform((-2, 0.5, -2), (2, 3, 2)), generator.uniform(0, 90, 3))
        for n in range(7)
    ]
    lux = irradiance(FLOOR, lamps, points, normals, threads=1)
    expected = sum(point_lux(points, normals, x.position_m, x.intensity_cd) for x in lamps)
    np.testing.assert_allclose(lux, expected, rtol=2e-4)


def test_an_occluder_casts_its_shadow():
    x = np.array([-1.01, -0.99, 0.0, 0.99, 1.01])
    points, normals = np.column_stack([x, 0 * x, 0 * x]), np.tile(UP, (5, 1))
    position, intensity = np.array([0.0, 2.0, 0.0]), np.full(3, 50.0)
    # From 2 m the square's shadow on the floor is twice as wide: ±1 m.
    lux = irradiance(floor_with_shade(), [PointLamp("p", position, intensity)], points, normals)
    expected = point_lux(points, normals, position, intensity)
    expected[1:4] = 0
    np.testing.assert_allclose(lux, expected, rtol=1e-4)


def test_a_spot_has_the_falloff_of_gltf():
    x = np.linspace(0, 2.5, 120)
    points, normals = np.column_stack([x, 0 * x, 0 * x]), np.tile(UP, (len(x), 1))
    position, intensity = np.array([0.0, 2.0, 0.0]), np.array([80.0, 60.0, 10.0])
    spot = spot_lamp(position, -UP * 3, intensity, 20, 40)
    lux = irradiance(FLOOR, [spot], points, normals, threads=1)
    cosine = 2 / np.hypot(x, 2)
    inner, outer = np.cos(np.radians([20, 40]))
    falloff = np.clip((cosine - outer) / (inner - outer), 0, 1) ** 2
    expected = point_lux(points, normals, position, intensity) * falloff[:, None]
    np.testing.assert_allclose(lux, expected, rtol=1e-3, atol=1e-3)
    assert (lux[np.degrees(np.arccos(cosine)) > 41] == 0).all()


def test_a_spot_shines_where_it_points():
    points = np.array([(1.5, 0.0, 0.0), (-1.5, 0.0, 0.0)])
    spot = spot_lamp(UP, np.array([1.5, -1.0, 0.0]), np.ones(3), 5, 10)
    lux = irradiance(FLOOR, [spot], points, np.tile(UP, (2, 1)), threads=1)
    assert (lux[0] > 0).all()
    assert (lux[1] == 0).all()


def test_directional_light_is_cosine_and_casts_shadows():
    tilt = np.radians(30)
    lamp = DirectionalLamp(
        "sun", np.array([np.sin(tilt), -np.cos(tilt), 0.0]), np.array([900.0, 500, 1])
    )
    # The square at 1 m is shifted by tan 30° = 0.577 m on the floor.
    points = np.array([(-2.0, 0, 0), (0.577, 0, 0), (1.06, 0, 0), (1.09, 0, 0)])
    lux = irradiance(floor_with_shade(), [lamp], points, np.tile(UP, (4, 1)), threads=1)
    facing = np.cos(tilt) * lamp.illuminance_lux
    np.testing.assert_allclose(lux, [facing, 0 * facing, 0 * facing, facing], rtol=1e-4)


def test_an_area_lamp_is_lamberts_polygon():
    lamp = panel((-0.3, 1.5, -0.2), (0.6, 0, 0), (0, 0, 0.4), (24, 16))
    source = MeshLamp("a", np.array([1000.0, 500.0, 100.0]), lamp.positions, lamp.triangles)
    points, normals = floor_points(40)
    lux = irradiance(FLOOR, [source], points, normals, threads=1)
    corners = np.array([(-0.3, 1.5, -0.2), (0.3, 1.5, -0.2), (0.3, 1.5, 0.2), (-0.3, 1.5, 0.2)])
    assert np.cross(corners[1] - corners[0], corners[2] - corners[1])[1] < 0, "it shines downwards"
    # Lambert 1760: E = L/2 · Σ γᵢ n·unit(vᵢ × vᵢ₊₁), all corners above the horizon.
    expected = []
    for point in points:
        v = corners - point
        v /= np.linalg.norm(v, axis=1, keepdims=True)
        w = np.roll(v, -1, axis=0)
        edge = np.cross(v, w)
        length = np.linalg.norm(edge, axis=1)
        gamma = np.arctan2(length, np.einsum("ij,ij->i", v, w))
        expected.append(abs((gamma * edge[:, 1] / length).sum()) / 2)
    expected = np.array(expected)[:, None] * source.luminance_cd_m2
    np.testing.assert_allclose(lux, expected, rtol=2e-3)
    below = irradiance(FLOOR, [source], np.array([(0, 2.0, 0)]), -UP[None], threads=1)
    assert (below == 0).all(), "area lamps shine from their front only"


def test_bounces_in_a_white_sphere_are_the_geometric_series():
    ball = icosphere(1.0, 8)
    inside = Geometry(
        ball.positions,
        np.ascontiguousarray(ball.triangles[:, ::-1]),
        materials=(Material(reflectance=(0.5, 0.2, 0.0)),),
    )
    points = ball.positions[ball.triangles[::97]].mean(axis=1)
    normals = -points / np.linalg.norm(points, axis=1, keepdims=True)
    lamp = PointLamp("p", np.zeros(3), np.full(3, 10.0))
    with RadianceScene(inside, [lamp]) as scene:
        direct = scene.irradiance(points, normals, threads=1)
        once = scene.irradiance(
            points, normals, ambient_bounces=1, ambient_divisions=512, threads=1
        )
    np.testing.assert_allclose(direct, 10.0, rtol=0.03)
    # One bounce in a sphere: E₁ = E₀ (1 + ρ), Radiance's cache and facets within 3 %.
    np.testing.assert_allclose(once / direct, np.tile([1.5, 1.2, 1.0], (len(points), 1)), rtol=0.03)


def test_a_furnished_room_agrees_with_embree_shadows_and_the_closed_form():
    room = furnished_room(1)
    lamp = lamps_in(room, 1)[0]
    generator = np.random.default_rng(2)
    chosen = room.triangles[generator.choice(len(room.triangles), 1500)]
    corners = room.positions[chosen]
    points = np.einsum("ij,ijk->ik", generator.dirichlet((2, 2, 2), 1500), corners)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lux = irradiance(room, [PointLamp("p", lamp.position, lamp.intensity_rgb_cd)], points, normals)
    seen = Visibility(room).visible(points, normals, lamp.position)
    expected = point_lux(points, normals, lamp.position, lamp.intensity_rgb_cd) * seen[:, None]
    close = np.isclose(lux, expected, rtol=2e-3, atol=1e-3).all(axis=1)
    assert close.mean() > 0.995


def test_a_view_sees_luminance_and_no_lamps():
    rho, lamp = np.array([0.6, 0.3, 0.1]), PointLamp("p", UP, np.full(3, 20.0))
    painted = replace(FLOOR, materials=(Material(reflectance=tuple(rho)),))
    # From straight above, the lamp is in the middle of the picture, before the floor.
    pose = look_at(np.array([0.0, 3.0, 0.0]), np.zeros(3), up=(0, 0, -1))
    view = View("pinhole", 41, 31, fx=40, fy=40, cx=20, cy=15, world_from_camera=pose)
    with RadianceScene(painted, [lamp]) as scene:
        seen = scene.luminance(view, threads=1)
        timing = time_view(scene, view, repeats=2, threads=1)
        assert timing.points == 41 * 31
        assert len(timing.seconds) == 2
        assert min(timing.seconds) > 0
    assert seen.shape == (31, 41, 3)
    column, row = np.meshgrid(np.arange(41), np.arange(31))
    points = np.stack([(column - 20) * 3 / 40, 0 * row, (row - 15) * 3 / 40], -1).reshape(-1, 3)
    lux = point_lux(points, np.tile(UP, (len(points), 1)), lamp.position_m, lamp.intensity_cd)
    expected = (rho * lux / np.pi).reshape(seen.shape)
    beside = (column != 20) | (row != 15)
    np.testing.assert_allclose(seen[beside], expected[beside], rtol=1e-4)
    assert seen[15, 20].max() <= expected.max(), "the lamp itself must not shine into the picture"


def test_no_points_and_no_lamps():
    points, normals = floor_points(3)
    assert irradiance(FLOOR, [], points[:0], normals[:0]).shape == (0, 3)
    np.testing.assert_array_equal(irradiance(FLOOR, [], points, normals, threads=1), 0)


@pytest.mark.parametrize(
    ("lamp", "rule"),
    [
        (PointLamp("p", UP, np.array([1.0, -1.0, 1.0])), "≥ 0"),
        (PointLamp("p", UP, np.array([1.0, np.nan, 1.0])), "≥ 0"),
        (spot_lamp(UP, -UP, np.ones(3), 40, 30), "inner < outer"),
        (spot_lamp(UP, 0 * UP, np.ones(3), 10, 30), "direction"),
        (DirectionalLamp("d", np.array([np.inf, 0, 0]), np.ones(3)), "direction"),
    ],
)
def test_hostile_lamps_are_refused(lamp, rule):
    with pytest.raises(InputError, match=rule):
        irradiance(FLOOR, [lamp], *floor_points(1))


@pytest.mark.parametrize(
    ("points", "normals", "field"),
    [
        (np.full((1, 3), np.nan), UP[None], "points"),
        (np.zeros((1, 3)), np.zeros((1, 3)), "normals"),
        (np.zeros((2, 3)), UP[None], "normals"),
        (np.zeros(3), UP, "points"),
    ],
)
def test_hostile_points_are_refused(points, normals, field):
    with pytest.raises(InputError, match=field):
        irradiance(FLOOR, [], points, normals)


def test_a_scene_outside_its_context_is_refused():
    with pytest.raises(InputError, match="entered"):
        RadianceScene(FLOOR, []).irradiance(*floor_points(1))


def test_a_run_over_the_time_limit_is_the_machines_fault(monkeypatch):
    """By a program that sleeps: the real ones may be quicker than any limit."""

    def sleeper(command, **options):
        return subprocess.run(["sleep", "5"], **options)

    class Slow:
        TimeoutExpired = subprocess.TimeoutExpired
        run = staticmethod(sleeper)

    monkeypatch.setattr(radiance_programs, "subprocess", Slow)
    scene = RadianceScene(FLOOR, [], time_limit_seconds=0.05)
    with pytest.raises(MachineError, match=r"more than 0\.05 s"), scene:
        pass


def test_a_failing_program_is_reported_with_its_words():
    broken = [PointLamp("p", np.array([np.nan, 0, 0]), np.ones(3))]
    with pytest.raises(MachineError, match=r"oconv failed .*argument"):
        irradiance(FLOOR, broken, *floor_points(1))


def test_missing_radiance_says_how_to_install_it(monkeypatch):
    monkeypatch.setattr(radiance_programs, "find_spec", lambda name: None)
    with pytest.raises(MachineError, match=r"pip install 'andon\[radiance\]'"):
        irradiance(FLOOR, [], *floor_points(1))


def test_points_under_the_surface_need_a_higher_lift():
    points, normals = floor_points(20)
    points = points - 3e-5 * UP
    with RadianceScene(FLOOR, [PointLamp("p", UP, np.ones(3))]) as scene:
        assert (scene.irradiance(points, normals, threads=1) == 0).all()
        lit = scene.irradiance(points, normals, lift_m=8e-5, threads=1)
    np.testing.assert_allclose(lit, point_lux(points, normals, UP, np.ones(3)), rtol=3e-4)
