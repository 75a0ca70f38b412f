"""Objects that move through whole frames: both engines, their shadows, lamps of E0, two eyes."""

import shutil

import numpy as np
import pytest

from andon.files.pictures import write_png
from andon.pipeline import Renderer
from andon.scene import scene_from_dict
from andon.spaces import look_at
from andon.verify.edges import near_change
from comparison import assert_agree
from worlds import block, write_glb, write_obj

WIDTH, HEIGHT = 160, 120
# Codes that the engines may differ by, and the share of pixels that may differ more.
CODES, SHARE = 5, 1e-3
# Left out around outlines and shadows' edges, pixels.
EDGE_PX = 2

LAMP = {"kind": "point", "name": "lamp", "position": [0.2, 2.7, 0.1], "flux_lm": 2000.0}
DOWN = look_at(np.array([0.0, 2.9, 0.01]), np.array([0.0, 0.0, 0.0])).tolist()
ASIDE = look_at(np.array([1.5, 1.3, 1.9]), np.array([-0.1, 0.7, -0.1])).tolist()

NEAR = look_at(np.array([0.4, 1.0, 0.3]), np.array([-0.7, 0.7, -0.7])).tolist()


def room(folder, objects, *, camera=None, pose=ASIDE, **tables):
    """A scene in a closed room of 5 × 3 × 5 m with one lamp."""
    write_obj(folder / "room.obj", block((5, 3, 5), (0, 1.5, 0), inwards=True))
    write_png(folder / "photo.png", np.full((HEIGHT, WIDTH, 3), 150, np.uint8))
    camera = {"fx": 130.0} if camera is None else camera
    base = {
        "rig": {"camera": {**camera, "world_from_camera": pose}},
        "capture": {"source": "photo.png"},
        "surface": {"mesh": "room.obj", "reflectance": 0.6},
        "ambient": {"illuminance_lux": 100.0, "dimming": 0.3},
        "lamp": [LAMP],
        "object": objects,
    }
    return scene_from_dict(base | tables, folder=folder)


def walking(folder, data_dir):
    """A walking figure that keyframes carry through the room."""
    shutil.copy(data_dir / "gltf_models" / "CesiumMan.glb", folder / "man.glb")
    keys = [{"time_seconds": 0.0, "position": [-0.9, 0, -0.9]},
            {"time_seconds": 2.0, "position": [0.3, 0, 0.3]}]  # fmt: skip
    half = np.radians(45) / 2
    turn = [0.0, float(np.sin(half)), 0.0, float(np.cos(half))]
    return {"mesh": "man.glb", "animation": "0", "rotation_xyzw": turn, "key": keys}


def sliding(folder, **table):
    """A slab at 1 m of height that slides along x by 1 m a second."""
    write_glb(folder / "slab.glb", block((0.5, 0.02, 0.5), (0, 0, 0)))
    keys = [{"time_seconds": float(t), "position": [t - 0.5, 1.0, 0.0]} for t in (0, 1)]
    return {"mesh": "slab.glb", "key": keys, **table}


def assert_engines_agree(scene, times):
    fast, slow = Renderer(scene, "gpu"), Renderer(scene, "reference")
    for name in fast.view_names:
        for time in times:
            a, b = fast.render(time, name), slow.render(time, name)
            own = b.surface.material_id * b.surface.is_object + b.surface.is_object
            lit = b.illuminance.lux.max(axis=-1)
            dark = lit < 0.35 * np.median(lit)
            edges = near_change(own, EDGE_PX) | near_change(dark, EDGE_PX + 2)
            edges |= near_change(np.rint(b.surface.normal * 2).sum(axis=-1), EDGE_PX)
            codes = np.abs(a.image.rgb.astype(int) - b.image.rgb).max(axis=-1)
            assert (own > 0).sum() > 100, "it is seen"
            assert edges.mean() < 0.5, "most is compared"
            failing = (codes > CODES)[~edges].mean()
            assert failing <= SHARE, f"{name}, {time} s: {failing:.3%} differ"


def test_both_engines_draw_the_same_walk(gpu, tmp_path, data_dir):
    assert_engines_agree(room(tmp_path, [walking(tmp_path, data_dir)]), (0.0, 0.7, 1.6))


@pytest.mark.parametrize("projection", ["fisheye", "latlong"])
def test_curved_projections(gpu, tmp_path, data_dir, projection):
    camera = {"projection": projection} | ({"fx": 70.0} if projection == "fisheye" else {})
    man = walking(tmp_path, data_dir)
    assert_engines_agree(room(tmp_path, [man], camera=camera, pose=NEAR), (0.0, 0.7))


def test_two_eyes_see_one_moment(gpu, tmp_path, data_dir):
    """Each from its own place; positions on the figure are the same points of the world."""
    poses = [np.array(ASIDE) for _ in range(2)]
    poses[1][:3, 3] += 0.065 * poses[1][:3, 0]
    eyes = [{"fx": 130.0, "world_from_camera": pose.tolist()} for pose in poses]
    made = room(
        tmp_path,
        [walking(tmp_path, data_dir)],
        rig={"kind": "stereo", "left": eyes[0], "right": eyes[1]},
        capture={"source": {"left": "photo.png", "right": "photo2.png"}},
    )
    shutil.copy(tmp_path / "photo.png", tmp_path / "photo2.png")
    assert_engines_agree(made, (0.7,))
    renderer = Renderer(made, "gpu")
    first = renderer.render(0.7, "left")
    second = renderer.render(0.7, "right")
    assert second.report.maps_redrawn == 0, "the shadow maps are shared"
    left, right = (f.surface.position[f.surface.is_object] for f in (first, second))
    assert_agree(left.mean(axis=0), right.mean(axis=0), atol=0.02)
    assert (first.surface.is_object != second.surface.is_object).any()


# ── shadows ───────────────────────────────────────────────────────────────────────────────────


def shadow_on_floor(frame):
    """(n, 3) points of the floor that the lamp does not reach."""
    position = frame.surface.position
    floor = np.abs(position[..., 1]) < 1e-3
    dark = np.asarray(frame.illuminance.lux).max(axis=-1) < 1e-6
    return position[floor & dark & ~frame.surface.is_object]


@pytest.mark.parametrize("seconds", [0.0, 0.35, 1.0])
def test_shadows_move_along(tmp_path, engine, seconds):
    """From a lamp 2.7 m high the shadow of a slab at 1 m is 2.7/1.7 times as large and as far."""
    scene = room(tmp_path, [sliding(tmp_path)], pose=DOWN, camera={"fx": 70.0})
    found = shadow_on_floor(Renderer(scene, engine).render(seconds))
    lamp, grown = np.array(LAMP["position"]), 2.7 / 1.7
    pixel = 2.9 / 70
    for axis, at in ((0, seconds - 0.5), (2, 0.0)):
        low, high = (lamp[axis] + grown * (at + side - lamp[axis]) for side in (-0.25, 0.25))
        # What the slab itself hides of its shadow, seen from above, leaves at least one end.
        ends = (found[:, axis].min() - low, found[:, axis].max() - high)
        assert min(abs(end) for end in ends) < 2 * pixel
        assert ends[0] > -2 * pixel
        assert ends[1] < 2 * pixel


def test_maps_are_redrawn_when_and_only_when_something_moved(gpu, tmp_path):
    still = {"mesh": "slab.glb", "position": [1.5, 1.0, 1.0]}
    scene = room(tmp_path, [sliding(tmp_path), still])
    renderer = Renderer(scene, "gpu")
    redrawn = []
    for time in (0.0, 0.2, 0.2, 5.0, 6.0, 0.2):  # after its last key it stands
        renderer.draw(time)
        redrawn.append(renderer._engine.maps_redrawn)
    assert redrawn == [1, 1, 0, 1, 0, 1]


def test_an_object_without_a_shadow_casts_none(tmp_path, engine):
    scene = room(tmp_path, [sliding(tmp_path, casts_shadow=False)], pose=DOWN)
    renderer = Renderer(scene, engine)
    frame = renderer.render(0.5)
    assert frame.surface.is_object.any()
    assert len(shadow_on_floor(frame)) == 0


def test_a_mover_shades_itself_and_others(tmp_path, engine):
    """A box that stands still goes dark while the slab is over it."""
    write_glb(tmp_path / "box.glb", block((0.2, 0.2, 0.2), (0, 0, 0)))
    box = {"mesh": "box.glb", "position": [0.0, 0.3, 0.0]}
    lamp = {**LAMP, "position": [0.0, 2.7, 0.0]}
    scene = room(tmp_path, [sliding(tmp_path), box], lamp=[lamp])
    renderer = Renderer(scene, engine)
    top = {}
    for seconds in (0.5, 1.0):
        frame = renderer.render(seconds)
        own = frame.surface.is_object & (frame.surface.material_id == 0)
        upward = own & (frame.surface.normal[..., 1] > 0.9)
        assert upward.sum() > 10
        top[seconds] = np.asarray(frame.illuminance.lux)[upward].max()
    assert top[0.5] < 1e-6
    assert top[1.0] == pytest.approx(2000 / (4 * np.pi) / 2.3**2, rel=1e-2)


def test_movers_hide_known_lamps_of_the_photograph(tmp_path, engine):
    """The lamp is in the photograph: the slab takes its light away, and nothing else changes."""
    ambient = {"illuminance_lux": 100.0, "source": [LAMP]}
    scene = room(tmp_path, [sliding(tmp_path)], ambient=ambient, lamp=[], pose=DOWN)
    renderer = Renderer(scene, engine)
    for seconds in (0.0, 1.0):
        frame = renderer.render(seconds)
        lux = np.asarray(frame.illuminance.lux).max(axis=-1)
        real = ~frame.surface.is_object
        taken = real & (lux < -5)
        assert 50 < taken.sum() < 0.5 * real.sum()
        assert np.abs(lux[real & ~near_change(taken, 3) & ~taken]).max() < 0.5
        side = frame.surface.position[taken][:, 0].mean()
        assert (side < 0) == (seconds == 0.0)


def test_notes_find_movers_that_nobody_sees(tmp_path):
    from andon.cli.notes import notes_on

    objects = [sliding(tmp_path, name="slab"), {"mesh": "slab.glb", "name": "still"}]
    objects[1]["position"] = [0.0, 1.0, 9.0]
    scene = room(tmp_path, objects)
    renderer = Renderer(scene, "reference")
    notes = notes_on(renderer.render(0.5), renderer.prepared, 0.5)
    assert sum("covers no pixel" in line for line in notes) == 1
    assert any("the object 'still' covers no pixel" in line for line in notes)
    key = {"time_seconds": 1.0, "position": [0.0, 1.0, 30.0]}
    away = room(tmp_path, [{**objects[0], "key": [*objects[0]["key"][:1], key]}])
    renderer = Renderer(away, "reference")
    notes = notes_on(renderer.render(1.0), renderer.prepared, 1.0)
    assert any("the object 'slab' covers no pixel: it stands around (0.00, 1.00, 30.00)" in line
               for line in notes)  # fmt: skip


def test_smooth_objects_do_not_shade_themselves_falsely(gpu, tmp_path, data_dir):
    """Where a shadow map's texel shows the next triangle; 10 % went dark with a lift of 0.2 mm."""
    lamp = {**LAMP, "position": [1.2, 2.4, 1.2]}
    scene = room(tmp_path, [walking(tmp_path, data_dir)], pose=NEAR, lamp=[lamp])
    fast, slow = (Renderer(scene, name).render(1.4) for name in ("gpu", "reference"))
    lit, expected = (np.asarray(f.illuminance.lux).max(axis=-1) for f in (fast, slow))
    own = slow.surface.is_object & fast.surface.is_object & (expected > 5)
    assert own.sum() > 300
    assert (lit < 0.5 * expected)[own].mean() < 0.01
