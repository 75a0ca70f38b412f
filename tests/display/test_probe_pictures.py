"""Pictures of probe volumes: what a pixel of a ball shows, what hides what, where lines run."""

import numpy as np
import pytest

from andon.display.probe_pictures import STRIP_PX, Look, around_view, framed_points, probe_picture
from andon.display.probe_pictures.canvas import SEEN_THROUGH, Canvas
from andon.display.probe_pictures.legend import round_length
from andon.display.probe_pictures.solids import draw_balls, draw_geometry, shown_light
from andon.errors import InputError
from andon.files.volumes import Cells, ProbeVolume, Zone
from andon.harmonics import basis, convolved
from andon.quantities import Geometry, Material
from andon.responses import srgb_decode
from andon.spaces import View, look_at, transform_points
from worlds import block, sheet

BLACK = np.zeros((1, 1, 3))
FRONT = View(
    "pinhole", 101, 81, 100.0, 100.0, 50.0, 40.0,
    world_from_camera=look_at(np.array([0, 0, 4.0]), np.zeros(3)),
)  # fmt: skip


def volume(light=None, *, count=2, cells=True):
    """Probes in the corners of a tetrahedron, or fewer."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)[:count]
    joined = None
    if cells and count == 4:
        facets = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]], np.int32)
        joined = Cells(
            np.array([[0, 1, 2, 3]], np.int32), -1 - np.arange(4, dtype=np.int32)[None], facets,
            np.zeros((4, 3), np.int32), np.zeros(4, np.int32),
            np.array([[0, 1]], np.int32), np.array([[0, 4]], np.int32),
        )  # fmt: skip
    return ProbeVolume(
        corners, corners, tuple(f"p{i}" for i in range(count)), ("sky",) * count,
        np.full(count, np.inf), {} if light is None else {"default": light},
        (Zone("all", np.arange(count, dtype=np.int32)),), joined,
    )  # fmt: skip


def test_a_balls_pixel_shows_the_light_of_its_normal():
    generator = np.random.default_rng(0)
    light = generator.uniform(-0.1, 0.1, (1, 9, 3))
    light[0, 0] = 1.0
    for irradiance in (False, True):
        canvas = Canvas(FRONT, BLACK)
        draw_balls(canvas, np.zeros((1, 3)), 1.0, light, [(0.0, 0.0, 0.0)], irradiance=irradiance)
        origin, rays = FRONT.rays_world()
        for row, column in ((40, 50), (30, 60), (55, 45), (40, 68)):
            ray = rays[row, column]
            along = -(origin @ ray)
            reach = along - np.sqrt(1 - (origin @ origin - along**2))
            normal = origin + reach * ray
            assert np.linalg.norm(normal) == pytest.approx(1)
            held = convolved(light[0]) / np.pi if irradiance else light[0]
            expected = np.maximum(basis(normal, 2) @ held, 0)
            np.testing.assert_allclose(canvas.colour[row, column], expected, atol=1e-12)
            depth = (origin - normal) @ [0, 0, 1]
            assert canvas.depth[row, column] == pytest.approx(depth, abs=1e-12)
    np.testing.assert_array_equal(canvas.colour[0, 0], 0)
    assert np.isinf(canvas.depth[0, 0])


def test_even_light_is_shown_as_it_is():
    """Luminance 1 everywhere: so is irradiance/π."""
    even = np.zeros((9, 3))
    even[0] = np.sqrt(4 * np.pi)
    normals = np.array([[0, 0, 1], [0.6, 0, 0.8]])
    for irradiance in (False, True):
        np.testing.assert_allclose(shown_light(even, normals, irradiance=irradiance), 1)


def test_near_balls_hide_far_ones_and_surfaces_hide_balls():
    one = np.full((2, 1, 3), np.sqrt(4 * np.pi))
    one[0] *= [1, 0, 0]
    one[1] *= [0, 1, 0]
    canvas = Canvas(FRONT, BLACK)
    places = np.array([[0, 0, 1.0], [0, 0, -1.0]])
    draw_balls(canvas, places, 0.4, one, [(0.0, 0.0, 1.0)] * 2, irradiance=False)
    np.testing.assert_allclose(canvas.colour[40, 50], [1, 0, 0], atol=1e-12)
    wall = sheet((-9, -9, 2), (18, 0, 0), (0, 18, 0))
    canvas = Canvas(FRONT, BLACK)
    draw_geometry(canvas, wall)
    before = canvas.colour[40, 50].copy()
    draw_balls(canvas, places[:1], 0.4, one[:1], [(1.0, 0.0, 0.0)], irradiance=False)
    after = canvas.colour[40, 50]
    share = 1 - (1 - SEEN_THROUGH) ** 2  # the ring's disc below, the ball above
    np.testing.assert_allclose(after, before + share * (np.array([1.0, 0, 0]) - before))
    assert canvas.depth[40, 50] == pytest.approx(2)


def test_only_fronts_of_surfaces_are_drawn():
    room = block((2, 2, 2), (0, 0, 0), inwards=True)
    canvas = Canvas(FRONT, BLACK)
    draw_geometry(canvas, room)
    assert canvas.depth[40, 50] == pytest.approx(5), "the near wall is left out"
    canvas = Canvas(FRONT, BLACK)
    draw_geometry(canvas, block((2, 2, 2), (0, 0, 0)))
    assert canvas.depth[40, 50] == pytest.approx(3)


@pytest.mark.parametrize(("inwards", "solid"), [(False, False), (True, False), (True, True)])
def test_walls_between_the_eye_and_the_probes_are_left_out(inwards, solid):
    """Near walls go, whichever way they are turned; far ones and the floor stay."""
    room = block((2, 2, 2), (0, 0, 0), inwards=inwards)
    if solid:
        outer = block((2.4, 2.4, 2.4), (0, 0, 0))
        room = Geometry(
            np.concatenate([room.positions, outer.positions]),
            np.concatenate([room.triangles, outer.triangles + len(room.positions)]),
        )
    probes = np.random.default_rng(0).uniform(-0.8, 0.8, (20, 3))
    canvas = Canvas(FRONT, BLACK)
    draw_geometry(canvas, room, probes)
    assert canvas.depth[40, 50] == pytest.approx(5)
    assert canvas.colour[40, 50].min() > 0.2


def test_plan_views_have_their_back_at_the_top():
    """From above and from below; a hair off the plumb line keeps its upright."""
    for side in (3.0, -3.0):
        view = around_view(
            np.eye(3), (300, 260), eye=np.array([0.5, side, 0.2]), target=np.array([0.5, 0, 0.2])
        )
        back = view.project(transform_points(view.camera_from_world, np.array([0.5, 0, -0.8])))
        assert back[1] < view.cy - 20
        assert back[0] == pytest.approx(view.cx)


@pytest.mark.parametrize("count", [1, 2, 4])
def test_all_balls_are_inside_the_picture(count):
    held = volume(np.full((count, 4, 3), 2.0), count=count)
    view = around_view(framed_points(held), (320, 240))
    picture = probe_picture(held, view, Look(("balls",))).rgb[: 240 - STRIP_PX].astype(int)
    edge = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
    assert edge.max() < 80, "only what lies behind everything"
    assert picture.max() > 150


def test_balls_have_no_holes():
    """A series that swings below 0 opposite to a lamp is smoothed, not clipped."""
    light = basis(np.array([[0.0, 0.0, -1.0]]), 2)[0][:, None] * np.ones((1, 1, 3))
    held = volume(light, count=1)
    view = around_view(framed_points(held), (320, 240), eye=np.array([0, 0, 2.0]))
    picture = probe_picture(held, view, Look(("balls",))).rgb[: 240 - STRIP_PX]
    ball = picture[60:120, 130:190].reshape(-1, 3).max(axis=1)
    assert (ball < 2).mean() < 0.05


def test_materials_and_textures_are_told_apart():
    texture = np.zeros((2, 2, 3), np.float32)
    texture[:, 0], texture[:, 1] = [1, 0, 0], [0, 0, 1]
    base = sheet((-2, -2, 0), (4, 0, 0), (0, 4, 0))
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float)
    wall = Geometry(
        base.positions, base.triangles, None, uvs, None, (Material("m", (0.8, 0.8, 0.8), texture),)
    )
    canvas = Canvas(FRONT, BLACK)
    draw_geometry(canvas, wall)
    left, right = canvas.colour[40, 30], canvas.colour[40, 70]
    assert left[0] > 2 * left[2]
    assert right[2] > 2 * right[0]


def test_lines_run_between_their_ends():
    canvas = Canvas(FRONT, BLACK)
    ends = np.array([[[-1, 0.5, 0], [1, 0.5, 0]]], float)
    canvas.lines(ends, (1.0, 1.0, 1.0), width_px=2.0)
    pixels = FRONT.project(transform_points(FRONT.camera_from_world, ends[0]))
    row = round(pixels[0, 1])
    first, last = round(pixels[0, 0]), round(pixels[1, 0])
    drawn = canvas.colour[..., 0]
    assert (drawn[row, first + 1 : last] > 0.5).all()
    assert drawn[row, : first - 2].max() == 0
    assert drawn[row, last + 3 :].max() == 0
    assert drawn[: row - 3].max() == 0
    # As much ink as the line is wide.
    middle = drawn[:, (first + last) // 2].sum()
    assert middle == pytest.approx(2.0, rel=0.1)


def test_lines_are_cut_at_the_eye_and_fade_behind_surfaces():
    canvas = Canvas(FRONT, BLACK)
    through = np.array([[[0, 0.3, 9.0], [0, 0.3, -2]], [[0, 1, 5], [0, 1, 6.0]]])
    canvas.lines(through, (1.0, 1.0, 1.0), width_px=2.0)
    assert np.isfinite(canvas.colour).all()
    assert canvas.colour.max() > 0
    inks = []
    for distance in (-1.0, 1.0):
        canvas = Canvas(FRONT, BLACK)
        draw_geometry(canvas, sheet((-9, -9, distance), (18, 0, 0), (0, 18, 0)))
        empty = canvas.colour.copy()
        canvas.lines(np.array([[[-1, 0, 0], [1, 0, 0.0]]]), (1.0, 1.0, 1.0), width_px=3.0)
        inks.append((canvas.colour - empty)[40, 50, 0] / (1 - empty[40, 50, 0]))
    assert inks[1] == pytest.approx(SEEN_THROUGH * inks[0], rel=1e-6)


@pytest.mark.parametrize("count", [1, 2, 4])
def test_pictures_of_few_probes(count):
    light = np.full((count, 4, 3), 2.0)
    held = volume(light, count=count)
    parts = ("balls", "cells", "hull", "graph", "zones")
    picture = probe_picture(held, around_view(held.positions, (240, 180)), Look(parts))
    assert picture.rgb.shape == (180, 240, 3)
    assert picture.rgb[: 180 - STRIP_PX].max() > 150


def test_white_is_chosen_said_and_kept():
    light = np.zeros((2, 1, 3))
    light[:, 0] = np.sqrt(4 * np.pi) * 500.0  # 500 cd/m² all around
    held = volume(light)
    view = around_view(held.positions, (200, 180))
    chosen = probe_picture(held, view, Look(("balls",)))
    assert chosen.white_cd_m2 == pytest.approx(500 / 0.9)
    fixed = probe_picture(held, view, Look(("balls",), units_per_cd_m2=1 / 2000))
    assert fixed.white_cd_m2 == pytest.approx(2000)
    column, row = view.project(transform_points(view.camera_from_world, held.positions[0]))
    for picture, value in ((chosen, 0.9), (fixed, 0.25)):
        code = picture.rgb[round(row), round(column)]
        np.testing.assert_allclose(srgb_decode(code / 255), value, atol=0.01)


def test_no_light_no_white():
    assert np.isnan(probe_picture(volume(), around_view(np.eye(3), (200, 160))).white_cd_m2)


def test_dark_volumes_are_drawn():
    held = volume(np.zeros((2, 9, 3)))
    picture = probe_picture(held, around_view(held.positions, (200, 160)))
    assert picture.white_cd_m2 == 1


def test_an_unknown_state_is_refused():
    held = volume(np.ones((2, 1, 3)))
    with pytest.raises(InputError, match="no state 'night'"):
        probe_picture(held, around_view(held.positions, (200, 160)), state="night")


def test_the_view_has_all_in_it():
    points = np.random.default_rng(0).uniform([-8, 0, -3], [2, 3, 5], (100, 3))
    view = around_view(points, (640, 360))
    pixels = view.project(transform_points(view.camera_from_world, points))
    assert view.shape == (360 - STRIP_PX, 640)
    assert (pixels >= 0).all()
    assert (pixels < [view.width, view.height]).all()
    filled = np.ptp(pixels, axis=0) / [view.width, view.height]
    assert 0.8 < filled.max() < 0.95
    middle = (pixels.min(axis=0) + pixels.max(axis=0)) / 2
    np.testing.assert_allclose(middle, [view.width / 2, view.height / 2], atol=8)


def test_a_stated_view_is_kept():
    view = around_view(
        np.eye(3), (640, 360), eye=np.array([0, 1, 5.0]), target=np.array([0, 1, 0.0])
    )
    np.testing.assert_allclose(view.position, [0, 1, 5])
    np.testing.assert_allclose(view.world_from_camera[:3, 2], [0, 0, -1])


def test_round_lengths():
    assert [round_length(x) for x in (1.0, 1.9, 4.99, 5.0, 73.0, 0.034)] == [
        1, 1, 2, 5, 50, pytest.approx(0.02),
    ]  # fmt: skip
