"""Light of probes is drawn anew only where something moved, and the picture is the same as if it
were all drawn."""

import numpy as np
import pytest

from andon.engines.changes import Changes, joined
from andon.files.pictures import write_png
from andon.files.volumes import write_volume
from andon.pipeline import Renderer
from andon.quantities import Geometry
from andon.scene import scene_from_dict
from andon.spaces import View, look_at
from andon.transport.probes.stage import ProbePicture
from probes.volumes import POSITIONS, random_volume
from worlds import block, write_glb, write_obj

WIDTH, HEIGHT = 160, 120
POSE = look_at(np.array([1.5, 1.4, 1.9]), np.array([-0.2, 0.8, -0.2]))
WHOLE = [(0, 0, WIDTH, HEIGHT)]


def moving(x, z, seconds):
    return [
        {"time_seconds": float(t), "position": [x + 0.8 * t, 1.0, z - 0.5 * t]} for t in seconds
    ]


def room(folder, *, virtual=True, lookup="pixel", eyes=1, projection="pinhole"):
    """A box that stands, another that moves past it, and a glowing ball that flies along.

    In the light of probes: all of it, or but for the room, of which there is a photograph. A dark
    slab that takes no light of probes moves, too.
    """
    write_obj(folder / "room.obj", block((5, 3, 5), (0, 1.5, 0), inwards=True))
    write_glb(folder / "box.glb", block((0.5, 0.8, 0.5), (0, 0, 0)))
    write_glb(folder / "column.glb", block((0.2, 0.7, 0.3), (0, 0, 0)))
    write_glb(folder / "slab.glb", block((0.6, 0.1, 0.2), (0, 0, 0)))
    shifts = POSITIONS["lattice"] - [1.5, 0.0, 1.5]
    write_volume(folder / "light.glb", random_volume(shifts))
    camera = {"width": WIDTH, "height": HEIGHT, "fx": 90.0, "projection": projection}
    poses = [POSE.copy() for _ in range(eyes)]
    poses[-1][:3, 3] += 0.065 * (eyes - 1) * POSE[:3, 0]
    cameras = [{**camera, "world_from_camera": pose.tolist()} for pose in poses]
    rig = {"camera": cameras[0]} if eyes == 1 else {
        "kind": "stereo", "left": cameras[0], "right": cameras[1]}  # fmt: skip
    tables = {
        "rig": rig,
        "surface": {"mesh": "room.obj", "reflectance": 0.6},
        "probes": {"volume": "light.glb", "lookup": lookup},
        "object": [
            {"mesh": "box.glb", "position": [-0.3, 0.7, -0.3]},
            {"mesh": "column.glb", "key": moving(-0.9, 0.4, (0, 1, 2))},
            {"mesh": "slab.glb", "key": moving(-0.5, 0.1, (0, 1)), "lit_by_probes": False},
        ],
        "lamp": [
            {"kind": "sphere", "name": "ball", "radius_m": 0.15, "luminance_cd_m2": 200.0,
             "position": [-0.9, 1.2, 0.9], "key": moving(-0.6, 0.7, (0, 1))},
        ],
    }  # fmt: skip
    if virtual:
        tables["capture"] = {"luminance_per_unit": 300.0}
        tables["ambient"] = {"illuminance_lux": 5.0}
    else:
        names = ("photo.png", "photo2.png")[:eyes]
        for name in names:
            write_png(folder / name, np.full((HEIGHT, WIDTH, 3), 150, np.uint8))
        source = names[0] if eyes == 1 else dict(zip(("left", "right"), names, strict=True))
        tables["capture"] = {"source": source}
        tables["ambient"] = {"illuminance_lux": 100.0}
    return scene_from_dict(tables, folder=folder)


def assert_as_drawn_at_once(scene, moments):
    """Frames of one renderer, in that order, against those of renderers that draw nothing else."""
    renderer = Renderer(scene, "gpu")
    seen = []
    for time, view in moments:
        found = renderer.render(time, view)
        alone = Renderer(renderer.prepared, "gpu").render(time, view)
        np.testing.assert_array_equal(found.luminance.cd_m2, alone.luminance.cd_m2)
        np.testing.assert_array_equal(found.image.rgb, alone.image.rgb)
        assert (found.surface.body_id >= 0).sum() > 20, "the ball is seen"
        own = found.surface.is_object & (found.surface.body_id < 0)
        assert own.sum() > 200, "so are the objects"
        seen.append(found.image.rgb)
    assert (seen[0] != seen[1]).any(), "something moves"


TIMES = [(time, None) for time in (0.0, 0.3, 0.9, 0.9, 1.6, 0.1)]


@pytest.mark.parametrize("lookup", ["pixel", "object"])
@pytest.mark.parametrize("virtual", [True, False], ids=["virtual", "photograph"])
def test_a_frame_after_movement_is_that_of_a_new_renderer(gpu, tmp_path, virtual, lookup):
    assert_as_drawn_at_once(room(tmp_path, virtual=virtual, lookup=lookup), TIMES)


def test_each_eye_keeps_its_own_picture(gpu, tmp_path):
    moments = [(0.0, "left"), (0.5, "left"), (0.5, "right"), (0.9, "right"), (1.6, "left")]
    assert_as_drawn_at_once(room(tmp_path, virtual=False, eyes=2, lookup="object"), moments)


def test_curved_projections(gpu, tmp_path):
    assert_as_drawn_at_once(room(tmp_path, projection="fisheye"), TIMES[:3])


def drawn_rectangles(monkeypatch, scene, times):
    """What each frame draws."""
    found, encode = [], ProbePicture.encode

    def noted(self, encoder, rectangles):
        found.append(list(rectangles))
        encode(self, encoder, rectangles)

    monkeypatch.setattr(ProbePicture, "encode", noted)
    renderer = Renderer(scene, "gpu")
    for time in times:
        renderer.draw(time)
    return found


def test_only_what_moved_is_drawn(gpu, tmp_path, monkeypatch):
    """At 0.9 s all move, at 1.6 s the column alone, at 2 s and later nothing does."""
    frames = drawn_rectangles(monkeypatch, room(tmp_path), (0.0, 0.8, 1.0, 1.05, 2.0, 2.0, 3.0))
    areas = [sum(w * h for _, _, w, h in rectangles) for rectangles in frames]
    assert frames[0] == WHOLE, "the room is all around"
    assert 0 < areas[3] < areas[2] < 0.5 * areas[0]
    assert frames[5:] == [[], []]


def test_curved_projections_draw_all_of_it(gpu, tmp_path, monkeypatch):
    scene = room(tmp_path, projection="fisheye")
    assert drawn_rectangles(monkeypatch, scene, (0.0, 0.3, 3.0, 3.0)) == [WHOLE, WHOLE, WHOLE, []]


# ── rectangles ────────────────────────────────────────────────────────────────────────────────

VIEW = View("pinhole", 100, 80, 50.0, 50.0, 49.5, 39.5, world_from_camera=np.eye(4))


def card(x, z=5.0, normals=None):
    """A square of 10 × 10 pixels, whose left edge stands at x pixels beside the middle."""
    # One vertex of the file is in no triangle, and behind the camera.
    positions = np.array([[0, 0, z], [1, 0, z], [1, 1, z], [0, 1, z], [0, 0, -9.0]])
    positions[:, 0] += x / 10
    return Geometry(positions, np.array([[0, 1, 2], [0, 2, 3]], np.int32), normals=normals)


def holds(rectangle, x):
    """The card at x, and not much more."""
    left, top, width, height = rectangle
    assert left <= 49.5 + x - 1 < left + 4
    assert 49.5 + x + 10 <= left + width <= 49.5 + x + 15
    return 12 <= width <= 16 and 12 <= height <= 16 and top > 30


def test_where_it_was_and_where_it_is():
    changes = Changes(VIEW, [])
    assert holds(*changes.since_last([card(-40)]), -40)
    was, now = changes.since_last([card(20)])
    assert holds(was, -40)
    assert holds(now, 20)
    assert changes.since_last([card(20)]) == []


def test_a_normal_that_turns_is_a_change():
    changes = Changes(VIEW, [])
    changes.since_last([card(0, normals=np.tile([0.0, 0, -1], (5, 1)))])
    (changed,) = changes.since_last([card(0, normals=np.tile([0.0, 0.6, -0.8], (5, 1)))])
    assert holds(changed, 0)


def test_out_of_view_and_back():
    changes = Changes(VIEW, [])
    assert changes.since_last([card(0, z=-5.0)]) == []
    assert holds(*changes.since_last([card(0)]), 0)
    assert holds(*changes.since_last([card(0, z=-5.0)]), 0)
    assert changes.since_last([card(3, z=-5.0)]) == []


def test_what_stands_still_is_drawn_once():
    still = card(0).positions[:4]
    changes = Changes(VIEW, [still, np.zeros((0, 3))])
    assert holds(*changes.since_last([]), 0)
    assert changes.since_last([]) == []


def test_joined_rectangles_hold_the_same_pixels_and_few_more():
    random = np.random.default_rng(3)
    for count in (0, 1, 2, 5, 12):
        given = [tuple(int(n) for n in random.integers(1, 30, 4)) for _ in range(count)]
        found = joined(given)
        pixels = [np.zeros((64, 64), bool) for _ in range(2)]
        for picture, rectangles in zip(pixels, (given, found), strict=True):
            for x, y, width, height in rectangles:
                picture[y : y + height, x : x + width] = True
        assert not (pixels[0] & ~pixels[1]).any()
        assert sum(w * h for _, _, w, h in found) <= sum(w * h for _, _, w, h in given)
    assert joined([(0, 0, 4, 4), (2, 0, 4, 4)]) == [(0, 0, 6, 4)]
    assert len(joined([(0, 0, 4, 4), (20, 20, 4, 4)])) == 2
