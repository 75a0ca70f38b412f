"""Form factors in WGSL against NumPy, function by function.

Errors are relative to the reference, near the horizon to what the lamp gives at cos φ = 0.05.
"""

import numpy as np
import pytest

from andon.lamps.areas import MeshLamp
from andon.lamps.edges import mesh_edges, textured_edges
from andon.lamps.form_factors import (
    disk_factor,
    edges_factor,
    mesh_factor,
    polygon_factor,
    sphere_factor,
    tube_factor,
)
from direct.shader_functions import Caller
from worlds import ball, block, unit

MODULE = "andon/transport/direct/areas.wgsl"
ORIGIN, COUNT = np.zeros(3), 512
ZIGZAG = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]) - 0.8
# radius/distance, from, to; the error that is allowed
RATIOS = [(1e-3, 0.01, 2e-2), (0.01, 0.03, 1e-3), (0.03, 0.3, 1e-3), (0.3, 0.99, 1e-4)]
CONTACT = [(0.99, 0.9999, 1e-3)]

pytestmark = pytest.mark.usefixtures("gpu")


def exact(values):
    """Rounded to float32, so that both sides are given the same."""
    return np.asarray(values, np.float32).astype(float)


def cases(low, high, seed=1):
    """(ratio (n,), direction (n, 3), normal (n, 3)): every other lamp astride the horizon."""
    rng = np.random.default_rng(seed)
    ratio = np.exp(rng.uniform(np.log(low), np.log(high), COUNT))
    direction, normal = unit(rng.normal(size=(2, COUNT, 3)))
    level = unit(normal - (normal * direction).sum(axis=1, keepdims=True) * direction)
    lift = np.minimum(ratio, 1) * rng.uniform(-1.5, 1.5, COUNT)
    normal[::2] = unit(level + lift[:, None] * direction)[::2]
    radius = exact(10 ** rng.uniform(-2, 0, COUNT))
    return rng, radius, direction * (radius / ratio)[:, None], exact(normal)


def agree(got, factor, normal, reach, allowed):
    truth = np.array([factor(k, normal[k]) for k in range(len(got))])
    facing = np.array([factor(k, unit(reach[k])) for k in range(len(got))])
    kept = facing > 0
    error = np.abs(got - truth)[kept] / np.maximum(truth, 0.05 * facing)[kept]
    assert kept.mean() > 0.5
    assert np.isfinite(got).all()
    assert error.max() <= allowed
    assert np.median(error) <= 0.05 * allowed
    assert (truth > 0.02 * facing)[kept].mean() > 0.1


@pytest.mark.parametrize(("low", "high", "allowed"), [*RATIOS, *CONTACT])
def test_sphere(gpu, low, high, allowed):
    _, radius, reach, normal = cases(low, high)
    reach = exact(reach)
    call = Caller(gpu, MODULE, "vec4f(sphere_factor(x[0].xyz, x[1].xyz, x[0].w))", 2, COUNT)
    got = call(np.c_[reach, radius], normal)[:, 0]
    agree(got, lambda k, n: sphere_factor(ORIGIN, n, reach[k], radius[k]), normal, reach, 5e-5)
    assert allowed >= 5e-5


@pytest.mark.parametrize(("low", "high", "allowed"), [*RATIOS, (1, 300, 1e-4)])
def test_disk(gpu, low, high, allowed):
    rng, radius, reach, normal = cases(low, high)
    reach, direction = exact(reach), exact(unit(rng.normal(size=(COUNT, 3))))
    direction[(direction * reach).sum(axis=1) > 0] *= -1
    code = "vec4f(disk_factor(x[0].xyz, x[1].xyz, x[2].xyz, x[0].w))"
    got = Caller(gpu, MODULE, code, 3, COUNT)(np.c_[reach, radius], normal, direction)[:, 0]

    def factor(k, n):
        return disk_factor(ORIGIN, n, reach[k], direction[k], radius[k])

    agree(got, factor, normal, reach, allowed)


@pytest.mark.parametrize("length", [1e-6, 0.3, 10])
@pytest.mark.parametrize(("low", "high", "allowed"), [*RATIOS, *CONTACT])
def test_tube(gpu, low, high, allowed, length):
    """Beside and beyond its ends."""
    rng, radius, near, normal = cases(low, high)
    along = rng.normal(size=(COUNT, 3))
    beside = along - (along * near).sum(axis=1, keepdims=True) / (near**2).sum(1)[:, None] * near
    beyond = along * np.sign((along * near).sum(axis=1, keepdims=True))
    is_beside = rng.uniform(size=COUNT) < 0.7
    along = unit(np.where(is_beside[:, None], beside, beyond)) * (length * radius)[:, None]
    share = (rng.uniform(size=COUNT) * is_beside)[:, None]
    a, b = exact(near - share * along), exact(near + (1 - share) * along)
    code = "vec4f(tube_factor(x[0].xyz, x[1].xyz, x[2].xyz, x[0].w))"
    got = Caller(gpu, MODULE, code, 3, COUNT)(np.c_[a, radius], b, normal)[:, 0]

    def factor(k, n):
        return tube_factor(ORIGIN, n, [a[k], b[k]], radius[k])

    agree(got, factor, normal, near, allowed)


POLYGON = """
  let towards = polygon_towards(x[2].xyz, x[2].w, x[1].xyz, x[0].xyz);
  var sum = 0.0;
  for (var k = 0; k < 6; k++) {
    sum += edge_factor(x[3 + k].xyz, x[3 + (k + 1) % 6].xyz, x[0].xyz, towards);
  }
"""


@pytest.mark.parametrize(("size", "allowed"), [(0.01, 4e-3), (0.03, 2e-3), (0.3, 2e-4), (3, 1e-4)])
def test_polygon(gpu, size, allowed):
    """Not convex, tilted up to grazing; errors of no less than a lamp tilted to 5 % of its area."""
    rng, _, _, normal = cases(size, size * 1.1)
    columns, truth, least = [], [], []
    reaches = unit(cases(size, size * 1.1)[2])
    for reach, up in zip(reaches, normal, strict=True):
        front = unit(rng.normal(size=3))
        right = unit(np.cross(front, [0.3, 0.5, 0.8]))
        across = np.cross(front, right)
        vertices = exact(reach + size * (ZIGZAG[:, :1] * right + ZIGZAG[:, 1:] * across))
        if vertices[0] @ front > 0:
            vertices, front = vertices[::-1], -front
        middle = vertices.mean(axis=0)
        bound = np.linalg.norm(vertices - middle, axis=1).max()
        rows = [[*up, 0], [*front, 0], [*middle, bound], *np.c_[vertices, np.zeros(6)]]
        columns.append(rows)
        truth.append(polygon_factor(ORIGIN, up, vertices))
        seen = polygon_factor(ORIGIN, unit(reach), vertices)
        least.append(0.05 * max(seen, 0.05 * 3 * size**2))
    call = Caller(gpu, MODULE, "vec4f(max(sum, 0.0))", 9, COUNT, statements=POLYGON)
    got = call(*np.moveaxis(np.array(columns), 1, 0))[:, 0]
    error = np.abs(got - truth) / np.maximum(truth, least)
    assert error.max() <= allowed
    assert np.percentile(error, 99) <= allowed / 2
    assert np.mean(np.array(truth) > least) > 0.1


def vector(values):
    return f"vec{len(values)}f({', '.join(f'{v:.9g}' for v in np.float32(values))})"


def mesh_shader(lamp):
    """WGSL that sums the edges of a mesh for a receiver x[0] with normal x[1]."""
    edges, middle = mesh_edges(lamp), lamp.positions_m.mean(axis=0)
    lines = [
        f"let t = mesh_towards({vector(middle)} - x[0].xyz, x[1].xyz);",
        "var sum = vec3f(0.0); var s = vec2f(0.0); var l = vec4f(0.0); var r = vec4f(0.0);",
    ]
    for a, b, left, right, left_light, right_light in zip(
        edges.a, edges.b, edges.left_plane, edges.right_plane,
        edges.left_luminance_cd_m2, edges.right_luminance_cd_m2, strict=True,
    ):  # fmt: skip
        for name, plane in (("l", left), ("r", right)):
            place = f"dot({vector(plane[:3])}, x[0].xyz) + {plane[3]:.9g}"
            lines.append(f"{name} = vec4f({vector(plane[:3])}, {place});")
        lines.append(
            f"s = facet_edge_factor({vector(a)} - x[0].xyz, {vector(b)} - x[0].xyz, "
            f"l, r, x[1].xyz, t);"
        )
        lines.append(f"sum += {vector(left_light)} * s.x - {vector(right_light)} * s.y;")
    return "\n  ".join(lines)


def meshes():
    rng = np.random.default_rng(3)
    ico, box = ball(0.4, (0.1, 0.2, 0.1), 1), block((0.2, 3, 0.3), (0, 0.1, 0))
    corners = exact(rng.uniform(-2, 2, (30, 3)))
    soup = np.arange(30, dtype=np.int32).reshape(10, 3)
    return {
        "icosahedron": (exact(ico.positions), ico.triangles, rng.uniform(0, 5, (20, 3))),
        "tall box": (exact(box.positions), box.triangles, None),
        "triangles all around": (corners, soup, rng.uniform(0, 5, (10, 3))),
    }


@pytest.mark.parametrize("kind", meshes())
def test_mesh(gpu, kind):
    """Around, above and astride the horizon, and with the receiver in the midst of triangles."""
    positions, triangles, light = meshes()[kind]
    lamp = MeshLamp(
        "m", np.ones(3), positions_m=positions, triangles=triangles, facet_luminance_cd_m2=light
    )
    rng = np.random.default_rng(4)
    place = exact(rng.uniform(-1.5, 1.5, (4 * COUNT, 3)))
    normal = exact(unit(rng.normal(size=place.shape)))
    weights = np.ones((len(triangles), 3)) if light is None else light
    truth = mesh_factor(place, normal, positions, triangles, weights)
    call = Caller(gpu, MODULE, "vec4f(sum, 0.0)", 2, len(place), statements=mesh_shader(lamp))
    got = call(place, normal)[:, :3]
    # Within 1 mm of a facet's plane float32 may see the other side of it.
    corners = positions[triangles]
    outward = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    height = place @ outward.T - (outward * corners[:, 0]).sum(axis=1)
    kept = np.abs(height).min(axis=1) > 1e-3
    assert kept.mean() > 0.9
    error = np.abs(got - truth)[kept] / weights.max()
    assert error.max() <= 2e-5
    assert truth[kept].max() > 0.5


def test_luminous_picture(gpu):
    picture = np.random.default_rng(5).uniform(0, 2, (4, 4, 3))
    square = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    a, b, weight = textured_edges(square, picture, 4)
    lines = ["let t = polygon_towards(-x[0].xyz, 0.7072, vec3f(0.0, 0.0, 1.0), x[1].xyz);",
             "var sum = vec3f(0.0);"]  # fmt: skip
    lines += [
        f"sum += {vector(w)} * edge_factor({vector(p)} - x[0].xyz, "
        f"{vector(q)} - x[0].xyz, x[1].xyz, t);"
        for p, q, w in zip(a, b, weight, strict=True)
    ]
    rng = np.random.default_rng(6)
    place = exact(np.c_[rng.uniform(-1, 1, (COUNT, 2)), rng.uniform(0.05, 2, COUNT)])
    normal = exact(unit(rng.normal(size=(COUNT, 3))))
    statements = "\n  ".join(lines)
    got = Caller(gpu, MODULE, "vec4f(sum, 0.0)", 2, COUNT, statements=statements)(place, normal)
    truth = edges_factor(place, normal, square, a, b, weight)
    assert np.abs(got[:, :3] - truth).max() <= 2e-5
    assert truth.max() > 1
