"""What the shaders mirror against the reference: all lamps, all finishes, shadows, water."""

import numpy as np
import pytest

from andon.composite.model import Ambient
from andon.engines.highlights import SceneHighlights
from andon.engines.prepared import Prepared
from andon.glare.highlights.model import Finish
from andon.glare.highlights.waves import make_waves
from andon.lamps import (
    DirectionalLamp,
    DiskLamp,
    HemisphereLamp,
    MeshLamp,
    PointLamp,
    PolygonLamp,
    Shadow,
    SkyLamp,
    SphereLamp,
    SpotLamp,
    TubeLamp,
)
from andon.pipeline import Renderer
from andon.quantities import CameraFrame, Geometry, Material, merged
from andon.spaces import View, look_at, pinhole_view
from andon.surface.model import ObjectInfo, SurfaceModel
from comparison import assert_agree
from worlds import ball

POSE = look_at([0.2, 1.2, 2.2], [0, 0.3, 0])
WHITE, UP = np.array([1.0, 0.9, 0.7]), np.array([0.0, 1, 0])
CORNERS = np.array([[-0.4, 1.9, -0.9], [0.4, 1.9, -0.9], [0.4, 1.7, -0.3], [-0.4, 1.7, -0.3]])
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
MIDDLE = np.array([0.4, 1.6, -1.0])
LAMPS = {
    "point": PointLamp("lamp", MIDDLE, 80 * WHITE),
    "drawn point": PointLamp("lamp", MIDDLE, 80 * WHITE, None, 0.06),
    "spot": SpotLamp("lamp", MIDDLE, 300 * WHITE, direction=-MIDDLE / np.linalg.norm(MIDDLE)),
    "directional": DirectionalLamp("lamp", np.array([0.0, -0.6, -0.8]), 900 * WHITE),
    "sky": SkyLamp("lamp", UP, 700 * WHITE),
    "hemisphere": HemisphereLamp("lamp", UP, 700 * WHITE, 200 * WHITE[::-1]),
    "sphere": SphereLamp("lamp", 3e3 * WHITE, MIDDLE, 0.15),
    "disk": DiskLamp("lamp", 3e3 * WHITE, MIDDLE, -UP, 0.3),
    "disk both": DiskLamp("lamp", 3e3 * WHITE, MIDDLE, UP, 0.3, two_sided=True),
    "polygon": PolygonLamp("lamp", 3e3 * WHITE, CORNERS),
    "picture": PolygonLamp(
        "lamp", 3e3 * WHITE, CORNERS,
        texture=np.linspace(0.2, 1.8, 48).reshape(4, 4, 3),
    ),
    "tube": TubeLamp("lamp", 3e3 * WHITE, CORNERS[:2], 0.05),
    "mesh": MeshLamp("lamp", 3e3 * WHITE, CORNERS, FACES),
}  # fmt: skip
FINISHES = {
    "metal": Finish(alpha=(0.15, 0.15)),
    "plastic": Finish(alpha=(0.3, 0.3), metallic=0.0),
    "brushed": Finish(alpha=(0.5, 0.12), axis=np.array([0.6, 0.8, 0.0])),
    "turned": Finish(alpha=(0.5, 0.12), axis=UP, around=True),
    "phong": Finish("phong", exponent=60.0, reflectance=(0.6, 0.5, 0.4), metallic=0.5),
    "half phong": Finish("phong", exponent=300.0, metallic=0.5),
}
SUN = DirectionalLamp("sun", np.array([0.5, -0.6, -0.6]) / np.sqrt(0.97), 900 * WHITE)
LEVEL = np.array([[-2.0, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]])
RIPPLES = make_waves(slope=0.08, wavelength_m=(0.2, 1.0), wind_degrees=20.0, count=12, seed=2)
WATER = Finish("water", (0.002, 0.002), 0.0, waves=RIPPLES)


def smooth_ball():
    solid = ball(0.45, (0, 0.5, 0), 12)
    normals = (solid.positions - (0, 0.5, 0)) / 0.45
    look = (Material(reflectance=(0.9, 0.7, 0.3)),)
    return Geometry(solid.positions, solid.triangles, normals, materials=look)


def level():
    normals = np.repeat(UP[None], 4, axis=0)
    look = (Material(reflectance=(0.02, 0.05, 0.04)),)
    return Geometry(LEVEL, FACES, normals, materials=look)


def prepared(finish, lamps, view=None, geometry=None, casters=None):
    view = view or pinhole_view(72, 56, 70.0, POSE)
    geometry = smooth_ball() if geometry is None else geometry
    table = (ObjectInfo("thing", 0, 1, len(geometry.triangles)),)
    black = np.zeros((*view.shape, 3), np.float32)
    own = {} if casters is None else {"casters": casters}
    return Prepared(
        frames={"mono": CameraFrame(black, view, luminance_per_unit=50.0)},
        surface=SurfaceModel(objects=geometry, objects_table=table, **own),
        ambient=Ambient(np.array([30.0, 25, 20])),
        lamps=lambda _: tuple(lamps),
        highlights=SceneHighlights((finish,), (None,)),
    )


def both(scene, time=0.0):
    return [Renderer(scene, engine).render(time) for engine in ("reference", "gpu")]


def assert_alike(scene, *, share=0.0, rtol=0.02, time=0.0):
    expected, actual = both(scene, time)
    assert expected.highlights is not None
    # Normals have 2 × 16 bits, and luminance is kept in half floats.
    scale = np.percentile(expected.luminance.cd_m2, 99)
    assert_agree(
        actual.luminance.cd_m2, expected.luminance.cd_m2,
        rtol=rtol, atol=4e-3 * scale, share=share, what="luminance",
    )  # fmt: skip
    assert_agree(
        actual.highlights.cd_m2, expected.highlights.cd_m2,
        rtol=rtol, atol=4e-3 * scale, share=share, what="highlights",
    )  # fmt: skip
    return expected


@pytest.mark.parametrize("kind", LAMPS)
def test_every_lamp(gpu, kind):
    frame = assert_alike(prepared(FINISHES["metal"], [LAMPS[kind]]), share=0.002)
    shines = kind not in ("sky", "hemisphere")
    assert (frame.highlights.cd_m2.max() > 100) == shines
    assert frame.luminance.cd_m2.max() > 20


@pytest.mark.parametrize("name", FINISHES)
def test_every_finish(gpu, name):
    lamps = [LAMPS["sphere"], PointLamp("other", np.array([-1.5, 1.0, 1.5]), 60 * WHITE)]
    assert_alike(prepared(FINISHES[name], lamps), share=0.003)


@pytest.mark.parametrize("projection", ["fisheye", "latlong"])
def test_other_projections(gpu, projection):
    view = View("latlong", 96, 48, world_from_camera=POSE)
    if projection == "fisheye":
        view = View("fisheye", 72, 56, 40.0, 40.0, 35.5, 27.5, (), POSE)
    assert_alike(prepared(FINISHES["metal"], [LAMPS["sphere"]], view), share=0.003)


@pytest.mark.parametrize("height", [1.2, -1.2])
def test_water_from_above_and_below(gpu, height):
    view = pinhole_view(72, 56, 60.0, look_at([0.1, height, 2.2], [0, 0, -0.4]))
    lamp = SphereLamp("lamp", 3e3 * WHITE, np.array([0.2, np.sign(height) * 1.3, -1.4]), 0.12)
    scene = prepared(WATER, [lamp], view, level())
    frame = assert_alike(scene, share=0.02, time=1.7)
    assert frame.highlights.cd_m2.max() > 20


def test_shadows_take_highlights_away(gpu):
    shade = ball(0.2, 0.62 * (MIDDLE - (0, 0.5, 0)) + (0, 0.5, 0))
    lamp = PointLamp("lamp", MIDDLE, 80 * WHITE, Shadow(map_size=1024))
    open_scene = prepared(FINISHES["metal"], [lamp])
    closed = prepared(FINISHES["metal"], [lamp], casters=merged(shade))
    before = Renderer(open_scene, "reference").render().highlights.cd_m2
    for frame in both(closed):
        assert frame.highlights.cd_m2.sum() < 0.2 * before.sum()


def test_things_that_no_lamp_lights_mirror_none(gpu):
    finish = Finish(alpha=(0.15, 0.15), takes_lamps=False)
    for frame in both(prepared(finish, [LAMPS["sphere"], SUN])):
        assert frame.highlights.cd_m2.max() == 0
        assert frame.luminance.cd_m2.max() > 0


def test_ripples_move_and_are_the_same_again():
    view = pinhole_view(48, 36, 40.0, look_at([0.1, 1.2, 2.2], [0, 0, -0.4]))
    lamp = SphereLamp("lamp", 3e3 * WHITE, np.array([0.2, 1.3, -1.4]), 0.12, shadow=None)
    scene = prepared(WATER, [lamp], view, level())
    first, later, again = (
        Renderer(scene, "reference").render(time).highlights.cd_m2 for time in (0.0, 0.5, 0.0)
    )
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - later).max() > 10
