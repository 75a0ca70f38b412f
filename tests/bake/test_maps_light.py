"""Light in baked maps: against closed forms, and of everything that a scene may have in it."""

import numpy as np
import pytest

from andon.files.illuminance_maps import read_manifest
from andon.scene import scene_from_dict
from andon.spaces import transform_points
from map_scenes import CAMERAS, bake, baked_moment, camera, room_scene, room_tables
from photometry_files import ies
from requirements import required
from worlds import ball, block, write_glb, write_relight_files

required("pyradiance")

INSIDE = camera((0, 0, 0), (0, 0, -1), width=32, height=24)


def points_of(stored):
    """(h, w, 3) world positions of a map's pixels."""
    local = stored.view.rays_planar() * stored.depth_m[..., None].astype(float)
    return transform_points(stored.view.world_from_camera, local)


def ball_scene(folder, reflectance, transport, bounces):
    """A point lamp in the middle of a ball of radius 2 m that reflects evenly."""
    shell = ball(2.0, (0, 0, 0), 12)
    inwards = type(shell)(shell.positions, shell.triangles[:, ::-1].copy())
    write_glb(folder / "ball.glb", inwards, colour=[reflectance] * 3)
    lamp = {
        "name": "a", "kind": "point", "position": [0, 0, 0], "intensity_cd": 100.0,
        "transport": transport, "rgb": [1.0, 0.5, 0.25],
    }  # fmt: skip
    baked = {
        "folder": "maps", "lamps": ["a"], "quality": "draft", "bounces": bounces,
        "camera": [INSIDE],
    }  # fmt: skip
    tables = {"surface": {"mesh": "ball.glb"}, "lamp": [lamp], "baked": baked}
    return scene_from_dict(tables, folder=folder)


def lamp_triple(intensity_cd):
    """Per channel, of a lamp of 1 : 0.5 : 0.25."""
    ratio = np.array([1.0, 0.5, 0.25])
    return intensity_cd * ratio / (ratio @ [0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize(
    ("transport", "bounces", "sum_of_powers"),
    [("baked", 0, 1.0), ("baked", 2, 1 + 0.6 + 0.36), ("direct+bounce", 2, 0.6 + 0.36)],
)
def test_a_ball_reflects_a_geometric_series(tmp_path, transport, bounces, sum_of_powers):
    bake(ball_scene(tmp_path, 0.6, transport, bounces))
    (stored,) = baked_moment(tmp_path / "maps")
    direct = lamp_triple(100.0) / 4.0
    error = stored.lux["a"] / (sum_of_powers * direct) - 1
    # A faceted ball is up to 1.5 % nearer, and 1 % brighter; draft rays add their noise.
    assert np.abs(np.median(error, axis=(0, 1))).max() < 0.02
    assert np.quantile(np.abs(error), 0.95) < 0.06


def test_reflected_light_alone_is_none_without_bounces(tmp_path):
    bake(ball_scene(tmp_path, 0.6, "direct+bounce", 0))
    (stored,) = baked_moment(tmp_path / "maps")
    assert np.abs(stored.lux["a"]).max() == 0


def test_direct_light_is_that_of_the_lamp_at_the_map_s_points(tmp_path):
    """Views, depths, normals and lux belong together: I·cos/d² in each pixel that sees the lamp."""
    bake(room_scene(tmp_path, baked={"bounces": 0}))
    checked = 0
    for stored in baked_moment(tmp_path / "maps"):
        to_lamp = np.array([-1.0, 0.8, -0.7]) - points_of(stored)
        distance = np.linalg.norm(to_lamp, axis=-1)
        cosine = np.einsum("ijk,ijk->ij", to_lamp, stored.normal) / distance
        expected = 200.0 * np.maximum(cosine, 0) / distance**2
        lux = stored.lux["left"]
        lit = lux[..., 0] > 0
        np.testing.assert_allclose(lux[lit], np.repeat(expected[lit][:, None], 3, axis=1), 2e-3)
        # What is dark is turned away or in the box's shadow; in a room that is little.
        assert lit.mean() > 0.85
        checked += lit.sum()
    assert checked > 2500


def test_the_manifest_says_what_was_baked(tmp_path):
    report, done = bake(room_scene(tmp_path))
    manifest = read_manifest(tmp_path / "maps")
    assert [view.name for view in manifest.cameras] == ["camera-1", "camera-2"]
    assert manifest.moments == (0.0,)
    assert [(lamp.name, lamp.part) for lamp in manifest.lamps] == [
        ("left", "all"), ("right", "bounce"),
    ]  # fmt: skip
    assert (manifest.quality, manifest.bounces, manifest.photometry) == ("draft", 1, "absolute")
    assert set(manifest.facts) == {"geometry", "lamp left", "lamp right"}
    assert list(manifest.missing()) == []
    files = {file.name for file in (*manifest.geometry.values(), *manifest.light.values())}
    assert files == {path.name for path in (tmp_path / "maps").glob("*.exr")}
    assert report.disk_bytes == sum(p.stat().st_size for p in (tmp_path / "maps").glob("*.exr"))
    assert len(done) == report.computed == report.tasks == 6


def test_flicker_is_not_baked(tmp_path):
    flicker = {"amount": 0.5}
    lamps = room_tables()["lamp"]
    bake(room_scene(tmp_path))
    scene = room_scene(tmp_path, lamp=[lamps[0] | {"flicker": flicker}, lamps[1]])
    assert bake(scene)[1] == []


MOVES = [
    {"time_seconds": 0.0, "position": [-0.8, 0, 1]},
    {"time_seconds": 1.0, "position": [0.8, 0, 1]},
]


def moving_tables(folder, **entry):
    write_glb(folder / "ball.glb", ball(0.4, (0, 0, 0), 3), colour=(0.5, 0.5, 0.5))
    thing = {"name": "ball", "mesh": "ball.glb", "key": MOVES} | entry
    return {
        "scene": {"duration_seconds": 1.0},
        "object": [thing],
        "baked": {"frames_per_second": 2.0, "camera": CAMERAS[:1]},
    }


def test_a_moving_object_is_baked_at_each_moment(tmp_path):
    report, _ = bake(room_scene(tmp_path, **moving_tables(tmp_path)))
    assert report.plan.moments == (0.0, 0.5, 1.0)
    assert report.tasks == 3 * (1 + 2)
    for moment, x in enumerate([-0.8, 0.0, 0.8]):
        (stored,) = baked_moment(tmp_path / "maps", moment)
        near = np.linalg.norm(points_of(stored) - [x, 0, 1], axis=-1) < 0.41
        assert near.sum() > 50, "the ball is where it is at that moment"
        assert stored.lux["left"][near].max() > 0
        others = [
            np.linalg.norm(points_of(stored) - [other, 0, 1], axis=-1) < 0.39
            for other in (-0.8, 0.0, 0.8)
            if other != x
        ]
        assert not any(mask.any() for mask in others), "and nowhere else"


def test_of_a_film_the_disk_holds_what_one_task_reads(tmp_path):
    """Three moments, two lamps, two cameras: six lamps' worlds, of which one is there at a time."""
    tables = moving_tables(tmp_path) | {"surface": {"mesh": "room.glb"}}
    tables["baked"] |= {"camera": CAMERAS, "bounces": 0}
    inputs, worlds, seen = tmp_path / "maps" / "inputs", [], []

    def look(done, of, what, left):
        folders = list(inputs.iterdir()) if inputs.exists() else []
        worlds.append(sum((folder / "scene.oct").exists() for folder in folders))
        seen.append(len(folders) - worlds[-1])

    _, done = bake(room_scene(tmp_path, **tables), progress=look)
    assert len(done) == 3 * 2 * (1 + 2)
    assert max(worlds) == 1
    assert max(seen) == 2, "what both cameras see of one moment"


def test_what_does_not_change_is_one_file_for_all_moments(tmp_path):
    tables = moving_tables(tmp_path, casts_shadow=False)
    tables["baked"]["camera"] = [camera((0, 0.5, -2.2), (0, -0.5, -9))]
    report, done = bake(room_scene(tmp_path, **tables))
    # It casts no shadows and the camera does not see it: three moments are one.
    assert report.plan.moments == (0.0, 0.5, 1.0)
    assert len(done) == report.tasks == 1 + 2
    manifest = read_manifest(tmp_path / "maps")
    assert len({manifest.light["left", 0, moment].name for moment in range(3)}) == 1


def test_what_casts_no_shadow_is_lit_and_hides_nothing(tmp_path):
    tables = moving_tables(tmp_path, casts_shadow=False, key=[], position=[0, 0, 1])
    tables["baked"]["bounces"] = 0  # light that rays find by chance differs from point to point
    bake(room_scene(tmp_path, **tables))
    (with_it,) = baked_moment(tmp_path / "maps")
    bake(room_scene(tmp_path, baked=tables["baked"] | {"folder": "empty"}))
    (without,) = baked_moment(tmp_path / "empty")
    own = with_it.depth_m < without.depth_m - 1e-3
    assert own.sum() > 50
    assert with_it.lux["left"][own].max() > 0
    np.testing.assert_array_equal(with_it.depth_m[~own], without.depth_m[~own])
    np.testing.assert_array_equal(with_it.lux["left"][~own], without.lux["left"][~own])


def test_a_lamp_that_moves_is_baked_at_each_moment(tmp_path):
    lamps = room_tables()["lamp"]
    keys = [
        {"time_seconds": 0.0, "intensity_cd": 200.0},
        {"time_seconds": 1.0, "intensity_cd": 400.0},
    ]
    scene = room_scene(
        tmp_path,
        scene={"duration_seconds": 1.0, "frames_per_second": 1.0},
        lamp=[lamps[0] | {"key": keys}, lamps[1]],
    )
    report, _ = bake(scene)
    # Geometry 2, the other lamp 2, the one that gets brighter 4.
    assert report.tasks == 8
    first, last = (baked_moment(tmp_path / "maps", moment)[0] for moment in (0, 1))
    # Which of the hemisphere's points are kept depends a little on how bright they are.
    assert np.median(last.lux["left"] / first.lux["left"]) == pytest.approx(2, abs=1e-3)
    assert (last.lux["left"] / first.lux["left"] - 2).max() < 0.25
    np.testing.assert_array_equal(last.lux["right"], first.lux["right"])


def one_lamp(folder, lamp, **baked):
    lamp = {"name": "a", "transport": "baked"} | lamp
    own = {"lamps": ["a"], "camera": CAMERAS[:1], "bounces": 0}
    bake(room_scene(folder, lamp=[lamp], baked=own | baked))
    (stored,) = baked_moment(folder / "maps")
    return stored


def test_a_luminaire_of_a_file(tmp_path):
    """Half as bright at 60° as straight down, and nothing above."""
    angles = (0, 30, 60, 90)
    (tmp_path / "lamp.ies").write_text(ies(verticals=angles, candela=[[400, 300, 200, 0]]))
    lamp = {"kind": "ies", "file": "lamp.ies", "position": [0, 1, 0], "direction": [0, -1, 0]}
    stored = one_lamp(tmp_path, lamp)
    down = points_of(stored) - [0, 1, 0]
    distance = np.linalg.norm(down, axis=-1)
    gamma = np.degrees(np.arccos(np.clip(-down[..., 1] / distance, -1, 1)))
    intensity = np.interp(gamma, (*angles, 180), (400, 300, 200, 0, 0))
    cosine = -np.einsum("ijk,ijk->ij", down, stored.normal) / distance
    expected = intensity * np.maximum(cosine, 0) / distance**2
    lux = stored.lux["a"][..., 0]
    assert lux[gamma > 91].max() == 0
    lit = lux > 0
    np.testing.assert_allclose(lux[lit], expected[lit], rtol=0.01)
    assert lit.sum() > 600


def test_a_lamp_in_a_shell(tmp_path):
    """A closed ball of paper with t = 0.5: as a point of half the intensity, from farther away."""
    shell = {"radius_m": 0.1, "transmittance": 0.5}
    lamp = {"kind": "point", "position": [0, 0.5, 0], "intensity_cd": 200.0, "shell": shell}
    stored = one_lamp(tmp_path, lamp)
    to_lamp = np.array([0, 0.5, 0]) - points_of(stored)
    distance = np.linalg.norm(to_lamp, axis=-1)
    cosine = np.einsum("ijk,ijk->ij", to_lamp, stored.normal) / distance
    expected = 100.0 * cosine / distance**2
    clear = (cosine > 0.3) & (stored.lux["a"][..., 0] > 0.5 * expected)
    assert clear.mean() > 0.5
    error = stored.lux["a"][..., 1][clear] / expected[clear] - 1
    assert np.abs(np.median(error)) < 0.01
    assert np.quantile(np.abs(error), 0.95) < 0.03


def test_the_body_of_another_lamp_stands_in_the_light(tmp_path):
    """A direct lamp's shell hides the baked one's light, and gives none."""
    baked = {"kind": "point", "position": [0, 1, 0], "intensity_cd": 200.0}
    plain = one_lamp(tmp_path, baked)
    other = {
        "name": "b", "kind": "point", "position": [0, 0, 0], "intensity_cd": 500.0,
        "shell": {"radius_m": 0.3, "transmittance": 0.5},
    }  # fmt: skip
    lamp = {"name": "a", "transport": "baked"} | baked
    own = {"lamps": ["a"], "camera": CAMERAS[:1], "bounces": 0, "folder": "two"}
    bake(room_scene(tmp_path, lamp=[lamp, other], baked=own))
    (hidden,) = baked_moment(tmp_path / "two")
    under = np.linalg.norm(points_of(hidden) - [0, -1.5, 0], axis=-1) < 0.3
    assert under.sum() > 10
    assert plain.lux["a"][under].min() > 0
    assert hidden.lux["a"][under].max() == 0
    assert (hidden.lux["a"] <= plain.lux["a"] * 1.001).all()


def photographed(folder, **changes):
    """A depth image of a wall with a ball before it, seen from where the photograph was taken."""
    write_relight_files(folder)
    tables = {
        "rig": {"camera": {"fx": 57.6}},
        "capture": {"source": "photo.png"},
        "surface": {"depth": "depth.npy"},
        "ambient": {"illuminance_lux": 200.0},
        "lamp": [
            {
                "name": "a", "kind": "point", "position": [-0.5, 0.3, -1.2],
                "intensity_cd": 50.0, "transport": "baked",
            }
        ],
        "baked": {
            "folder": "maps", "lamps": ["a"], "quality": "draft", "bounces": 1,
            "camera": [{"width": 64, "height": 48, "fx": 57.6}],
        },
    }  # fmt: skip
    return scene_from_dict(tables | changes, folder=folder)


def test_a_depth_image_is_baked_with_the_reflectance_of_its_photograph(tmp_path):
    bake(photographed(tmp_path))
    (stored,) = baked_moment(tmp_path / "maps")
    # The map traces the triangles of the depth image from the camera's own place.
    depth = np.load(tmp_path / "depth.npy")
    both = np.isfinite(depth) & np.isfinite(stored.depth_m)
    assert both.mean() > 0.8
    assert np.median(np.abs(stored.depth_m[both] - depth[both])) < 1e-3
    assert stored.lux["a"][both].max() > 5
    assert np.isnan(stored.depth_m[:2, :4]).all(), "holes stay holes"


def test_a_brighter_photograph_reflects_more(tmp_path):
    """The wall's reflected light on the ball grows with what the photograph shows of the wall."""
    means = []
    for name, e0 in (("dark", 2000.0), ("bright", 200.0)):
        folder = tmp_path / name
        folder.mkdir()
        lamp = dict(photographed(folder).model_dump(exclude_unset=True)["lamp"][0])
        lamp["transport"] = "direct+bounce"
        about = {"source": "photo.png", "luminance_per_unit": 60.0}
        scene = photographed(folder, lamp=[lamp], ambient={"illuminance_lux": e0}, capture=about)
        bake(scene)
        (stored,) = baked_moment(folder / "maps")
        means.append(float(np.nanmean(stored.lux["a"])))
    assert means[0] > 0
    # ρ = π·L/E0 is ten times as large; light between wall and ball is one bounce.
    assert means[1] / means[0] == pytest.approx(10, rel=0.2)


def test_two_sided_sheets_and_thin_boxes_leak_no_light(tmp_path):
    """A closed box around the lamp: outside it is dark, whatever the rays do."""
    closed = block((0.5, 0.5, 0.5), (0, 0.5, 0))
    write_glb(tmp_path / "box.glb", closed)
    lamp = {"name": "a", "kind": "point", "position": [0, 0.5, 0], "intensity_cd": 200.0}
    own = {"lamps": ["a"], "camera": CAMERAS[:1]}
    box = {"name": "box", "mesh": "box.glb"}
    bake(room_scene(tmp_path, lamp=[lamp | {"transport": "baked"}], baked=own, object=[box]))
    (stored,) = baked_moment(tmp_path / "maps")
    assert stored.lux["a"].max() == 0
