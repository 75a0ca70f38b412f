"""Projected solid angles: against quadratures, known values, and each other."""

import numpy as np
import pytest

from andon.lamps.form_factors import (
    disk_factor,
    mesh_factor,
    polygon_factor,
    sphere_factor,
    tube_factor,
)
from andon.verify.solids import icosphere
from lamps.quadratures import by_area, by_hull, by_nusselt, by_rings
from worlds import unit

ORIGIN, UP = np.zeros(3), np.array([0.0, 0.0, 1.0])
ZIGZAG = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]) - 0.8
SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])


def astride(rng, reach, size):
    """A normal whose horizon passes within 1.5 `size` of `reach`."""
    towards = unit(reach)
    level = rng.normal(size=3)
    level = unit(level - (level @ towards) * towards)
    return unit(level + towards * rng.uniform(-1.5, 1.5) * size / np.linalg.norm(reach))


def axes(direction):
    right = unit(np.cross(direction, [0.3, 0.5, 0.8]))
    return right, np.cross(direction, right)


def flat(shape, centre, direction, size=1.0):
    """A plane shape counter-clockwise as seen from where `direction` points."""
    right, down = axes(direction)
    return centre + size * (shape[:, :1] * right + shape[:, 1:] * down)


def facing(rng, reach):
    direction = unit(rng.normal(size=3))
    return -direction if direction @ reach > 0 else direction


def circle(k):
    t = np.arange(k) * 2 * np.pi / k
    return np.c_[np.cos(t), np.sin(t)] * np.sqrt(t[1] / np.sin(t[1]))  # of the disk's area


def scale(factor, reach):
    """What counts as relative error's base near the horizon: the lamp at cos φ = 0.05."""
    return 0.05 * factor(unit(reach))


RATIOS = [1e-4, 0.01, 0.3, 0.9, 0.999]


# ── against quadratures ─────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("ratio", RATIOS)
def test_sphere_is_its_rings(ratio):
    rng = np.random.default_rng(1)
    for k in range(40):
        radius = rng.uniform(0.01, 2)
        reach = unit(rng.normal(size=3)) * radius / ratio
        normal = astride(rng, reach, radius) if k % 2 else unit(rng.normal(size=3))
        truth = by_rings(reach, normal, radius)
        least = scale(lambda n, c=reach, r=radius: sphere_factor(ORIGIN, n, c, r), reach)
        got = sphere_factor(ORIGIN, normal, reach, radius)
        assert abs(got - truth) <= 1e-6 * max(truth, least)


@pytest.mark.parametrize("size", [1e-4, 0.03, 0.5, 5.0])
@pytest.mark.parametrize("shape", [SQUARE, ZIGZAG], ids=["square", "zigzag"])
def test_polygon_is_its_area(shape, size):
    """Also one that is not convex, and cut by the horizon more than once."""
    pieces = [[0, 1, 2, 3]] if len(shape) == 4 else [[0, 1, 2, 3], [0, 3, 4, 5]]
    rng = np.random.default_rng(2)
    for k in range(16):
        reach = unit(rng.normal(size=3))
        direction = facing(rng, reach)
        if direction @ -reach < 0.15:
            direction = unit(direction - 0.5 * reach)
        vertices = flat(shape, reach, direction, size)
        if unit(direction) @ -reach < 0.1 * size or direction @ -vertices[0] < 0:
            vertices = flat(shape, reach, -unit(reach), size)
        normal = astride(rng, reach, size) if k % 2 else unit(rng.normal(size=3))
        parts = [vertices[p] for p in pieces]
        triangles = [t for p in parts for t in (p[[0, 1, 2]], p[[0, 2, 3]])]
        truth = by_area(triangles, normal, 80)
        least = scale(lambda n, v=vertices: polygon_factor(ORIGIN, n, v), reach)
        got = polygon_factor(ORIGIN, normal, vertices)
        assert abs(got - truth) <= 1e-6 * max(truth, least)


@pytest.mark.parametrize("size", [1e-4, 0.03, 0.5, 5.0])
def test_disk_is_a_fine_polygon(size):
    rng = np.random.default_rng(3)
    shape = circle(600)
    for k in range(10):
        reach = unit(rng.normal(size=3))
        direction = facing(rng, reach)
        vertices = flat(shape, reach, direction, size)
        normal = astride(rng, reach, size) if k % 2 else unit(rng.normal(size=3))
        truth = polygon_factor(ORIGIN, normal, vertices)
        least = scale(lambda n, v=vertices: polygon_factor(ORIGIN, n, v), reach)
        got = disk_factor(ORIGIN, normal, reach, direction, size)
        assert abs(got - truth) <= 1e-6 * max(truth, least)


@pytest.mark.parametrize("seed", range(16))
def test_tube_is_the_hull_of_its_ends(seed):
    """The outline from the convex hull of two circles, in a plane before the eye."""
    rng = np.random.default_rng(seed)
    radius, gap = rng.uniform(0.02, 0.5), 10 ** rng.uniform(-1, 1)
    ends = capsule(rng, radius, gap * radius)
    middle = ends.mean(axis=0)
    normal = astride(rng, middle, radius) if seed % 3 else unit(rng.normal(size=3))
    truth = by_hull(ends, radius, normal)
    least = 0.05 * by_hull(ends, radius, unit(middle), 100)
    assert abs(tube_factor(ORIGIN, normal, ends, radius) - truth) <= 1e-6 * max(truth, least)


def capsule(rng, radius, gap):
    """Ends of a tube whose surface is `gap` from the origin, anywhere about it."""
    near = unit(rng.normal(size=3)) * (radius + gap)
    along = rng.normal(size=3)
    if rng.uniform() < 0.7:  # beside the tube, else beyond its end
        along -= (along @ unit(near)) * unit(near)
        share = rng.uniform()
    else:
        along *= np.sign(along @ near)
        share = 0.0
    length = 10 ** rng.uniform(-1, 1) * (radius + gap)
    return near + np.array([[-share], [1 - share]]) * length * unit(along)


@pytest.mark.parametrize("seed", range(6))
def test_tube_covers_directions(seed):
    """By the area of its shadow: shares no geometry with the outline, 10⁻³."""
    rng = np.random.default_rng(seed)
    a, b = ends = capsule(rng, 0.4, 0.1)
    normal = unit(rng.normal(size=3))

    def inside(w):
        edge = b - a
        across = edge @ edge - (w @ edge) ** 2
        at = np.clip(((w @ edge) * (w @ a) - a @ edge) / np.maximum(across, 1e-14), 0, 1)
        nearest = np.inf
        for s in (at, 0 * at, 0 * at + 1):
            along = np.maximum(w @ a + s * (w @ edge), 0)
            point = a + s[:, None] * edge - along[:, None] * w
            nearest = np.minimum(nearest, (point**2).sum(axis=1))
        return nearest < 0.4**2

    assert tube_factor(ORIGIN, normal, ends, 0.4) == pytest.approx(
        by_nusselt(inside, normal), abs=3e-3
    )


# ── known values ────────────────────────────────────────────────────────────────────────────────


def test_spheres_of_the_specification():
    """60 cd in a ball of 0.1 m, 0.3 m away: 124.6 lx at 80°, 61 at 88°, 24 at 95°."""
    luminance = 60 / (np.pi * 0.1**2)
    for degrees, lux in ((80, 124.6), (88, 61), (95, 24)):
        angle = np.radians(degrees)
        normal = np.array([np.sin(angle), 0, np.cos(angle)])
        got = luminance * sphere_factor(ORIGIN, normal, 0.3 * UP, 0.1)
        assert got == pytest.approx(lux, abs=0.5)


def test_facing_disk_and_rectangle():
    """π R²/(R² + h²); a quarter rectangle above its corner (Lambert)."""
    got = disk_factor(ORIGIN, UP, 2 * UP, -UP, 0.7)
    assert got == pytest.approx(np.pi * 0.49 / 4.49, rel=1e-14)
    a, b = 0.8, 1.7
    corner = np.array([[0, 0, 1], [0, b, 1], [a, b, 1], [a, 0, 1.0]])
    quarter = 0.5 * (
        a / np.hypot(1, a) * np.arctan(b / np.hypot(1, a))
        + b / np.hypot(1, b) * np.arctan(a / np.hypot(1, b))
    )
    assert polygon_factor(ORIGIN, UP, corner) == pytest.approx(quarter, rel=1e-14)


def test_an_endless_tube():
    """Of a long tube of radius r at ρ, seen square on: π r/ρ."""
    ends = np.array([[-1e5, 0, 2.0], [1e5, 0, 2.0]])
    assert tube_factor(ORIGIN, UP, ends, 0.5) == pytest.approx(np.pi / 4, rel=1e-6)


def test_far_lamps_are_points():
    direction = unit(np.array([1.0, 2, 2]))
    reach, normal = 1e3 * direction, unit(np.array([0.3, 0.1, 1]))
    inverse = 1e-6 * (normal @ direction)
    tilted = unit(np.array([-1.0, 0.5, -1]))
    faced = -(tilted @ direction)
    assert sphere_factor(ORIGIN, normal, reach, 0.1) == pytest.approx(0.01 * np.pi * inverse)
    got = disk_factor(ORIGIN, normal, reach, tilted, 0.1)
    assert got == pytest.approx(0.01 * np.pi * faced * inverse, rel=1e-6)
    square = flat(SQUARE, reach, tilted, 0.05)
    assert polygon_factor(ORIGIN, normal, square) == pytest.approx(0.01 * faced * inverse, rel=1e-6)


def test_huge_lamps_fill_the_sky():
    normal = unit(np.array([1.0, 0, 2]))
    sky = np.pi * (1 + normal[2]) / 2
    assert disk_factor(ORIGIN, normal, UP, -UP, 1e7) == pytest.approx(sky, rel=1e-6)
    square = flat(SQUARE, UP, -UP, 1e7)
    assert polygon_factor(ORIGIN, normal, square) == pytest.approx(sky, rel=1e-6)
    assert sphere_factor(ORIGIN, normal, (1 + 1e7) * UP, 1e7) == pytest.approx(sky, rel=1e-3)


# ── identities ──────────────────────────────────────────────────────────────────────────────────


def receivers(n=200, seed=5):
    rng = np.random.default_rng(seed)
    return rng.uniform(-3, 3, (n, 3)), unit(rng.normal(size=(n, 3)))


def test_rotation_changes_nothing():
    place, normal = receivers()
    turn = np.linalg.qr(np.random.default_rng(6).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    c, d = np.array([0.2, 0.3, -0.4]), unit(np.array([1.0, 2, 3]))
    ends, polygon = np.array([c, d]), flat(ZIGZAG, c, d, 0.5)
    for one, other in (
        (sphere_factor(place, normal, c, 0.3), ("sphere", turn @ c, 0.3)),
        (disk_factor(place, normal, c, d, 0.3), ("disk", turn @ c, turn @ d, 0.3)),
        (tube_factor(place, normal, ends, 0.3), ("tube", ends @ turn.T, 0.3)),
        (polygon_factor(place, normal, polygon), ("polygon", polygon @ turn.T)),
    ):
        kind = {
            "sphere": sphere_factor,
            "disk": disk_factor,
            "tube": tube_factor,
            "polygon": polygon_factor,
        }
        turned = kind[other[0]](place @ turn.T, normal @ turn.T, *other[1:])
        np.testing.assert_allclose(turned, one, rtol=1e-9, atol=1e-11)


def test_a_split_polygon_adds_up():
    place, normal = receivers()
    whole = flat(ZIGZAG, np.array([0.1, 0.2, 0.3]), unit(np.array([1.0, -1, 2])))
    parts = polygon_factor(place, normal, whole[:4])
    parts = parts + polygon_factor(place, normal, whole[[0, 3, 4, 5]])
    np.testing.assert_allclose(polygon_factor(place, normal, whole), parts, atol=1e-13)


def test_reciprocity():
    """A small disk sees a polygon as a small polygon sees the disk's place: cos φ cos θ/d²."""
    a, b = np.array([0.1, 0.2, 0.3]), np.array([1.3, -0.4, 1.1])
    na, nb = unit(np.array([0.5, 0, 1])), unit(np.array([0.1, 0.3, -1]))
    there = disk_factor(a, na, b, nb, 1e-3) / (np.pi * 1e-6)
    back = polygon_factor(b, nb, flat(SQUARE, a, na, 1e-3)) / 4e-6
    assert there == pytest.approx(back, rel=1e-5)


def test_both_ways_up_make_a_whole():
    """F(n) − F(−n) = n·(vector irradiance): linear in n, for lamps astride too."""
    place, _ = receivers(50)
    c, d = np.array([0.2, 0.3, -0.4]), unit(np.array([1.0, 2, 3]))
    ends = np.array([c, c + d])
    outside = np.linalg.norm(place - c, axis=1) > 1.5
    for factor in (
        lambda n: disk_factor(place, n, c, d, 0.3),
        lambda n: tube_factor(place[outside], n, ends, 0.3),
        lambda n: polygon_factor(place, n, flat(ZIGZAG, c, d, 0.5)),
    ):
        x, y, z = (factor(e) - factor(-e) for e in np.eye(3))
        n = unit(np.array([1.0, -2, 0.5]))
        linear = n[0] * x + n[1] * y + n[2] * z
        np.testing.assert_allclose(factor(n) - factor(-n), linear, atol=1e-11)


def test_a_tube_without_length_is_a_sphere():
    place, normal = receivers()
    c = np.array([0.2, 0.3, -0.4])
    truth = sphere_factor(place, normal, c, 0.3)
    np.testing.assert_allclose(tube_factor(place, normal, [c, c], 0.3), truth, atol=1e-12)
    near = [c, c + 1e-9 * unit(np.array([1.0, 2, 3]))]
    np.testing.assert_allclose(tube_factor(place, normal, near, 0.3), truth, atol=1e-7)


def test_a_fine_icosphere_is_a_sphere():
    place, normal = receivers(40)
    place = unit(place) * np.linspace(0.6, 3, 40)[:, None]
    solid = icosphere(0.5, 24)
    got = mesh_factor(place, normal, solid.positions, solid.triangles)
    truth = sphere_factor(place, normal, ORIGIN, 0.5)
    # an inscribed mesh: 1 − (edge/2R)²
    np.testing.assert_allclose(got, truth, rtol=2e-2, atol=2e-3)
    assert (got <= truth + 1e-9).all()


def test_a_box_is_its_faces_with_weights():
    place, normal = receivers(100)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    light = np.repeat(np.random.default_rng(7).uniform(0, 5, (6, 3)), 2, axis=0)
    faces = [polygon_factor(place, normal, corners[list(q)]) for q in quads]
    truth = sum(f[:, None] * w for f, w in zip(faces, light[::2], strict=True))
    got = mesh_factor(place, normal, corners, triangles, light)
    np.testing.assert_allclose(got, truth, atol=1e-12)
    single = mesh_factor(place, normal, corners, triangles, light[:, 0])
    np.testing.assert_allclose(single, truth[:, 0], atol=1e-12)


@pytest.mark.parametrize("coloured", [False, True])
def test_a_mesh_is_its_triangles_wherever_one_stands(coloured):
    """Below, above, inside and far beside it, where whole edges cancel and where none may."""
    rng = np.random.default_rng(8)
    solid = icosphere(0.5, 3)
    middle = solid.positions[solid.triangles].mean(axis=1)
    open_above = solid.triangles[middle[:, 1] < 0.2]
    light = rng.uniform(0, 5, (len(open_above), 3)) if coloured else np.ones((len(open_above), 3))
    reach = 10.0 ** rng.uniform(-1, 2, (400, 1))
    place, normal = reach * unit(rng.normal(size=(400, 3))), unit(rng.normal(size=(400, 3)))
    normal[:100] = UP
    faces = [polygon_factor(place, normal, solid.positions[one]) for one in open_above]
    truth = np.stack(faces, axis=1) @ light
    got = mesh_factor(place, normal, solid.positions, open_above, light)
    np.testing.assert_allclose(got, truth, rtol=1e-6, atol=1e-12)
    assert (truth[:, 0] > 0).mean() > 0.3


# ── edges and hostile places ────────────────────────────────────────────────────────────────────


def test_batches_keep_their_shape():
    place, normal = (v.reshape(2, 5, 3) for v in receivers(10))
    c = np.array([0.2, 0.3, -0.4])
    for got in (
        sphere_factor(place, normal, c, 0.3),
        disk_factor(place, normal[0, 0], c, UP, 0.3),
        tube_factor(place, normal[0, 0], [c, UP], 0.3),
        polygon_factor(place, normal[0, 0], flat(SQUARE, c, UP)),
        mesh_factor(place, normal[0, 0], flat(SQUARE, c, UP), np.array([[0, 1, 2]])),
    ):
        assert got.shape == (2, 5)


def test_contact_is_finite_and_documented():
    normal = unit(np.array([1.0, 0, 2]))
    on = np.pi * (1 + normal[2]) / 2
    for inside in (np.array([0, 0, -1.0]), np.array([0, 0, -0.2])):
        assert sphere_factor(inside, normal, ORIGIN, 1.0) == pytest.approx(on)
        assert tube_factor(inside, normal, [[-1, 0, 0], [1, 0, 0]], 1.0) == pytest.approx(on)
    just = np.array([0, 0, -1 - 1e-10])
    assert sphere_factor(just, normal, ORIGIN, 1.0) == pytest.approx(on, abs=1e-4)
    assert tube_factor(just, normal, [[-1, 0, 0], [1, 0, 0]], 1.0) == pytest.approx(on, abs=1e-4)
    assert sphere_factor(ORIGIN, normal, ORIGIN, 1.0) == pytest.approx(np.pi / 2)
    assert np.isfinite(tube_factor(ORIGIN, normal, [[-1, 0, 0], [1, 0, 0]], 1.0))
    close = np.array([0.1, 0.2, -1e-10])
    assert disk_factor(close, normal, ORIGIN, -UP, 1.0) == pytest.approx(on, abs=1e-6)
    assert polygon_factor(close, normal, flat(SQUARE, ORIGIN, -UP)) == pytest.approx(on, abs=1e-6)


@pytest.mark.parametrize("normal", [*np.eye(3), *-np.eye(3)])
def test_special_places_are_never_nan(normal):
    """On the axis, in the plane, at the centre, the rim, a corner, and in the horizon."""
    line = np.array([-2.0, -1, -0.3, 0, 0.3, 1, 2])
    place = np.stack(np.meshgrid(line, line, line), axis=-1)
    square = flat(SQUARE, ORIGIN, UP)
    with np.errstate(all="raise", under="ignore"):
        everything = [
            sphere_factor(place, normal, ORIGIN, 1.0),
            disk_factor(place, normal, ORIGIN, UP, 1.0),
            tube_factor(place, normal, [[-0.3, 0, 0], [0.3, 0, 0]], 0.7),
            tube_factor(place, normal, [[0, 0, 0], [0, 0, 0]], 0.3),
            polygon_factor(place, normal, square),
            mesh_factor(place, normal, square, np.array([[0, 1, 2], [0, 2, 3]])),
        ]
    for got in everything:
        assert np.isfinite(got).all()
        assert (got >= 0).all()
        assert (got <= np.pi + 1e-12).all()


def test_nothing_from_behind_and_from_below():
    square = flat(SQUARE, UP, -UP)
    behind = 2 * UP
    assert disk_factor(behind, -UP, UP, -UP, 0.5) == 0
    assert polygon_factor(behind, -UP, square) == 0
    assert polygon_factor(ORIGIN, UP, square[::-1]) == 0
    for below in (
        disk_factor(ORIGIN, -UP, UP, -UP, 5.0),
        polygon_factor(ORIGIN, -UP, square),
        sphere_factor(ORIGIN, -UP, UP, 0.9),
        tube_factor(ORIGIN, -UP, [UP, np.array([3.0, 0, 1])], 0.9),
    ):
        assert below == pytest.approx(0, abs=1e-15)


def test_the_disk_is_smooth_across_its_axis_and_the_horizon():
    """No jump where a case of the closed form begins: second differences stay small."""
    line = np.c_[np.linspace(-3, 3, 6001), np.full(6001, 0.2), np.full(6001, -0.5)]
    normal = unit(np.array([1.0, 0.2, 0.3]))
    for got in (
        disk_factor(line, normal, ORIGIN, -UP, 0.5),
        sphere_factor(line, normal, ORIGIN, 0.5),
        tube_factor(line, normal, [[-0.2, 0.1, 0], [0.5, 0.3, 0.1]], 0.3),
        polygon_factor(line, normal, flat(SQUARE, ORIGIN, -UP, 0.5)),
    ):
        assert np.abs(np.diff(got)).max() < 5e-3 * got.max()
        assert got.max() > 0.5
