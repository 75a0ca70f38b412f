"""Cubes and panoramas: directions, solid angles, sums, and input that is no light."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.harmonics import (
    basis,
    clipped,
    cube_directions,
    cube_from_latlong,
    cube_solid_angles,
    latlong_pixels,
    latlong_solid_angles,
    nonnegative,
    project_cube,
    project_latlong,
)
from andon.spaces import View

from .quadrature import units

X, Y, Z = np.eye(3)


def latlong_directions(height):
    """(H, 2H, 3) world directions, by the view's own convention."""
    return View("latlong", 2 * height, height).rays_world()[1]


# ── directions and solid angles ─────────────────────────────────────────────────────────────────


def test_faces_look_along_their_axes():
    middle = cube_directions(1)[:, 0, 0]
    np.testing.assert_array_equal(middle, [X, -X, Y, -Y, Z, -Z])


def test_layout_of_a_face():
    """+X: a step to the right goes to −Z, a step down to −Y (OpenGL's table)."""
    face = cube_directions(4)[0]
    assert face[0, 3, 2] < face[0, 0, 2]
    assert face[3, 0, 1] < face[0, 0, 1]


def test_every_direction_once():
    directions = cube_directions(8).reshape(-1, 3)
    assert len(np.unique(directions.round(9), axis=0)) == 6 * 64
    np.testing.assert_allclose(directions.sum(axis=0), 0, atol=1e-12)


@pytest.mark.parametrize("size", [1, 2, 8, 128])
def test_exact_solid_angles_fill_the_sphere(size):
    assert 6 * cube_solid_angles(size).sum() == pytest.approx(4 * np.pi, abs=4e-15 * 4 * np.pi)


@pytest.mark.parametrize(("size", "worst"), [(8, 1.0e-2), (128, 4.6e-5)])
def test_the_papers_solid_angles(size, worst):
    paper = cube_solid_angles(size, "paper")
    error = paper * 4 * np.pi / (6 * paper.sum()) / cube_solid_angles(size) - 1
    assert np.abs(error).max() == pytest.approx(worst, rel=0.02)


def test_latlong_solid_angles_are_the_views():
    areas = View("latlong", 64, 32).solid_angles()
    np.testing.assert_allclose(latlong_solid_angles(32), areas[:, 0], rtol=1e-12)
    assert 64 * latlong_solid_angles(32).sum() == pytest.approx(4 * np.pi, rel=1e-15)


def test_latlong_pixels_are_the_views():
    grid = View("latlong", 32, 16).pixel_grid()
    np.testing.assert_allclose(latlong_pixels(latlong_directions(16) * 3, 16), grid, atol=1e-12)


# ── sums ────────────────────────────────────────────────────────────────────────────────────────


def test_cube_of_a_basis_function():
    """Each Y_lm gives its own unit vector, to the grid's error, which falls as h²."""
    errors = []
    for size in (16, 32, 64):
        light = basis(cube_directions(size), 4)
        given = project_cube(np.stack([light] * 3, axis=-1)[..., 0, :], 4, signed=True)
        assert given.shape == (25, 3)
        worst = 0.0
        for number in range(25):
            face = np.repeat(light[..., number, None], 3, axis=-1)
            worst = max(
                worst,
                np.abs(project_cube(face, 4, signed=True) - np.eye(25)[:, [number]]).max(),
            )
        errors.append(worst)
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 4e-4
    np.testing.assert_allclose(order, 2, atol=0.05)


def test_constant_light_is_exact():
    faces = np.full((2, 6, 8, 8, 3), [1.0, 2.0, 3.0])
    given = project_cube(faces, 2)
    np.testing.assert_allclose(given[:, 0], [np.array([1, 2, 3]) * np.sqrt(4 * np.pi)] * 2)
    np.testing.assert_allclose(given[:, 1:4], 0, atol=1e-14)
    panorama = project_latlong(np.full((8, 16, 3), [1.0, 2.0, 3.0]), 2)
    np.testing.assert_allclose(panorama[0], given[0, 0], rtol=1e-14)
    np.testing.assert_allclose(panorama[1:4], 0, atol=1e-14)


@pytest.mark.parametrize("kind", ["exact", "paper"])
def test_many_cubes_are_as_one(kind):
    """Bitwise in shape, to rounding in value; and the plain sum is the definition."""
    faces = np.random.default_rng(2).random((3, 2, 6, 4, 4, 3), np.float32)
    together = project_cube(faces, 3, kind)
    assert together.shape == (3, 2, 16, 3)
    area = np.broadcast_to(cube_solid_angles(4, kind), (6, 4, 4))
    area = area * 4 * np.pi / area.sum()
    plain = np.einsum("nmfrcx,frck,frc->nmkx", faces, basis(cube_directions(4), 3), area)
    np.testing.assert_allclose(together, plain, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("order", range(5))
def test_latlong_is_the_integral_over_its_pixels(order):
    """Against a plain sum over 32 × 32 points in each pixel, with their own solid angles."""
    picture = np.random.default_rng(3).random((12, 24, 3))
    fine = picture.repeat(32, axis=0).repeat(32, axis=1)
    height = len(fine)
    values = basis(latlong_directions(height), order)
    plain = np.einsum("hwx,hwk,h->kx", fine, values, latlong_solid_angles(height))
    np.testing.assert_allclose(project_latlong(picture, order), plain, atol=1e-3)
    one_pixel = np.zeros((12, 24, 3))
    one_pixel[2, 5] = 1
    area = latlong_solid_angles(12)[2]
    np.testing.assert_allclose(
        project_latlong(one_pixel, 0)[0], area / np.sqrt(4 * np.pi), rtol=1e-14
    )


@pytest.mark.parametrize("height", [4, 16])
def test_a_constant_panorama_has_a_mean_and_nothing_else(height):
    given = project_latlong(np.ones((height, 2 * height, 3)), 4)
    np.testing.assert_allclose(given[0], np.sqrt(4 * np.pi), rtol=1e-14)
    np.testing.assert_allclose(given[1:], 0, atol=1e-13)


def test_a_large_picture_is_read_in_parts():
    picture = np.random.default_rng(4).random((1024, 2048, 3), np.float32)
    whole = project_latlong(picture, 2)
    halves = [picture.copy(), picture.copy()]
    halves[0][:700], halves[1][700:] = 0, 0
    np.testing.assert_allclose(whole, sum(project_latlong(h) for h in halves), atol=1e-12)


# ── resampling ──────────────────────────────────────────────────────────────────────────────────


def test_panorama_and_its_cube_agree():
    """A smooth light: both grids, one answer; a turned axis would show."""
    axis = units(1, 5)[0]
    light = np.exp(2 * latlong_directions(128) @ axis)
    picture = light[..., None] * [1.0, 0.5, 2.0]
    cube = cube_from_latlong(picture, 64)
    np.testing.assert_allclose(cube[..., 0], np.exp(2 * cube_directions(64) @ axis), rtol=2e-3)
    np.testing.assert_allclose(project_cube(cube), project_latlong(picture), atol=2e-3)


def test_a_small_sun_is_not_lost():
    """One bright pixel keeps its light in a cube of far larger texels, below 30°."""
    for row, column in [(50, 7), (70, 0), (64, 255), (85, 130)]:
        picture = np.zeros((128, 256, 3), np.float32)
        picture[row, column] = 1e5
        cube = cube_from_latlong(picture, 8)
        whole = project_latlong(picture, 0)
        np.testing.assert_allclose(project_cube(cube, 0), whole, rtol=0.1)


# ── input that is no light ──────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_non_finite_light(value):
    faces = np.ones((2, 6, 4, 4, 3))
    faces[1, 3, 2, 1, 0] = value
    with pytest.raises(InputError, match="cube map: must be finite, 1 values"):
        project_cube(faces)
    picture = np.ones((4, 8, 3))
    picture[2, 3, 1] = value
    with pytest.raises(InputError, match="panorama: must be finite, 1 values"):
        project_latlong(picture)


def test_negative_light():
    picture = np.ones((4, 8, 3), np.float32)
    picture[1, 2] = -2
    with pytest.raises(InputError, match=r"3 values are negative, down to -2; .*nonnegative"):
        project_latlong(picture)
    cleaned = nonnegative(picture)
    assert cleaned.count == 3
    assert cleaned.lost_share == pytest.approx(6 / 93)
    assert cleaned.values.dtype == np.float32
    assert project_latlong(cleaned.values).shape == (9, 3)
    np.testing.assert_array_equal(picture[1, 2], -2)


def test_light_without_faults_is_passed_on():
    picture = np.ones((4, 8, 3))
    assert nonnegative(picture).values is picture


@pytest.mark.parametrize("shape", [(4, 9, 3), (4, 4, 3), (0, 0, 3), (4, 8), (4, 8, 4)])
def test_no_panorama(shape):
    with pytest.raises(InputError, match="panorama: must be"):
        project_latlong(np.ones(shape))


@pytest.mark.parametrize("shape", [(5, 4, 4, 3), (6, 4, 5, 3), (6, 4, 4, 4), (6, 4, 3)])
def test_no_cube(shape):
    with pytest.raises(InputError, match="cube map: "):
        project_cube(np.ones(shape))


def test_sizes_and_kinds():
    with pytest.raises(InputError, match="cube size: must be 1…1024 px, got 0"):
        cube_directions(0)
    with pytest.raises(InputError, match="must be 'exact' or 'paper', got 'other'"):
        cube_solid_angles(4, "other")
    with pytest.raises(InputError, match="samples: must be ≥ 1, got 0"):
        cube_from_latlong(np.ones((4, 8, 3)), 4, samples=0)


def test_clipped_texels():
    picture = np.full((8, 16, 3), 0.5)
    picture[0], picture[4, 3, 1] = 1.0, 1.0
    found = clipped(picture, 1.0)
    assert found.count == 17
    areas = latlong_solid_angles(8)
    assert found.share == pytest.approx((16 * areas[0] + areas[4]) / (4 * np.pi))
    assert clipped(picture, 1.5).count == 0
