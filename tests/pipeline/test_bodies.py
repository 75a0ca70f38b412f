"""Luminous bodies in the frame: seen, hidden and hiding, on both engines."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest

import andon
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.lamps import Shadow
from andon.pipeline import Renderer
from comparison import assert_agree, assert_same_picture
from worlds import ball, block, scene, write_glb, write_obj, write_relight_files

# A wall 2 m before the camera, which looks along −Z.
BALL = {
    "kind": "point", "name": "ball", "position": [0.1, 0.05, -1.3], "intensity_cd": 40.0,
    "shell": {"radius_m": 0.1, "transmittance": 0.5, "absorptance": 0.5},
}  # fmt: skip
PANEL = {
    "kind": "rectangle", "name": "panel", "position": [-0.4, 0.2, -1.4], "direction": [0.3, -1, 0],
    "width_m": 0.3, "height_m": 0.2, "luminance_cd_m2": 900.0, "temperature_k": 4000.0,
}  # fmt: skip


def test_bodies_on_both_engines(gpu, tmp_path):
    room = scene(tmp_path, lamp=[BALL, PANEL])
    expected, actual = (Renderer(room, name).render() for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.02, mean=1.0)
    assert_agree(
        actual.bodies.cd_m2, expected.bodies.cd_m2,
        rtol=3e-3, atol=1.0, share=0.02, what="bodies",
    )  # fmt: skip
    np.testing.assert_array_equal(
        (expected.bodies.cd_m2 > 0).any(axis=-1), expected.surface.body_id >= 0
    )
    assert (actual.surface.body_id == expected.surface.body_id).mean() > 0.99


def test_a_ball_has_the_luminance_that_its_transmittance_gives_it(engine, tmp_path):
    """L = t·I/(π r²), plus what the room's light makes of its paper."""
    frame = Renderer(scene(tmp_path, lamp=[BALL]), engine).render()
    ball = frame.surface.body_id == 0
    assert ball.sum() > 50
    expected = 0.5 * 40 / (np.pi * 0.1**2)
    alone = np.asarray(frame.bodies.cd_m2)
    np.testing.assert_allclose(alone[ball], expected, rtol=2e-3)
    assert not alone[~ball].any()


@pytest.mark.parametrize("mode", ["exact", "paper"])
def test_a_closed_ball_lights_like_a_point_of_its_own_light(engine, tmp_path, mode):
    """The paper's approximation and the sphere agree away from the horizon."""
    shelled = BALL | {"shell": BALL["shell"] | {"mode": mode}, "shadow": False}
    plain = {k: v for k, v in BALL.items() if k != "shell"} | {
        "intensity_cd": 20.0,
        "shadow": False,
    }
    frames = [Renderer(scene(tmp_path, lamp=[lamp]), engine).render() for lamp in (shelled, plain)]
    lux = [np.asarray(frame.illuminance.lux, float) for frame in frames]
    wall = (frames[0].surface.body_id < 0) & (frames[0].surface.depth > 1.9)
    assert_agree(lux[0][wall], lux[1][wall], rtol=5e-3, atol=1e-3, share=5e-3)


def test_a_body_hides_other_lamps_but_not_its_own(engine, tmp_path):
    far = {"kind": "point", "name": "far", "position": [0.1, 0.05, -0.2], "intensity_cd": 9.0}
    both = Renderer(scene(tmp_path, lamp=[far, BALL]), engine).render()
    alone = Renderer(scene(tmp_path, lamp=[far]), engine).render()
    own = Renderer(scene(tmp_path, lamp=[BALL]), engine).render()
    with_ball, without, ball = (np.asarray(f.illuminance.lux, float) for f in (both, alone, own))
    wall = (both.surface.body_id < 0) & both.surface.valid
    taken = (without + ball - with_ball)[..., 1] * wall
    # The wall behind the ball loses the far lamp's light, and nothing else does.
    assert taken.max() > 0.9 * without[..., 1][taken > 0.5 * taken.max()].max()
    assert 0.002 < (taken > 0.1 * taken.max()).mean() < 0.3
    assert taken.min() > -0.01 * without.max()


def test_nearer_things_hide_a_body(engine, tmp_path):
    write_obj(tmp_path / "screen.obj", block((0.1, 0.3, 0.02), (0, 0, 0)))
    screen = {"name": "screen", "mesh": "screen.obj", "position": [0.1, 0.04, -0.8]}
    open_, hidden = (
        Renderer(scene(tmp_path, lamp=[BALL], **more), engine).render()
        for more in ({}, {"object": [screen]})
    )
    pixels = [int((frame.surface.body_id == 0).sum()) for frame in (open_, hidden)]
    assert 0 < pixels[1] < 0.8 * pixels[0]
    lit = [(np.asarray(f.bodies.cd_m2) > 0).any(axis=-1).sum() for f in (open_, hidden)]
    assert lit == pixels


def test_a_moving_body_takes_its_light_and_its_shadow_along(engine, tmp_path):
    key = [
        {"time_seconds": 0.0, "position": [-0.3, 0.0, -1.3]},
        {"time_seconds": 1.0, "position": [0.3, 0.1, -1.3]},
    ]
    lamp = {"kind": "point", "name": "far", "position": [0, 0, -0.1], "intensity_cd": 9.0}
    room = scene(tmp_path, lamp=[BALL | {"key": key}, lamp])
    renderer = Renderer(room, engine)
    renderer.render(0.0)
    moved = renderer.render(1.0)
    there = {**BALL, "position": key[1]["position"]}
    fresh = Renderer(scene(tmp_path, lamp=[there, lamp]), engine).render()
    np.testing.assert_array_equal(moved.image.rgb, fresh.image.rgb)
    np.testing.assert_array_equal(moved.illuminance.lux, fresh.illuminance.lux)


def test_bodies_in_curved_views(engine, tmp_path):
    """A fisheye sees the ball where a pinhole does, with the same luminance."""
    room = prepare(scene(tmp_path, lamp=[BALL]))
    (name, frame), *_ = room.frames.items()
    view = replace(frame.view, projection="fisheye", fx=60.0, fy=60.0)
    model = replace(room.surface, depth={}, normals={}, real=room.surface.occluder.geometry)
    curved = replace(room, frames={name: replace(frame, view=view)}, surface=model)
    seen = Renderer(curved, engine).render()
    ball = seen.surface.body_id == 0
    assert ball.sum() > 5
    expected = 0.5 * 40 / (np.pi * 0.1**2)
    np.testing.assert_allclose(np.asarray(seen.bodies.cd_m2)[ball], expected, rtol=2e-3)


def test_the_glow_keeps_the_light_of_the_bodies(engine, tmp_path):
    glow = {"model": "glow", "glow_sigma_degrees": 1.0, "glow_fraction": 0.4}
    lit, plain = (
        Renderer(scene(tmp_path, lamp=[BALL], **more), engine).render()
        for more in ({"glare": glow}, {})
    )
    assert lit.glow is not None
    assert plain.glow is None
    change = np.asarray(lit.luminance.cd_m2, float) - np.asarray(plain.luminance.cd_m2, float)
    bodies = np.asarray(lit.bodies.cd_m2, float)
    assert abs(change.sum()) < 0.01 * bodies.sum()
    assert change[lit.surface.body_id == 0].min() < -0.05 * bodies.max()
    near = (change > 0) & (lit.surface.body_id < 0)[..., None]
    assert near.any()


def test_area_lamps_given_to_relight_are_seen(engine, tmp_path):
    photo, depth, view = write_relight_files(tmp_path)
    lamp = andon.SphereLamp("ball", np.full(3, 700.0), np.array([0.1, 0.05, -1.3]), 0.1,
                            shadow=Shadow(64, samples=4))  # fmt: skip
    frame = andon.relight(photo, view, [lamp], depth_m=depth, ambient_lux=300.0, engine=engine)
    assert (frame.surface.body_id == 0).sum() > 50
    np.testing.assert_allclose(frame.bodies.cd_m2[frame.surface.body_id == 0], 700.0, rtol=2e-3)
    behind = frame.surface.body_id < 0
    assert np.asarray(frame.illuminance.lux)[behind].max() > 5


# ── the light that was there ──────────────────────────────────────────────────────────────────

SOURCE = {"kind": "point", "name": "ceiling", "position": [0.0, 0.9, -0.9], "intensity_cd": 60.0}
BOX = {"name": "box", "mesh": "box.glb", "position": [0.0, 0.1, -1.5]}


def with_source(folder, **more):
    write_glb(folder / "box.glb", block((0.3, 0.3, 0.3), (0, 0, 0)))
    ambient = {"illuminance_lux": 120.0, "source": [SOURCE]} | more.pop("ambient", {})
    return scene(folder, ambient=ambient, **more)


def test_an_object_darkens_what_it_hides_of_the_rooms_own_light(engine, tmp_path):
    frame = Renderer(with_source(tmp_path, object=[BOX]), engine).render()
    lux = np.asarray(frame.illuminance.lux, float)
    real = frame.surface.valid & ~frame.surface.is_object
    dark = lux[..., 1] < -1
    assert 0.005 < (dark & real).mean() < 0.5
    # What is taken away is the source's own light there: never more, and nothing elsewhere.
    source = Renderer(scene(tmp_path, lamp=[SOURCE | {"shadow": False}]), engine).render()
    own = np.asarray(source.illuminance.lux, float)[..., 1]
    assert (lux[..., 1][real] >= -own[real] * 1.01 - 0.05).all()
    assert np.abs(lux[..., 1][real & ~dark]).max() < 1.0
    before = Renderer(scene(tmp_path, lamp=[]), engine).render()
    change = frame.image.rgb.astype(int) - before.image.rgb.astype(int)
    assert (change[dark & real] <= 0).all()
    assert change[dark & real].min() < -3


def test_nothing_virtual_nothing_changes(engine, tmp_path):
    plain = Renderer(with_source(tmp_path), engine).render()
    assert not np.asarray(plain.illuminance.lux).any()


def test_a_source_that_is_removed_takes_its_light_with_it(engine, tmp_path):
    removed = {"removed": ["ceiling"], "dimming": 0.5}
    frame = Renderer(with_source(tmp_path, ambient=removed), engine).render()
    lamp = Renderer(scene(tmp_path, lamp=[SOURCE]), engine).render()
    taken, given = (np.asarray(f.illuminance.lux, float) for f in (frame, lamp))
    assert_agree(taken, -0.5 * given, rtol=1e-5, atol=1e-5)


PANEL_SOURCE = {
    "kind": "rectangle", "name": "ceiling", "position": [0, 0.9, -1.2], "direction": [0, -1, 0],
    "up": [0, 0, 1], "width_m": 0.4, "height_m": 0.3, "luminance_cd_m2": 400.0,
}  # fmt: skip
SPOT = {"kind": "spot", "direction": [0, -1, -0.2], "outer_degrees": 40.0}
SOURCES = {
    "point": SOURCE,
    "rectangle": PANEL_SOURCE,
    "picture": PANEL_SOURCE | {"texture": "picture.png"},
    "mesh": {"kind": "mesh", "name": "ceiling", "mesh": "lantern.obj", "position": [0, 0.8, -1.2],
             "luminance_cd_m2": 300.0},
    "spot in a ball": SOURCE | SPOT | {"shell": {"radius_m": 0.1, "transmittance": 0.6}},
    "open shell": SOURCE | {"shell": {"mesh": "shade.obj", "transmittance": 0.5}},
}  # fmt: skip


@pytest.mark.parametrize("removed", [(), ("ceiling",)], ids=["kept", "removed"])
@pytest.mark.parametrize("kind", SOURCES)
def test_engines_agree_on_darkening(gpu, tmp_path, kind, removed):
    from andon.files.pictures import write_png

    codes = np.random.default_rng(1).integers(0, 256, (6, 8, 3), dtype=np.uint8)
    write_png(tmp_path / "picture.png", codes)
    write_obj(tmp_path / "lantern.obj", block((0.2, 0.2, 0.2), (0, 0, 0)))
    shade = block((0.2, 0.2, 0.2), (0, 0, 0))
    sides = np.abs(shade.positions[shade.triangles].mean(axis=1)[:, 1]) < 0.05
    write_obj(tmp_path / "shade.obj", replace(shade, triangles=shade.triangles[sides]))
    ambient = {"source": [SOURCES[kind]], "removed": list(removed)}
    room = with_source(tmp_path, object=[BOX], lamp=[BALL], ambient=ambient)
    expected, actual = (Renderer(room, name).render() for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.03, mean=1.0)
    truth, ours = (np.asarray(f.illuminance.lux, float) for f in (expected, actual))
    error = np.abs(ours - truth)
    assert np.percentile(error, 95) < 0.02 * np.abs(truth).max()
    assert np.isfinite(truth).all()
    assert (truth.min() < -0.1 * truth.max()) == bool(removed) or kind != "point"


def test_a_lamp_that_is_part_of_the_room_is_removed_though_its_own_glass_is_in_the_way(
    engine, tmp_path
):
    bulb = {"kind": "sphere", "name": "ceiling", "position": [0.0, 0.4, -1.4], "radius_m": 0.08,
            "luminance_cd_m2": 900.0}  # fmt: skip
    from andon.files.meshes import read_mesh

    walls = block((3.0, 2.4, 3.4), (0, 0, 0), inwards=True)
    write_obj(tmp_path / "bare.obj", walls)
    glass = ball(0.08, bulb["position"])
    whole = replace(
        walls,
        positions=np.concatenate([walls.positions, glass.positions]),
        triangles=np.concatenate([walls.triangles, glass.triangles + len(walls.positions)]),
    )
    write_obj(tmp_path / "glazed.obj", whole)
    assert len(read_mesh(tmp_path / "glazed.obj").geometry.triangles) > len(walls.triangles)
    taken = []
    for mesh in ("bare.obj", "glazed.obj"):
        ambient = {"illuminance_lux": 120.0, "source": [bulb], "removed": ["ceiling"]}
        room = scene(tmp_path, ambient=ambient, surface={"mesh": mesh})
        frame = Renderer(room, engine).render()
        taken.append(np.asarray(frame.illuminance.lux, float))
    wall = frame.surface.valid & (np.abs(taken[0] - taken[1]).max(axis=-1) >= 0)
    wall &= np.linalg.norm(frame.surface.position - bulb["position"], axis=-1) > 0.3
    np.testing.assert_allclose(taken[1][wall].mean(), taken[0][wall].mean(), rtol=0.03)
    assert taken[0][wall].mean() < -3


def test_paper_dimming_of_sources_is_refused(tmp_path):
    ambient = {"removed": ["ceiling"], "dimming": 0.3, "dimming_mode": "paper"}
    with pytest.raises(InputError, match="dimming_mode"):
        Renderer(with_source(tmp_path, ambient=ambient), "reference")


def with_a_light(path):
    """Adds a point light of 50 cd to a .glb file."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    document["extensionsUsed"] = ["KHR_lights_punctual"]
    lights = [{"type": "point", "intensity": 50}]
    document["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    node = {"name": "bulb", "translation": [0, 0.3, 0.5]}
    document["nodes"].append(node | {"extensions": {"KHR_lights_punctual": {"light": 0}}})
    document["scenes"][0]["nodes"].append(len(document["nodes"]) - 1)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    header = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    path.write_bytes(header + text + rest)


def test_lights_of_a_gltf_file_reach_the_frame(engine, tmp_path):
    write_glb(tmp_path / "box.glb", block((0.3, 0.3, 0.3), (0, 0, 0)))
    with_a_light(tmp_path / "box.glb")
    room = scene(tmp_path, object=[BOX | {"lamps": True}], lamp=[])
    frame = Renderer(room, engine).render()
    assert np.asarray(frame.illuminance.lux).max() > 1
