"""A lamp whose shade stands in the photograph: switched on, on both engines."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.lamps.shells.drum import drum_mesh
from andon.lamps.shells.model import Drum
from andon.pipeline import Renderer
from andon.quantities import Geometry
from andon.scene import scene_from_dict
from andon.spaces import View
from andon.surface.reference import trace
from comparison import assert_agree, assert_same_picture
from worlds import block, scene, sheet, write_obj

# The camera looks along −Z; a shade stands 1.2 m before it on nothing, a wall is 0.5 m behind.
WIDTH, HEIGHT = 64, 48
PLACE = [0.05, -0.02, -1.2]
DRUM = {"radius_m": 0.15, "top_radius_m": 0.12, "height_m": 0.2}
WALL_M = 1.7
LAMP = {
    "kind": "point", "name": "lamp", "position": PLACE, "intensity_cd": 30.0,
    "shadow_map_size": 256,
    "shell": {"drum": DRUM, "real": True, "transmittance": 0.4, "absorptance": 0.2},
}  # fmt: skip


def depth(*, shade=True, holes=0.0):
    view = View("pinhole", WIDTH, HEIGHT, 70.0, 70.0, 31.5, 23.5)
    wall = np.full(view.shape, WALL_M)
    if not shade:
        return wall
    mesh = drum_mesh(Drum(0.15, 0.12, 0.2, 0.1), 64, 6)
    seen = trace(Geometry(mesh.positions + PLACE, mesh.triangles), view, is_object=False)
    found = np.where(seen.valid, seen.depth, wall)
    random = np.random.default_rng(5).random(found.shape)
    return np.where(seen.valid & (random < holes), 0.0, found)


def room(folder, lamp=LAMP, *, values=None, **tables):
    """The scene of a grey photograph with that depth."""
    from andon.files.pictures import write_png

    folder.mkdir(exist_ok=True)
    random = np.random.default_rng(1)
    write_png(folder / "photo.png", random.integers(90, 120, (HEIGHT, WIDTH, 3)).astype(np.uint8))
    np.save(folder / "depth.npy", depth() if values is None else values)
    camera = {"width": WIDTH, "height": HEIGHT, "fx": 70.0, "fy": 70.0, "cx": 31.5, "cy": 23.5}
    return scene_from_dict(
        {
            "rig": {"camera": camera},
            "capture": {"source": "photo.png", "luminance_per_unit": 500.0},
            "surface": {"depth": "depth.npy"},
            "ambient": {"illuminance_lux": 100.0},
            "lamp": [lamp] if isinstance(lamp, dict) else lamp,
            **tables,
        },
        folder=folder,
    )


def test_both_engines_draw_the_same(gpu, tmp_path):
    lit = room(tmp_path, LAMP | {"visible_radius_m": 0.02}, values=depth(holes=0.1))
    expected, actual = (Renderer(lit, name).render() for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.01, mean=0.7)
    np.testing.assert_array_equal(actual.surface.shell_id, expected.surface.shell_id)
    for frame in (actual, expected):
        assert not frame.surface.is_object.any()
    assert_agree(
        actual.surface.shell_cd_m2, expected.surface.shell_cd_m2, rtol=1e-5, atol=1e-3,
        what="light of the shell",
    )  # fmt: skip
    assert_agree(actual.bodies.cd_m2, expected.bodies.cd_m2, rtol=2e-3, atol=0.5, what="bodies")


def test_the_wall_gets_the_light_that_a_virtual_shade_sends(engine, tmp_path):
    """A measured shade hides nothing of its lamp; a virtual one before a bare wall is the same."""
    virtual = LAMP | {"shell": LAMP["shell"] | {"real": False}}
    real = Renderer(room(tmp_path / "real"), engine).render()
    drawn = Renderer(room(tmp_path / "drawn", virtual, values=depth(shade=False)), engine).render()
    wall = (real.surface.depth > 1.6) & (drawn.surface.body_id < 0)
    # Beside the shade normals are fitted to fewer pixels, and a bulb's shadow has hard edges.
    lux = [np.asarray(frame.illuminance.lux, float)[wall] for frame in (real, drawn)]
    assert lux[0].mean() > 5
    assert_agree(lux[0], lux[1], rtol=0.01, share=0.03, what="light on the wall")


def test_the_shade_is_its_photograph_and_its_own_light(engine, tmp_path):
    frame = Renderer(room(tmp_path), engine).render()
    shell = frame.surface.shell_id == 0
    assert shell.sum() > 100
    unlit = np.asarray(frame.captured.linear, float) * frame.captured.luminance_per_unit
    expected = unlit + frame.surface.shell_cd_m2
    lit = np.asarray(frame.luminance.cd_m2, float)
    assert_agree(lit[shell], expected[shell], rtol=3e-3, atol=0.1, what="the shade")
    assert not np.asarray(frame.illuminance.lux)[shell].any()
    # t of what meets it, over its area: less than if all light did.
    even = 0.4 * 4 * np.pi * 30 / (np.pi * np.pi * 0.27 * np.hypot(0.2, 0.03))
    assert 0.4 * even < np.median(frame.surface.shell_cd_m2[shell]) < even


def test_a_dark_lamp_changes_nothing(engine, tmp_path):
    frame = Renderer(room(tmp_path, LAMP | {"intensity_cd": 0.0}), engine).render()
    from andon.files.pictures import read_picture

    np.testing.assert_array_equal(frame.image.rgb, read_picture(tmp_path / "photo.png").values)


def test_holes_in_the_shade_are_lit_like_the_rest(engine, tmp_path):
    whole = Renderer(room(tmp_path / "whole"), engine).render()
    holed = Renderer(room(tmp_path / "holed", values=depth(holes=0.4)), engine).render()
    assert holed.report.hole_pixels > 50
    assert_agree(
        holed.surface.shell_cd_m2, whole.surface.shell_cd_m2, rtol=0.03, atol=1.0, share=0.005
    )


def test_filled_holes_of_the_shade_are_the_shade(engine, tmp_path):
    fill = {"surface": {"depth": {"file": "depth.npy", "fill_px": 8}}}
    whole = Renderer(room(tmp_path / "whole"), engine).render()
    filled = Renderer(room(tmp_path / "f", values=depth(holes=0.4), **fill), engine).render()
    assert filled.report.hole_pixels == 0
    assert_agree(
        filled.surface.shell_cd_m2, whole.surface.shell_cd_m2, rtol=0.03, atol=1.0, share=0.005
    )


def test_a_thing_before_the_shade_hides_its_light(engine, tmp_path):
    (tmp_path / "room").mkdir()
    write_obj(tmp_path / "room" / "box.obj", block((0.2, 0.4, 0.05), (0, 0, 0)))
    box = {"name": "box", "mesh": "box.obj", "position": [0.1, 0.0, -0.8]}
    frame = Renderer(room(tmp_path / "room", object=[box]), engine).render()
    hidden = frame.surface.is_object
    assert hidden.sum() > 100
    assert not frame.surface.shell_cd_m2[hidden].any()
    assert (frame.surface.shell_id[hidden] == -1).all()
    assert not np.asarray(frame.bodies.cd_m2)[hidden].any()


def test_another_lamp_lights_the_shade_and_throws_its_shadow(engine, tmp_path):
    """The measured shade is what hides; the stated one does not stand in its own light."""
    far = {"kind": "point", "name": "far", "position": [0.0, 0.1, -0.1], "intensity_cd": 50.0}
    both = Renderer(room(tmp_path / "both", [LAMP | {"intensity_cd": 0.0}, far]), engine).render()
    alone = Renderer(room(tmp_path / "alone", [far]), engine).render()
    assert_agree(both.illuminance.lux, alone.illuminance.lux, rtol=1e-3, atol=1e-3, share=0.002)


def test_a_flickering_shade(engine, tmp_path):
    flicker = LAMP | {"flicker": {"seed": 3}}
    renderer = Renderer(room(tmp_path, flicker), engine)
    lights = [renderer.render(time).surface.shell_cd_m2.sum() for time in (0.0, 0.31, 0.62)]
    assert len({round(float(light), 3) for light in lights}) == 3


def test_a_shade_of_a_mesh_of_the_room(engine, tmp_path):
    """The real surface is a mesh, and the shade is in it."""
    from andon.quantities import merged

    mesh = drum_mesh(Drum(0.15, 0.12, 0.2, 0.1), 48, 4)
    shade = Geometry(mesh.positions + PLACE, mesh.triangles)
    (tmp_path / "m").mkdir()
    wall = sheet((-3, -3, -WALL_M), (6, 0, 0), (0, 6, 0))
    write_obj(tmp_path / "m" / "room.obj", merged(shade, wall))
    lit = Renderer(room(tmp_path / "m", surface={"mesh": "room.obj"}), engine).render()
    measured = Renderer(room(tmp_path / "d"), engine).render()
    assert_agree(
        lit.surface.shell_cd_m2, measured.surface.shell_cd_m2, rtol=0.02, atol=1.0, share=0.01
    )
    lux = np.asarray(lit.illuminance.lux)
    assert lux[lit.surface.shell_id < 0].mean() > 5


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"key": [{"time_seconds": 1.0, "position": [0, 0, -1]}]}, "the lamp moves"),
        ({"shell": LAMP["shell"] | {"drum": DRUM | {"drop_m": 0.3}}}, "must be < height_m"),
        ({"shell": LAMP["shell"] | {"radius_m": 0.1}}, "exactly one of radius_m, mesh, drum"),
        ({"shell": {"drum": DRUM, "margin_m": 0.1}}, "belongs to real shells"),
        ({"shell": {"drum": {"radius_m": 0.1}}}, "height_m"),
    ],
)
def test_what_a_scene_may_not_say(tmp_path, changes, message):
    with pytest.raises(InputError, match=message):
        room(tmp_path, LAMP | changes)


def test_real_shells_of_maps_and_of_the_photographs_own_light_are_refused(tmp_path):
    baked = {"folder": "maps", "lamps": ["lamp"]}
    with pytest.raises(InputError, match=r"lamp\[0\].shell.real"):
        Renderer(room(tmp_path, LAMP | {"transport": "baked"}, baked=baked), "reference")
    with pytest.raises(InputError, match=r"ambient.source\[0\].shell.real"):
        Renderer(
            room(tmp_path, ambient={"illuminance_lux": 100.0, "source": [LAMP]}, lamp=[]),
            "reference",
        )


def test_without_a_photograph_there_is_no_real_shell(tmp_path):
    with pytest.raises(InputError, match="there is none"):
        Renderer(scene(tmp_path, lamp=[LAMP], capture=None), "reference")
