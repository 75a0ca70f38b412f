"""Virtual objects in the light of probes: both engines, and what else lights them."""

from dataclasses import replace

import numpy as np
import pytest

from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.volumes import write_volume
from andon.lamps import PointLamp, SkyLamp
from andon.pipeline import Renderer
from andon.surface.model import EMPTY_GEOMETRY
from andon.verify.rows.probe_light import ball_setting
from comparison import assert_agree, assert_same_picture
from probes.volumes import POSITIONS, volume_at
from worlds import ball, scene, write_glb

SKY = SkyLamp("sky", np.array([0.0, 1, 0]), np.array([30.0, 40, 60]))
LAMP = PointLamp("lamp", np.array([0.0, 0.6, 0.3]), np.full(3, 40.0), None)


def setting(lookup="pixel", *, lamps=(), rows=None, **changes):
    found = ball_setting(lookup, width=120, height=90)
    if rows is not None:
        infos = tuple(replace(info, **rows) for info in found.surface.objects_table)
        found = replace(found, surface=replace(found.surface, objects_table=infos))
    if changes:
        found = replace(found, probes=replace(found.probes, **changes))
    return replace(found, lamps=lambda _: tuple(lamps))


def drawn(prepared, engine):
    return Renderer(prepared, engine).render()


def standing_in_e0(pixels):
    """cd/m² of white balls in 100 lx."""
    return np.full((np.count_nonzero(pixels), 3), 0.9 * 100 / np.pi)


@pytest.mark.parametrize("lookup", ["pixel", "object"])
@pytest.mark.parametrize("visibility", [True, False], ids=["walls", "open"])
def test_engines_agree(gpu, tmp_path, lookup, visibility):
    prepared = setting(lookup, lamps=(SKY, LAMP), captured=frozenset(["sky"]))
    if not visibility:
        light = replace(prepared.probes.light, walls=None)
        prepared = replace(prepared, probes=replace(prepared.probes, light=light))
    expected, actual = drawn(prepared, "reference"), drawn(prepared, "gpu")
    both = expected.surface.is_object & actual.surface.is_object
    assert 0.1 < both.mean() < 0.5
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.01)
    a, e = actual.luminance.cd_m2[both], expected.luminance.cd_m2[both]
    assert_agree(a, e, rtol=5e-3, atol=0.02, share=0.01)


def test_colours_bleed(engine):
    """The ball in the middle is redder on the side of the red wall."""
    frame = drawn(setting(), engine)
    own = frame.surface.is_object & (np.abs(frame.surface.position[..., 0]) < 0.4)
    normal, light = frame.surface.normal[own], frame.luminance.cd_m2[own]
    left, right = light[normal[:, 0] < -0.6].mean(axis=0), light[normal[:, 0] > 0.6].mean(axis=0)
    assert left[0] / left[1] > 1.3 * right[0] / right[1]


def test_an_object_without_probes_stands_in_e0(engine):
    frame = drawn(setting(rows={"lit_by_probes": False}), engine)
    own = frame.surface.is_object
    expected = frame.surface.reflectance[own] * 100 / np.pi
    assert_agree(frame.luminance.cd_m2[own], expected, rtol=5e-3)


def test_dimming_scales_the_light_of_probes(engine):
    full, half = (drawn(setting(dimming=(s, s, s)), engine) for s in (1.0, 0.5))
    own = full.surface.is_object
    assert_agree(half.luminance.cd_m2[own] * 2, full.luminance.cd_m2[own], rtol=5e-3)
    assert full.luminance.cd_m2[own].min() > 0


def test_a_captured_sky_does_not_light_twice(engine):
    prepared = setting(lamps=(SKY, LAMP), captured=frozenset(["sky"]))
    frame = drawn(prepared, engine)
    alone = drawn(setting(lamps=(LAMP,)), engine)
    own, real = frame.surface.is_object, frame.surface.valid & ~frame.surface.is_object
    assert_agree(frame.illuminance.lux[own], alone.illuminance.lux[own], rtol=1e-3, atol=1e-2)
    assert (frame.illuminance.lux[real] > alone.illuminance.lux[real]).mean() > 0.9
    beside = drawn(setting(lamps=(SKY, LAMP)), engine)
    assert (beside.illuminance.lux[own] > alone.illuminance.lux[own]).mean() > 0.9


def test_lamps_spare_objects_that_say_so(engine):
    spared = drawn(setting(lamps=(LAMP,), rows={"lit_by_lamps": False}), engine)
    own = spared.surface.is_object
    assert (spared.illuminance.lux[own] == 0).all()
    assert spared.illuminance.lux[spared.surface.valid & ~own].max() > 1
    assert_agree(
        spared.luminance.cd_m2[own], drawn(setting(), engine).luminance.cd_m2[own], rtol=1e-4
    )


def test_lamps_spare_objects_without_any_probes(engine):
    prepared = replace(setting(lamps=(LAMP,), rows={"lit_by_lamps": False}), probes=None)
    frame = drawn(prepared, engine)
    own = frame.surface.is_object
    assert (frame.illuminance.lux[own] == 0).all()
    assert_agree(frame.luminance.cd_m2[own], standing_in_e0(own), rtol=5e-3)


def test_some_of_each(engine):
    """Flags belong to objects, not to the frame."""
    prepared = setting(lamps=(LAMP,))
    first, *others = prepared.surface.objects_table
    infos = (replace(first, lit_by_probes=False, lit_by_lamps=False), *others)
    prepared = replace(prepared, surface=replace(prepared.surface, objects_table=infos))
    frame = drawn(prepared, engine)
    is_first = frame.surface.is_object & (frame.surface.material_id == 0)
    rest = frame.surface.is_object & (frame.surface.material_id > 0)
    assert (frame.illuminance.lux[is_first] == 0).all()
    assert_agree(frame.luminance.cd_m2[is_first], standing_in_e0(is_first), rtol=5e-3)
    assert frame.illuminance.lux[rest].max() > 1


# ── from a scene ────────────────────────────────────────────────────────────────────────────────


def even_volume(lux=(30.0, 60.0, 90.0), distances=True):
    """The same light from everywhere: any surface gets `lux`."""
    positions = POSITIONS["lattice"] - [1.5, 1.5, 3.0]
    coefficients = np.zeros((64, 9, 3))
    coefficients[:, 0] = np.sqrt(4 * np.pi) * np.array(lux) / np.pi
    return volume_at(positions, coefficients, np.full((64, 6, 8, 8), 9.0) if distances else None)


def scene_with(tmp_path, volume, *, thing=True, **tables):
    write_volume(tmp_path / "light.glb", volume)
    write_glb(tmp_path / "ball.glb", ball(0.25, (-0.3, 0, -1.4)), colour=(0.5, 0.5, 0.5))
    tables = {"probes": {"volume": "light.glb"}} | tables
    if thing:
        tables["object"] = [{"mesh": "ball.glb"}]
    return scene(tmp_path, **tables)


def test_a_scene_takes_its_volume(tmp_path, engine):
    frame = drawn(prepare(scene_with(tmp_path, even_volume())), engine)
    own = frame.surface.is_object
    expected = frame.surface.reflectance[own] * np.array([30.0, 60, 90]) / np.pi
    assert own.any()
    assert_agree(frame.luminance.cd_m2[own], expected, rtol=5e-3)
    assert frame.report.ignored_tables == ()


def test_e0_by_probes(tmp_path, engine):
    """E0 of each pixel is what the probes light it with: a lamp of as much light doubles it."""
    made = scene_with(
        tmp_path,
        even_volume(),
        thing=False,
        ambient={"probes": True, "dimming": 0.5},
        lamp=[{"kind": "sky", "illuminance_lux": 1e-6}],
    )
    prepared = prepare(made)
    lux = prepared.ambient.illuminance_lux
    assert lux.shape == (48, 64, 3)
    assert_agree(lux, np.broadcast_to([30.0, 60, 90], lux.shape), rtol=1e-5)
    frame = drawn(prepared, engine)
    captured = np.asarray(frame.captured.linear) * frame.captured.luminance_per_unit
    assert_agree(frame.luminance.cd_m2, captured * 0.5, rtol=3e-3, atol=0.05)


def test_e0_by_probes_is_never_zero(tmp_path):
    volume = even_volume()
    volume.states["day"][:, 3] = 5 * volume.states["day"][:, 0]
    made = scene_with(
        tmp_path, volume, thing=False, ambient={"probes": True},
        probes={"volume": "light.glb", "dering": False},
    )  # fmt: skip
    prepared = prepare(made)
    assert prepared.ambient.illuminance_lux.min() > 0
    assert any("was raised to that" in note for note in prepared.surface.notes)


def test_a_volume_that_is_not_there_yet(tmp_path):
    made = scene_with(tmp_path, even_volume(), probes={"volume": "other.glb"})
    with pytest.raises(InputError, match=r"no file other\.glb yet") as caught:
        prepare(made)
    assert "andon probes bake" in caught.value.remedy
    made = scene_with(tmp_path, even_volume(), thing=False, probes={"volume": "other.glb"})
    assert prepare(made).probes is None  # nothing asks for it


@pytest.mark.parametrize(
    ("table", "field"),
    [
        ({"state": "night"}, "probes.state"),
        ({"zones": ["hall"]}, "probes.zones"),
        ({"blend_state": "night", "blend": 0.5}, "probes.blend_state"),
    ],
)
def test_what_the_volume_has_not_is_named(tmp_path, table, field):
    made = scene_with(tmp_path, even_volume(), probes={"volume": "light.glb"} | table)
    with pytest.raises(InputError) as caught:
        prepare(made)
    assert caught.value.field == field


def test_a_volume_without_distances_is_said(tmp_path):
    prepared = prepare(scene_with(tmp_path, even_volume(distances=False)))
    assert prepared.probes.light.walls is None
    assert any("holds no distances" in note for note in prepared.surface.notes)
    silent = scene_with(
        tmp_path,
        even_volume(distances=False),
        probes={"volume": "light.glb", "visibility": False},
    )
    assert not any("distances" in note for note in prepare(silent).surface.notes)


def test_states_are_mixed(tmp_path):
    volume = even_volume()
    volume = replace(volume, states={**volume.states, "night": 0.1 * volume.states["day"]})
    table = {"volume": "light.glb", "blend_state": "night", "blend": 0.5, "dering": False}
    prepared = prepare(scene_with(tmp_path, volume, probes=table))
    expected = 0.55 * volume.states["day"]
    assert_agree(prepared.probes.light.coefficients, expected, rtol=1e-6)


def test_without_objects_no_light_is_looked_up():
    prepared = ball_setting(width=60, height=45)
    bare = replace(prepared.surface, objects_table=(), objects=EMPTY_GEOMETRY)
    frame = drawn(replace(prepared, surface=bare), "reference")
    assert prepared.probes.standing_lux(frame.surface, bare, np.zeros((0, 3))) is None
