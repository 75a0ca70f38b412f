"""Area lamps of a scene: luminance from what is stated, what is drawn, and shells in a scene."""

import os
from dataclasses import replace

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.pictures import write_exr, write_png
from andon.lamps import (
    DiskLamp,
    MeshLamp,
    PointLamp,
    PolygonLamp,
    SphereLamp,
    TubeLamp,
    body_of,
    resolve_bodies,
    resolve_lamps,
    resources,
)
from andon.lamps.areas import SOFT_SHADOW
from andon.lamps.shells import exact
from andon.lamps.shells.exact import solve_shell
from andon.lamps.shells.form import form_of
from andon.quantities import photometric
from andon.scene import scene_from_dict
from lamps.shell_worlds import area_lm, areas
from worlds import ball, block, write_obj

SPHERE = {"kind": "sphere", "position": [1, 2, 3], "radius_m": 0.1}
DISK = {"kind": "disk", "position": [1, 2, 3], "radius_m": 0.1, "direction": [0, -2, 0]}
RECTANGLE = {
    "kind": "rectangle",
    "position": [1, 2, 3],
    "direction": [0, 0, 5],
    "width_m": 0.4,
    "height_m": 0.2,
}
TUBE = {"kind": "tube", "ends": [[0, 0, 0], [1.2, 0, 0]], "radius_m": 0.02, "position": [0, 1, 0]}
L_SHAPE = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]
POLYGON = {"kind": "polygon", "vertices": L_SHAPE, "position": [0, 0, -1]}
MESH = {"kind": "mesh", "mesh": "lamp.obj", "position": [0, 1, 0]}
R2 = 0.1**2

# kind: (table, type, area of one side or all round, area as seen along the stated direction)
KINDS = {
    "sphere": (SPHERE, SphereLamp, 4 * np.pi * R2, np.pi * R2),
    "disk": (DISK, DiskLamp, np.pi * R2, np.pi * R2),
    "rectangle": (RECTANGLE, PolygonLamp, 0.08, 0.08),
    "tube": (
        TUBE,
        TubeLamp,
        2 * np.pi * 0.02 * 1.2 + 4 * np.pi * 0.02**2,
        2 * 0.02 * 1.2 + np.pi * 0.02**2,
    ),
    "polygon": (POLYGON, PolygonLamp, 3.0, 3.0),
    "mesh": (MESH, MeshLamp, 6 * 0.5**2, 6 * 0.5**2 / 4),
}


@pytest.fixture
def folder(tmp_path):
    write_obj(tmp_path / "lamp.obj", block((0.5, 0.5, 0.5), (0, 0, 0)))
    write_obj(tmp_path / "ball.obj", ball(0.2, (0, 0, 0)))
    picture = np.zeros((3, 4, 3), np.float32)
    picture[0, 0] = [4, 2, 1]
    picture[2, 3] = 1
    write_exr(tmp_path / "glow.exr", picture, unit="1")
    return tmp_path


def scene(folder, *tables, **more):
    return scene_from_dict({"lamp": tables, **more}, folder=folder)


def lamp_of(folder, table, **more):
    (found,) = resolve_lamps(scene(folder, table, **more), 0)
    return found


def body(folder, table, **more):
    (found,) = resolve_bodies(scene(folder, table, **more), 0)
    return found


def shown_m2(geometry):
    return np.linalg.norm(areas(geometry.positions[geometry.triangles]), axis=1).sum()


@pytest.mark.parametrize("kind", KINDS)
def test_luminance_from_each_way_to_state_it(folder, kind):
    table, expected_type, area, projected = KINDS[kind]
    light = {"luminance_cd_m2": 500, "flux_lm": np.pi * 500 * area, "intensity_cd": 500 * projected}
    for key, value in light.items():
        found = lamp_of(folder, table | {key: value, "temperature_k": 2700})
        assert type(found) is expected_type
        assert photometric(found.luminance_cd_m2) == pytest.approx(500)
        assert found.luminance_cd_m2[0] > found.luminance_cd_m2[2]
        assert found.shadow == replace(SOFT_SHADOW, through=frozenset({found.name}))


@pytest.mark.parametrize("kind", ["disk", "rectangle", "polygon"])
def test_two_sides_share_the_flux(folder, kind):
    table, _, area, _ = KINDS[kind]
    both = lamp_of(folder, table | {"flux_lm": np.pi * 500 * area, "two_sided": True})
    assert both.two_sided
    assert photometric(both.luminance_cd_m2) == pytest.approx(250)
    ahead = lamp_of(folder, table | {"intensity_cd": 500 * area, "two_sided": True})
    assert photometric(ahead.luminance_cd_m2) == pytest.approx(500)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_drawn_has_the_area_that_shines(folder, kind):
    table, _, area, _ = KINDS[kind]
    table = table | {"luminance_cd_m2": 500, "name": "glow"}
    drawn = body(folder, table)
    assert drawn.name == "glow"
    assert shown_m2(drawn.geometry) == pytest.approx(area, rel=0.01)
    np.testing.assert_allclose(drawn.outside_cd_m2, 500)
    assert not drawn.inside_cd_m2.any()
    assert drawn.outside_cd_m2.shape == drawn.inside_cd_m2.shape == drawn.geometry.positions.shape
    assert resolve_bodies(scene(folder, table | {"drawn": False}), 0) == ()
    assert resolve_lamps(scene(folder, table | {"shadow": False}), 0)[0].shadow is None


def test_drawn_sides(folder):
    for table, ahead in ((DISK, [0, -1, 0]), (RECTANGLE, [0, 0, 1]), (POLYGON, [0, 0, 1])):
        one = body(folder, table | {"luminance_cd_m2": 5})
        at = one.geometry.positions[one.geometry.triangles]
        facing = areas(at) @ np.array(ahead)
        assert (facing > 0).all()
        two = body(folder, table | {"luminance_cd_m2": 5, "two_sided": True})
        np.testing.assert_allclose(two.inside_cd_m2, 5)


@pytest.mark.parametrize("table", [SPHERE, TUBE])
def test_round_bodies(folder, table):
    drawn = body(folder, table | {"flux_lm": 5}).geometry
    at = drawn.positions[drawn.triangles]
    assert len(drawn.triangles) >= 2500
    volume = np.einsum("ij,ij->i", areas(at), at.mean(axis=1)).sum() / 3
    expected = 4 / 3 * np.pi * 1e-3
    if table is TUBE:
        expected = np.pi * 0.02**2 * 1.2 + 4 / 3 * np.pi * 0.02**3
    assert volume == pytest.approx(expected, rel=0.01)
    flat = areas(at)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    assert np.einsum("ti,tki->tk", flat, drawn.normals[drawn.triangles]).min() > 0.98


def test_rectangle_corners(folder):
    found = lamp_of(folder, RECTANGLE | {"luminance_cd_m2": 1})
    # As seen from in front of it: bottom left, bottom right, top right, top left.
    expected = [[0.8, 1.9, 3], [1.2, 1.9, 3], [1.2, 2.1, 3], [0.8, 2.1, 3]]
    np.testing.assert_allclose(found.vertices_m, expected)
    turned = lamp_of(folder, RECTANGLE | {"luminance_cd_m2": 1, "up": [1, 0, 3]})
    np.testing.assert_allclose(turned.vertices_m[3] - turned.vertices_m[0], [0.2, 0, 0], atol=1e-15)


def test_texture(folder):
    table = RECTANGLE | {"luminance_cd_m2": 100, "texture": "glow.exr"}
    found = lamp_of(folder, table)
    assert found.texture.shape == (3, 4, 3)
    assert photometric(found.texture).mean() == pytest.approx(1)
    np.testing.assert_allclose(found.texture[0, 0] / found.texture[2, 3], [4, 2, 1])
    drawn = body(folder, table)
    at = drawn.geometry.positions
    top_left = np.argmin(at[:, 0] - at[:, 1])
    np.testing.assert_allclose(drawn.outside_cd_m2[top_left], 100 * found.texture[0, 0])
    bottom_right = np.argmax(at[:, 0] - at[:, 1])
    np.testing.assert_allclose(drawn.outside_cd_m2[bottom_right], 100 * found.texture[2, 3])


def test_texture_of_codes_and_of_many_texels(folder):
    random = np.random.default_rng(0)
    write_png(folder / "big.png", random.integers(0, 256, (300, 700, 3)).astype(np.uint8))
    found = lamp_of(folder, RECTANGLE | {"luminance_cd_m2": 1, "texture": "big.png"})
    assert found.texture.shape == (256, 256, 3)
    assert photometric(found.texture).mean() == pytest.approx(1)


def test_black_texture(folder):
    write_exr(folder / "black.exr", np.zeros((2, 2, 3), np.float32), unit="1")
    with pytest.raises(InputError, match="black"):
        lamp_of(folder, RECTANGLE | {"luminance_cd_m2": 1, "texture": "black.exr"})


def test_files_are_read_once_and_again_when_they_change(folder):
    table = MESH | {"luminance_cd_m2": 500}
    wanted = scene(folder, table)
    resolve_lamps(wanted, 0)
    os.utime(folder / "lamp.obj", ns=(0, 0))
    (before,) = resolve_lamps(wanted, 0)
    write_obj(folder / "lamp.obj", block((2, 2, 2), (0, 0, 0)))
    (after,) = resolve_lamps(wanted, 0)
    assert np.ptp(before.positions_m[:, 0]) == pytest.approx(0.5)
    assert np.ptp(after.positions_m[:, 0]) == pytest.approx(2)
    (folder / "lamp.obj").unlink()
    with pytest.raises(InputError):
        resolve_lamps(wanted, 0)


def test_units_and_axes_of_a_mesh(folder):
    write_obj(folder / "tall.obj", block((10, 20, 40), (0, 0, 0)))
    table = MESH | {"mesh": "tall.obj", "luminance_cd_m2": 1}
    found = lamp_of(folder, table, scene={"unit": "cm", "up": "z"})
    np.testing.assert_allclose(np.ptp(found.positions_m, axis=0), [0.1, 0.4, 0.2])


def test_a_fine_mesh_keeps_its_flux(folder):
    table = MESH | {"mesh": "ball.obj", "flux_lm": 700}
    found = lamp_of(folder, table)
    assert len(found.triangles) <= 4 * 96
    size = np.linalg.norm(areas(found.positions_m[found.triangles]), axis=1).sum()
    assert photometric(found.luminance_cd_m2) * np.pi * size == pytest.approx(700)
    drawn = body(folder, table)
    assert len(drawn.geometry.triangles) > len(found.triangles)
    seen = photometric(drawn.outside_cd_m2[0]) * np.pi * shown_m2(drawn.geometry)
    assert seen == pytest.approx(700)


REFUSED = [
    (RECTANGLE | {"up": [0, 0, -1]}, "parallel", "lamp[0].up"),
    (POLYGON | {"vertices": [[0, 0, 0], [1, 0, 0], [2, 0, 0]]}, "no area", "lamp[0].vertices"),
    (
        POLYGON | {"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]]},
        "not flat",
        "lamp[0].vertices",
    ),
    (SPHERE | {"name": "real"}, "already names", "lamp[0].name"),
    (SPHERE | {"flux_lm": 1e300, "radius_m": 1e-9}, "too large", "lamp[0]"),
]


@pytest.mark.parametrize(("table", "message", "field"), REFUSED)
def test_refused(folder, table, message, field):
    with pytest.raises(InputError, match=message) as caught:
        lamp_of(folder, {"flux_lm": 1} | table)
    assert caught.value.field == field


def test_a_polygon_that_crosses_itself_is_refused(folder):
    crossed = [[0, 0, 0], [3, 0, 0], [0, 1, 0], [2, 2, 0], [1, -1, 0]]
    with pytest.raises(InputError, match="crosses itself"):
        body(folder, POLYGON | {"flux_lm": 1, "vertices": crossed})


@pytest.mark.parametrize("seed", range(4))
def test_any_simple_polygon(seed):
    random = np.random.default_rng(seed)
    angle = np.sort(random.uniform(0, 2 * np.pi, 60))
    reach = random.uniform(0.2, 1, 60)
    star = np.stack([reach * np.cos(angle), reach * np.sin(angle), 0 * angle], axis=1)
    star = star[:: random.choice([-1, 1])]
    drawn = body_of(PolygonLamp("star", np.ones(3), star)).geometry
    flat = areas(drawn.positions[drawn.triangles])
    whole = np.cross(star, np.roll(star, -1, axis=0)).sum(axis=0) / 2
    np.testing.assert_allclose(flat.sum(axis=0), whole, atol=1e-12)
    assert np.linalg.norm(flat, axis=1).sum() == pytest.approx(np.linalg.norm(whole))


LANTERN = {"kind": "point", "name": "lantern", "position": [0, 1, 0], "flux_lm": 800}


def test_a_shell_in_a_scene(folder):
    shell = {"mesh": "lamp.obj", "transmittance": [0.5, 0.4, 0.3], "absorptance": 0.1}
    other = LANTERN | {"name": "other", "position": [5, 0, 0]}
    wanted = scene(folder, LANTERN | {"shell": shell}, other)
    glow, point = resolve_lamps(wanted, 0)
    assert (type(glow), type(point)) == (MeshLamp, PointLamp)
    np.testing.assert_allclose(area_lm(glow), [400, 320, 240], rtol=1e-9)
    (lantern,) = resolve_bodies(wanted, 0)
    assert lantern.name == "lantern"
    np.testing.assert_allclose(lantern.reflectance, [0.4, 0.5, 0.6])
    np.testing.assert_allclose(lantern.geometry.positions.mean(axis=0), [0, 1, 0], atol=1e-9)


def test_a_shell_moves_with_its_lamp(folder):
    keys = [
        {"time_seconds": 0, "position": [0, 1, 0], "flux_lm": 0},
        {"time_seconds": 2, "position": [2, 1, 0], "flux_lm": 800},
    ]
    wanted = scene(folder, LANTERN | {"shell": {"radius_m": 0.1, "mode": "exact"}, "key": keys})
    (glow,) = resolve_lamps(wanted, 1)
    assert glow.position_m.tolist() == [1, 1, 0]
    assert photometric(glow.luminance_cd_m2) == pytest.approx(0.5 * 400 / (4 * np.pi**2 * 0.01))
    (still,) = resolve_lamps(wanted, 0)
    assert (still.name, photometric(still.luminance_cd_m2)) == ("lantern", 0)
    before, after = (resolve_bodies(wanted, t)[0] for t in (0, 1))
    np.testing.assert_allclose(
        after.geometry.positions - before.geometry.positions, [[1, 0, 0]] * 2562
    )


def test_paper_mode_of_a_scene(folder):
    shell = {"radius_m": 0.1, "transmittance": 0.25, "mode": "paper"}
    (through,) = resolve_lamps(scene(folder, LANTERN | {"shell": shell}), 0)
    assert photometric(through.intensity_cd) == pytest.approx(0.25 * 800 / (4 * np.pi))
    assert through.shadow.through == {"lantern"}


def test_a_shell_that_is_none_is_named_with_its_lamp(folder):
    write_obj(folder / "far.obj", ball(0.2, (3, 0, 0)))
    with pytest.raises(InputError, match="outside its shell") as caught:
        resolve_lamps(
            scene(folder, LANTERN, LANTERN | {"name": "b", "shell": {"mesh": "far.obj"}}), 0
        )
    assert caught.value.field == "lamp[1].shell.mesh"
    with pytest.raises(InputError, match="stay inside"):
        resolve_lamps(scene(folder, LANTERN | {"shell": {"mesh": "../far.obj"}}), 0)


def test_names_of_a_shells_parts_are_not_taken_twice(folder):
    ball_mesh = ball(0.2, (0, 0, 0))
    open_above = ball_mesh.triangles[
        ball_mesh.positions[ball_mesh.triangles].mean(axis=1)[:, 1] < 0.1
    ]
    write_obj(folder / "shade.obj", type(ball_mesh)(ball_mesh.positions, open_above))
    shade = LANTERN | {"shell": {"mesh": "shade.obj"}}
    assert len(resolve_lamps(scene(folder, shade), 0)) == 3
    with pytest.raises(InputError, match="'lantern: bulb' is taken"):
        resolve_lamps(scene(folder, shade, LANTERN | {"name": "lantern: bulb"}), 0)


def test_many_shells_are_solved_once(folder):
    """Seventy different shells: the next frame finds all of them."""
    for number in range(3):
        write_obj(folder / f"{number}.obj", block((0.2, 0.3 + 0.1 * number, 0.2), (0, 0, 0)))
    lamps = [
        LANTERN
        | {"name": f"lantern {i}", "position": [i, 1, 0]}
        | {"shell": {"mesh": f"{i % 3}.obj", "transmittance": (i + 1) / 100}}
        for i in range(70)
    ]
    wanted = scene(folder, *lamps)
    resolve_lamps(wanted, 0)
    caches = (resources._geometry, resources._shell, form_of, solve_shell, exact._shares)
    before = [cache.cache_info() for cache in caches]
    resolve_lamps(wanted, 0.5)
    after = [cache.cache_info() for cache in caches]
    assert [info.misses for info in after] == [info.misses for info in before]
    assert after[1].hits >= before[1].hits + 70
