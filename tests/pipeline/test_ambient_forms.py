"""E0 by the light from all sides, and by its known sources: what pixels get, and what is left."""

import json

import numpy as np
import pytest

from andon import Renderer
from andon.engines.ambient_light import LEAST_SHARE
from andon.errors import InputError
from andon.files.pictures import write_exr, write_png
from andon.harmonics import irradiance, project_latlong
from comparison import assert_agree
from worlds import block, scene, unit, write_obj, write_relight_files

COEFFICIENTS = [
    [282.0, 270, 255], [35, 30, 24], [-8, -7, -6], [12, 11, 9],
    [1, 1, 1], [2, 2, 2], [-3, -3, -2], [0, 0.5, 0], [4, 4, 3],
]  # fmt: skip
LAMP = {"kind": "point", "name": "floor lamp", "position": [-0.5, 0.4, -1.2], "intensity_cd": 90.0}
SUN = {"kind": "directional", "name": "flash", "direction": [0.3, -0.2, -1.0],
       "illuminance_lux": 300.0}  # fmt: skip
OTHER = SUN | {"name": "second", "direction": [-0.5, 0.1, -1.0], "rgb": [1.0, 0.9, 0.7]}


def light(folder, coefficients=COEFFICIENTS, **more):
    (folder / "light.json").write_text(json.dumps({"coefficients_cd_m2": coefficients} | more))
    return {"harmonics": "light.json"}


def e0(prepared):
    return prepared.ambient.illuminance_lux


# ── one light from all sides ──────────────────────────────────────────────────────────────────


def test_e0_is_the_irradiance_at_each_normal_and_its_mean_in_holes(engine, tmp_path):
    renderer = Renderer(scene(tmp_path, ambient=light(tmp_path)), engine)
    frame = renderer.render()
    lux, valid = e0(renderer.prepared), frame.surface.valid
    assert 0 < np.count_nonzero(~valid) < valid.size
    expected = irradiance(np.array(COEFFICIENTS), np.asarray(frame.surface.normal, float)[valid])
    assert_agree(lux[valid], expected, rtol=1e-3)  # the G-buffer's normals have 16 bits
    assert np.ptp(lux[valid][:, 0]) > 0.1 * lux[valid][:, 0].mean()
    np.testing.assert_allclose(lux[~valid], np.tile(lux[valid].mean(axis=0), (15, 1)))


def test_a_light_of_one_luminance_gives_pi_times_it(tmp_path):
    # ∫ L·cos = π·L; the first coefficient of a constant L is L·√(4π).
    rows = [[np.sqrt(4 * np.pi) * 50.0] * 3, *([[0.0] * 3] * 8)]
    prepared = Renderer(scene(tmp_path, ambient=light(tmp_path, rows)), "reference").prepared
    np.testing.assert_allclose(e0(prepared), np.pi * 50.0)


def test_it_is_the_side_that_faces_the_light_that_is_bright(tmp_path):
    """World axes, +Y up: fails if order or sign of the coefficients is turned round."""
    overhead = np.zeros((64, 128, 3))
    overhead[:8] = 100.0  # rows of a panorama begin at the zenith
    rows = project_latlong(overhead, 2).tolist()
    room = scene(tmp_path, ambient=light(tmp_path, rows))
    frame = Renderer(room, "reference").render()
    up = np.asarray(frame.surface.normal, float)[..., 1]
    lux = Renderer(room, "reference").prepared.ambient.illuminance_lux[..., 1]
    assert lux[up > 0.5].min() > 3 * lux[up < -0.5].max()


def test_light_probes_of_three_js_are_the_same_light(tmp_path):
    own = Renderer(scene(tmp_path, ambient=light(tmp_path)), "reference").prepared
    numbers = (np.array(COEFFICIENTS) / 2).ravel().tolist()
    probe = {"type": "LightProbe", "intensity": 2, "sh": numbers}
    for top in ({"object": probe}, probe):
        (tmp_path / "three.json").write_text(json.dumps(top))
        three = scene(tmp_path, ambient={"harmonics": "three.json"})
        np.testing.assert_allclose(e0(Renderer(three, "reference").prepared), e0(own))


def test_light_that_rings_below_zero_is_smoothed_and_said(tmp_path):
    rows = [list(row) for row in COEFFICIENTS]
    rows[2] = [-400.0] * 3  # bright behind the camera's wall, negative in front
    prepared = Renderer(scene(tmp_path, ambient=light(tmp_path, rows)), "reference").prepared
    valid = prepared.surface.depth["mono"] > 0
    assert e0(prepared).min() >= LEAST_SHARE * e0(prepared)[valid].mean(axis=0).min()
    assert irradiance(np.array(rows), prepared.surface.normals["mono"])[valid].min() < -100
    assert any("smoothed" in note for note in prepared.surface.notes)


def test_both_eyes_have_their_own_e0(engine, tmp_path):
    write_relight_files(tmp_path)
    room = scene(
        tmp_path,
        rig={"kind": "stereo", "camera": {"fx": 57.6}},
        capture={"source": {"left": "photo.png", "right": "photo.png"}},
        ambient=light(tmp_path),
        lamp=[LAMP],
    )
    renderer = Renderer(room, engine)
    ambient = renderer.prepared.ambient
    assert ambient.illuminance_lux.shape == (3,)
    for name in ("left", "right"):
        frame = renderer.render(view=name)
        own = ambient.lux_of(name)[frame.surface.valid]
        normal = np.asarray(frame.surface.normal, float)[frame.surface.valid]
        expected = irradiance(np.array(COEFFICIENTS), normal)
        # Edges of triangles are rasterised by one engine and hit by rays in the other.
        assert_agree(own, expected, rtol=2e-3, share=0.02)
    assert np.abs(ambient.lux_of("left") - ambient.lux_of("right")).max() > 1


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ({"coefficients_cd_m2": COEFFICIENTS[:4]}, "must be 9 rows of r, g, b, got 4"),
        ({"coefficients_cd_m2": [[-1, 1, 1], *COEFFICIENTS[1:]]}, "must be > 0 in each channel"),
        ({"coefficients_cd_m2": COEFFICIENTS, "unti": "cd/m²"}, "unknown key"),
        ({"object": {"type": "Group"}}, "one LightProbe of three.js"),
        ({"coefficients_cd_m2": [["1", 0, 0], *COEFFICIENTS[1:]]}, "must be a number"),
    ],
)
def test_other_files_are_refused_with_what_would_be_right(tmp_path, written, message):
    (tmp_path / "light.json").write_text(json.dumps(written))
    with pytest.raises(InputError, match=message):
        Renderer(scene(tmp_path, ambient={"harmonics": "light.json"}), "reference")


# ── known sources ─────────────────────────────────────────────────────────────────────────────


def photographed(folder, lux, **tables):
    """A scene whose photograph is a surface of ρ = 0.4 in `lux` (H, W, 3)."""
    write_exr(folder / "photo.exr", (0.4 * lux / 1000).astype(np.float32), unit="1")
    return scene(folder, capture={"source": "photo.exr"}, **tables)


def lux_of(folder, lamps, **tables):
    """What `lamps` give the room, shadows included, by the reference."""
    frame = Renderer(scene(folder, lamp=lamps, **tables), "reference").render()
    return np.asarray(frame.illuminance.lux, float), frame.surface


def test_a_source_switched_off_leaves_the_rest_and_another_takes_its_place(engine, tmp_path):
    rest = np.array([40.0, 50.0, 70.0])
    given, surface = lux_of(tmp_path, [LAMP])
    assert (given[surface.valid] == 0).any()  # the ball's shadow
    ambient = {"rest_lux": rest.tolist(), "source": [LAMP], "removed": ["floor lamp"]}
    other = LAMP | {"name": "new", "position": [0.7, 0.5, -1.0], "rgb": [1.0, 0.7, 0.4]}
    room = photographed(tmp_path, rest + given, ambient=ambient, lamp=[other])
    renderer = Renderer(room, engine)
    assert_agree(e0(renderer.prepared)[surface.valid], (rest + given)[surface.valid], rtol=1e-9)
    frame = renderer.render()
    per_unit = renderer.prepared.frames["mono"].luminance_per_unit
    left = np.asarray(frame.luminance.cd_m2, float) / per_unit
    new, _ = lux_of(tmp_path, [other])
    expected = 0.4 * (rest + new) / 1000
    # Maps of shadows have texels where rays have none: the edges differ on the GPU.
    share = 0.0 if engine == "reference" else 0.03
    assert_agree(left[surface.valid], expected[surface.valid], rtol=5e-3, share=share)


def test_what_stays_changes_nothing(engine, tmp_path):
    given, _ = lux_of(tmp_path, [LAMP])
    room = photographed(tmp_path, 30 + given, ambient={"rest_lux": 30.0, "source": [LAMP]})
    changed = Renderer(room, engine).render().image.rgb
    plain = photographed(tmp_path, 30 + given, ambient={"illuminance_lux": 30.0})
    np.testing.assert_array_equal(changed, Renderer(plain, engine).render().image.rgb)


def test_normals_alone_relight_from_one_distant_lamp_to_another(engine, tmp_path):
    """Photometric stereo: a photograph under one lamp becomes that under another."""
    _, _, view = write_relight_files(tmp_path)
    x, y = np.meshgrid(*[np.linspace(-1.2, 1.2, n) for n in (view.width, view.height)])
    normal = unit(np.stack([x, -y, np.ones_like(x)], axis=-1))  # world: y up, towards the camera
    write_exr(tmp_path / "normals.exr", normal.astype(np.float32), unit="1")
    tables = {"surface": {"normals": "normals.exr", "normals_axes": "world"}}
    given = [lux_of(tmp_path, [lamp], **tables)[0] for lamp in (SUN, OTHER)]
    assert (given[0] == 0).mean() < 0.2 < given[0].std() / given[0].mean()
    ambient = {"rest_lux": 2.0, "source": [SUN], "removed": ["flash"]}
    room = photographed(tmp_path, 2 + given[0], ambient=ambient, lamp=[OTHER], **tables)
    renderer = Renderer(room, engine)
    frame = renderer.render()
    per_unit = renderer.prepared.frames["mono"].luminance_per_unit
    expected = 0.4 * (2 + given[1]) / 1000
    left = np.asarray(frame.luminance.cd_m2, float) / per_unit
    assert_agree(left, expected, rtol=1e-2, atol=1e-4 * expected.max())


def test_e0_of_a_room_has_the_shadows_of_real_things_but_not_of_virtual_ones(tmp_path):
    write_obj(tmp_path / "box.obj", block((0.3, 0.3, 0.3), (0, 0, 0)))
    box = {"name": "box", "mesh": "box.obj", "position": [-0.3, 0.1, -1.7]}
    ambient = {"rest_lux": 25.0, "source": [LAMP]}
    with_box, without = (
        e0(Renderer(scene(tmp_path, ambient=ambient, **more), "reference").prepared)
        for more in ({"object": [box]}, {})
    )
    np.testing.assert_array_equal(with_box, without)
    given, surface = lux_of(tmp_path, [LAMP])
    np.testing.assert_allclose(without[surface.valid], 25 + given[surface.valid])


def test_a_source_with_a_place_is_refused_where_the_surface_has_none(tmp_path):
    _, _, view = write_relight_files(tmp_path)
    towards = np.broadcast_to([0.0, 0.0, 1.0], (*view.shape, 3))
    write_png(tmp_path / "normals.png", np.round(255 * (towards + 1) / 2).astype(np.uint8))
    ambient = {"rest_lux": 2.0, "source": [LAMP]}
    room = scene(tmp_path, surface={"normals": "normals.png"}, ambient=ambient)
    with pytest.raises(InputError, match=r"ambient\.source\[0\]\.kind.*has a place"):
        Renderer(room, "reference")
