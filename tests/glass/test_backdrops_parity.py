"""Backdrops: shaders against the reference, function by function."""

from dataclasses import replace

import numpy as np
import pytest

from andon.gbuffer import STRUCTS as VIEW_STRUCTS
from andon.gbuffer import pack_surface, pack_view, projection_variant
from andon.glass.backdrops.atlas import make_atlas, spread_levels
from andon.glass.backdrops.buffers import BackdropBuffers
from andon.glass.backdrops.environment import environment_of
from andon.glass.backdrops.levels import FrameLevels
from andon.glass.backdrops.model import FAR_M
from andon.glass.backdrops.paper import preblurred
from andon.glass.backdrops.pyramids import pyramid
from andon.glass.backdrops.records import STRUCTS, backdrop_variants
from andon.glass.backdrops.reference import environment_light, look, sticker_at
from andon.glass.model import Backdrop, Ball, Closed, Slab, Solid, Sticker
from andon.gpu.bindings import bind_group
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.quantities import Geometry
from comparison import assert_agree

from .backdrop_scenes import VIEWS, WALL_AND_BOX, eye_of, footprint_of, rays_from_a_ball

WIDTH = 64
MODULES = ("bindings", "which", "sticker", "environment")
HEAD = (
    "".join(f"//!import andon/glass/backdrops/{name}.wgsl\n" for name in MODULES)
    + """
//!import andon/gbuffer/gbuffer.wgsl
@group(0) @binding(0) var rows: texture_2d_array<f32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var gbuffer: texture_2d<u32>;
fn row(k: i32, at: vec2i) -> vec3f { return textureLoad(rows, at, k, 0).xyz; }
@fragment fn call(@builtin(position) place: vec4f) -> @location(0) vec4f {
  let at = vec2i(place.xy);
  let a = row(0, at);
  let b = row(1, at);
  let c = mat2x3f(row(2, at), row(3, at));
  let d = mat2x3f(row(4, at), row(5, at));
"""
)
SEEN = "let seen = backdrop_seen({}, a, b, Footprint(c, d));"
LIGHT = "return vec4f(seen.light, seen.distance);"
FLAGS = "return vec4f(f32(seen.missed), f32(seen.beside), 0.0, 0.0);"


def half(values):
    return np.asarray(values).astype(np.float16).astype(np.float64)


class Shader:
    """WGSL statements over rows of six vec3f, with the backdrops of `solids` seen by an eye."""

    def __init__(self, gpu, solids, eye, environment=None):
        self.gpu, self.solids, self.view = gpu, solids, eye.view
        environment = np.zeros((len(solids), 9, 3)) if environment is None else environment
        self.buffers = BackdropBuffers(
            gpu, solids, environment, eye.luminance_per_unit, eye.dimming
        )
        frame = make_texture(gpu, "rgba16float", self.view.width, self.view.height)
        frame.write(np.dstack([eye.luminance / eye.luminance_per_unit, np.ones(self.view.shape)]))
        self.levels = FrameLevels(gpu, frame)
        encoder = gpu.device.create_command_encoder()
        self.levels.encode(encoder)
        gpu.device.queue.submit([encoder.finish()])
        self.gbuffer = make_texture(gpu, "rgba32uint", self.view.width, self.view.height)
        self.gbuffer.write(pack_surface(eye.surface))
        record = pack_view(self.view)
        self.record = uniform_buffer(gpu, record.nbytes)
        write_buffer(gpu, self.record, record)

    def __call__(self, statements, *columns):
        gpu, height = self.gpu, -(-len(columns[0]) // WIDTH)
        inputs = make_texture(gpu, "rgba32float", WIDTH, height, layers=6)
        target = make_texture(gpu, "rgba32float", WIDTH, height)
        for layer, column in enumerate(columns):
            data = np.zeros((height * WIDTH, 4), np.float32)
            data[: len(column), : column.shape[1]] = column
            inputs.write(data, layer)
        group = bind_group(
            gpu,
            {
                0: ("float array", inputs.view),
                1: ("uniform", self.record),
                2: ("uint", self.gbuffer.view),
            },
        )
        call = FullscreenPass(
            gpu,
            "harness",
            "call",
            ["rgba32float"],
            [group, self.buffers.group(self.levels.texture)],
            structs=STRUCTS | VIEW_STRUCTS,
            variants={"harness": HEAD + statements + "\n}\n"}
            | backdrop_variants(self.solids, self.view.projection)
            | projection_variant(self.view),
        )
        encoder = gpu.device.create_command_encoder()
        call.encode(encoder, [target.view])
        gpu.device.queue.submit([encoder.finish()])
        return target.read().reshape(-1, 4)[: len(columns[0])].astype(np.float64)


def rounded(*arrays):
    """As the shader gets them."""
    return [array.astype(np.float32).astype(np.float64) for array in arrays]


def both(gpu, solid, eye, rays, number=0, solids=None):
    """Light in units of the frame's white, distance, missed and beside, by shader and reference."""
    origins, directions = rounded(*rays)
    footprint = footprint_of(directions)
    columns = (
        origins,
        directions,
        *footprint.place.swapaxes(0, 1),
        *footprint.course.swapaxes(0, 1),
    )
    shader = Shader(gpu, solids or (solid,), eye)
    lit = shader(SEEN.format(number) + LIGHT, *columns)
    flags = shader(SEEN.format(number) + FLAGS, *columns)
    expected = look(solid.backdrop, origins, directions, footprint, eye)
    return (lit[:, :3], lit[:, 3], flags[:, 0] > 0, flags[:, 1] > 0), (
        expected.light / eye.luminance_per_unit,
        expected.distance_m,
        expected.missed,
        expected.beside,
    )


def assert_same(actual, expected, *, share=0.0):
    """Flags first: light and distance are compared where both are the same."""
    same = (actual[2] == expected[2]) & (actual[3] == expected[3])
    assert (~same).mean() <= max(share, 1e-3), f"{(~same).mean():.3%} of the flags differ"
    for index, tolerance in ((0, {"atol": 4e-3, "rtol": 2e-3}), (1, {"rtol": 1e-3})):
        assert_agree(actual[index][same], expected[index][same], share=share, **tolerance)


def photograph(seed=1, size=(83, 61)):
    generator = np.random.default_rng(seed)
    return half(generator.random((*size, 3))).astype(np.float32)


PICTURE = Backdrop(
    "texture",
    picture=photograph(),
    centre_m=np.array([0.1, 0.0, -1.2]),
    right_m=np.array([0.6, 0.1, 0.1]),
    up_m=np.array([-0.1, 0.6, 0.0]),
)


@pytest.mark.parametrize("projection", VIEWS)
def test_pictures(gpu, projection):
    eye = eye_of(VIEWS[projection])
    actual, expected = both(
        gpu, Solid("a", Ball(1.0), backdrop=PICTURE), eye, rays_from_a_ball(4000)
    )
    assert 0.02 < expected[2].mean() < 0.9
    assert_same(actual, expected)


@pytest.mark.parametrize("projection", VIEWS)
@pytest.mark.parametrize("distance", [0.3, 1.5])
def test_frames(gpu, projection, distance):
    eye = eye_of(VIEWS[projection])
    solid = Solid("a", Ball(1.0), backdrop=Backdrop("frame", distance_m=distance))
    actual, expected = both(gpu, solid, eye, rays_from_a_ball(4000))
    assert_same(actual, expected)
    assert (expected[1] < FAR_M).all() == (distance > 1)


@pytest.mark.parametrize("projection", VIEWS)
def test_surfaces(gpu, projection):
    eye = eye_of(VIEWS[projection], WALL_AND_BOX)
    solid = Solid("a", Ball(1.0), backdrop=Backdrop("surface"))
    actual, expected = both(gpu, solid, eye, rays_from_a_ball(20000))
    assert (expected[1] < FAR_M).mean() > 0.5
    # Rays that graze an edge: float32 goes to one side of it, float64 to the other.
    assert_same(actual, expected, share=0.005)


def test_surfaces_full_of_holes(gpu):
    """Where in a hole a ray meets what is around it, is settled to a pixel only: left out."""
    eye = eye_of(VIEWS["pinhole"], WALL_AND_BOX)
    torn = np.random.default_rng(4).random((18, 32)) < 0.2
    eye.surface.valid[np.kron(torn, np.ones((10, 10), bool))] = False
    solid = Solid("a", Ball(1.0), backdrop=Backdrop("surface"))
    origins, directions = rays_from_a_ball(20000, centre=(0.5, 0.1, -1.6))
    actual, expected = both(gpu, solid, eye, (origins, directions))
    hidden = expected[3] & (expected[1] < FAR_M)
    assert hidden.mean() > 0.2
    there, here = (
        eye.view.project((origins + one[1][:, None] * directions) * [1, -1, -1])
        for one in (expected, actual)
    )
    both_hidden = hidden & actual[3] & (actual[1] < FAR_M)
    assert_agree(here[both_hidden], there[both_hidden], atol=1.0, share=0.01)
    column, row = np.clip(np.rint(np.nan_to_num(there)), 0, [319, 179]).astype(int).T
    sound = np.where(expected[3], ~hidden, eye.surface.valid[row, column])
    assert_same(*([one[sound] for one in each] for each in (actual, expected)), share=0.005)


def test_rays_along_the_picture_have_light(gpu):
    """Nearly at right angles to the eye's axis the footprint in the picture has no end."""
    eye, solid = eye_of(VIEWS["pinhole"]), Solid("a", Ball(1.0), backdrop=Backdrop("surface"))
    directions = np.array([[0.3, 0.9, -z] for z in np.geomspace(1e-12, 1e-3, 300)])
    origins = np.tile([[0.0, 0.0, -0.5]], (300, 1))
    assert_same(*both(gpu, solid, eye, (origins, directions)), share=0.005)


def test_one_kind_for_each_body(gpu):
    eye = eye_of(VIEWS["pinhole"], WALL_AND_BOX)
    kinds = (PICTURE, Backdrop("frame", distance_m=2.0), Backdrop("surface"))
    solids = tuple(Solid(b.kind, Ball(1.0), backdrop=b) for b in kinds)
    for number, solid in enumerate(solids):
        rays = rays_from_a_ball(4000, seed=number)
        assert_same(*both(gpu, solid, eye, rays, number, solids), share=0.005)


MESH = Geometry(np.zeros((3, 3)), np.zeros((1, 3), np.int32))


@pytest.mark.parametrize("shape", [Ball(0.1), Slab(np.ones(3)), Closed(MESH)])
@pytest.mark.parametrize("size", [(64, 128), (33, 47), (1, 1)])
def test_stickers(gpu, shape, size):
    generator = np.random.default_rng(3)
    picture = half(generator.random((*size, 4))).astype(np.float32)
    # A body without a sticker stands before it.
    solids = (Solid("bare", Ball(1.0)), Solid("a", shape, sticker=Sticker(picture, 0.8)))
    uv = generator.random((2000, 2)) * (1.5 if isinstance(shape, Closed) else 1.0)
    steps = generator.normal(size=(2000, 2, 2)) * generator.choice([1e-4, 0.01, 0.3], (2000, 1, 1))
    uv, steps = rounded(uv, steps)
    shader = Shader(gpu, solids, eye_of(VIEWS["pinhole"]))
    call = "return sticker_at({}, a.xy, mat2x2f(b.xy, c[0].xy));"
    columns = (uv, steps[:, 0], steps[:, 1])
    assert_agree(shader(call.format(1), *columns), sticker_at(solids[1], uv, steps), atol=3e-3)
    assert (shader(call.format(0), *columns) == 0).all()


def test_environments(gpu):
    coefficients = np.random.default_rng(4).normal(size=(3, 9, 3)) * 30
    coefficients[2] = environment_of((300, 200, 100))
    solids = tuple(Solid(name, Ball(1.0)) for name in "abc")
    _, directions = rays_from_a_ball(2000)
    shader = Shader(gpu, solids, eye_of(VIEWS["pinhole"]), coefficients)
    for index, own in enumerate(coefficients):
        actual = shader(f"return vec4f(environment_light({index}, a), 0.0);", directions)
        expected = environment_light(own, directions) / 100.0
        assert expected.min() == 0 or index == 2
        assert_agree(actual[:, :3], expected, atol=1e-5)


@pytest.mark.parametrize("size", [(64, 36), (37, 21), (1, 5), (1, 1), (129, 255)])
def test_levels_of_the_frame(gpu, size):
    width, height = size
    frame = make_texture(gpu, "rgba16float", width, height)
    picture = half(np.random.default_rng(1).random((height, width, 4)))
    frame.write(picture)
    levels = FrameLevels(gpu, frame)
    for _ in range(2):
        encoder = gpu.device.create_command_encoder()
        levels.encode(encoder)
        gpu.device.queue.submit([encoder.finish()])
    actual = levels.texture.read().astype(np.float64)
    expected = np.zeros_like(actual)
    spread_levels(expected, levels.place, pyramid(picture))
    # Half floats, some drivers cut instead of rounding: 2⁻¹⁰ a level.
    assert_agree(actual, expected, atol=len(pyramid(picture).levels) * 2.0**-11)


def points(shape, width):
    """White points on black; at wide blurs none near the border, where coarser levels go on."""
    picture = np.zeros((*shape, 3))
    picture[np.random.default_rng(1).random(shape) < 0.01] = 1000
    if width > 32:
        inner = picture[8:-8, 8:-8].copy()
        picture[:] = 0
        picture[8:-8, 8:-8] = inner
    return picture


def board(shape, _):
    rows, columns = np.indices(shape) // 7
    return np.repeat(((rows + columns) % 2)[..., None] * 1000.0, 3, axis=2)


# Share of the largest luminance, where the blur is made in a coarser level: points lie in the
# middle of its texels then, by half a texel of σ/4 off; of a board only the corners differ by more
# than 0.02. Narrower blurs agree as half floats do.
COARSE = {points: 0.15, board: 0.06}


@pytest.mark.parametrize("pattern", COARSE)
@pytest.mark.parametrize("kernel", [0.0, 0.9, 1.0, 3.0, 8.0, 31.0, 33.0, 60.0, 200.0])
def test_the_papers_blur_of_the_frame(gpu, kernel, pattern):
    width, height = 150, 110
    picture = pattern((height, width), kernel)
    frame = make_texture(gpu, "rgba16float", width, height)
    frame.write(np.dstack([picture, np.ones((height, width))]))
    levels = FrameLevels(gpu, frame, blurs=True)
    for asked in (60.0, kernel):
        encoder = gpu.device.create_command_encoder()
        levels.encode(encoder, asked)
        gpu.device.queue.submit([encoder.finish()])
    actual = levels.texture.read()[..., :3].astype(np.float64)
    blurred = preblurred(picture, 1.0, kernel)
    expected = np.zeros((*actual.shape[:2], 4))
    spread_levels(expected, levels.place, pyramid(np.dstack([blurred, blurred[..., :1]])))
    share = 2e-3 if kernel < 32 else COARSE[pattern]
    assert_agree(actual, expected[..., :3], atol=share * blurred.max())


def test_the_papers_blur_of_a_picture(gpu):
    """In the atlas, one body's picture and not the other's."""
    picture = photograph(3, (64, 96))
    backdrops = [replace(PICTURE, picture=picture)] * 2
    solids = tuple(Solid(str(k), Ball(1.0), backdrop=b) for k, b in enumerate(backdrops))
    buffers = BackdropBuffers(gpu, solids, np.zeros((2, 9, 3)), 1.0, blurs=True)
    before = buffers.atlas.read().astype(np.float64)
    encoder = gpu.device.create_command_encoder()
    buffers.encode_blur(encoder, 1, 9.0)
    gpu.device.queue.submit([encoder.finish()])
    after = buffers.atlas.read().astype(np.float64)
    blurred = preblurred(picture, 3.0, 3.0)
    for index, expected in enumerate((picture, blurred)):
        place = make_atlas(solids, 8192).backdrops[index]
        rows, columns = (slice(a, a + n) for a, n in ((place.row, 64), (place.column, 96)))
        assert_agree(after[rows, columns, :3], expected, atol=2e-3)
    assert (before != after).any()


def test_pictures_that_are_too_large_are_halved():
    solids = tuple(
        Solid(name, Ball(1.0), backdrop=Backdrop("texture", picture=photograph(1, size)))
        for name, size in (("small", (20, 30)), ("large", (300, 200)))
    )
    atlas = make_atlas(solids, 256)
    assert atlas.texels.shape[0] <= 256
    assert atlas.texels.shape[1] <= 256
    large, small = atlas.backdrops[1], atlas.backdrops[0]
    assert (small.width, small.height) == (30, 20)
    assert (large.width, large.height) == (100, 150)
    assert len(atlas.notes) == 1
    assert atlas.notes[0].startswith("large: the backdrop's picture of 200×300 is halved")
    assert make_atlas(solids, 1024).notes == ()
