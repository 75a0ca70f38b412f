"""The shaders against the reference: projections, modes, moments, flicker; and when they draw."""

import re

import numpy as np
import pytest

from andon.errors import InputError, MachineError
from andon.gpu import wgsl
from andon.gpu.device import open_gpu
from andon.surface.objects import joined
from andon.surface.stage import SurfaceStage
from andon.transport.baked import BakedLight, BakedMoment, illuminance_at, texels
from andon.transport.baked.atlas import Atlas, Place, atlas_of
from andon.transport.baked.records import check_memory
from andon.transport.baked.rims import with_rims
from andon.transport.baked.stage import BakedBuffers, BakedPicture
from andon.verify.setting import prepared_of
from baked.scenes import baked_map, candles, fisheye, latlong, pinhole, still
from comparison import assert_agree
from worlds import ball, block

pytestmark = pytest.mark.usefixtures("gpu")

ROOM = joined(
    [
        block((4, 2.4, 4), (0, 1.2, 0), inwards=True),
        block((0.6, 1.0, 0.6), (-0.6, 0.5, -0.8)),
        ball(0.4, (0.6, 0.4, 0), 12),
    ]
)
EYE, TARGET = (-1.2, 1.5, 1.5), (0.5, 0.6, -1)
VIEW = pinhole(200, 150, EYE, TARGET)
MAPS = {
    "pinhole": pinhole(160, 120, (1.5, 1.7, 1.7), (-0.5, 0.8, -1), 1.5),
    "fisheye": fisheye(160, (1.5, 1.7, -1.7), (-0.5, 0.8, 0)),
    "latlong": latlong(192, (0.3, 1.6, 0.9)),
}


class Frame:
    """A view of the room, and baked light on it."""

    def __init__(self, light, view=VIEW, geometry=ROOM):
        self.light, self.gpu = light, open_gpu()
        stage = SurfaceStage(self.gpu, prepared_of(geometry, view, ()).surface, view)
        self.run(stage.encode)
        seen = stage.surface
        self.surface = seen.read()
        self.buffers = BakedBuffers(self.gpu, light)
        self.picture = BakedPicture(self.buffers, view, seen.texture.view, seen.view_buffer)

    def run(self, encode):
        encoder = self.gpu.device.create_command_encoder()
        result = encode(encoder)
        self.gpu.device.queue.submit([encoder.finish()])
        return result

    def draw(self, time_seconds=0.0, **options):
        return self.run(lambda encoder: self.picture.encode(encoder, time_seconds, **options))

    def assert_right(self, time_seconds=0.0):
        """Within 1e-3 where both know the light; which is where one does, but for 0.1 %."""
        got, shown = self.picture.lux.read(), self.surface.valid
        place = self.surface.position[shown], self.surface.normal[shown]
        lux, covered = illuminance_at(self.light, time_seconds, *place)
        assert not got[~shown].any()
        assert set(np.unique(got[..., 3])) <= {0.0, 1.0}
        known = got[shown][:, 3] > 0
        assert np.mean(known != covered) <= 1e-3
        self.assert_rims(got, lux, covered)
        both = known & covered
        assert both.mean() > 0.3
        # Where the ball turns away from the lamp a dark texel lies beside a bright one: float32
        # knows the place between them to 1e-5 texels, which is a large share of little light.
        assert_agree(got[shown][both, :3], lux[both], rtol=1e-3, atol=1e-5 * lux.max())

    def assert_rims(self, got, lux, covered):
        """What no map sees has the light of its rims, in both engines' pictures the same."""
        shown, known = self.surface.valid, got[..., 3] > 0
        truth, both = np.zeros((*shown.shape, 3)), np.zeros_like(shown)
        truth[shown], both[shown] = lux * covered[:, None], covered
        rims = with_rims(truth, both, self.surface, self.light.depth_tolerance_m)
        bare = shown & ~known & ~both
        off = np.abs(got[bare, :3] - rims[bare]).max(axis=-1, initial=0.0)
        # Beside a pixel that only one of both engines calls covered the rims differ.
        assert np.mean(off > 2e-3 * rims[bare].max(axis=-1, initial=0.0) + 1e-5 * lux.max()) < 0.01


@pytest.mark.parametrize("mode", ["blend", "first_valid"])
@pytest.mark.parametrize("names", [("pinhole",), ("fisheye",), ("latlong",), tuple(MAPS)], ids=str)
def test_every_projection(names, mode):
    light = still(*[baked_map(ROOM, MAPS[name]) for name in names], mode=mode)
    frame = Frame(light)
    assert frame.draw()
    frame.assert_right()


@pytest.mark.parametrize(
    "view",
    [fisheye(150, EYE, TARGET), latlong(200, (-1.2, 1.5, 1.5))],
    ids=lambda v: v.projection,
)
def test_every_view(view):
    frame = Frame(still(*[baked_map(ROOM, seen) for seen in MAPS.values()]), view)
    frame.draw()
    frame.assert_right()


def test_maps_of_all_sizes_and_more_than_shaders_name():
    views = [
        *(
            pinhole(20 + 7 * k, 50 - 3 * k, (1.5, 1.7, 1.7 - 0.1 * k), TARGET, 1.5)
            for k in range(9)
        ),
        *MAPS.values(),
        pinhole(1, 1, EYE, TARGET),
        latlong(3, (0, 1, 0.5), (1, 1, 0)),
    ]
    frame = Frame(still(*[baked_map(ROOM, view) for view in views]))
    frame.draw()
    frame.assert_right()


def test_no_maps():
    frame = Frame(still())
    frame.draw()
    assert not frame.picture.lux.read().any()


def moving():
    """Two lamps, one of which flickers; the ball moves, and so does a camera."""
    cold = np.array([-1.0, 1.5, 0.5])

    def moment(number):
        things = [
            block((4, 2.4, 4), (0, 1.2, 0), inwards=True),
            ball(0.4, (0.6 - 0.3 * number, 0.4, 0), 12),
        ]
        view = pinhole(160, 120, (1.5, 1.7, 1.7 - 0.2 * number), (-0.5, 0.8, -1), 1.5)
        first = baked_map(joined(things), view)
        second = baked_map(
            joined(things), MAPS["latlong"], lambda p, n: 40 * candles(p, n, cold), "cold"
        )
        return BakedMoment(float(number), (first, second))

    moments = [moment(number) for number in range(3)]
    shares = lambda t: {"lamp": 1.0, "cold": 0.6 + 0.4 * np.sin(9 * t)}  # noqa: E731
    return BakedLight((0.0, 1.0, 2.0), moments.__getitem__, shares)


def test_moments_come_and_go():
    frame = Frame(moving())
    for time_seconds in (-1.0, 0.0, 0.3, 1.0, 1.7, 5.0, 0.2):
        assert frame.draw(time_seconds)
        frame.assert_right(time_seconds)


def test_one_moment_is_loaded_once():
    light, loaded = moving(), []

    def load(number):
        loaded.append(number)
        return light.load(number)

    frame = Frame(BakedLight(light.moments, load, light.shares))
    for time_seconds in (0.3, 0.6, 1.2, 1.9, 1.1):
        frame.draw(time_seconds)
    assert loaded == [0, 0, 1, 2]  # the first one to see what maps there are


def test_it_draws_only_what_has_changed():
    light = moving()
    frame = Frame(BakedLight((0.0,), light.load, light.shares))
    views = [frame.draw(t) for t in (0.0, 0.0, 0.1, 0.1)]
    assert views == [True, False, True, False]
    assert frame.draw(0.1, changed=True)
    frame.assert_right(0.1)
    standing = Frame(BakedLight((0.0,), light.load, lambda t: {"lamp": 1.0, "cold": 0.5}))
    assert [standing.draw(t) for t in (0.0, 1.0, 9.0)] == [True, False, False]


def test_a_lamp_that_is_off_gives_nothing_and_bright_ones_do_not_overflow():
    seen = baked_map(ROOM, MAPS["latlong"], lambda p, n: 1e9 * candles(p, n))
    dark = BakedLight((0.0,), lambda _: BakedMoment(0.0, (seen,)), lambda t: {"lamp": 1.0 - t})
    frame = Frame(dark)
    frame.draw(0.0)
    frame.assert_right(0.0)
    frame.draw(1.0)
    lux = frame.picture.lux.read()
    assert not lux[..., :3].any()
    assert lux[..., 3].any()


def test_moments_of_other_maps_are_refused():
    maps = [baked_map(ROOM, view) for view in (MAPS["pinhole"], VIEW)]
    light = BakedLight(
        (0.0, 1.0), lambda k: BakedMoment(float(k), (maps[k],)), lambda t: {"lamp": 1.0}
    )
    frame = Frame(light)
    with pytest.raises(InputError, match="other sizes"):
        frame.draw(0.5)


@pytest.mark.parametrize(("maps", "lamps"), [(65, 1), (1, 257)])
def test_more_than_shaders_hold_is_refused(maps, lamps):
    seen = baked_map(ROOM, pinhole(2, 2, EYE, TARGET))
    seen = type(seen)(
        seen.view, seen.depth_m, seen.normal, {str(k): seen.lux["lamp"] for k in range(lamps)}
    )
    with pytest.raises(MachineError, match="more than shaders hold"):
        BakedBuffers(open_gpu(), still(*[seen] * maps))


def test_maps_that_no_adapter_holds_are_refused():
    """Before any memory is asked for; two moments of 8192² texels and no lamp fit."""
    check_memory(Atlas(8192, 8192, 1, ()), lamps=0, moments=2)
    with pytest.raises(MachineError, match=r"need 5\.0 GiB .* more than 4"):
        check_memory(Atlas(8192, 8192, 1, ()), lamps=1, moments=2)


def test_constants_are_those_of_the_reference():
    text = wgsl.resolve("andon/transport/baked/constants.wgsl")
    found = {k: float(v) for k, v in re.findall(r"const (\w+): f32 = ([-\d.e]+);", text)}
    low, high = texels.NORMAL_COSINES
    assert found == pytest.approx(
        {
            "BAKED_COSINE_LOW": low,
            "BAKED_COSINE_RATE": 1 / (high - low),
            "BAKED_VALID_LEAST": texels.VALID_LEAST,
            "BAKED_VALID_RATE": 1 / (1 - texels.VALID_LEAST),
            "BAKED_TRUST_UNIT": 1 / (texels.EDGE_TEXELS + 1),
            "BAKED_MOST_DENSITY": texels.MOST_DENSITY,
            "BAKED_LEAST_WEIGHT": texels.LEAST_WEIGHT,
        },
        rel=1e-6,
    )


# ── the atlas ───────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("most", [64, 100, 1000])
def test_maps_lie_side_by_side(most):
    generator = np.random.default_rng(3)
    sizes = [tuple(map(int, size)) for size in generator.integers(1, 65, (50, 2))]
    atlas = atlas_of(sizes, most)
    assert max(atlas.width, atlas.height) <= most
    pages = np.zeros((atlas.pages, atlas.height, atlas.width), int)
    for (height, width), place in zip(sizes, atlas.places, strict=True):
        pages[place.page, place.y : place.y + height, place.x : place.x + width] += 1
    assert pages.max() == 1
    assert pages.sum() == sum(height * width for height, width in sizes)


def test_an_atlas_of_nothing_and_of_too_much():
    assert atlas_of([], 64).places == ()
    assert atlas_of([(64, 64)], 64).places == (Place(0, 0, 0),)
    with pytest.raises(MachineError, match="exceeds the adapter's 64 px"):
        atlas_of([(65, 1)], 64)
