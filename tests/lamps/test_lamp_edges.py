"""Lamps as lists of edges: nothing is lost where edges are shared or left out."""

from dataclasses import dataclass

import numpy as np
import pytest

from andon.errors import InputError
from andon.lamps import resolve_lamps
from andon.lamps.areas import MeshLamp, PolygonLamp
from andon.lamps.edges import mesh_edges, polygon_edges, textured_edges
from andon.lamps.form_factors import edge_factor, edges_factor, mesh_factor, polygon_factor
from andon.lamps.shells.pairs import evened, flat_pairs
from andon.lamps.triangles import triangle_areas
from andon.scene import scene_from_dict
from worlds import ball, block, unit, write_obj

GREY = np.ones(3)
SQUARE = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])


def summed(edges, place, normal):
    """Σ of both facets of every edge, each azimuth towards its own facet's plane."""
    total = np.zeros((*place.shape[:-1], 3))
    sides = (
        (1, edges.left_plane, edges.left_luminance_cd_m2),
        (-1, edges.right_plane, edges.right_luminance_cd_m2),
    )
    for sign, planes, light in sides:
        for a, b, plane, luminance in zip(edges.a, edges.b, planes, light, strict=True):
            front = place @ plane[:3] + plane[3] > 0
            share = edge_factor(a - place, b - place, normal, -plane[:3])
            total += sign * np.where(front, share, 0)[..., None] * luminance
    return total


def receivers(n=60, seed=1):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1.5, 1.5, (n, 3)), unit(rng.normal(size=(n, 3)))


def soup(seed=2, n=12):
    """Triangles anywhere around the receivers, of different luminance."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-2, 2, (3 * n, 3))
    return corners, np.arange(3 * n, dtype=np.int32).reshape(n, 3), rng.uniform(0, 5, (n, 3))


def meshes():
    ico, box = ball(0.4, (0.1, 0.2, 0.1), 2), block((0.5, 1, 0.7), (0, 0.1, 0))
    rng = np.random.default_rng(3)
    return {
        "ball": (ico.positions, ico.triangles, None),
        "box": (box.positions, box.triangles, None),
        "coloured": (ico.positions, ico.triangles, rng.uniform(0, 5, (len(ico.triangles), 3))),
        "soup": soup(),
        "split vertices": (box.positions[box.triangles].reshape(-1, 3),
                           np.arange(36, dtype=np.int32).reshape(12, 3), None),
        "three facets": (np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 1, 0], [-1, -1, 0.0]]),
                         np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]], np.int32), None),
        "a sliver": (np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0.0]]),
                     np.array([[0, 1, 2], [0, 2, 3]], np.int32), None),
    }  # fmt: skip


@pytest.mark.parametrize("kind", meshes())
def test_edges_give_the_facets_sum(kind):
    positions, triangles, light = meshes()[kind]
    lamp = MeshLamp(
        "m", GREY, positions_m=positions, triangles=triangles, facet_luminance_cd_m2=light
    )
    place, normal = receivers()
    weights = np.ones((len(triangles), 3)) if light is None else light
    truth = mesh_factor(place, normal, positions, triangles, weights)
    got = summed(mesh_edges(lamp), place, normal)
    np.testing.assert_allclose(got, truth, atol=1e-9)
    assert truth.max() > 0.1


@pytest.mark.parametrize(("kind", "count"), [("box", 12), ("split vertices", 12), ("ball", 120)])
def test_shared_edges_come_once_and_flat_ones_never(kind, count):
    positions, triangles, light = meshes()[kind]
    edges = mesh_edges(MeshLamp("m", GREY, positions_m=positions, triangles=triangles))
    assert len(edges.a) == count
    assert edges.left_plane.shape == (count, 4)
    np.testing.assert_allclose(np.linalg.norm(edges.right_plane[:, :3], axis=1), 1)
    assert light is None


@dataclass(frozen=True)
class Grouped(MeshLamp):
    """Says which facets always shine alike."""

    facet_groups: np.ndarray | None = None


def test_edges_are_those_of_the_form_whatever_the_light():
    """A box whose panes shine alike keeps 12 edges, one whose facets are free 18, dark or not."""
    box = block((0.5, 1, 0.7), (0, 0, 0))
    normal = np.cross(*np.moveaxis(np.diff(box.positions[box.triangles], axis=1), 1, 0))
    panes = np.unique(np.round(unit(normal)), axis=0, return_inverse=True)[1].ravel()
    free = np.random.default_rng(4).uniform(0, 5, (12, 3))
    for light in (free, free * [1, 0, 0], 0 * free, 0 * free + 1):
        for groups, count, own in ((panes, 12, light[panes]), (None, 18, light)):
            lamp = Grouped(
                "m", GREY, positions_m=box.positions, triangles=box.triangles,
                facet_luminance_cd_m2=own, facet_groups=groups,
            )  # fmt: skip
            edges = mesh_edges(lamp)
            assert len(edges.a) == count
            place, up = receivers(20)
            truth = mesh_factor(place, up, box.positions, box.triangles, own)
            np.testing.assert_allclose(summed(edges, place, up), truth, atol=1e-9)


@pytest.mark.parametrize("kind", ["point", "spot"])
def test_a_shell_keeps_its_edges_while_its_light_comes_and_turns(tmp_path, kind):
    write_obj(tmp_path / "box.obj", block((0.2, 0.3, 0.2), (0, 0, 0)))
    first = {"time_seconds": 0, "intensity_cd": 0, "position": [0, 1, 0]}
    last = {"time_seconds": 2, "intensity_cd": 80, "position": [2, 1, 0.7]}
    table = {"kind": kind, "position": [0, 1, 0], "intensity_cd": 1, "rgb": [1, 0.5, 0]}
    if kind == "spot":
        table["direction"], first["direction"], last["direction"] = (
            [0, -1, 0],
            [0, -1, 0],
            [1, 0, 0],
        )
    table |= {"shell": {"mesh": "box.obj", "transmittance": 0.5}, "key": [first, last]}
    scene = scene_from_dict({"lamp": [table]}, folder=tmp_path)
    found = [[x for x in resolve_lamps(scene, t) if isinstance(x, MeshLamp)] for t in (0, 0.7, 2)]
    (dark,), *lit = found
    assert not dark.facet_luminance_cd_m2.any()
    count = len(mesh_edges(dark).a)
    assert [len(mesh_edges(lamp).a) for (lamp,) in lit] == [count, count]


def test_pairs_shine_alike_and_keep_their_flux():
    box = block((0.2, 0.3, 0.2), (0, 0, 0))
    corners = box.positions[box.triangles]
    groups = flat_pairs(corners)
    assert len(np.unique(groups)) == 6
    area, light = triangle_areas(corners), np.random.default_rng(5).uniform(0, 5, (12, 3))
    even = evened(light, area, groups)
    np.testing.assert_allclose(area @ even, area @ light)
    assert len(np.unique(even, axis=0)) == 6
    np.testing.assert_array_equal(evened(light, area, np.arange(12, dtype=np.int32)), light)


def test_corners_that_differ_by_rounding_are_one_wherever_they_are():
    """No grid splits what lies on both sides of its lines: 12 edges and 6 pairs at any place."""
    box, rng = block((1, 1, 1), (0, 0, 0)), np.random.default_rng(6)
    corners = box.positions[box.triangles]
    for offset in [np.zeros(3), *rng.uniform(-20, 20, (10, 3))]:
        moved = corners + offset + rng.uniform(-1e-7, 1e-7, corners.shape)
        lamp = MeshLamp(
            "m", GREY, moved.reshape(-1, 3), np.arange(36, dtype=np.int32).reshape(12, 3)
        )
        assert len(mesh_edges(lamp).a) == 12
        assert len(np.unique(flat_pairs(moved))) == 6


@pytest.mark.parametrize("two_sided", [False, True])
def test_polygons(two_sided):
    vertices = SQUARE + np.array([0.1, 0.2, 0.3])
    lamp = PolygonLamp("p", 2 * GREY, vertices_m=vertices, two_sided=two_sided)
    place, normal = receivers()
    truth = polygon_factor(place, normal, vertices)
    truth = truth + two_sided * polygon_factor(place, normal, vertices[::-1])
    got = summed(polygon_edges(lamp), place, normal)
    np.testing.assert_allclose(got, 2 * truth[:, None] * GREY, atol=1e-12)


# ── luminous pictures ───────────────────────────────────────────────────────────────────────────


def bilinear(picture, n):
    """(n, n, 3): the picture between the centres of its texels, held beyond the last."""
    places = [np.clip((np.arange(n) + 0.5) / n * k - 0.5, 0, k - 1) for k in picture.shape[:2]]
    for axis, at in enumerate(places):
        low = np.minimum(at.astype(int), picture.shape[axis] - 2)
        share = (at - low).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        lower, upper = np.take(picture, low, axis), np.take(picture, low + 1, axis)
        picture = lower * (1 - share) + upper * share
    return picture


def quadrature(picture, place, normal, n=192):
    """∫ picture·cos φ cos θ/d² dA over SQUARE, which faces +z, by midpoints."""
    values, q = bilinear(picture, n), (np.arange(n) + 0.5) / n - 0.5
    points = np.stack(np.broadcast_arrays(q[None], -q[:, None], 0.0), axis=-1)
    result = []
    for p, up in zip(place, normal, strict=True):
        reach = points - p
        form = np.maximum(reach @ up, 0) * p[2] / (reach**2).sum(axis=-1) ** 2
        result.append((form[..., None] * values).sum(axis=(0, 1)) / n**2)
    return np.array(result)


def before(distance, n=24, seed=4):
    rng = np.random.default_rng(seed)
    normal = unit(rng.normal(size=(n, 3)))
    normal[:, 2] = -np.abs(normal[:, 2])
    return np.c_[rng.uniform(-0.5, 0.5, (n, 2)), np.full(n, distance)], normal


@pytest.mark.parametrize(
    ("cells", "distance", "median"),
    [(16, 0.5, 5e-4), (16, 2, 1e-4), (8, 0.25, 0.02), (8, 0.5, 8e-3), (8, 2, 1.5e-3)],
)
def test_cells_against_the_bilinear_picture(cells, distance, median):
    rng = np.random.default_rng(3)
    picture = rng.uniform(0, 2, (16, 16, 3))
    picture /= picture.mean(axis=(0, 1))
    place, normal = before(distance)
    got = edges_factor(place, normal, SQUARE, *textured_edges(SQUARE, picture, cells))
    truth = quadrature(picture, place, normal)
    assert np.median(np.abs(got - truth) / truth) <= median


def test_row_0_is_on_top_and_column_0_by_vertex_0():
    picture = np.zeros((2, 2, 3))
    picture[0, 0] = 4  # beside vertex 3
    place = np.array([[x, y, 0.1] for x in (-0.25, 0.25) for y in (-0.25, 0.25)])
    down = np.array([0.0, 0, -1])
    got = edges_factor(place, down, SQUARE, *textured_edges(SQUARE, picture))[:, 0]
    assert got.argmax() == 1
    assert got[1] > 5 * np.delete(got, 1).max()


def test_cells_of_any_size_keep_flux_and_uniform_ones_leave_the_outline():
    place, normal = before(0.3)
    whole = polygon_factor(place, normal, SQUARE)[:, None] * GREY
    a, b, weight = textured_edges(SQUARE, np.ones((5, 7, 3)), 3)
    assert len(a) == 12
    np.testing.assert_allclose(edges_factor(place, normal, SQUARE, a, b, weight), whole, atol=1e-13)
    picture = np.random.default_rng(5).uniform(0, 2, (5, 7, 3))
    far = np.array([[0, 0, 1e3]])
    a, b, weight = textured_edges(SQUARE, picture, 3)
    got = edges_factor(far, np.array([0.0, 0, -1]), SQUARE, a, b, weight)
    np.testing.assert_allclose(got[0] * 1e6, picture.mean(axis=(0, 1)), rtol=1e-5)


def test_what_is_no_luminous_rectangle():
    with pytest.raises(InputError, match="4 vertices, not 3"):
        textured_edges(SQUARE[:3], np.ones((2, 2, 3)))
    with pytest.raises(InputError, match=r"\(h, w, 3\), not \(2, 2\)"):
        textured_edges(SQUARE, np.ones((2, 2)))
