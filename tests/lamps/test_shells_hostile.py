"""Meshes that are no shells, or not quite."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.lamps import PointLamp, Shell, expand
from andon.lamps.coarse import coarse_corners
from andon.lamps.shells.cutting import cut_long, widest_edge
from andon.lamps.shells.form import form_of
from andon.lamps.shells.layer import clean_layer, rims
from andon.lamps.solids import icosphere
from andon.lamps.triangles import triangle_areas, welded
from andon.quantities import Geometry
from lamps.shell_worlds import areas, box, lamp, moved, sent_lm, tube

BALL = icosphere(1)
T = np.array([0.5, 0.4, 0.3])


def mesh(positions, triangles):
    return Geometry(np.asarray(positions, float), np.asarray(triangles, np.int32))


def joined(*parts):
    offsets = np.cumsum([0, *(len(part.positions) for part in parts)])
    return mesh(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([p.triangles + o for p, o in zip(parts, offsets, strict=False)]),
    )


def moebius(steps=24):
    turn = 2 * np.pi * np.arange(steps) / steps
    axis = np.stack([np.cos(turn), 0 * turn, np.sin(turn)], axis=1)
    lean = np.cos(turn / 2)[:, None] * axis + np.sin(turn / 2)[:, None] * [0, 1, 0]
    points = np.concatenate([axis - 0.3 * lean, axis + 0.3 * lean])
    quads = [(i, i + 1, i + 1 + steps, i + steps) for i in range(steps - 1)]
    quads.append((steps - 1, steps, 0, 2 * steps - 1))  # the ends meet upside down
    return mesh(points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


REFUSED = {
    "no triangles": (mesh(np.zeros((3, 3)), np.zeros((0, 3))), "no triangles"),
    "no area": (mesh(np.zeros((3, 3)), [[0, 1, 2]]), "no triangle with an area"),
    "a line": (mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]), "no triangle with an area"),
    "not finite": (mesh([[0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), "not finite"),
    "lamp outside": (moved(BALL, [3, 0, 0]), "outside its shell"),
    "lamp above its shade": (moved(tube(), [0, -0.2, 0]), "outside its shell"),
    "lamp in the opening": (moved(tube(), [0, -0.15, 0]), "outside its shell"),
    "a sheet": (mesh([[-1, -1, 1], [1, -1, 1], [0, 1, 1]], [[0, 1, 2]]), "outside its shell"),
    "thick": (
        joined(BALL, mesh(0.9 * BALL.positions, BALL.triangles[:, ::-1])),
        "covers itself",
    ),
    "two shells": (joined(BALL, mesh(0.9 * BALL.positions, BALL.triangles)), "covers itself"),
    "one side": (moebius(), "only one side"),
    "a rib": (
        mesh(
            [*BALL.positions, [0, 0, 0]],
            [*BALL.triangles, [*BALL.triangles[0, :2], len(BALL.positions)]],
        ),
        "more than two triangles",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.parametrize("mode", ["exact", "paper"])
def test_refused(name, mode):
    given, message = REFUSED[name]
    with pytest.raises(InputError, match=message) as caught:
        expand(lamp(), Shell(mesh=given, transmittance=T, mode=mode))
    assert caught.value.field == "shell.mesh"
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({}, "shell"),
        ({"radius_m": 1.0, "mesh": BALL}, "shell"),
        ({"radius_m": 0.0}, "shell.radius_m"),
        ({"radius_m": np.nan}, "shell.radius_m"),
        ({"radius_m": 1.0, "transmittance": -T}, "shell.transmittance"),
        ({"radius_m": 1.0, "absorptance": -0.1}, "shell.transmittance"),
        ({"radius_m": 1.0, "transmittance": np.full(3, np.nan)}, "shell.transmittance"),
        ({"radius_m": 1.0, "transmittance": T, "absorptance": 0.6}, "shell.absorptance"),
    ],
)
def test_refused_shells(options, field):
    with pytest.raises(InputError) as caught:
        Shell(**options)
    assert caught.value.field == field


def spoilt(kind):
    """The same tube, as files bring it."""
    good = tube(sides=16)
    if kind == "inside out":
        return mesh(good.positions, good.triangles[:, ::-1])
    if kind == "mixed winding":
        turned = good.triangles.copy()
        turned[::3] = turned[::3, ::-1]
        return mesh(good.positions, turned)
    if kind == "loose triangles":
        noise = np.random.default_rng(1).normal(scale=1e-9, size=(3 * len(good.triangles), 3))
        corners = good.positions[good.triangles].reshape(-1, 3) + noise
        return mesh(corners, np.arange(len(corners)).reshape(-1, 3))
    if kind == "both sides":
        return mesh(good.positions, [*good.triangles, *good.triangles[:, ::-1]])
    if kind == "slivers":
        return mesh(good.positions, [*good.triangles, [0, 0, 1], [2, 2, 2]])
    return mesh([*good.positions, [9e5, 0, 0]], good.triangles)  # a vertex that nobody uses


@pytest.mark.parametrize(
    "kind", ["inside out", "mixed winding", "loose triangles", "both sides", "slivers"]
)
def test_mended(kind):
    shell, good = Shell(mesh=spoilt(kind)), Shell(mesh=tube(sides=16))
    form, expected = form_of(shell), form_of(good)
    assert len(form.lids) == 2
    assert len(form.corners) == len(expected.corners)
    outwards = np.einsum("ij,ij->i", areas(form.facets), form.facets.mean(axis=1))
    assert (outwards > 0).all()
    drawn = form.drawn.positions[form.drawn.triangles]
    assert (np.einsum("ij,ij->i", areas(drawn), drawn.mean(axis=1)) > 0).all()
    ours, theirs = (expand(lamp(), s)[0] for s in (shell, good))
    for one, other in zip(ours, theirs, strict=True):
        assert one.name == other.name
        assert type(one) is type(other)


def test_normals_that_look_in_are_turned():
    turned = Geometry(BALL.positions, BALL.triangles, -BALL.positions)
    drawn = form_of(Shell(mesh=turned)).drawn
    assert (np.einsum("ij,ij->i", drawn.positions, drawn.normals) > 0).all()


def test_a_perforated_shell_has_gaps_not_a_hundred_lamps():
    ball = icosphere(2)
    shell = Shell(
        mesh=mesh(ball.positions, ball.triangles[np.arange(320) % 16 != 0]), transmittance=T
    )
    parts, body = expand(lamp(), shell)
    assert [part.name for part in parts] == ["lantern", "lantern: bulb", "lantern: gaps"]
    np.testing.assert_allclose(sent_lm(parts, body), 400 * np.pi, rtol=0.03)


def test_a_seam_is_no_opening():
    good = tube(sides=16, floor=True)
    shell = form_of(Shell(mesh=good))
    assert len(shell.lids) == 1
    cut = joined(box(), mesh([[0, 0.15, 0], [1e-7, 0.15, 0], [0, 0.15, 1e-7]], [[0, 1, 2]]))
    assert not form_of(Shell(mesh=cut)).is_open


def test_lamp_near_its_shell():
    near = PointLamp("lantern", np.zeros(3), np.full(3, 100.0))
    offset = np.array([1 - 1e-3, 0, 0])
    ball = icosphere(3)
    parts, body = expand(near, Shell(mesh=moved(ball, 0.97 * offset), transmittance=T))
    assert np.isfinite(body.outside_cd_m2).all()
    np.testing.assert_allclose(sent_lm(parts, body), 400 * np.pi * T, rtol=0.02)


def test_welding():
    random = np.random.default_rng(0)
    points = random.uniform(-1, 1, (200, 3))
    points[::4] = np.round(points[::4], 1)  # on the borders of many grids
    twice = np.concatenate([points, points + random.uniform(-1e-8, 1e-8, points.shape)])
    kept, index = welded(twice, 1e-6)
    assert len(kept) == 200
    assert (index[:200] == index[200:]).all()
    np.testing.assert_allclose(kept[index], twice, atol=1e-7)


def test_rims_close_the_layer():
    layer = clean_layer(tube(sides=7).positions, tube(sides=7).triangles)
    loops = rims(layer)
    assert sorted(len(loop) for loop in loops) == [7, 7]
    faces = areas(layer.corners).sum(axis=0)
    lids = [np.cross(lp, np.roll(lp, -1, axis=0)).sum(axis=0) / 2 for lp in loops]
    np.testing.assert_allclose(faces + sum(lids), 0, atol=1e-12)  # closed: no net area


@pytest.mark.parametrize("solid", [icosphere(4), tube(sides=2000), joined(tube(sides=300), BALL)])
def test_few_triangles_stand_for_many(solid):
    fewer = coarse_corners(solid.positions, solid.triangles, 96)
    assert len(fewer) <= 4 * 96
    whole = triangle_areas(solid.positions[solid.triangles]).sum()
    assert triangle_areas(fewer).sum() == pytest.approx(whole, rel=0.2)


def test_dust_has_no_few_triangles():
    random = np.random.default_rng(0)
    flakes = random.uniform(-1, 1, (3000, 1, 3)) + random.normal(scale=1e-3, size=(3000, 3, 3))
    with pytest.raises(InputError, match="cannot stand for"):
        coarse_corners(flakes.reshape(-1, 3), np.arange(9000).reshape(-1, 3), 96)


def test_cutting_keeps_area_winding_and_neighbours():
    slab = box((0.2, 0.9, 0.3))
    corners = slab.positions[slab.triangles]
    cut = cut_long(np.concatenate([corners, 2 * corners], axis=2), radians=0.3, most=10_000)
    np.testing.assert_allclose(cut[..., 3:], 2 * cut[..., :3])
    assert widest_edge(cut[..., :3]) <= 0.3
    np.testing.assert_allclose(
        np.linalg.norm(areas(cut[..., :3]), axis=1).sum(),
        np.linalg.norm(areas(corners), axis=1).sum(),
    )
    assert (
        rims(clean_layer(cut[..., :3].reshape(-1, 3), np.arange(3 * len(cut)).reshape(-1, 3))) == []
    )
    few = cut_long(corners, radians=0.01, most=500)
    assert len(few) <= 500


def test_facets_of_a_tall_shade_are_cut_across():
    form = form_of(Shell(mesh=tube(sides=300)))
    assert len(form.facets) <= 96
    assert widest_edge(form.facets) < 1.5  # the walls as a whole are seen under 1.97
    outwards = np.einsum("ij,ij->i", areas(form.facets), form.facets.mean(axis=1))
    assert (outwards > 0).all()
