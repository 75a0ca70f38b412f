"""Cube captures: where they look, what they see, and that both engines see the same."""

import numpy as np
import pytest
from worlds_of_probes import furnace, lamp_room, scene_of

from andon.engines.cubes import cube_engine, cube_setting, cube_views, mirrored
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.harmonics import cube_directions
from andon.scene import scene_from_dict
from andon.transport.probes.capture import captured, quantised
from worlds import block, scene, write_glb

SIZE = 16


def taken(loaded, position, engine="reference", *, size=SIZE, range_m=np.inf):
    setting = cube_setting(loaded, prepare(loaded, drawn=False))
    seen, lux = cube_engine(setting, size, engine).look(np.array(position, float))
    directions = cube_directions(size)
    return captured(seen, directions, setting.lighting, lux=lux, range_m=range_m), seen


def test_mirrored_views_look_where_texels_do():
    position = np.array([1.0, 2.0, 3.0])
    for size in (8, 9):
        rays = [view.rays_world() for view in cube_views(position, size)]
        directions = mirrored(np.stack([ray for _, ray in rays]))
        np.testing.assert_allclose(directions, cube_directions(size), atol=1e-15)
        assert all((origin == position).all() for origin, _ in rays)


def test_distances_in_a_box_are_the_closed_form(tmp_path, engine):
    place = np.array([0.3, -0.4, 0.5])
    capture, seen = taken(furnace(tmp_path, 0.5), place, engine)
    directions = cube_directions(SIZE)
    walls = np.where(directions > 0, 1.5 - place, 1.5 + place) / np.abs(directions)
    np.testing.assert_allclose(capture.distance_m, walls.min(axis=-1), rtol=1e-5)
    expected = place + directions * walls.min(axis=-1)[..., None]
    np.testing.assert_allclose(seen.position, expected, atol=3e-5)


def test_emission_is_seen_as_it_is(tmp_path, engine):
    capture, _ = taken(furnace(tmp_path, 0.5, emitted=0.75), (0.1, 0.2, 0.3), engine)
    np.testing.assert_allclose(capture.luminance_cd_m2, 0.75, rtol=1e-6)


def test_walls_reflect_a_lamp(tmp_path, engine):
    """L = ρ/π·I·cos φ/d² on every wall of a box."""
    write_glb(tmp_path / "box.glb", block((3, 3, 3), (0, 0, 0), inwards=True), colour=(0.6,) * 3)
    place = np.array([0.5, 0.2, -0.3])
    lamp = {"kind": "point", "position": place.tolist(), "intensity_cd": 100.0}
    loaded = scene_of(tmp_path, surface={"mesh": "box.glb"}, lamp=[lamp])
    capture, seen = taken(loaded, (0, 0, 0), engine)
    reach = place - seen.position
    square = (reach**2).sum(axis=-1)
    cosine = (reach * seen.normal).sum(axis=-1) / np.sqrt(square)
    expected = 0.6 / np.pi * 100 * cosine / square
    np.testing.assert_allclose(capture.reflected_cd_m2[..., 1], expected, rtol=2e-3)


def test_both_engines_see_the_same(tmp_path, gpu):
    loaded = lamp_room(tmp_path)
    a, b = (
        taken(loaded, (-0.7, 0.6, 0.9), name, size=64)[0].luminance_cd_m2
        for name in ("reference", "gpu")
    )
    assert a.mean() > 1
    error = np.abs(a - b).max(axis=-1) / a.mean()
    # The rims of the board and its shadow differ by a texel.
    assert (error > 0.02).mean() < 0.02
    assert error.mean() < 0.01


def test_the_sky_is_seen_where_nothing_else_is(tmp_path, engine):
    write_glb(tmp_path / "box.glb", block((1, 1, 1), (0, -3, 0)))
    sky = {"kind": "sky", "illuminance_lux": 1000.0}
    both = {"kind": "hemisphere", "illuminance_lux": 300.0, "ground_illuminance_lux": 30.0}
    loaded = scene_of(tmp_path, surface={"mesh": "box.glb"}, lamp=[sky, both])
    capture, seen = taken(loaded, (0, 0, 0), engine)
    up = cube_directions(SIZE)[..., 1]
    light = capture.luminance_cd_m2[..., 0]
    np.testing.assert_allclose(light[~seen.valid & (up > 0)], 1300 / np.pi)
    np.testing.assert_allclose(light[~seen.valid & (up < 0)], 30 / np.pi)
    assert seen.valid.any()
    assert (seen.valid <= (up < 0)).all()
    np.testing.assert_array_equal(light[seen.valid], 0)  # it lights surfaces by probes alone


def test_what_lies_beyond_the_range_is_dark_but_keeps_its_distance(tmp_path, engine):
    loaded = furnace(tmp_path, 0.5, lamp=[{"kind": "sky", "illuminance_lux": 1.0}])
    capture, _ = taken(loaded, (0, 0, 0), engine, range_m=2.0)
    near = capture.distance_m <= 2.0
    assert 0.1 < near.mean() < 0.9
    np.testing.assert_allclose(capture.luminance_cd_m2[near], 1.0)
    np.testing.assert_array_equal(capture.luminance_cd_m2[~near], 0.0)
    assert capture.distance_m.max() > 2.4


def test_the_sky_is_not_cut_by_the_range(tmp_path):
    write_glb(tmp_path / "box.glb", block((1, 1, 1), (0, -3, 0)))
    loaded = scene_of(
        tmp_path, surface={"mesh": "box.glb"}, lamp=[{"kind": "sky", "illuminance_lux": np.pi}]
    )
    capture, seen = taken(loaded, (0, 0, 0), range_m=0.1)
    up = cube_directions(SIZE)[..., 1] > 0
    np.testing.assert_allclose(capture.luminance_cd_m2[up & ~seen.valid], 1.0)


def test_lamps_that_are_not_in_probes_stay_out(tmp_path, engine):
    lamps = [
        {"kind": "point", "position": [0, 1, 0], "intensity_cd": 9.0, "in_probes": False},
        {"kind": "sky", "illuminance_lux": 9.0, "in_probes": False},
    ]
    capture, _ = taken(lamp_room(tmp_path, lamp=lamps), (0.1, 0.3, 0.2), engine)
    np.testing.assert_array_equal(capture.luminance_cd_m2, 0)


def test_lamps_that_are_in_illuminance_maps_are_captured_like_others(tmp_path, engine):
    """Probes have no maps: they find out themselves what surfaces reflect of a lamp."""
    lamp = {"kind": "point", "name": "lamp", "position": [0, 1, 0], "intensity_cd": 9.0}
    table = {"folder": "maps", "lamps": ["lamp"]}
    captures = [
        taken(lamp_room(tmp_path, lamp=[lamp | own], **more), (0.1, 0.3, 0.2), engine)[0]
        for own, more in (
            ({}, {}),
            ({"transport": "baked"}, {"baked": table}),
            ({"transport": "direct+bounce"}, {"baked": table}),
        )
    ]
    direct = captures[0].luminance_cd_m2
    assert direct.max() > 0
    for capture in captures[1:]:
        np.testing.assert_array_equal(capture.luminance_cd_m2, direct)


def test_light_that_is_no_number_counts_as_none():
    from andon.transport.probes.capture import Lighting, Seen

    shape = (6, 8, 8)
    seen = Seen(
        np.ones((*shape, 3)), np.ones((*shape, 3)), np.ones(shape), np.ones(shape, bool),
        np.full((*shape, 3), 0.5), np.zeros((*shape, 3)),
    )  # fmt: skip
    lux = np.full((*shape, 3), np.pi)
    lux[0, 0, 0, 1], lux[3, 2, 1, 0] = np.nan, np.inf
    capture = captured(seen, cube_directions(8), Lighting(np.zeros(3)), lux=lux)
    assert capture.not_finite == 2
    assert np.isfinite(capture.luminance_cd_m2).all()
    np.testing.assert_allclose(capture.luminance_cd_m2.sum(axis=(0, 1, 2)), 0.5 * (384 - 2))


def photographed(folder, **tables):
    return scene(folder, probes={"volume": "p.glb"}, **tables)


@pytest.mark.parametrize("dimming", [1.0, 0.25])
def test_at_the_camera_a_capture_is_the_photograph(tmp_path, engine, dimming):
    loaded = photographed(tmp_path, ambient={"illuminance_lux": 200.0, "dimming": dimming})
    frame = next(iter(prepare(loaded).frames.values()))
    capture, seen = taken(loaded, frame.view.position, engine, size=64)
    assert capture.unphotographed_share < 0.01
    front = seen.valid[5]  # −Z
    assert front.mean() > 0.15
    view = frame.view
    directions = cube_directions(64)[5][front] * [1, -1, -1]
    column, row = np.rint(view.project(directions)).astype(int).T
    picture = frame.linear[row, column] * frame.luminance_per_unit * dimming
    got = capture.ambient_cd_m2[5][front]
    # Noise of the picture, one pixel aside at most.
    np.testing.assert_allclose(got.mean(axis=0), picture.mean(axis=0), rtol=0.02)
    assert np.corrcoef(got[:, 0], picture[:, 0])[0, 1] > 0.8
    np.testing.assert_array_equal(capture.reflected_cd_m2, 0)


def test_a_photographed_surface_answers_lamps_with_its_own_reflectance(tmp_path):
    sun = {"kind": "directional", "direction": [0, 0, -1], "illuminance_lux": 100.0,
           "shadow": False}  # fmt: skip
    loaded = photographed(tmp_path, lamp=[sun])
    capture, seen = taken(loaded, (0, 0, 0), size=32)
    wall = seen.valid & (seen.normal[..., 2] > 0.999)
    assert wall.sum() > 50
    # Half of E0 more: half of the photograph's light more.
    ratio = capture.reflected_cd_m2[wall] / capture.ambient_cd_m2[wall]
    np.testing.assert_allclose(ratio, 0.5, rtol=1e-2)


def test_what_no_photograph_saw_has_its_mean(tmp_path):
    loaded = photographed(tmp_path)
    setting = cube_setting(loaded, prepare(loaded))
    # Straight from the side, between ball and wall: much of what is seen was hidden.
    points = np.array([[0.0, 0.0, 5.0], [90.0, 0.0, -2.5]])
    shown = setting.lighting.photograph.at(points)
    assert not shown.seen.any()
    np.testing.assert_allclose(shown.luminance_cd_m2[0], setting.lighting.photograph.mean[:3])


def test_normals_alone_cannot_be_captured(tmp_path):
    from andon.files.pictures import write_png

    photographed(tmp_path)
    write_png(tmp_path / "normals.png", np.full((48, 64, 3), (128, 128, 0), np.uint8))
    loaded = photographed(tmp_path, surface={"normals": "normals.png"})
    with pytest.raises(InputError, match=r"surface\.normals: has no positions"):
        cube_setting(loaded, prepare(loaded))


def test_an_unknown_engine_is_refused(tmp_path):
    loaded = furnace(tmp_path, 0.5)
    setting = cube_setting(loaded, prepare(loaded, drawn=False))
    with pytest.raises(InputError, match="engine: must be auto, gpu or reference"):
        cube_engine(setting, 8, "cpu")


def test_no_rig_and_no_white_are_needed(tmp_path):
    loaded = lamp_room(tmp_path)
    assert loaded.rig is None
    assert prepare(loaded, drawn=False).frames == {}
    with pytest.raises(InputError):
        prepare(loaded)


def test_eight_bits_clip_and_quantise():
    light = np.array([[[0.0, 0.5, 1.0], [2.0, 0.1, 0.1]]]) * 300
    codes, clipped = quantised(light, 300.0)
    assert clipped == 1
    np.testing.assert_allclose(codes[0, 1, 0], 300)
    np.testing.assert_allclose(codes[0, 0], light[0, 0], rtol=1e-2)
    assert (codes != light).any()


def test_objects_are_seen_before_the_surface(tmp_path, engine):
    write_glb(tmp_path / "room.glb", block((4, 4, 4), (0, 0, 0), inwards=True), colour=(0,) * 3)
    write_glb(tmp_path / "lit.glb", block((1, 1, 1), (0, 0, 0)), colour=(0,) * 3,
              emissive=(1.0, 1.0, 1.0))  # fmt: skip
    loaded = scene_from_dict(
        {
            "surface": {"mesh": "room.glb"},
            "object": [{"mesh": "lit.glb", "position": [1.2, 0, 0]}],
            "probes": {"volume": "p.glb"},
        },
        folder=tmp_path,
    )
    capture, seen = taken(loaded, (-0.5, 0, 0), engine)
    assert capture.luminance_cd_m2[0, 7, 7].min() > 0
    np.testing.assert_allclose(seen.distance_m[0, 7:9, 7:9], 1.2, rtol=0.01)
    np.testing.assert_array_equal(capture.luminance_cd_m2[1], 0)


def test_things_that_move_are_not_seen_and_cast_no_shadow(tmp_path, engine):
    write_glb(tmp_path / "box.glb", block((0.8, 0.8, 0.8), (0, 0, 0)))
    box = {"mesh": "box.glb", "position": [0.5, 0.3, -0.5]}
    keys = [{"time_seconds": t, "position": [0.5, 0.3, -0.5]} for t in (0.0, 1.0)]
    alone, still, moving = (
        taken(lamp_room(tmp_path, object=objects), (-0.7, 0.6, 0.9), engine)[0].luminance_cd_m2
        for objects in ([], [box], [box | {"key": keys}])
    )
    np.testing.assert_array_equal(moving, alone)
    assert np.abs(still - alone).max() > 1
