"""Backdrops against closed forms and exact rays."""

import numpy as np
import pytest

from andon.glass.backdrops.environment import environment_of
from andon.glass.backdrops.march import march
from andon.glass.backdrops.model import FAR_M, Footprint, SceneOfView
from andon.glass.backdrops.paper import blur_metres, preblurred, taps_of
from andon.glass.backdrops.projecting import moved_pixels
from andon.glass.backdrops.pyramids import MAX_LEVEL, pyramid, sampled
from andon.glass.backdrops.reference import environment_light, look, sticker_at
from andon.glass.model import Backdrop, Ball, Solid, Sticker
from andon.harmonics import irradiance
from andon.lamps import HemisphereLamp, PointLamp, SkyLamp
from andon.quantities import merged
from andon.spaces import pinhole_view, transform_points
from comparison import assert_agree
from worlds import block, sheet, unit

from .backdrop_scenes import (
    SLANTED_WALL,
    VIEWS,
    WALL_AND_BOX,
    eye_of,
    rays_from_a_ball,
    surface_of,
)

TRIPLE = (1.0, 2.0, 3.0)


def still(count):
    """Footprints of nothing."""
    return Footprint(np.zeros((count, 2, 3)), np.zeros((count, 2, 3)))


def plain_eye(view=None):
    view = view or pinhole_view(40, 30, 30.0)
    return SceneOfView(
        np.ones((*view.shape, 3)), surface_of(view, SLANTED_WALL)[0], view, 10.0, TRIPLE
    )


# ── pictures on planes ──────────────────────────────────────────────────────────────────────────

QUARTERS = np.zeros((2, 2, 3), np.float32)
QUARTERS[0, 0], QUARTERS[0, 1], QUARTERS[1, 0], QUARTERS[1, 1] = 0.1, 0.2, 0.3, 0.4
BOARD = Backdrop(
    "texture",
    picture=QUARTERS,
    centre_m=np.array([0.0, 0.0, -2.0]),
    right_m=np.array([0.5, 0.0, 0.0]),
    up_m=np.array([0.0, 0.25, 0.0]),
)


def test_a_picture_hangs_upright_on_its_plane():
    """Row 0 at +up, column 0 at −right, in the light that dims the frame."""
    corners = np.array([(-0.4, 0.2, -2), (0.4, 0.2, -2), (-0.4, -0.2, -2), (0.4, -0.2, -2.0)])
    seen = look(BOARD, np.zeros((4, 3)), unit(corners), still(4), plain_eye())
    assert_agree(seen.light, np.outer([1, 2, 3, 4], TRIPLE), rtol=1e-6)
    assert_agree(seen.distance_m, np.linalg.norm(corners, axis=1), rtol=1e-12)
    assert not seen.missed.any()
    assert not seen.beside.any()


def test_both_sides_of_a_plane_show_its_picture():
    origins = np.array([[-0.4, 0.2, -1.0], [-0.4, 0.2, -3.5]])
    seen = look(BOARD, origins, np.array([[0, 0, -1.0], [0, 0, 1.0]]), still(2), plain_eye())
    assert_agree(seen.light[0], seen.light[1], rtol=1e-12)
    assert_agree(seen.distance_m, [1.0, 1.5], rtol=1e-12)


@pytest.mark.parametrize(
    ("origin", "direction"),
    [
        ((0.51, 0, 0), (0, 0, -1)),
        ((0, -0.26, 0), (0, 0, -1)),
        ((0, 0, 0), (0, 0, 1)),
        ((0, 0, -2.5), (0, 0, -1)),
        ((0, 0, -1), (1, 0, 0)),
        ((0, 0, -2), (1, 0, 0)),
    ],
)
def test_beside_a_picture_nothing_is(origin, direction):
    rays = np.array([origin], float), np.array([direction], float)
    seen = look(BOARD, *rays, still(1), plain_eye())
    assert seen.missed.all()
    assert (seen.light == 0).all()
    assert (seen.distance_m == FAR_M).all()


def test_a_footprint_is_how_far_the_hit_moves():
    """Against rays that are really moved, through planes and spheres."""
    origins, directions = rays_from_a_ball(50)
    generator = np.random.default_rng(1)
    moves = generator.normal(size=(2, 50, 2, 3)) * 1e-6
    moves[1] -= np.einsum("nki,ni->nk", moves[1], directions)[..., None] * directions[:, None]
    normal = unit(np.array([0.2, 0.1, 1.0]))
    distance = ((np.array([0, 0, -3.0]) - origins) @ normal) / (directions @ normal)
    expected = []
    for k in range(2):
        start, course = origins + moves[0, :, k], unit(directions + moves[1, :, k])
        reach = ((np.array([0, 0, -3.0]) - start) @ normal) / (course @ normal)
        expected.append(start + reach[:, None] * course - origins - distance[:, None] * directions)
    normals = np.broadcast_to(normal, directions.shape)
    actual = Footprint(*moves).at(directions, normals, distance)
    assert_agree(actual, np.stack(expected, axis=1), atol=1e-10)


# ── the frame ───────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("projection", VIEWS)
def test_a_frame_seen_from_the_eye_is_the_frame(projection):
    """Through every pixel's own ray its own light, as far away as it was put."""
    eye = eye_of(VIEWS[projection])
    rays = eye.view.directions().reshape(-1, 3) @ eye.view.world_from_camera[:3, :3].T
    backdrop = Backdrop("frame", distance_m=1.7)
    seen = look(backdrop, np.zeros_like(rays), rays, still(len(rays)), eye)
    assert_agree(seen.light.reshape(eye.luminance.shape), eye.luminance, rtol=1e-9)
    assert_agree(seen.distance_m, np.full(len(rays), 1.7), rtol=1e-12)
    assert not (seen.missed | seen.beside).any()


def test_a_frame_is_met_on_its_sphere():
    eye = eye_of(VIEWS["latlong"])
    origins, directions = rays_from_a_ball(200)
    seen = look(Backdrop("frame", distance_m=1.5), origins, directions, still(200), eye)
    reached = origins + seen.distance_m[:, None] * directions
    assert_agree(np.linalg.norm(reached, axis=1), np.full(200, 1.5), rtol=1e-12)


def test_beside_the_frame_its_border_goes_on():
    view = VIEWS["pinhole"]
    eye = eye_of(view)
    directions = unit(np.array([[-3.0, 0, -1], [0, 9.0, -1], [0, 0, 1.0]]))
    seen = look(Backdrop("frame", distance_m=2), np.zeros((3, 3)), directions, still(3), eye)
    middle = (view.height - 1) / 2, (view.width - 1) / 2
    row, column = (slice(int(m), int(m) + 2) for m in middle)
    assert_agree(seen.light[0], eye.luminance[row, 0].mean(axis=0), rtol=1e-9)
    assert_agree(seen.light[1], eye.luminance[0, column].mean(axis=0), rtol=1e-9)
    assert seen.missed.tolist() == [False, False, True]


@pytest.mark.parametrize("projection", VIEWS)
def test_moved_pixels_are_derivatives(projection):
    view, generator = VIEWS[projection], np.random.default_rng(3)
    points = unit(generator.normal(size=(300, 3)) * [1, 1, 0.5] + [0, 0, 1.2])
    points = points[points[:, 2] > 0.1]
    points[0] = 0, 0, 1
    moves = generator.normal(size=(len(points), 2, 3)) * 1e-6
    pixels, actual = moved_pixels(view, points, moves)
    assert_agree(pixels, view.project(points), atol=1e-9)
    step = view.project(points[:, None] + moves) - view.project(points[:, None] - moves)
    assert_agree(actual, step / 2, atol=1e-7)


# ── the scene's geometry ────────────────────────────────────────────────────────────────────────


def exact_and_marched(view, geometry, count=20000, **rays):
    """Distances by the march and by Embree, of rays whose hit the eye sees; and of the others."""
    surface, scene = surface_of(view, geometry)
    origins, directions = rays_from_a_ball(count, **rays)
    marched = march(surface, origins, directions).distance_m
    hits = scene.first_hits(origins, directions)
    hit = np.isfinite(hits.distance)
    points = origins + np.where(hit, hits.distance, 0)[:, None] * directions
    pixels = view.project(transform_points(view.camera_from_world, points))
    limit = np.array([view.width, view.height]) - 0.5
    with np.errstate(invalid="ignore"):
        seen = hit & ((pixels > -0.5) & (pixels < limit)).all(axis=1)
    seen &= scene.is_visible(points - 1e-4 * directions, view.position)
    return (marched[seen], hits.distance[seen]), (marched[~seen], hits.distance[~seen])


@pytest.mark.parametrize("projection", VIEWS)
def test_a_slanted_plane_is_met_where_it_is(projection):
    (marched, exact), (others, unseen) = exact_and_marched(VIEWS[projection], SLANTED_WALL)
    assert len(exact) > 5000
    assert_agree(marched, exact, rtol=1e-9)
    # A hit within a pixel beyond the picture's border is still on the plane of its last pixel.
    found = np.isfinite(others)
    assert found.mean() < 0.02 if len(others) else projection != "pinhole"
    np.testing.assert_allclose(others[found], unseen[found], rtol=1e-9)


# Share of the rays whose hit differs by more than 1e-3: those that pass through a corner of the box
# within one step, or meet it within a pixel of its border. It falls with the length of the steps.
NEAR_EDGES = 0.02


@pytest.mark.parametrize("projection", VIEWS)
def test_a_box_before_a_wall(projection):
    (marched, exact), _ = exact_and_marched(VIEWS[projection], WALL_AND_BOX)
    assert_agree(np.where(np.isfinite(marched), marched, 0), exact, rtol=1e-3, share=NEAR_EDGES)


def test_rays_pass_behind_what_is_nearer():
    """One runs parallel to the wall behind a box, and meets another wall beyond it."""
    view = VIEWS["pinhole"]
    aside = sheet((0.9, -1, -3), (0, 0, 2.5), (0, 2, 0))
    before = block((0.3, 0.3, 0.1), (0.0, 0.0, -1.0))
    back = sheet((-4, -4, -3), (8, 0, 0), (0, 8, 0))
    surface, _ = surface_of(view, merged(aside, before, back))
    origins, directions = np.array([[-0.6, 0.0, -1.7]]), np.array([[1.0, 0.0, 0.0]])
    met = march(surface, origins, directions)
    distance, normals = met.distance_m, met.normal
    assert_agree(distance, [1.5], rtol=1e-6)
    assert_agree(normals, [[-1.0, 0, 0]], atol=1e-9)


def test_holes_are_passed():
    view = VIEWS["pinhole"]
    eye = eye_of(view)
    eye.surface.valid[60:120, 100:220] = False
    origins = np.array([[0.0, 0.0, -0.5]] * 2)
    directions = unit(np.array([[0.0, 0.0, -1.0], [0.5, 0.0, -1.0]]))
    seen = look(Backdrop("surface"), origins, directions, still(2), eye)
    assert seen.beside.tolist() == [True, False]
    assert not seen.missed.any()
    # What is infinitely far away straight ahead: the middle of the frame.
    assert_agree(seen.light[0], eye.luminance[89:91, 159:161].mean(axis=(0, 1)), rtol=1e-9)


def test_a_surface_is_met_from_its_front_only():
    """A ray that starts behind a wall and comes towards the eye does not see the wall's back."""
    surface, _ = surface_of(VIEWS["pinhole"], SLANTED_WALL)
    distance = march(surface, np.array([[0.0, 0, -2.5]]), np.array([[0.0, 0, 1.0]])).distance_m
    assert distance[0] == np.inf


def test_light_of_a_hit_is_that_of_its_pixel():
    """From the eye itself: the ray of a pixel meets what the pixel shows."""
    eye = eye_of(VIEWS["pinhole"], WALL_AND_BOX)
    position, directions = eye.view.rays_world()
    rays = directions[::7, ::7].reshape(-1, 3)
    origins = position + 0.3 * rays
    seen = look(Backdrop("surface"), origins, rays, still(len(rays)), eye)
    assert_agree(seen.light, eye.luminance[::7, ::7].reshape(-1, 3), rtol=1e-6)
    depths = np.linalg.norm(eye.surface.position[::7, ::7] - position, axis=-1).ravel()
    assert_agree(seen.distance_m, depths - 0.3, rtol=1e-6)


# ── filtering ───────────────────────────────────────────────────────────────────────────────────


def checkers(cells=64, texels=8):
    rows, columns = np.mgrid[: cells * texels, : cells * texels] // texels
    return np.repeat(((rows + columns) % 2)[..., None].astype(np.float64), 3, axis=2)


def test_levels_keep_the_mean():
    generator = np.random.default_rng(1)
    levels = pyramid(generator.random((64, 256, 3))).levels
    assert len(levels) == 1 + MAX_LEVEL
    for level in levels:
        assert_agree(level.mean(axis=(0, 1)), levels[0].mean(axis=(0, 1)), rtol=1e-12)


def test_a_sharp_footprint_reads_texels():
    picture = np.random.default_rng(1).random((9, 7, 3))
    rows, columns = np.mgrid[:9, :7]
    places = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(float)
    steps = np.broadcast_to(0.1 * np.eye(2), (63, 2, 2))
    assert_agree(sampled(pyramid(picture), places, steps)[:, 0], picture[..., 0].ravel(), atol=0.1)
    none = sampled(pyramid(picture), places, np.zeros((63, 2, 2)))
    assert_agree(none, picture.reshape(-1, 3), atol=1e-12)


@pytest.mark.parametrize("turned", np.radians([0, 30, 90, 135]))
@pytest.mark.parametrize("texels", [7, 8])
@pytest.mark.parametrize(("long", "short"), [(16, 16), (32, 16), (100, 50), (60, 5)])
def test_minified_checkers_do_not_alias(turned, texels, long, short):
    """A footprint of a period gives grey wherever it lies, at most 15 % off.

    Elongated ones, too, and those that are longer than the taps reach.
    """
    turn = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
    places = np.random.default_rng(2).uniform(100, 400, (500, 2))
    steps = np.broadcast_to(np.diag([long, short]) @ turn, (500, 2, 2))
    grey = sampled(pyramid(checkers(texels=texels)), places, steps)
    assert np.abs(grey - 0.5).max() < 0.15


def test_elongated_footprints_do_not_blur_across():
    """Stripes that run along a footprint twice as long as wide keep more of their contrast."""
    stripes = np.zeros((256, 256, 1))
    stripes[:, (np.arange(256) // 6) % 2 == 1] = 1
    places = np.random.default_rng(2).uniform(50, 200, (500, 2))
    along = np.broadcast_to([[0.0, 8.0], [4.0, 0.0]], (500, 2, 2))
    around = np.broadcast_to([[0.0, 8.0], [8.0, 0.0]], (500, 2, 2))
    kept, lost = (sampled(pyramid(stripes), places, steps).std() for steps in (along, around))
    assert kept > 0.25
    assert lost < 0.7 * kept


def test_a_board_seen_small_is_grey():
    """The whole way through `look`: a pencil as wide as many checkers."""
    board = Backdrop(
        "texture",
        picture=checkers().astype(np.float32),
        centre_m=np.array([0.0, 0.0, -2.0]),
    )
    directions = unit(np.random.default_rng(5).normal(size=(400, 3)) * 0.05 + [0, 0, -1.0])
    across = np.broadcast_to(np.eye(3)[:2], (400, 2, 3))
    eye = plain_eye()
    wide = Footprint(np.zeros((400, 2, 3)), 0.03 * across)
    grey = look(board, np.zeros((400, 3)), directions, wide, eye).light / 10 / TRIPLE
    assert np.abs(grey - 0.5).max() < 0.15
    sharp = look(board, np.zeros((400, 3)), directions, still(400), eye).light / 10 / TRIPLE
    assert ((sharp < 0.01) | (sharp > 0.99)).mean() > 0.7


# ── stickers ────────────────────────────────────────────────────────────────────────────────────


def test_a_sticker_without_cover_lends_no_colour():
    """Means are of reflectance times cover: a red that covers nothing is not seen beside green."""
    picture = np.zeros((4, 4, 4), np.float32)
    picture[:, :2] = 1, 0, 0, 0
    picture[:, 2:] = 0, 1, 0, 1
    solid = Solid("a", Ball(0.1), sticker=Sticker(picture, 0.8))
    steps = np.broadcast_to(np.eye(2), (1, 2, 2))
    seen = sticker_at(solid, np.array([[0.5, 0.5]]), steps)
    assert_agree(seen[0], [0, 0.5, 0, 0.5], atol=1e-7)


def test_a_ball_is_wrapped_without_a_seam():
    picture = np.random.default_rng(2).random((8, 16, 4)).astype(np.float32)
    picture[..., 3] = 1
    solid = Solid("a", Ball(0.1), sticker=Sticker(picture, 0.8))
    ends = sticker_at(solid, np.array([[0.0, 0.3], [1.0, 0.3]]), np.zeros((2, 2, 2)))
    assert_agree(ends[0], ends[1], atol=1e-12)


# ── what is all around ──────────────────────────────────────────────────────────────────────────

UP = np.array([0.0, 1.0, 0.0])


def test_uniform_light_is_e0_over_pi():
    around = environment_of((300.0, 200.0, 100.0))
    light = environment_light(around, unit(np.random.default_rng(1).normal(size=(50, 3))))
    assert_agree(light, np.broadcast_to(np.array([300, 200, 100]) / np.pi, (50, 3)), rtol=1e-12)


def test_skies_light_surfaces_as_their_lamps_do():
    """Illuminance from the harmonics is the lamp's own formula: bands 0 and 1 are exact."""
    up = unit(np.array([0.3, 1.0, -0.2]))
    sky = SkyLamp("sky", up, np.array([100.0, 50, 20]))
    dome = HemisphereLamp("dome", up, np.array([10.0, 20, 30]), np.array([5.0, 1, 0]))
    normals = unit(np.random.default_rng(1).normal(size=(50, 3)))
    height = (normals @ up)[:, None]
    ground = dome.ground_illuminance_lux * (1 - height) / 2
    both = (sky.illuminance_lux + dome.sky_illuminance_lux) * (1 + height) / 2
    around = environment_of((7.0, 7.0, 7.0), [sky, dome])
    assert_agree(irradiance(around, normals), 7 + both + ground, rtol=1e-9)


def test_lamps_in_one_place_surround_nothing():
    lamp = PointLamp("point", np.zeros(3), np.ones(3))
    assert_agree(environment_of((1, 2, 3), [lamp]), environment_of((1, 2, 3)))


def test_no_light_is_negative():
    around = np.random.default_rng(1).normal(size=(9, 3))
    light = environment_light(around, unit(np.random.default_rng(2).normal(size=(500, 3))))
    assert light.min() == 0
    assert light.max() > 0


# ── the paper's blur ────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("kernel", "total"), [(1.0, 0.32), (8.0, 0.95)])
def test_the_printed_weights_do_not_sum_to_one(kernel, total):
    """Equation 4 with its 1/2πσ²; ours are the same weights, normalised."""
    taps = np.arange(-int(kernel / 2), int(kernel / 2) + 1)
    printed = np.exp(-(taps**2) / kernel)[:, None] * np.exp(-(taps**2) / kernel) / (np.pi * kernel)
    assert printed.sum() == pytest.approx(total, abs=0.005)
    ours = np.concatenate([taps_of(kernel)[:0:-1], taps_of(kernel)])
    assert_agree(np.outer(ours, ours), printed / printed.sum(), rtol=1e-12)


def test_the_papers_blur_of_its_own_scene():
    """Looking at the ball 0.4 m away, with 6 mm of pupil: 3.0 mm on the background at 0.6 m."""
    assert blur_metres(0.006, 0.6, 0.4) == pytest.approx(0.003)
    assert blur_metres(0.006, 0.6, 0.6) == 0
    assert blur_metres(0.006, 0.6, np.inf) == 0.006


@pytest.mark.parametrize("kernel", [1.0, 2.0, 7.3, 30.0])
def test_a_blurred_point_has_half_the_kernel_as_variance(kernel):
    """K_g/2 texels², but for what the window cuts off; and the light is kept."""
    point = np.zeros((101, 101, 1))
    point[50, 50] = 1
    blurred = preblurred(point, 1000.0, kernel / 1000)[..., 0]
    assert blurred.sum() == pytest.approx(1)
    places = np.arange(101) - 50
    variance = (blurred.sum(axis=0) * places**2).sum()
    # The window cuts a Gaussian at √(K_g/2) of its σ: 3.9 of them at 30, 2 at 8.
    assert variance < kernel / 2
    if kernel >= 30:
        assert variance == pytest.approx(kernel / 2, rel=0.01)
    assert np.flatnonzero(blurred.sum(axis=1)).max() - 50 == int(kernel / 2)


def test_kernels_below_a_texel_are_no_blur():
    picture = np.random.default_rng(1).random((5, 6, 3)).astype(np.float32)
    assert (preblurred(picture, 1000.0, 0.00099) == picture).all()
    assert (preblurred(picture, 1000.0, 0.0) == picture).all()
    uniform = np.full((9, 8, 3), 3.0)
    assert_agree(preblurred(uniform, 1.0, 20.0), uniform, rtol=1e-12)
