"""Objects that move: when what plays, where keyframes put it, and whose pixels are whose."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.quantities import Material
from andon.scene.keyframes import object_at
from andon.scene.objects import SceneObject
from andon.spaces import View, look_at, transform_points
from andon.surface import reference
from andon.surface.load import load_surface
from andon.surface.objects import object_geometry
from andon.surface.stage import SurfaceStage
from animations import TRIANGLE, bending_arm, moving_triangle
from comparison import assert_agree
from worlds import block, scene, write_glb, write_obj

HALF = np.sqrt(0.5)
POSE = look_at(np.array([0.4, 0.6, 2.0]), np.array([0.3, 0.3, 0.0]))
PINHOLE = View("pinhole", 96, 72, 90.0, 88.0, 46.0, 36.5, world_from_camera=POSE)
FISHEYE = View("fisheye", 96, 72, 60.0, 61.0, 47.0, 35.0, world_from_camera=POSE)
SLIDE = (0, "translation", [0, 1], [(0, 0, 0), (1, 0, 0)], "LINEAR")


def objects(folder, *tables):
    """The model of objects before a mesh far behind them."""
    write_obj(folder / "wall.obj", block((20, 20, 1), (0, 0, -9)))
    made = scene(folder, surface={"mesh": "wall.obj"}, object=list(tables))
    return load_surface(made, {"mono": PINHOLE}), made


def corner(folder, seconds, **table):
    """x of the triangle's first corner, which an animation moves from 0 to 1 m in 1 s."""
    moving_triangle(SLIDE, name="slide").write(folder / "a.glb")
    _, made = objects(folder, {"mesh": "a.glb", "animation": "slide", **table})
    return float(object_geometry(made, 0, seconds).positions[0, 0])


# ── when what plays ───────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("table", "times"),
    [
        ({}, {0: 0, 0.25: 0.25, 1.25: 0.25, 7.5: 0.5, -3: 0}),
        ({"loop": False}, {0.25: 0.25, 1: 1, 7.5: 1, -3: 0}),
        ({"animation_start_seconds": 2.0}, {0: 0, 2: 0, 2.75: 0.75, 3.25: 0.25}),
        ({"animation_speed": 0.5}, {0.5: 0.25, 1: 0.5, 2.5: 0.25}),
        ({"animation_speed": 0.0}, {0: 0, 5.3: 0}),
        ({"animation_speed": -1.0}, {0.25: 0.75, 1.25: 0.75}),
        ({"animation_speed": -1.0, "animation_start_seconds": 2.0}, {0: 1, 2: 1, 2.25: 0.75}),
        ({"animation_speed": -1.0, "loop": False}, {0: 1, 0.25: 0.75, 4: 0}),
    ],
)
def test_when_the_animation_plays(tmp_path, table, times):
    for seconds, expected in times.items():
        assert corner(tmp_path, seconds, **table) == pytest.approx(expected, abs=1e-9), seconds


def test_an_animation_that_the_file_has_not(tmp_path):
    with pytest.raises(InputError, match=r"object\[0\]\.animation: there is no animation 'slid'"):
        corner(tmp_path, 0, animation="slid")
    write_obj(tmp_path / "b.obj", block((1, 1, 1), (0, 0, 0)))
    with pytest.raises(InputError, match=r"b\.obj: only glTF files have animations"):
        objects(tmp_path, {"mesh": "b.obj", "animation": "0"})


def test_what_could_play_and_does_not_is_said(tmp_path):
    moving_triangle(SLIDE).write(tmp_path / "a.glb")
    still, _ = objects(tmp_path, {"mesh": "a.glb"})
    assert len(still.notes) == 1
    assert 'animation = "0" plays the first' in still.notes[0]
    playing, _ = objects(tmp_path, {"mesh": "a.glb", "animation": "0"})
    assert playing.notes == ()


# ── keyframes ─────────────────────────────────────────────────────────────────────────────────

KEYS = [
    {"time_seconds": 1.0, "position": (1, 0, 0), "rotation_xyzw": (0, 0, 0, 1)},
    {"time_seconds": 2.0, "position": (3, 4, 0)},
    {"time_seconds": 3.0, "rotation_xyzw": (0, 0, HALF, HALF)},
]


@pytest.mark.parametrize(
    ("seconds", "position", "degrees"),
    [
        (0, (1, 0, 0), 0),
        (1.5, (2, 2, 0), 22.5),
        (2, (3, 4, 0), 45),
        (2.5, (3, 4, 0), 67.5),
        (9, (3, 4, 0), 90),
    ],
)
def test_between_keys(seconds, position, degrees):
    """Position and rotation each run through the keys that set them."""
    entry = SceneObject(mesh="a.glb", scale=2.0, key=tuple(KEYS))
    angle = np.radians(degrees)
    world = object_at(entry, seconds)
    assert_agree(world[:3, 3], position, atol=1e-12)
    c, s = 2 * np.cos(angle), 2 * np.sin(angle)
    assert_agree(world[:3, :3], [[c, -s, 0], [s, c, 0], [0, 0, 2]], atol=1e-9)


def test_what_no_key_states_is_the_objects_own():
    own = {"position": (7, 8, 9), "rotation_xyzw": (0, 0, HALF, HALF)}
    turning = SceneObject(mesh="a.glb", **own, key=({**KEYS[2], "time_seconds": 0.0},))
    assert_agree(object_at(turning, 1.0)[:3, 3], [7, 8, 9])
    sliding = SceneObject(mesh="a.glb", **own, key=({**KEYS[1], "time_seconds": 0.0},))
    assert_agree(object_at(sliding, 1.0)[:3, 0], [0, 1, 0], atol=1e-12)
    with pytest.raises(InputError, match="time_seconds: must be finite"):
        object_at(sliding, np.inf)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"key": [{"time_seconds": 0.0}]}, "needs position or rotation_xyzw"),
        ({"key": [KEYS[0], KEYS[0]]}, "must be later than the key before"),
        ({"key": KEYS[:1], "transform": np.eye(4).tolist()}, "excludes keyframes"),
    ],
)
def test_keys_that_are_refused(tmp_path, table, message):
    with pytest.raises(InputError, match=message):
        scene(tmp_path, object=[{"mesh": "a.glb", **table}])


def test_keys_carry_what_plays(tmp_path):
    """The clip moves the triangle in its own frame, keyframes that frame."""
    keys = [{"time_seconds": 0, "position": (0, 0, 0)}, {"time_seconds": 1, "position": (0, 0, 4)}]
    moving_triangle(SLIDE).write(tmp_path / "a.glb")
    table = {"mesh": "a.glb", "animation": "0", "key": keys, "scale": 3.0}
    _, made = objects(tmp_path, table)
    found = object_geometry(made, 0, 0.5)
    assert_agree(found.positions, 3 * (TRIANGLE + np.array([0.5, 0, 0])) + [0, 0, 2], atol=1e-9)


def test_what_stands_still_is_the_same_object(tmp_path):
    builder = moving_triangle(SLIDE)
    builder.write(tmp_path / "a.glb")
    model, _ = objects(tmp_path, {"mesh": "a.glb", "animation": "0", "loop": False})
    (mover,) = model.movers
    assert mover.at(0.5) is mover.at(0.5)
    assert mover.at(0.5) is not mover.at(0.6)
    assert mover.at(4) is mover.at(5), "held after its end"
    assert mover.at(0.5).triangles is mover.at(0.9).triangles


# ── whose pixels are whose ────────────────────────────────────────────────────────────────────


def three_objects(folder):
    """A box that moves stands between two that do not in the scene file."""
    for name, colour in (("a", (0.9, 0.1, 0.1)), ("b", (0.1, 0.9, 0.1)), ("c", (0.1, 0.1, 0.9))):
        box = block((0.3, 0.3, 0.3), (0, 0, 0))
        write_glb(folder / f"{name}.glb", box, colour=colour, emissive=tuple(x / 2 for x in colour))
    keys = [
        {"time_seconds": 0, "position": (0.2, 0.3, 0.4)},
        {"time_seconds": 1, "position": (0.9, 0.3, 0.4)},
    ]
    tables = [
        {"mesh": "a.glb", "name": "a", "position": (-0.3, 0.3, 0), "lit_by_lamps": False},
        {"mesh": "b.glb", "name": "b", "key": keys, "lit_by_probes": False},
        {"mesh": "c.glb", "name": "c", "position": (0.9, 0.3, 0)},
    ]
    return objects(folder, *tables)


def test_the_table_has_the_moving_last(tmp_path):
    model, _ = three_objects(tmp_path)
    rows = [(x.name, x.first_slot, x.slots, x.triangles) for x in model.objects_table]
    assert rows == [("a", 0, 1, 12), ("c", 1, 1, 12), ("b", 2, 1, 12)]
    assert [x.lit_by_lamps for x in model.objects_table] == [False, True, True]
    assert [x.lit_by_probes for x in model.objects_table] == [True, True, False]
    assert [x.name for x in model.moving_table] == ["b"]
    assert_agree(model.emitted_cd_m2 / model.emitted_cd_m2.max(), np.array(
        [[0.9, 0.1, 0.1], [0.1, 0.1, 0.9], [0.1, 0.9, 0.1]]) / 0.9, atol=1e-6)  # fmt: skip


def test_middles_follow(tmp_path):
    from andon.engines.prepared import prepare

    _, made = three_objects(tmp_path)
    prepared = prepare(made)
    expected = [(-0.3, 0.3, 0), (0.9, 0.3, 0), (0.55, 0.3, 0.4)]
    assert_agree(prepared.at(0.5).object_middles, expected, atol=1e-7)
    expected[2] = (0.9, 0.3, 0.4)
    assert_agree(prepared.at(2).object_middles, expected, atol=1e-7)


@pytest.mark.parametrize("view", [PINHOLE, FISHEYE], ids=lambda view: view.projection)
def test_both_engines_see_the_same_movers(gpu, tmp_path, view):
    """Slots, emission, normals, depth and reflectance, at two times from one stage."""
    builder, _, _ = bending_arm()
    builder.write(tmp_path / "arm.glb")
    _, made = three_objects(tmp_path)
    arm = {"mesh": "arm.glb", "animation": "bend", "loop": False, "scale": 0.4,
           "position": (-0.4, 0.0, 0.5)}  # fmt: skip
    tables = [*(entry.model_dump(exclude_unset=True) for entry in made.object), arm]
    model, _ = objects(tmp_path, *tables)
    moved = [tuple(mover.at(t) for mover in model.movers) for t in (0.0, 0.7)]
    stage = SurfaceStage(gpu, model, view, (), moved[0])
    still = reference.see(model, view)
    seen = []
    for movers in (*moved, moved[0]):
        expected = reference.with_movers(still, model, movers)
        encoder = gpu.device.create_command_encoder()
        surface = stage.encode(encoder, (), movers)
        gpu.device.queue.submit([encoder.finish()])
        actual = surface.read()
        differ = actual.material_id != expected.material_id
        assert differ.mean() < 0.004, "outlines only"
        both = actual.valid & expected.valid & ~differ
        for name in ("normal", "reflectance", "emitted_cd_m2"):
            found, wanted = getattr(actual, name)[both], getattr(expected, name)[both]
            if name == "emitted_cd_m2":
                wanted = np.where(expected.is_object[both][:, None], wanted, 0)
            assert_agree(found, wanted, atol=0.005, share=0.004, what=name)
        assert_agree(actual.depth[both], expected.depth[both], rtol=1e-4, share=0.004)
        counts = np.bincount(expected.material_id[expected.is_object], minlength=4)
        assert (counts > 20).all(), "all four are seen"
        seen.append(actual.material_id)
    assert (seen[0] != seen[1]).mean() > 0.01
    assert (seen[0] == seen[2]).all(), "back again"


def test_a_mirrored_object_faces_outwards(tmp_path):
    builder, _, _ = bending_arm()
    builder.write(tmp_path / "arm.glb")
    mirror = np.diag([-1.0, 1, 1, 1])
    table = {"mesh": "arm.glb", "animation": "bend", "transform": mirror.tolist()}
    model, made = objects(tmp_path, table)
    plain, _ = objects(tmp_path, {"mesh": "arm.glb", "animation": "bend"})
    found, straight = model.movers[0].at(0.4), plain.movers[0].at(0.4)
    assert_agree(found.positions, transform_points(mirror, straight.positions), atol=1e-12)
    a, b, c = (found.positions[found.triangles[:, i]] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] * found.normals[found.triangles[:, 0], 2] > 0).all()
    assert isinstance(found.materials[0], Material)
    assert_agree(object_geometry(made, 0, 0.4).positions, found.positions)
