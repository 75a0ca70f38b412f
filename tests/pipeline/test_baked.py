"""Frames with baked light: maps made from lamps' direct light, so that the sum is known."""

from dataclasses import replace

import numpy as np
import pytest

import andon
from andon.engines.baked_light import map_facts
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.pictures import write_png
from andon.pipeline import Renderer
from andon.scene import scene_from_dict
from pipeline.direct_maps import (
    bake_direct_light,
    lamp_tables,
    lux_of,
    map_views,
    relative,
    world,
)


def test_baked_lamps_light_as_direct_ones(tmp_path, engine):
    truth = lux_of(world(tmp_path, {}), engine)
    frame = andon.render(world(tmp_path, {"ball": "baked", "spot": "baked"}), engine=engine)
    assert frame.report.uncovered_share < 0.01
    median, most = relative(frame.illuminance.lux, truth, frame.baked.covered)
    assert median < 0.005, "of a map of 160×120, from elsewhere"
    assert most < 0.1, "edges of shadows"


def test_each_lamp_counts_once(tmp_path, engine):
    both = lux_of(world(tmp_path, {}), engine)
    frame = andon.render(world(tmp_path, {"ball": "baked"}), engine=engine)
    median, _ = relative(frame.illuminance.lux, both, frame.baked.covered)
    assert median < 0.005, "one direct, one baked"
    frame = andon.render(world(tmp_path, {"ball": "direct+bounce"}), engine=engine)
    # Here the map called a bounce is as bright as the direct light itself.
    expected = both + frame.baked.lux
    assert np.allclose(frame.illuminance.lux, expected, rtol=2e-3, atol=0.05)
    assert frame.baked.lux.mean() > 0.2 * both.mean()


def test_engines_agree(gpu, tmp_path):
    scene = world(tmp_path, {"ball": "baked", "spot": "direct+bounce"})
    ours, theirs = (andon.render(scene, engine=name).image.rgb for name in ("gpu", "reference"))
    off = np.abs(ours.astype(int) - theirs.astype(int))
    assert (off.max(axis=-1) <= 5).mean() >= 0.999
    assert off.mean() <= 0.5


def test_what_lamps_do_not_light_takes_none(tmp_path, engine):
    table = {"name": "box", "mesh": "box.obj", "lit_by_lamps": False}
    frame = andon.render(world(tmp_path, {"ball": "baked"}, object=[table]), engine=engine)
    on_box = frame.surface.is_object
    assert on_box.sum() > 50
    assert np.all(np.asarray(frame.illuminance.lux)[on_box] == 0)
    assert not frame.baked.asked[on_box].any()
    assert np.asarray(frame.illuminance.lux)[~on_box].mean() > 1


def test_flicker_scales_the_maps(tmp_path, engine):
    lamps = lamp_tables({"ball": "baked"}, ["ball"], flicker={"amount": 0.8})
    tables = {"lamp": lamps, "scene": {"duration_seconds": 3.0}}
    renderer = Renderer(world(tmp_path, {"ball": "baked"}, **tables), engine)
    light = renderer.prepared.baked.light
    steady = None
    for time in (0.0, 0.4, 1.7):
        share = light.shares(time)["ball"]
        lux = np.asarray(renderer.render(time).illuminance.lux, float) / share
        assert lux.max() > 1
        steady = lux if steady is None else steady
        assert np.allclose(lux, steady, rtol=2e-3)
    assert light.shares(0.0)["ball"] != light.shares(1.7)["ball"]


def test_gaps_are_counted(tmp_path, engine):
    scene = world(tmp_path, {"ball": "baked"})
    bake_direct_light(scene, tmp_path / "maps", {"ball": "all"}, views=map_views()[:1])
    one = andon.render(scene, engine=engine)
    bake_direct_light(scene, tmp_path / "maps", {"ball": "all"})
    two = andon.render(scene, engine=engine)
    assert one.report.uncovered_share > 0.05 > two.report.uncovered_share
    assert one.baked.uncovered.sum() == round(one.report.uncovered_share * one.baked.asked.sum())


def test_no_table_no_light(tmp_path):
    frame = andon.render(world(tmp_path, {}), engine="reference")
    assert frame.baked is None
    assert frame.report.uncovered_share is None


class TestRefusals:
    def test_nothing_baked_yet(self, tmp_path):
        scene = world(tmp_path, {"ball": "baked"})
        (tmp_path / "maps" / "maps.json").unlink()
        with pytest.raises(InputError, match="no illuminance maps") as caught:
            andon.render(scene, engine="reference")
        assert caught.value.field == "baked.folder"
        assert "andon bake" in caught.value.remedy

    def test_a_lamp_that_is_not_in_the_maps(self, tmp_path):
        scene = world(tmp_path, {"ball": "baked", "spot": "baked"})
        bake_direct_light(scene, tmp_path / "maps", {"ball": "all"})
        with pytest.raises(InputError, match="'spot'") as caught:
            andon.render(scene, engine="reference")
        assert caught.value.field == "lamp[1].transport"

    def test_another_part_of_its_light(self, tmp_path):
        scene = world(tmp_path, {"ball": "direct+bounce"})
        bake_direct_light(scene, tmp_path / "maps", {"ball": "all"})
        with pytest.raises(InputError, match="reflected light alone"):
            andon.render(scene, engine="reference")

    def test_relative_maps_of_an_absolute_scene(self, tmp_path):
        scene = world(tmp_path, {"ball": "baked"})
        bake_direct_light(scene, tmp_path / "maps", {"ball": "all"}, photometry="relative")
        with pytest.raises(InputError, match="relative light"):
            andon.render(scene, engine="reference")

    def test_a_damaged_map(self, tmp_path):
        scene = world(tmp_path, {"ball": "baked"})
        path = tmp_path / "maps" / "ball-0-0.exr"
        path.write_bytes(path.read_bytes()[:-7])
        with pytest.raises(InputError) as caught:
            andon.render(scene, engine="reference")
        assert caught.value.file.endswith("ball-0-0.exr")


def test_what_changed_since_the_bake_is_said(tmp_path):
    scene = world(tmp_path, {"ball": "baked"})
    assert not [note for note in prepare(scene).surface.notes if "changed" in note]
    moved = lamp_tables({"ball": "baked"}, ["ball"], position=[0.0, 1.5, 0.2])
    other = scene.model_copy(update={"lamp": scene_from_dict(
        {"lamp": moved, "baked": {"folder": "maps", "lamps": ["ball"]}}
    ).lamp})  # fmt: skip
    (note,) = [note for note in prepare(other).surface.notes if "changed" in note]
    assert "the lamp ball" in note
    assert "what stands in it" not in note


def changes_of(scene):
    return [note for note in prepare(scene).surface.notes if "changed" in note]


def facts_of_all(scene, moments=(0.0,)):
    prepared = prepare(scene, drawn=False)
    return map_facts(
        scene, prepared.surface, prepared.lamps(0.0), moments=moments,
        frames=prepared.frames, ambient=prepared.ambient,
    )  # fmt: skip


def test_another_photograph_is_said_where_surfaces_have_its_reflectance(tmp_path):
    scene = world(tmp_path, {"ball": "baked"})
    assert changes_of(scene) == []
    brighter = scene.model_copy(
        update={"ambient": scene.ambient.model_copy(update={"illuminance_lux": 300.0})}
    )
    assert changes_of(brighter) == [], "white and E0 go up together: the reflectance stays"
    stated = brighter.model_copy(
        update={"capture": scene.capture.model_copy(update={"luminance_per_unit": 64.0})}
    )
    (note,) = changes_of(stated)
    assert "baked: the photograph, or E0; andon bake" in note
    write_png(tmp_path / "photo.png", np.full((48, 64, 3), 140, np.uint8))
    (note,) = changes_of(scene)
    assert "baked: the photograph, or E0; andon bake" in note


def test_a_dimmed_photograph_is_no_change(tmp_path):
    scene = world(tmp_path, {"ball": "baked"})
    dimmed = scene.model_copy(update={"ambient": scene.ambient.model_copy(update={"dimming": 0.2})})
    assert facts_of_all(dimmed) == facts_of_all(scene)


def moving(key, of="object"):
    box = {"name": "box", "mesh": "box.obj"}
    (lamp,) = lamp_tables({"ball": "baked"}, ["ball"])
    tables = {"lamp": [lamp | ({"key": key} if of == "lamp" else {})]}
    tables["object"] = [box | ({"key": key} if of == "object" else {})]
    return tables | {"scene": {"duration_seconds": 2.0}}


@pytest.mark.parametrize(
    ("of", "words"), [("object", "how things move in it"), ("lamp", "the lamp ball")]
)
def test_another_movement_is_said(tmp_path, of, words):
    keys = [
        [{"time_seconds": 0.0, "position": [0, 1, 0]}, {"time_seconds": 2.0, "position": [x, 1, 0]}]
        for x in (0.3, 0.6)
    ]
    transports, moments = {"ball": "baked"}, (0.0, 1.0, 2.0)
    second, first = (
        world(tmp_path, transports, moments=moments, **moving(key, of)) for key in keys[::-1]
    )
    assert changes_of(first) == []
    (note,) = changes_of(second)
    assert f"baked: {words}; andon bake" in note


def test_movers_stay_where_they_start(tmp_path):
    """Comparing them at later times moves none."""
    keys = [{"time_seconds": t, "position": [t, 1, 0]} for t in (0.0, 2.0)]
    scene = world(tmp_path, {"ball": "baked"}, **moving(keys))
    prepared = prepare(scene, drawn=False)
    (mover,) = prepared.surface.movers
    before = mover.geometry.positions.copy()
    map_facts(scene, prepared.surface, prepared.lamps(0.0), moments=(0.0, 1.0, 2.0))
    assert np.array_equal(mover.geometry.positions, before)


def test_a_shadow_map_is_no_change(tmp_path):
    scene = world(tmp_path, {"spot": "baked"})
    prepared = prepare(scene)
    lamps = prepared.lamps(0.0)
    finer = [
        replace(lamp, shadow=replace(lamp.shadow, map_size=4096)) if lamp.owner == "spot" else lamp
        for lamp in lamps
    ]
    model = prepared.surface
    assert map_facts(scene, model, finer) == map_facts(scene, model, lamps)
