"""[[surface.response]] through files: whose pixels a curve has, and what does not fit."""

import numpy as np
import pytest

import andon
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.pictures import write_png
from andon.files.responses import read_surface_response, write_surface_response
from andon.pipeline import Renderer
from andon.responses import SurfaceCurve
from andon.scene import scene_from_dict
from comparison import assert_agree, assert_same_picture
from worlds import scene, write_scene_files

LUX = [0.0, 50, 200, 1000]
RGB = [[0.0, 0, 0], [0.2, 0.15, 0.1], [0.5, 0.45, 0.4], [1.0, 1, 1]]
LISTS = {"illuminance_lux": LUX, "rgb": RGB}
LAMP = {"kind": "point", "name": "lamp", "position": [-0.5, 0.3, -1.2], "intensity_cd": 200.0}
SIZE = (48, 64)


def with_responses(folder, *responses, **tables):
    return scene(folder, surface={"depth": "depth.npy", "response": list(responses)}, **tables)


def curve_of(found):
    return prepare(found).measured["mono"].curve_of


def write_mask(path, own):
    write_png(path, np.repeat((255 * own[..., None]).astype(np.uint8), 3, axis=-1))


# ── masks ─────────────────────────────────────────────────────────────────────────────────────


def test_masks_in_their_order_and_all_other_pixels(tmp_path):
    columns = np.broadcast_to(np.arange(64), SIZE)
    write_mask(tmp_path / "wall.png", columns < 40)
    write_mask(tmp_path / "ball.png", columns >= 30)
    rest, wall, ball = LISTS, LISTS | {"mask": "wall.png"}, LISTS | {"mask": "ball.png"}
    both = curve_of(with_responses(tmp_path, wall, ball))
    assert both[5].tolist() == [0] * 30 + [1] * 34
    other = curve_of(with_responses(tmp_path, ball, rest, wall))
    assert other[5].tolist() == [2] * 40 + [0] * 24
    write_mask(tmp_path / "wall.png", columns < 20)
    assert curve_of(with_responses(tmp_path, ball, rest, wall))[5, 25] == 1


def test_a_mask_loses_the_distortion_of_its_photograph(tmp_path):
    write_mask(tmp_path / "m.png", np.broadcast_to(np.arange(64) < 8, SIZE))
    camera = {"camera": {"fx": 57.6, "distortion": [-0.2, 0.0, 0.0, 0.0]}}
    bent = curve_of(with_responses(tmp_path, LISTS | {"mask": "m.png"}, rig=camera))
    columns = np.count_nonzero(bent == 0, axis=1)
    assert columns[24] > columns[0]


def test_files_and_lists_say_the_same(engine, tmp_path):
    path = write_surface_response(tmp_path / "f.csv", SurfaceCurve(np.array(LUX), np.array(RGB)))
    assert path.read_text().splitlines()[0] == "illuminance_lux,linear_r,linear_g,linear_b"
    by_file, by_lists = (
        andon.render(with_responses(tmp_path, table, lamp=[LAMP]), engine=engine)
        for table in ({"file": "f.csv"}, LISTS)
    )
    assert (by_file.image.rgb == by_lists.image.rgb).all()
    assert by_file.report.beyond_curve_share == 0
    assert by_file.report.ignored_tables == ()
    plain = andon.render(scene(tmp_path, lamp=[LAMP]), engine=engine)
    assert plain.report.beyond_curve_share is None
    assert np.abs(plain.image.rgb.astype(int) - by_file.image.rgb).mean() > 1


# ── materials of a mesh ───────────────────────────────────────────────────────────────────────

WALLS = "mtllib room.mtl\nv -2 -2 -2.5\nv 0 -2 -2.5\nv 0 2 -2.5\nv -2 2 -2.5\n" + (
    "v 2 -2 -2.5\nv 2 2 -2.5\nusemtl brick\nf 1 2 3 4\nusemtl paper\nf 2 5 6 3\n"
)


def meshed(folder, *responses, **tables):
    (folder / "room.obj").write_text(WALLS)
    (folder / "room.mtl").write_text("newmtl brick\nKd 0.5 0.3 0.2\nnewmtl paper\nKd 0.8 0.8 0.8\n")
    base = write_scene_files(folder, **tables)
    base["surface"] = {"mesh": "room.obj", "response": list(responses)}
    base["rig"] = {"camera": {"fx": 30.0}}
    return scene_from_dict(base, folder=folder)


def test_materials_of_a_mesh(tmp_path):
    brick = LISTS | {"material": "brick"}
    found = curve_of(meshed(tmp_path, brick))
    assert (found[8:40, 10:30] == 0).all()
    assert (found[8:40, 34:54] == -1).all()
    found = curve_of(meshed(tmp_path, brick, LISTS))
    assert (found[8:40, 10:30] == 0).all()
    assert (found[8:40, 34:54] == 1).all()
    assert (found[:, :2] == 1).all()  # beside the walls


def test_a_mask_goes_before_a_material(tmp_path):
    write_mask(tmp_path / "m.png", np.broadcast_to(np.arange(64) < 20, SIZE))
    found = curve_of(meshed(tmp_path, LISTS | {"mask": "m.png"}, LISTS | {"material": "brick"}))
    assert (found[8:40, 10:20] == 0).all()
    assert (found[8:40, 21:30] == 1).all()


def test_a_material_behind_an_object_keeps_its_curve(tmp_path):
    from worlds import block, write_glb

    write_glb(tmp_path / "box.glb", block((0.5, 0.5, 0.5), (-0.5, 0, -1.5)))
    hidden = meshed(tmp_path, LISTS | {"material": "brick"}, object=[{"mesh": "box.glb"}])
    assert (curve_of(hidden) == curve_of(meshed(tmp_path, LISTS | {"material": "brick"}))).all()


def test_both_engines_draw_the_materials(gpu, tmp_path):
    brick = {"material": "brick", "illuminance_lux": [0.0, 100, 600], "rgb": [RGB[0], *RGB[2:]]}
    tables = {"lamp": [LAMP], "ambient": {"illuminance_lux": 200.0, "dimming": [0.3, 0.5, 0.7]}}
    expected, actual = (
        Renderer(meshed(tmp_path, brick, LISTS, **tables), name).render()
        for name in ("reference", "gpu")
    )
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.001)
    assert_agree(actual.luminance.cd_m2, expected.luminance.cd_m2, rtol=5e-3, atol=0.1, share=0.01)


# ── who else looks at real light ──────────────────────────────────────────────────────────────


def test_a_see_through_display_subtracts_what_the_curve_leaves(gpu, tmp_path):
    tables = {
        "lamp": [LAMP],
        "ambient": {"illuminance_lux": 200.0, "dimming": 0.4},
        "display": {"mode": "ost", "peak_luminance_cd_m2": 400.0, "transmittance": 0.3},
    }
    expected, actual = (
        andon.render(with_responses(tmp_path, LISTS, **tables), engine=name)
        for name in ("reference", "gpu")
    )
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.01)
    straight = {"illuminance_lux": [0.0, 1.0], "rgb": [[0, 0, 0], [1e-3] * 3]}
    plain = andon.render(with_responses(tmp_path, straight, **tables), engine="reference")
    assert np.abs(plain.image.rgb.astype(int) - expected.image.rgb).mean() > 1


def test_what_lies_beyond_a_curve_is_unsure(engine, tmp_path):
    short = {"illuminance_lux": [0.0, 150], "rgb": [[0, 0, 0], [0.25] * 3]}
    frame = andon.render(with_responses(tmp_path, short, lamp=[LAMP]), engine=engine)
    share = frame.report.beyond_curve_share
    from andon.composite.confidence import Cause

    assert 0.05 < share < 0.95
    assert frame.confidence.share(Cause.BEYOND) == pytest.approx(share, abs=0.01)


# ── what does not fit ─────────────────────────────────────────────────────────────────────────


def refused(found, message):
    with pytest.raises(InputError, match=message):
        prepare(found)


def test_masks_that_do_not_fit(tmp_path):
    write_mask(tmp_path / "none.png", np.zeros(SIZE, bool))
    write_mask(tmp_path / "small.png", np.ones((4, 5), bool))
    refused(
        with_responses(tmp_path, LISTS, LISTS | {"mask": "none.png", "material": "wall"}),
        r"none\.png: surface\.response\[1\]\.mask: selects no pixel, so the curve of 'wall' has",
    )
    refused(
        with_responses(tmp_path, LISTS | {"mask": "small.png"}),
        r"small\.png: surface\.response\[0\]\.mask: is 5×4 px but the camera is 64×48",
    )


def test_materials_that_are_not_there(tmp_path):
    refused(
        meshed(tmp_path, LISTS | {"material": "birck"}),
        r"response\[0\]\.material: there is no material 'birck' .* did you mean 'brick'",
    )
    refused(
        with_responses(tmp_path, LISTS | {"material": "wall"}),
        r"response\[0\]\.material: names 'wall', and the surface has no materials; state mask",
    )
    with pytest.raises(InputError, match=r"response\[1\]\.material: '\*' has a response already"):
        with_responses(tmp_path, LISTS, LISTS)


def test_the_dimming_of_the_paper_scales_something_else(tmp_path):
    ambient = {"illuminance_lux": 200.0, "dimming": 0.5, "dimming_mode": "paper"}
    refused(
        with_responses(tmp_path, LISTS, ambient=ambient),
        r"ambient\.dimming_mode: 'paper' scales encoded values, and \[\[surface\.response\]\]",
    )


def test_there_is_no_camera_without_a_photograph(tmp_path):
    tables = {
        "rig": {"camera": {"fx": 30.0, "width": 64, "height": 48}},
        "ambient": {"illuminance_lux": 100.0},
        "surface": {"mesh": "room.obj", "response": [LISTS]},
    }
    assert meshed(tmp_path, LISTS).has_photograph
    refused(
        scene_from_dict(tables, folder=tmp_path),
        r"surface\.response: belongs to a photograph, and there is none",
    )


HEADER = "illuminance_lux,linear_r,linear_g,linear_b\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("\n", r"first line must be illuminance_lux,linear_r,linear_g,linear_b, got nothing"),
        ("encoded,linear_r,linear_g,linear_b\n", r"first line must be .* got 'encoded,"),
        (HEADER + "0,0,0,0\n", r"at least 2 illuminances"),
        (HEADER + "0,0,0,0\n1,1,1\n", r"must be four finite numbers ≥ 0, got '1,1,1'"),
        (HEADER + "0,0,0,0\n1,-1,1,1\n", r"must be four finite numbers ≥ 0"),
        (HEADER + "0,0,0,0\n1,nan,1,1\n", r"must be four finite numbers ≥ 0"),
        (HEADER + "0,0,0,0\n9,1,1,1\n8,2,2,2\n", r"illuminance_lux: must rise .* rows 2 and 3"),
        (HEADER + "0,0,0,0\n9,1,1,1\n10,2,1,2\n", r"linear: must rise .* rows 2 and 3"),
    ],
)
def test_files_that_hold_no_curve(tmp_path, text, message):
    (tmp_path / "f.csv").write_text(text)
    with pytest.raises(InputError, match=rf"f\.csv: .*{message}"):
        read_surface_response(tmp_path / "f.csv")
