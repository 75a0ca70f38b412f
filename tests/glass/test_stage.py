"""The pass that traces a view's glass: outlines, what hides it, how it blurs, where it draws."""

import numpy as np
import pytest

from andon.gbuffer import STRUCTS, pack_surface, pack_view
from andon.glass import paths, pencils
from andon.glass.backdrops.buffers import BackdropBuffers
from andon.glass.model import Backdrop, Ball, Highlight, LensShape, Slab, Solid, Sticker
from andon.glass.screen import outline_of, rectangle_of
from andon.glass.stage import SolidBuffers, TraceStage
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.quantities import Surface
from andon.spaces import View, look_at
from comparison import assert_agree

WIDTH, HEIGHT, FOCAL = 200, 120, 260.0
POSE = look_at(np.array([0.03, 0.02, 0.4]), np.zeros(3))
VIEW = View("pinhole", WIDTH, HEIGHT, FOCAL, FOCAL, 99.5, 59.5, world_from_camera=POSE)
FOCUS, PUPIL = 2.0, 0.005
WHITE = Backdrop(
    "texture",
    picture=np.ones((4, 4, 3), np.float32),
    centre_m=np.array([0, 0, -0.2]),
    right_m=np.array([5.0, 0, 0]),
    up_m=np.array([0, 5.0, 0]),
)


def solid(shape, **options):
    return Solid("glass", shape, backdrop=WHITE, **options)


def scene_surface(depth):
    """What is in the scene, at `depth` (H, W) metres, NaN for holes."""
    shape = depth.shape
    return Surface(
        view=VIEW,
        depth=depth,
        position=np.zeros((*shape, 3)),
        normal=np.broadcast_to([0, 0, 1.0], (*shape, 3)),
        reflectance=np.full((*shape, 3), 0.5),
        emitted_cd_m2=np.zeros((*shape, 3)),
        valid=np.isfinite(depth),
        material_id=np.zeros(shape, np.int32),
        is_object=np.zeros(shape, bool),
    )


class Drawn:
    """Layers of `solids`, as arrays."""

    def __init__(self, gpu, solids, depth=None, view=VIEW, lamps=(), environment=0.0):
        shared = SolidBuffers(gpu, solids)
        shared.write_highlights(lamps)
        harmonics = np.zeros((len(solids), 9, 3))
        harmonics[:, 0] = environment / 0.282094791773878
        backdrops = BackdropBuffers(gpu, solids, harmonics, 1.0)
        size = (view.width, view.height)
        packed = make_texture(gpu, "rgba32uint", *size)
        packed.write(
            pack_surface(scene_surface(np.full(view.shape, np.nan) if depth is None else depth))
        )
        record = uniform_buffer(gpu, STRUCTS["ViewRecord"].dtype.itemsize)
        write_buffer(gpu, record, pack_view(view))
        levels = make_texture(gpu, "rgba16float", 1, 1)
        group = backdrops.group(levels)
        self.stage = TraceStage(gpu, view, shared, (packed.view, record), group, largest_px=64.0)
        self.stage.focus(FOCUS, PUPIL, 1.0)
        self.kept = (shared, backdrops, packed, levels)
        encoder = gpu.device.create_command_encoder()
        self.stage.encode(encoder)
        self.stage.encode_stickers(encoder)
        gpu.device.queue.submit([encoder.finish()])
        for name in ("refracted", "surface", "reflected", "sizes"):
            setattr(self, name, getattr(self.stage, name).read().astype(float))


def traced(solids, view=VIEW):
    directions = view.directions() @ view.world_from_camera[:3, :3].T
    return paths.trace(solids, view.position, directions.reshape(-1, 3))


def as_picture(values):
    return values.reshape(HEIGHT, WIDTH, *values.shape[1:])


@pytest.mark.parametrize(
    "shape", [Ball(0.075), Slab(np.array([0.08, 0.05, 0.01])), LensShape(0.05, (0.1, 0.1), 0.03)]
)
def test_layers_are_those_of_the_reference(gpu, shape):
    """On a white background: what comes through, its blur, and the distance of the surface."""
    solids = [solid(shape, absorption_per_m=(4.0, 2.0, 0.0))]
    drawn, truth = Drawn(gpu, solids), traced(solids)
    inside = as_picture((truth.solid >= 0) & (truth.status == paths.THROUGH)) & (
        drawn.sizes[..., 0] == 1
    )
    assert inside.mean() > 0.1
    share = truth.transmitted[:, None] * np.exp(-truth.path_m * np.array([[4.0, 2.0, 0.0]]))
    to_wall = (-0.2 - truth.exit_point[:, 2]) / truth.exit_direction[:, 2]
    meets = inside & as_picture(to_wall > 0)
    assert_agree(
        drawn.refracted[..., :3][meets],
        as_picture(share)[meets],
        atol=3e-3,
        share=0.01,
        what="light",
    )
    seen = pencils.vergence(truth.pencil, to_wall, truth.exit_direction)
    radians = pencils.blur_radians(seen, FOCUS, PUPIL)
    want = np.minimum(as_picture(radians) / np.sqrt(VIEW.solid_angles()), 64)
    got = drawn.refracted[..., 3]
    assert_agree(got[meets], want[meets], rtol=3e-3, atol=3e-3, share=0.01, what="blur")
    near = as_picture(truth.distance_m)
    assert_agree(drawn.sizes[..., 3][inside], near[inside], rtol=1e-3, share=0.01, what="distance")
    surface = np.abs(1 / near - FOCUS) * PUPIL / np.sqrt(VIEW.solid_angles())
    assert_agree(drawn.sizes[..., 1][inside], surface[inside], atol=1e-2, rtol=2e-3, share=0.01)


def test_the_outline_of_a_ball_is_smooth(gpu):
    """Coverage is the share of the pixel within the outline, to a twentieth of a pixel."""
    solids = [solid(Ball(0.075))]
    drawn = Drawn(gpu, solids).sizes[..., 0]
    fine = 16
    offsets = (np.arange(fine) + 0.5) / fine - 0.5
    shares = np.zeros((HEIGHT, WIDTH))
    grid = VIEW.pixel_grid() - [VIEW.cx, VIEW.cy]
    to_middle = -VIEW.position
    for x in offsets:
        for y in offsets:
            place = (grid + np.array([x, y])) / FOCAL
            rays = np.concatenate([place, np.ones((HEIGHT, WIDTH, 1))], axis=-1) @ POSE[:3, :3].T
            along = rays @ to_middle / np.linalg.norm(rays, axis=-1)
            shares += to_middle @ to_middle - along**2 < 0.075**2
    shares /= fine * fine
    partial = (shares > 0.02) & (shares < 0.98)
    assert partial.sum() > 100
    assert np.abs(drawn - shares)[partial].mean() < 0.05
    assert np.abs(drawn - shares).max() < 0.2
    assert (drawn[shares == 1] > 0.9).all()


def test_what_is_nearer_hides_glass_and_holes_do_not(gpu):
    depth = np.full((HEIGHT, WIDTH), 2.0)
    depth[:, :80] = 0.2
    depth[:60, 80:100] = np.nan
    solids = [solid(Ball(0.075))]
    drawn, free = Drawn(gpu, solids, depth), Drawn(gpu, solids)
    for name in ("refracted", "reflected", "surface", "sizes"):
        layer = getattr(drawn, name)
        assert not layer[:, :80].any()
        np.testing.assert_array_equal(layer[:, 80:], getattr(free, name)[:, 80:])
    assert free.sizes[:, :80, 0].any()


def test_a_lamp_is_mirrored_where_it_should_be(gpu):
    """Phong's lobe: its peak is where the mirrored ray meets the lamp, and there F·E·(m + 1)/2π."""
    lamp, candela = np.array([0.3, 0.4, 0.5]), 100.0
    solids = [solid(Ball(0.075), highlight_exponent=200.0)]
    lit = Drawn(gpu, solids, lamps=[Highlight(0, lamp, np.full(3, candela))])
    dark = Drawn(gpu, solids)
    ours = (lit.reflected - dark.reflected)[..., 1]
    truth = traced(solids)
    reach = lamp - truth.point
    square = (reach**2).sum(axis=1)
    cosine = np.maximum((truth.mirrored * reach).sum(axis=1) / np.sqrt(square), 0)
    want = truth.reflectance * candela / square * 201 / (2 * np.pi) * cosine**200
    hit = as_picture(truth.solid >= 0) & (lit.sizes[..., 0] == 1)
    assert_agree(ours[hit], as_picture(want)[hit], rtol=5e-3, atol=2e-3 * want.max(), what="lobe")
    assert want.max() > 10


def test_misses_see_the_environment(gpu):
    nowhere = Backdrop(
        "texture",
        picture=np.ones((2, 2, 3), np.float32),
        centre_m=np.array([0, 9.0, 0]),
        right_m=np.array([1e-3, 0, 0]),
        up_m=np.array([0, 1e-3, 0]),
    )
    solids = [Solid("glass", Ball(0.075), backdrop=nowhere)]
    drawn, truth = Drawn(gpu, solids, environment=3.0), traced(solids)
    hit = drawn.sizes[..., 0] == 1
    np.testing.assert_allclose(
        drawn.refracted[hit, 0], 3 * as_picture(truth.transmitted)[hit], rtol=3e-3, atol=3e-3
    )
    np.testing.assert_allclose(
        drawn.reflected[hit, 0], 3 * as_picture(truth.reflectance)[hit], rtol=3e-3, atol=3e-3
    )
    assert (drawn.sizes[hit, 2].astype(int) & 2).all()


def test_stickers_have_a_surface_of_their_own(gpu):
    picture = np.zeros((8, 16, 4), np.float32)
    picture[:, 6:10] = [0.2, 0.4, 0.6, 1.0]
    solids = [solid(Ball(0.075), sticker=Sticker(picture, 0.25))]
    drawn = Drawn(gpu, solids)
    covered = (drawn.surface[..., 3] > 0.7499) & (drawn.sizes[..., 0] == 1)
    assert covered.sum() > 100
    np.testing.assert_allclose(
        drawn.surface[covered, :3],
        0.75 * np.array([[0.2, 0.4, 0.6]]).repeat(covered.sum(), 0),
        atol=2e-3,
    )
    packed = drawn.stage.stickers.read()
    assert (packed[..., 3] > 0)[covered].all()
    assert not packed[drawn.surface[..., 3] == 0].any()
    depth = packed[..., 0].view(np.float32)[covered]
    rays = VIEW.directions()[covered]
    np.testing.assert_allclose(depth / rays[:, 2], drawn.sizes[covered, 3], rtol=1e-3)


@pytest.mark.parametrize(
    "shape", [Ball(0.075), Slab(np.array([0.08, 0.05, 0.01])), LensShape(0.05, (-0.1, 0.1), 0.03)]
)
@pytest.mark.parametrize("eye", [(0.0, 0.0, 0.4), (0.2, 0.1, 0.2), (0.0, 0.05, 0.09)])
def test_all_glass_is_in_the_rectangle(shape, eye):
    view = View(
        "pinhole",
        160,
        120,
        90.0,
        100.0,
        50.0,
        70.0,
        world_from_camera=look_at(np.array(eye), np.array([0.02, 0, 0.0])),
    )
    solids = [solid(shape)]
    seen = traced(solids, view).solid.reshape(view.shape) >= 0
    x, y, width, height = rectangle_of(solids, view)
    outside = np.ones(view.shape, bool)
    outside[y : y + height, x : x + width] = False
    assert seen.any()
    assert not seen[outside].any()
    corners = outline_of(solids, view)
    rows, columns = np.nonzero(seen)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        side = (b[0] - a[0]) * (rows - a[1]) - (b[1] - a[1]) * (columns - a[0])
        assert (side >= 0).all()


def test_no_rectangle_for_glass_behind_the_eye():
    behind = solid(
        Ball(0.05), world_from_glass=look_at(np.array([0, 0, 2.0]), np.array([0, 0, 3.0]))
    )
    assert rectangle_of([behind], VIEW) is None
