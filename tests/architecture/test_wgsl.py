"""Shaders: they compile, their imports resolve, and they see memory as the host wrote it."""

import re

import numpy as np
import pytest

from andon.engines.gpu import RECEIVERS
from andon.glass.backdrops.records import KINDS, backdrop_variants
from andon.glass.model import Backdrop, Ball, Closed, LensShape, Slab, Solid, Sticker
from andon.glass.plan import variants_of
from andon.gpu import wgsl
from andon.gpu.layout import HostStruct
from andon.gpu.passes import shader_module
from andon.lamps import DirectionalLamp, PointLamp, SkyLamp, SpotLamp
from andon.lamps.areas import AreaLamp, DiskLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.quantities import Geometry
from andon.spaces import View
from andon.surface.stage import PLAIN, TEXTURED
from andon.transport.baked.records import moments_text, settings_text
from andon.transport.baked.stage import FRAME_VARIANTS as BAKED_VARIANTS
from andon.transport.baked.stage import MOMENTS, SETTINGS
from andon.transport.direct.balls.buffers import BALLS, NO_BALLS, PAIRS, pairs_code
from andon.transport.direct.balls.model import GlassBall
from andon.transport.direct.shadows.face_maps import DISTANCE, TRIANGLE
from andon.transport.direct.stage import FILTER, SOFT_FILTER, SUM
from andon.transport.direct.sum import sum_of_lamps
from andon.transport.probes.stage import VARIANTS as PROBE_VARIANTS

from .tree import modules

ENTRY_POINT = re.compile(r"@(?:vertex|fragment|compute)\b")
IMPORT = re.compile(r"^//!import (\S+)\s*$", re.MULTILINE)

MODULES = wgsl.all_modules()
TEXTS = {path: wgsl._read(path) for path in MODULES}
PROGRAMS = [path for path in MODULES if ENTRY_POINT.search(TEXTS[path])]

DOWN, GREY = np.array([0.0, -1.0, 0.0]), np.ones(3)
LIGHT = np.ones(3)
SQUARE = np.array([[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1.0]])
ONE_OF_EACH = [
    PointLamp("point", DOWN, GREY),
    SpotLamp("spot", DOWN, GREY, outer_radians=0.5),
    SpotLamp("wide", DOWN, GREY, outer_radians=1.5),
    DirectionalLamp("sun", DOWN, GREY),
    SkyLamp("sky", -DOWN, GREY),
    SphereLamp("sphere", LIGHT, DOWN, 0.1, body="shell"),
    DiskLamp("disk", LIGHT, DOWN, DOWN, 0.1),
    DiskLamp("both sides", LIGHT, DOWN, DOWN, 0.1, True, shadow=None),
    TubeLamp("tube", LIGHT, SQUARE[:2], 0.1),
    PolygonLamp("polygon", LIGHT, SQUARE),
]


def summed(lamps):
    soft = [lamp.name for lamp in lamps if isinstance(lamp, AreaLamp)]
    return sum_of_lamps(
        lamps,
        ["shell"],
        layers={"point": 0},
        samples={name: 16 * i for i, name in enumerate(soft)},
        edges={"polygon": (0, 4)},
        tables={},
        map_size=1024,
        soft_map_size=256,
        triangles=5,
    )


TRIANGLE_MESH = Closed(Geometry(SQUARE, np.array([[0, 1, 2]], np.int32), uvs=SQUARE[:, :2]))
STUCK = Sticker(np.zeros((1, 1, 4), np.float32), 0.5)
SOLIDS = {
    "a ball": Ball(1.0),
    "a slab": Slab(np.ones(3)),
    "a lens": LensShape(1.0, (2.0, 2.0), 1.0),
    "a mesh": TRIANGLE_MESH,
}


def placed(*shapes, **options):
    return variants_of([Solid("glass", shape, sticker=STUCK, **options) for shape in shapes])


def baked(maps, moments, mode, *projections):
    views = [View(name, 8, 4, 4.0, 4.0) for name in projections]
    return {SETTINGS: settings_text(views, 3, mode), MOMENTS: moments_text(maps, moments)}


def looked_at(*kinds, projection="pinhole"):
    solids = [Solid("glass", Ball(1.0), backdrop=Backdrop(kind)) for kind in kinds]
    return variants_of(solids) | backdrop_variants(solids, projection)


PROJECTION = "andon/gbuffer/projections/{}.wgsl"
QUADS = "andon/glare/quads/{}.wgsl"
STRIP = "andon/glare/needles/strip_{}.wgsl"
OUTLINES = "andon/glare/per_source/{}.wgsl"


def projected(name):
    straight, curved = STRIP.format("straight"), STRIP.format("curved")
    return {
        PROJECTION.format("pinhole"): PROJECTION.format(name),
        QUADS.format("pinhole"): QUADS.format(name),
        straight: curved,
    }


VARIANTS = {
    "as written": {},
    "fisheye": projected("fisheye"),
    "latlong": projected("latlong"),
    "linear filter": {FILTER.format("none"): FILTER.format("linear")},
    "exact filter": {FILTER.format("none"): FILTER.format("exact"), DISTANCE: TRIANGLE},
    "textures": {PLAIN: TEXTURED},
    "hard samples": {SOFT_FILTER.format("linear"): SOFT_FILTER.format("none")},
    "one lamp of each kind": {SUM: summed(ONE_OF_EACH)},
    "no lamps": {SUM: summed([])},
    "glass balls": {
        SUM: summed(ONE_OF_EACH),
        NO_BALLS: BALLS,
        PAIRS: pairs_code(ONE_OF_EACH, [GlassBall(np.zeros(3), 0.1)] * 2, {}),
    },
    "objects without lamps": {RECEIVERS.format(""): RECEIVERS.format("_lamps")},
    "objects in probes": {RECEIVERS.format(""): RECEIVERS.format("_probes")},
    "probes behind walls": PROBE_VARIANTS["walls"],
    "a ball's one interface": placed(SOLIDS["a ball"], interfaces=1),
    "glass of all shapes, dispersing": placed(*SOLIDS.values(), index=(1.5, 1.51, 1.52)),
    **{name: placed(shape) for name, shape in SOLIDS.items()},
    **{f"glass before the {kind}": looked_at(kind) for kind in KINDS},
    **{
        f"glass before all kinds, {name}": looked_at(*KINDS, projection=name)
        for name in ("fisheye", "latlong")
    },
    "probes of objects": PROBE_VARIANTS["object"],
    "baked light": BAKED_VARIANTS["all"],
    "baked light beside probes": BAKED_VARIANTS["beside probes"],
    "baked maps, one": baked(1, 1, "blend", "pinhole"),
    "baked maps, the first valid": baked(3, 1, "first_valid", "latlong", "fisheye"),
    "baked maps, many of two moments": baked(12, 2, "blend", "latlong", "pinhole"),
    "glare of any outline": {OUTLINES.format("circle"): OUTLINES.format("outline")},
}


def host_structs():
    found = {}
    for module in modules():
        for value in vars(module).values():
            if isinstance(value, HostStruct):
                assert found.setdefault(value.name, value) == value, f"two structs {value.name}"
    return found


STRUCTS = host_structs()


def test_there_is_something_to_test():
    assert {"andon/frame.wgsl", "andon/display/display.wgsl"} <= set(PROGRAMS)
    assert {"ViewRecord", "LampRecord"} <= set(STRUCTS)


# ── imports ─────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("path", MODULES)
def test_imports_resolve(path):
    text = wgsl.resolve(path, STRUCTS)
    assert "//!" not in text, "every import and struct is replaced"
    # each once
    assert all(text.count(f"// ── {name}\n") <= 1 for name in MODULES)


def test_every_module_is_used():
    imported = {name for text in TEXTS.values() for name in IMPORT.findall(text)}
    exchanged = {name for variant in VARIANTS.values() for name in variant.values()}
    generated = {n for v in VARIANTS.values() for text in v.values() for n in IMPORT.findall(text)}
    assert set(MODULES) - set(PROGRAMS) <= imported | exchanged | generated
    assert imported <= set(MODULES)


def test_cycles_are_refused(monkeypatch):
    texts = {"andon/a.wgsl": "//!import andon/b.wgsl\n", "andon/b.wgsl": "//!import andon/a.wgsl\n"}
    monkeypatch.setattr(wgsl, "_read", texts.__getitem__)
    with pytest.raises(ValueError, match=r"cycle: andon/a\.wgsl → andon/b\.wgsl → andon/a\.wgsl"):
        wgsl.resolve("andon/a.wgsl")


@pytest.mark.parametrize("path", ["andon/../setup.wgsl", "/etc/passwd", "other/a.wgsl", "andon/a"])
def test_imports_stay_in_the_package(path):
    with pytest.raises(ValueError, match="names a module inside andon/"):
        wgsl.resolve(path)


# ── compilation ─────────────────────────────────────────────────────────────────────────────────


def compilations():
    """(variant, path): every program as written, and in each variant that changes it."""
    for path in PROGRAMS:
        plain = wgsl.resolve(path, STRUCTS)
        for name, exchanged in VARIANTS.items():
            if not exchanged or wgsl.resolve(path, STRUCTS, exchanged) != plain:
                yield name, path


@pytest.mark.parametrize(("variant", "path"), list(compilations()))
def test_compiles(gpu, variant, path):
    shader_module(gpu, path, STRUCTS, VARIANTS[variant])


def test_a_wrong_shader_does_not_compile(gpu, monkeypatch):
    monkeypatch.setattr(wgsl, "_read", lambda path: "fn broken() -> f32 { return vec3f(1.0); }")
    with pytest.raises(Exception, match=r"broken"):
        shader_module(gpu, "andon/broken.wgsl")


# ── memory ──────────────────────────────────────────────────────────────────────────────────────

# WGSL specification, "Alignment and Size": type → (alignment, size) in bytes. Written down here
# once more, from the specification and not from the layout under test.
SCALARS = {"f32", "i32", "u32"}


def alignment_and_size(kind):
    if kind in SCALARS:
        return 4, 4
    vector = re.fullmatch(r"vec([234])[fiu]", kind)
    if vector:
        n = int(vector[1])
        return (8 if n == 2 else 16), 4 * n
    matrix = re.fullmatch(r"mat([234])x([234])f", kind)
    assert matrix, f"unknown type {kind}"
    columns, rows = int(matrix[1]), int(matrix[2])
    column = 8 if rows == 2 else 16
    return column, columns * column


def layout_of(declaration):
    """({member: (offset, size)}, size of the struct) by WGSL's rules, from its source text."""
    body = re.search(r"struct \w+ \{(.*?)\}", declaration, re.DOTALL)[1]
    members = re.findall(r"(\w+)\s*:\s*(\w+)", body)
    offsets, end, widest = {}, 0, 0
    for name, kind in members:
        alignment, size = alignment_and_size(kind)
        start = (end + alignment - 1) // alignment * alignment
        offsets[name] = (start, size)
        end, widest = start + size, max(widest, alignment)
    return offsets, (end + widest - 1) // widest * widest


@pytest.mark.parametrize("name", STRUCTS)
def test_layout(name):
    struct = STRUCTS[name]
    offsets, size = layout_of(struct.wgsl())
    fields = struct.dtype.fields
    assert {key: (fields[key][1], fields[key][0].itemsize) for key in fields} == offsets
    # Arrays of a struct have a stride of its size; in uniform buffers a multiple of 16.
    assert struct.dtype.itemsize >= size
    assert struct.dtype.itemsize % 16 == 0


ARRAYED = [n for n in STRUCTS if any(re.search(rf"array<{n}\b", t) for t in TEXTS.values())]


@pytest.mark.parametrize("name", ARRAYED)
def test_array_stride(name):
    """In an array the shader's stride is the struct's own size, so the host's must be the same."""
    assert STRUCTS[name].dtype.itemsize == layout_of(STRUCTS[name].wgsl())[1]


def test_layout_rules():
    """The examples of the specification: a vec3f leaves room for one scalar behind it."""
    offsets, size = layout_of("struct S { a: f32, b: vec3f, c: f32, d: vec2f, e: mat4x4f, }")
    assert offsets == {"a": (0, 4), "b": (16, 12), "c": (28, 4), "d": (32, 8), "e": (48, 64)}
    assert size == 112


@pytest.mark.parametrize("name", STRUCTS)
def test_pack_puts_values_where_the_shader_reads(name):
    struct = STRUCTS[name]
    generator = np.random.default_rng(1)
    values, expected = {}, {}
    for field, kind in struct.fields:
        shape = struct.dtype[field].shape
        values[field] = generator.integers(1, 100, shape)
        expected[field] = values[field].T.ravel() if kind.startswith("mat") else values[field]
    raw = struct.pack(**values).tobytes()
    offsets, _ = layout_of(struct.wgsl())
    for field, kind in struct.fields:
        start, length = offsets[field]
        scalar = "<u4" if kind in ("u32", "vec2u", "vec4u") else "<i4" if kind == "i32" else "<f4"
        read = np.frombuffer(raw[start : start + length], scalar)
        np.testing.assert_array_equal(read, np.ravel(expected[field]))
