"""The shaders of the glass against the reference, function by function and path by path."""

from dataclasses import replace

import numpy as np
import pytest

from andon.glass import paths, pencils, refraction, shapes
from andon.glass.bvh import hierarchy
from andon.glass.model import Ball, Closed, LensShape, Slab, Solid, Sticker
from andon.quantities import Geometry
from andon.spaces import look_at
from comparison import assert_agree
from glass.shaders import call, of_solids
from worlds import ball, block

pytestmark = pytest.mark.usefixtures("gpu")

REFRACTION, PENCILS = "andon/glass/refraction.wgsl", "andon/glass/pencils.wgsl"
TILTED = look_at(np.array([0.01, -0.02, 0.015]), np.array([0.3, 0.5, 1.0]))
LENS = LensShape(0.04, (0.09, -0.12), 0.012)
SHAPES = {
    "ball": Ball(0.075),
    "slab": Slab(np.array([0.06, 0.04, 0.01])),
    "lens": LENS,
    "hollow lens": LensShape(0.04, (-0.1, -0.08), 0.004),
}


def ring(radius, thickness, around=48, across=24):
    """A torus around y, with its own normals."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / across
    out = np.stack([np.cos(a), 0 * a, np.sin(a)], axis=-1)
    normals = np.cos(b)[..., None] * out + np.sin(b)[..., None] * [0, 1.0, 0]
    corners = [
        (((u + i) % around) * across + (v + j) % across).ravel()
        for i, j in ((0, 0), (0, 1), (1, 1), (1, 0))
    ]
    triangles = np.concatenate(
        [np.stack([corners[k] for k in (0, i, i + 1)], axis=1) for i in (1, 2)]
    )
    places = (radius * out + thickness * normals).reshape(-1, 3)
    uvs = np.stack([u / around, v / across], axis=-1).reshape(-1, 2)
    return Geometry(places, triangles.astype(np.int32), normals.reshape(-1, 3), uvs)


def smooth_ball(radius, frequency=12):
    solid = ball(radius, (0, 0, 0), frequency)
    return replace(
        solid, normals=solid.positions / np.linalg.norm(solid.positions, axis=1)[:, None]
    )


MESHES = {
    "smooth ball": Closed(smooth_ball(0.075)),
    "facets": Closed(ball(0.075, (0, 0, 0), 4)),
    "block": Closed(block(np.array([0.12, 0.08, 0.02]), (0, 0, 0))),
    "ring": Closed(ring(0.05, 0.02)),
}


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def rays(count, seed=0, *, size=0.09, distance=0.4):
    """From around an eye to a square around the origin."""
    generator = np.random.default_rng(seed)
    origins = np.array([0.05, 0.03, distance]) + generator.uniform(-0.02, 0.02, (count, 3))
    aims = generator.uniform(-size, size, (count, 3)) * [1, 1, 0]
    return origins, unit(aims - origins)


# ── one boundary ────────────────────────────────────────────────────────────────────────────────

ANGLES = np.radians(np.linspace(0, 89, 712))


@pytest.mark.parametrize("ratio", [1 / 1.51, 1.51, 1.33 / 1.51, 2.4])
def test_snell(gpu, ratio):
    """0–89°: within 1e-4 rad, and total reflection is flagged where it is."""
    directions = np.stack([np.sin(ANGLES), -np.cos(ANGLES), 0 * ANGLES], axis=1)
    normals = np.broadcast_to([0.0, 1.0, 0.0], directions.shape)
    ratios = np.full((len(ANGLES), 1), ratio)
    bend = "refracted(x[0].xyz, x[1].xyz, x[2].x)"
    ours = call(
        gpu, REFRACTION, f"vec4f({bend}.direction, f32({bend}.total))", directions, normals, ratios
    )
    truth, total = refraction.refracted(directions, normals, ratio, 1.0)
    sines = ratio * np.sin(ANGLES)
    clear = np.abs(sines - 1) > 1e-6
    np.testing.assert_array_equal(ours[clear, 3] > 0.5, total[clear])
    assert total.any() == (sines > 1).any()
    angle = np.arctan2(
        np.linalg.norm(np.cross(ours[:, :3], truth), axis=1), (ours[:, :3] * truth).sum(axis=1)
    )
    assert angle[clear].max() < 1e-4
    # Snell's law itself, not by way of the reference
    through = clear & ~total
    np.testing.assert_allclose(ours[through, 0], sines[through], atol=1e-6)


@pytest.mark.parametrize("ratio", [1 / 1.51, 1.51])
def test_fresnel(gpu, ratio):
    cosines = np.cos(ANGLES)
    beyond = np.sqrt(np.maximum(1 - (ratio * np.sin(ANGLES)) ** 2, 0))
    rows = np.stack([cosines, beyond], axis=1)
    ours = call(gpu, REFRACTION, f"vec4f(fresnel(x[0].x, x[0].y, {ratio}))", rows)[:, 0]
    np.testing.assert_allclose(ours, refraction.fresnel(cosines, ratio, 1.0), atol=2e-6)
    assert ours.max() <= 1


def random_pencil(count, seed=1):
    return np.random.default_rng(seed).normal(size=(count, 4, 2, 3)) * [[[0.1], [1.0]]]


def pencil_columns(pencil):
    return [pencil[:, k, part] for part in (0, 1) for k in range(4)]


PENCIL = """
  let places = mat4x3f(x[0].xyz, x[1].xyz, x[2].xyz, x[3].xyz);
  let p = Pencil(places, mat4x3f(x[4].xyz, x[5].xyz, x[6].xyz, x[7].xyz));
  let D = x[8].xyz; let N = x[9].xyz; let c1 = -dot(D, N);
  let C = mat3x3f(x[10].xyz, x[11].xyz, x[12].xyz);
  let bend_out = sqrt(1.0 - (1.0 - c1 * c1) / (1.51 * 1.51));
"""


@pytest.mark.parametrize("what", ["transferred", "refracted_pencil", "mirrored_pencil"])
def test_pencils(gpu, what):
    generator = np.random.default_rng(2)
    count = 256
    directions = unit(generator.normal(size=(count, 3)))
    normals = unit(-directions + 0.8 * unit(generator.normal(size=(count, 3))))
    turning = generator.normal(size=(count, 3, 3)) * 5
    turning += np.swapaxes(turning, 1, 2)
    pencil = random_pencil(count)
    expression, truth = {
        "transferred": (
            "transferred(p, 0.3, D, N)",
            pencils.transferred(pencil, np.full(count, 0.3), directions, normals),
        ),
        "refracted_pencil": (
            "refracted_pencil(p, D, N, C, 1.0 / 1.51, c1, bend_out)",
            pencils.refracted_pencil(
                pencil, directions, normals, turning, np.full(count, 1 / 1.51)
            ),
        ),
        "mirrored_pencil": (
            "mirrored_pencil(p, D, N, C)",
            pencils.mirrored_pencil(pencil, directions, normals, turning),
        ),
    }[what]
    rows = [*pencil_columns(pencil), directions, normals, *np.moveaxis(turning, 2, 0)]
    for part, name in enumerate(("place", "course")):
        for column in range(4):
            ours = call(
                gpu, PENCILS, f"vec4f({expression}.{name}[{column}], 0.0)", *rows, statements=PENCIL
            )
            assert_agree(
                ours[:, :3], truth[:, column, part], rtol=1e-3, atol=1e-4, share=0, what=name
            )


def test_vergence(gpu):
    """To 1e-3 of its own size, but where the image is so close to the eye that float32 is lost."""
    count = 512
    generator = np.random.default_rng(3)
    directions = unit(generator.normal(size=(count, 3)))
    pencil = random_pencil(count, 4)
    rows = [*pencil_columns(pencil), directions, directions, *np.zeros((3, count, 3))]
    expression = "vergence(spread_at(p, D, 0.7))"
    ours = call(gpu, PENCILS, expression, *rows, statements=PENCIL)
    truth = pencils.vergence(pencil, np.full(count, 0.7), directions)
    size = np.linalg.norm(truth, axis=(1, 2))
    # Rows and columns are those of the pencil: frames of both sides cancel.
    error = np.linalg.norm(ours.reshape(-1, 2, 2) - truth, axis=(1, 2)) / size
    assert error[size < 50 * np.median(size)].max() < 1e-3
    blurs = call(
        gpu, PENCILS, f"vec4f(blur_radians({expression}, 2.5, 0.004))", *rows, statements=PENCIL
    )
    want = pencils.blur_radians(truth, 2.5, 0.004)
    near = size < 50 * np.median(size)
    np.testing.assert_allclose(blurs[near, 0], want[near], rtol=1e-3)


# ── shapes ──────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("inside", [False, True], ids=["outside", "inside"])
@pytest.mark.parametrize("name", [*SHAPES, *MESHES])
def test_hits(gpu, name, inside):
    shape = (SHAPES | MESHES)[name]
    if inside:
        generator = np.random.default_rng(5)
        origins = generator.uniform(-0.05, 0.05, (20000, 3))
        origins = origins[shapes.contains(shape, origins, margin_m=1e-4)][:2000]
        directions = unit(generator.normal(size=origins.shape))
    else:
        origins, directions = rays(2000)
    hit = shapes.hit(shape, origins, directions, np.full(len(origins), inside))
    met = f"boundary(Ray(x[0].xyz, x[1].xyz), {int(inside)}u)"
    solid = Solid(name, shape)
    reached, normals = of_solids(
        gpu,
        [solid],
        [f"vec4f({met}.distance, f32({met}.solid), 0.0, 0.0)", f"vec4f({met}.normal, 0.0)"],
        origins,
        directions,
    )
    found = np.isfinite(hit.t)
    assert found.mean() > 0.1
    # Rounding decides for rays that pass within a hair of an edge.
    agree = (reached[:, 1] >= 0) == found
    assert agree.mean() > 0.998
    both = found & agree
    points = origins[both] + hit.t[both, None] * directions[both]
    parts = (hit.part[both], hit.weights[both])
    truth = shapes.boundary(shape, points, *parts)
    near = np.abs(reached[both, 0] - hit.t[both]) < 1e-5
    turned = np.linalg.norm(normals[both, :3] - truth.normal, axis=1)
    assert (near & (turned < 2e-3)).mean() > 0.998
    assert np.median(turned) < 1e-6


# ── paths ───────────────────────────────────────────────────────────────────────────────────────

TRACE = """
  let ray = Ray(x[0].xyz, x[1].xyz);
  let first = boundary(ray, 0u);
  var path: Path;
  path.solid = -1;
  let start = start_pencil(x[2].xyz, x[3].xyz);
  if first.solid >= 0 { path = trace(ray, start, first, CHANNEL); }
  let away = mirror(ray, start, path);
  let V = vergence(spread_at(path.pencil, path.exit.direction, 0.2));
  let W = vergence(spread_at(away.pencil, away.ray.direction, 0.2));
"""
OUTPUTS = {
    "exit_point": "vec4f(path.exit.origin, path.distance)",
    "exit_direction": "vec4f(path.exit.direction, path.transmitted)",
    "first": "vec4f(f32(path.solid), f32(path.status), path.reflectance, 0.0)",
    "inside": "vec4f(path.inside, 0.0)",
    "mirrored": "vec4f(away.ray.direction, 0.0)",
    "vergence": "V",
    "mirrored vergence": "W",
}


def placed(shape, pose=TILTED, **options):
    return Solid("body", shape, world_from_glass=pose, absorption_per_m=(3.0, 1.0, 0.5), **options)


def shrunk(radius, **options):
    return replace(placed(Ball(radius)), name="inner", **options)


SCENES = {
    "ball": [placed(Ball(0.075))],
    "ball, one interface": [placed(Ball(0.075), interfaces=1)],
    "slab": [placed(SHAPES["slab"])],
    "lens": [placed(LENS)],
    "hollow lens": [placed(SHAPES["hollow lens"])],
    "bubble": [placed(Ball(0.075)), shrunk(0.05, index=(1.0,) * 3, absorption_per_m=(0.0,) * 3)],
    "heavy core": [placed(Ball(0.075)), shrunk(0.05, index=(1.8,) * 3)],
    "behind each other": [
        placed(LENS),
        placed(
            Slab(np.array([0.05, 0.05, 0.01])),
            look_at(np.array([0, 0, -0.1]), np.array([0, 0.1, 1.0])),
        ),
    ],
    **{name: [placed(shape)] for name, shape in MESHES.items()},
    "ball in a ring": [placed(Ball(0.02)), placed(MESHES["ring"])],
    "dispersing": [placed(SHAPES["slab"], index=(1.5, 1.52, 1.55))],
}
# Of all rays: those that pass so close to an edge that rounding sends them another way.
EDGES = 0.01


@pytest.mark.parametrize("channel", [0, 2])
@pytest.mark.parametrize("name", SCENES)
def test_paths(gpu, name, channel):
    solids = SCENES[name]
    origins, directions = rays(3000, seed=6, size=0.06)
    e1, e2 = pencils.frames_of(directions)
    truth = paths.trace(solids, origins, directions, channel=channel, frame=(e1, e2))
    statements = TRACE.replace("CHANNEL", str(channel))
    columns = (origins, directions, e1, e2)
    ours = dict(
        zip(
            OUTPUTS,
            of_solids(gpu, solids, OUTPUTS.values(), *columns, statements=statements),
            strict=True,
        )
    )
    solid, status = ours["first"][:, 0], ours["first"][:, 1]
    through = truth.status == paths.THROUGH
    assert (
        (solid == truth.solid) & ((status == 1) == through) | (truth.solid < 0)
    ).mean() > 1 - EDGES
    kept = (truth.solid >= 0) & (solid == truth.solid) & through & (status == 1)
    assert kept.mean() > 0.2
    extinction = sum(
        truth.path_m[:, k, None] * np.asarray(body.absorption_per_m)
        for k, body in enumerate(solids)
    )
    far = np.full(len(origins), 0.2)
    pairs = {
        "exit_point": (ours["exit_point"][:, :3], truth.exit_point),
        "distance": (ours["exit_point"][:, 3], truth.distance_m),
        "exit_direction": (ours["exit_direction"][:, :3], truth.exit_direction),
        "transmitted": (ours["exit_direction"][:, 3], truth.transmitted),
        "reflectance": (ours["first"][:, 2], truth.reflectance),
        "inside": (ours["inside"][:, :3], np.exp(-extinction)),
        "mirrored": (ours["mirrored"][:, :3], truth.mirrored),
    }
    for what, (got, want) in pairs.items():
        assert_agree(got[kept], want[kept], rtol=1e-4, atol=1e-4, share=EDGES, what=what)
    for what, pencil, onward in (
        ("vergence", truth.pencil, truth.exit_direction),
        ("mirrored vergence", truth.mirrored_pencil, truth.mirrored),
    ):
        want = pencils.vergence(pencil, far, onward)[kept]
        size = np.linalg.norm(want, axis=(1, 2))
        error = np.linalg.norm(ours[what][kept].reshape(-1, 2, 2) - want, axis=(1, 2)) / size
        assert np.quantile(error, 1 - EDGES) < 1e-3, what


# ── meshes ──────────────────────────────────────────────────────────────────────────────────────


def test_boxes_hold_their_triangles():
    """Each order visits every triangle once, within the boxes of all nodes above it."""
    tree = hierarchy(MESHES["ring"].geometry)
    corners = tree.triangles[:, :3, :3]
    for nodes in tree.nodes:
        skip, leaf = nodes[:, 0, 3].astype(int), nodes[:, 1, 3].astype(int)
        seen = np.concatenate(
            [np.arange(code // 8, code // 8 + code % 8) for code in leaf[leaf >= 0]]
        )
        np.testing.assert_array_equal(np.sort(seen), np.arange(len(corners)))
        for node in range(0, len(nodes), 7):
            below = leaf[node : skip[node]]
            held = np.concatenate([np.arange(c // 8, c // 8 + c % 8) for c in below[below >= 0]])
            assert (corners[held] >= nodes[node, 0, :3]).all()
            assert (corners[held] <= nodes[node, 1, :3]).all()


# ── stickers ────────────────────────────────────────────────────────────────────────────────────

STUCK = Sticker(np.ones((4, 4, 4), np.float32), 0.2)
STICK = """
  let ray = Ray(x[0].xyz, x[1].xyz);
  let met = boundary(ray, 0u);
  let point = ray.origin + met.distance * ray.direction;
  let along = x[2].xyz - met.facet * dot(x[2].xyz, met.facet);
  let moves = mat2x3f(along, -2.0 * along);
  let here = sticking(met, point, moves);
  let there = sticking(met, point + 2e-4 * along, moves);
"""


@pytest.mark.parametrize("name", ["ball", "slab", "lens", "ring"])
def test_stickers(gpu, name):
    """Coordinates are those of the reference, and they grow as `steps` says."""
    solid = placed((SHAPES | MESHES)[name], sticker=STUCK)
    origins, directions = rays(2000, seed=8, size=0.05)
    truth = paths.trace([solid], origins, directions)
    generator = np.random.default_rng(9)
    moves = unit(generator.normal(size=origins.shape))
    place, steps, moved = of_solids(
        gpu,
        [solid],
        [
            "vec4f(here.uv, f32(met.solid), 0.0)",
            "vec4f(here.steps[0], here.steps[1])",
            "vec4f((there.uv - here.uv) / 2e-4, 0.0, 0.0)",
        ],
        origins,
        directions,
        moves,
        statements=STICK,
    )
    stuck = (truth.solid >= 0) & np.isfinite(truth.uv).all(axis=1)
    assert stuck.mean() > 0.1
    bare = (truth.solid >= 0) & ~stuck & (place[:, 2] >= 0)
    # A few are beside the edge of what can be stuck on.
    assert np.count_nonzero(place[bare, 0] >= 0) <= 0.002 * len(place)
    apart = np.abs(place[stuck, :2] - truth.uv[stuck] % 1.0)
    # 0 and 1 are one place on pictures that go around.
    assert_agree(np.minimum(apart, 1 - apart), 0 * apart, atol=1e-4, share=0.01, what="uv")
    np.testing.assert_allclose(steps[stuck, 2:], -2 * steps[stuck, :2], atol=1e-5)
    # Beside seams and poles, and not off the end of a cap.
    plain = stuck & (np.abs(moved[:, :2]).max(axis=1) < 30) & (place[:, :2].min(axis=1) > 0.02)
    error = np.abs(moved[plain, :2] - steps[plain, :2])
    assert np.quantile(error, 0.95) < 0.02 * np.abs(steps[plain, :2]).max()
