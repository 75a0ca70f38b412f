"""The shaders' composite against the reference, and the identity of both."""

from dataclasses import replace

import numpy as np
import pytest

from andon import relight
from andon.composite.lamp_pictures import disc_rectangle
from andon.composite.model import Ambient
from andon.display.model import Exposure
from andon.engines.prepared import Prepared
from andon.lamps import PointLamp, SkyLamp, SpotLamp
from andon.pipeline import Renderer
from andon.quantities import CameraFrame, Material
from andon.responses import LINEAR, SRGB, Response
from andon.spaces import View, look_at
from andon.surface.load import surface_of_depth
from andon.surface.model import SurfaceModel
from andon.transport.direct.records import MAX_LAMPS
from comparison import assert_agree, assert_same_picture
from worlds import ALL_CODES, ball, sphere_depth

KNOTS = np.linspace(0, 1, 17)[:, None]
CURVE = Response("curve", linear=KNOTS ** [1.8, 2.2, 2.6], encoded=KNOTS * np.ones(3))
RESPONSES = {
    "srgb": SRGB,
    "linear": LINEAR,
    "gamma 2.2": Response("gamma", gamma=2.2),
    "gamma 1.1": Response("gamma", gamma=1.1),
    "curve": CURVE,
}
SMALL = View("pinhole", 48, 16, 40.0, 40.0, 23.5, 7.5)


def holed_depth(view):
    depth = np.full(view.shape, 2.0)
    depth[::3, ::5] = np.nan
    depth[:, 20:24] = np.nan
    return depth


@pytest.mark.parametrize("name", RESPONSES)
@pytest.mark.parametrize("ambient", [1.0, 300.0, (5e4, 1.0, 0.02)], ids=["1 lx", "300 lx", "odd"])
def test_without_lamps_every_byte_stays(engine, name, ambient):
    frame = relight(
        ALL_CODES, SMALL, (), depth_m=holed_depth(SMALL), ambient_lux=ambient,
        response=RESPONSES[name], engine=engine,
    )  # fmt: skip
    assert frame.report.engine == engine
    assert frame.report.hole_pixels > 0
    assert (frame.image.rgb == ALL_CODES).all()
    assert (frame.illuminance.lux == 0).all()


@pytest.mark.parametrize("mode", ["linear", "paper"])
def test_a_map_of_e0_without_lamps_keeps_every_byte(engine, mode):
    e0 = np.random.default_rng(3).uniform(0.01, 2e4, (*SMALL.shape, 3))
    frame = drawn(engine, ambient=Ambient(e0, dimming_mode=mode))
    assert (frame.image.rgb == ALL_CODES).all()


def prepared(view=SMALL, photo=ALL_CODES, lamps=(), ambient=None, response=SRGB, **model):
    linear = response.decode(photo / 255.0).astype(np.float32)
    surface = surface_of_depth(holed_depth(view), view)
    ambient = ambient or Ambient(np.full(3, 200.0))
    return Prepared(
        frames={"mono": CameraFrame(linear, view, response, 200 / np.pi)},
        surface=replace(surface, **model),
        ambient=ambient,
        lamps=lambda _: tuple(lamps),
    )


def drawn(engine, **parts):
    return Renderer(prepared(**parts), engine).render()


LAMPS = (
    PointLamp("warm", np.array([0.3, 0.2, -1.2]), np.array([60.0, 40, 15]), None, 0.05),
    SkyLamp("sky", np.array([0.0, 1, 0]), np.array([5.0, 10, 30])),
)
AMBIENTS = {
    "constant": Ambient(np.array([250.0, 200, 150])),
    "dimmed": Ambient(np.array([250.0, 200, 150]), (0.2, 0.5, 0.0)),
    "paper": Ambient(np.array([250.0, 200, 150]), (0.6, 0.8, 0.3), "paper"),
    "map": Ambient(np.random.default_rng(0).uniform(20, 900, (16, 48, 3)), (0.7, 0.2, 1.0)),
    "paper map": Ambient(np.full((16, 48, 3), 90.0) + np.arange(48)[:, None], (0.7,) * 3, "paper"),
}  # fmt: skip


@pytest.mark.parametrize("name", RESPONSES)
@pytest.mark.parametrize("ambient", AMBIENTS)
def test_relit_pictures_agree(gpu, tmp_path, ambient, name):
    options = {"lamps": LAMPS, "ambient": AMBIENTS[ambient], "response": RESPONSES[name]}
    expected = drawn("reference", **options)
    actual = drawn("gpu", **options)
    # Linear light in half floats: 2⁻¹¹ of itself, and once more where E0 is a picture.
    assert_agree(actual.luminance.cd_m2, expected.luminance.cd_m2, rtol=2e-3, atol=2e-3)
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, codes=1, mean=0.1)
    changed = np.abs(expected.image.rgb.astype(int) - ALL_CODES).mean()
    assert changed > 2, "the lamps must do something for this to mean anything"


def test_objects_and_discs_agree(gpu, tmp_path):
    view = View("pinhole", 96, 72, 80.0, 80.0, 47.5, 35.5)
    photo = np.resize(ALL_CODES, (72, 96, 3))
    materials = (Material("paper", (0.8, 0.5, 0.3), emissive_cd_m2=(3.0, 1.0, 0.0)),)
    thing = replace(ball(0.35, (-0.25, 0, -1.5)), materials=materials)
    spot = SpotLamp(
        "spot", np.array([0.2, 0.35, -1.6]), np.array([90.0, 90, 40]), None, 0.08,
        np.array([-0.5, -0.6, 0.62]), 0.3, 1.2,
    )  # fmt: skip
    hidden = PointLamp("hidden", np.array([-0.25, 0.1, -1.9]), np.full(3, 5.0), None, 0.2)
    options = {
        "view": view, "photo": photo, "lamps": (*LAMPS, spot, hidden), "objects": thing,
        "ambient": Ambient(np.array([250.0, 200, 150]), (0.5, 0.5, 0.7)),
    }  # fmt: skip
    expected, actual = drawn("reference", **options), drawn("gpu", **options)
    assert 0.05 < expected.surface.is_object.mean() < 0.5
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.01)
    same = actual.surface.is_object == expected.surface.is_object
    assert same.mean() > 0.995
    a, e = actual.luminance.cd_m2[same], expected.luminance.cd_m2[same]
    assert_agree(a, e, rtol=5e-3, atol=0.5, share=0.01)


VIEWS = {
    "pinhole": View("pinhole", 80, 60, 60.0, 60.0, 39.5, 29.5),
    "fisheye": View("fisheye", 80, 60, 24.0, 24.0, 39.5, 29.5),
    "latlong": View("latlong", 96, 48),
}


@pytest.mark.parametrize("name", VIEWS)
def test_discs_agree_in_every_projection(gpu, name):
    view = replace(VIEWS[name], world_from_camera=look_at(np.array([0.4, 1, 2]), np.zeros(3)))
    lamps = [
        PointLamp("a", np.array([0.1, 0.2, 0.3]), np.full(3, 9.0), None, 0.2),
        PointLamp("b", np.array([-0.4, 0.1, -0.5]), np.array([3.0, 9, 1]), None, 0.35),
        PointLamp("behind", np.array([1.0, 3, 6]), np.full(3, 9.0), None, 0.5),
    ]
    depth = sphere_depth(view, (0.3, 0.2, 1.9), 0.25)[0]
    scene = Prepared(
        frames={"mono": CameraFrame(np.zeros((*view.shape, 3), np.float32), view)},
        surface=surface_of_depth(depth, view),
        ambient=Ambient(),
        lamps=lambda _: tuple(lamps),
    )
    expected = Renderer(scene, "reference").render().luminance.cd_m2
    actual = Renderer(scene, "gpu").render().luminance.cd_m2
    assert (expected > 1).any()
    # Rims: angles of a pixel are differences of float32 directions there.
    assert_agree(actual, expected, rtol=2e-3, atol=0.02 * expected.max())
    assert_agree(actual, expected, rtol=2e-3, atol=1e-2, share=0.02)


def test_more_visible_lamps_than_there_are_slots(engine):
    count = MAX_LAMPS + 3
    lamps = [
        PointLamp(f"{i}", np.array([0.02 * (i - 30), 0, -1.0]), np.ones(3), None, 0.01)
        for i in range(count)
    ]
    if engine == "reference":
        assert len(drawn(engine, lamps=lamps).image.rgb)
        return
    from andon.errors import AndonError

    with pytest.raises(AndonError, match=str(MAX_LAMPS)):
        drawn(engine, lamps=lamps)


@pytest.mark.parametrize("place", [(0, 0, -1), (0.6, -0.3, -1.2), (-2, 1.5, -1.6), (0, 0, -0.12)])
def test_a_discs_rectangle_holds_all_of_it(place):
    view = VIEWS["pinhole"]
    lamp = PointLamp("a", np.array(place, float), np.ones(3), None, 0.1)
    from andon.composite.reference import draw_lamps
    from andon.surface.reference import empty_surface

    picture = draw_lamps(np.zeros((*view.shape, 3)), empty_surface(view), [lamp])
    rows, columns = np.nonzero(picture[..., 0])
    rectangle = disc_rectangle(view, lamp.position_m, 0.1)
    if len(rows) == 0:
        assert rectangle is None or rectangle[2] * rectangle[3] < 400
        return
    x, y, width, height = rectangle
    assert x <= columns.min()
    assert columns.max() < x + width <= view.width
    assert y <= rows.min()
    assert rows.max() < y + height <= view.height


def test_a_disc_out_of_view_has_no_rectangle():
    view = VIEWS["pinhole"]
    for place in ((0, 0, 5.0), (5, 0, -1), (0, -6, -2)):
        assert disc_rectangle(view, np.array(place, float), 0.1) is None


@pytest.mark.parametrize("tone", ["none", "reinhard"])
def test_strong_light_is_clipped_or_bent_alike(gpu, tmp_path, tone):
    sun = (SkyLamp("sun", np.array([0.0, 0, 1]), np.full(3, 3e4)),)
    scene = replace(prepared(lamps=sun), exposure=Exposure(tone=tone))
    expected, actual = (Renderer(scene, name).render() for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, codes=1, mean=0.1)
    assert expected.image.rgb.max() == 255 if tone == "none" else 250


def test_nothing_but_lamps_in_the_dark(engine):
    """No surface at all: the photograph stays, the lamp hangs in it."""
    scene = Prepared(
        frames={"mono": CameraFrame(np.zeros((16, 48, 3), np.float32), SMALL)},
        surface=SurfaceModel(),
        ambient=Ambient(),
        lamps=lambda _: LAMPS,
    )
    frame = Renderer(scene, engine).render()
    assert frame.report.hole_pixels == 16 * 48
    assert 0 < (frame.image.rgb > 0).any(axis=-1).mean() < 0.2
    assert (frame.illuminance.lux == 0).all()


@pytest.mark.parametrize("place", [(0, 0, -1), (0.5, -0.3, -0.9), (-2, 1.5, -1.6), (0, 0, 0.05)])
def test_a_bodys_rectangle_holds_all_of_it(place):
    from andon.composite.lamp_pictures import body_rectangle
    from andon.surface.reference import trace
    from worlds import ball

    view = VIEWS["pinhole"]
    body = ball(0.1, place)
    rectangle = body_rectangle(view, body.positions)
    rows, columns = np.nonzero(trace(body, view, is_object=True).valid)
    if len(rows) == 0:
        assert rectangle is None or rectangle[2] * rectangle[3] < 400 or place[2] > 0
        return
    x, y, width, height = rectangle
    assert x <= columns.min()
    assert columns.max() < x + width <= view.width
    assert y <= rows.min()
    assert rows.max() < y + height <= view.height
