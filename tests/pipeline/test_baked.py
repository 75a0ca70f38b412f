"""Frames with baked light: maps made here from lamps' direct light, so that the sum is known."""

from dataclasses import replace

import numpy as np
import pytest

import andon
from andon.engines.baked_light import map_facts
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.illuminance_maps import (
    BakedLamp,
    Manifest,
    geometry_bytes,
    light_bytes,
    map_file,
    read_manifest,
    write_manifest,
)
from andon.files.pictures import write_png
from andon.pipeline import Renderer
from andon.scene import scene_from_dict
from andon.spaces import look_at, pinhole_view
from andon.surface import reference as surface
from andon.transport.direct import reference as direct
from andon.transport.direct.casters import ShadowRays
from worlds import block, write_obj

LAMPS = {
    "ball": {"kind": "sphere", "position": [0.5, 1.5, 0.2], "radius_m": 0.1, "flux_lm": 900.0},
    "spot": {
        "kind": "spot",
        "position": [-1.0, 2.2, 0.5],
        "direction": [0.4, -1.0, -0.5],
        "intensity_cd": 90.0,
    },
}


def world(folder, transports, parts=None, **tables):
    """A room of 4 × 2.5 × 4 m with a box in it, and its scene with maps in `folder`."""
    write_obj(folder / "room.obj", block((4, 2.5, 4), (0, 1.25, 0), inwards=True))
    write_obj(folder / "box.obj", block((0.6, 0.6, 0.6), (0.0, 0.3, -0.9)))
    write_png(folder / "photo.png", np.full((48, 64, 3), 120, np.uint8))
    lamps = [
        table | {"name": name, "transport": transports.get(name, "direct"), "drawn": False}
        if table["kind"] == "sphere"
        else table | {"name": name, "transport": transports.get(name, "direct")}
        for name, table in LAMPS.items()
    ]
    own = {
        "rig": {
            "camera": {"hfov_degrees": 70.0, "position": [0, 1.4, 1.7], "look_at": [0, 0.9, 0]}
        },
        "capture": {"source": "photo.png"},
        "surface": {"mesh": "room.obj"},
        "ambient": {"illuminance_lux": 200.0},
        "lamp": lamps,
        "object": [{"name": "box", "mesh": "box.obj"}],
    }
    if transports:
        own["baked"] = {"folder": "maps", "lamps": list(transports)}
    (folder / "maps").mkdir(exist_ok=True)
    scene = scene_from_dict(own | tables, folder=folder, file="scene")
    if transports:
        bake_direct_light(scene, folder / "maps", parts or PARTS_OF(transports))
    return scene


def PARTS_OF(transports):
    return {name: "all" if word == "baked" else "bounce" for name, word in transports.items()}


def map_views():
    eyes = [((-1.6, 1.8, 1.6), (0.5, 0.4, -1)), ((1.6, 1.8, 1.6), (-0.5, 0.4, -1))]
    return [
        pinhole_view(160, 120, 80, look_at(*eye), name=f"camera {number}")
        for number, eye in enumerate(eyes)
    ]


def bake_direct_light(scene, folder, parts, views=None, facts=None, photometry="absolute"):
    """Maps that hold the direct light of each lamp, whatever `parts` call it."""
    prepared = prepare(scene, maps=False)
    moment = prepared.at(0.0)
    rays = ShadowRays(prepared.casters(moment))
    geometry, light = {}, {}
    views = views or map_views()
    for number, view in enumerate(views):
        seen = surface.see(prepared.surface, view)
        contents = geometry_bytes(seen.depth, seen.normal)
        (folder / f"{number}.exr").write_bytes(contents)
        geometry[number, 0] = map_file(f"{number}.exr", contents)
        for name in parts:
            own = [lamp for lamp in moment.lamps if lamp.owner == name]
            bias_m = np.full(view.shape, 1e-3)
            lux = direct.illuminate(seen, own, rays, bias_m=bias_m)
            contents = light_bytes(lux.astype(np.float32), photometry=photometry)
            (folder / f"{name}-{number}.exr").write_bytes(contents)
            light[name, number, 0] = map_file(f"{name}-{number}.exr", contents)
    lamps = tuple(BakedLamp(name, part) for name, part in parts.items())
    if facts is None:
        facts = map_facts(scene, prepared.surface, moment.lamps)
    manifest = Manifest(
        tuple(views), (0.0,), lamps, geometry, light, facts=facts, photometry=photometry
    )
    write_manifest(folder, manifest)


def lux_of(scene, engine="reference"):
    return np.asarray(andon.render(scene, engine=engine).illuminance.lux, float)


def relative(ours, truth, covered):
    """Median and 95th percentile of the error, of the mean light, where maps see the surface."""
    off = np.abs(ours - truth)[covered].max(axis=-1) / truth[covered].mean()
    return np.median(off), np.percentile(off, 95)


def test_baked_lamps_light_as_direct_ones(tmp_path, engine):
    truth = lux_of(world(tmp_path, {}), engine)
    frame = andon.render(world(tmp_path, {"ball": "baked", "spot": "baked"}), engine=engine)
    assert frame.report.uncovered_share < 0.01
    median, most = relative(frame.illuminance.lux, truth, frame.baked.covered)
    assert median < 0.005, "of a map of 160×120, from elsewhere"
    assert most < 0.1, "edges of shadows"
    # All light is in the maps: where none sees the surface there is none.
    assert np.all(frame.illuminance.lux[frame.baked.uncovered] == 0)


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
    lamps = [
        LAMPS["ball"]
        | {"name": "ball", "transport": "baked", "drawn": False, "flicker": {"amount": 0.8}}
    ]
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
        path = tmp_path / "maps" / "ball-0.exr"
        path.write_bytes(path.read_bytes()[:-7])
        with pytest.raises(InputError) as caught:
            andon.render(scene, engine="reference")
        assert caught.value.file.endswith("ball-0.exr")


def test_what_changed_since_the_bake_is_said(tmp_path):
    scene = world(tmp_path, {"ball": "baked"})
    assert not [note for note in prepare(scene).surface.notes if "changed" in note]
    moved = [LAMPS["ball"] | {"name": "ball", "transport": "baked", "drawn": False}]
    moved[0] = moved[0] | {"position": [0.0, 1.5, 0.2]}
    other = scene.model_copy(update={"lamp": scene_from_dict(
        {"lamp": moved, "baked": {"folder": "maps", "lamps": ["ball"]}}
    ).lamp})  # fmt: skip
    (note,) = [note for note in prepare(other).surface.notes if "changed" in note]
    assert "the lamp ball" in note
    assert "what stands in it" not in note


def changes_of(scene):
    return [note for note in prepare(scene).surface.notes if "changed" in note]


def facts_of_all(scene, moments=(0.0,)):
    prepared = prepare(scene, maps=False)
    return map_facts(
        scene, prepared.surface, prepared.lamps(0.0), moments=moments,
        frames=prepared.frames, ambient=prepared.ambient,
    )  # fmt: skip


def test_another_photograph_is_said_where_surfaces_have_its_reflectance(tmp_path):
    scene = world(tmp_path, {"ball": "baked"})
    bake_direct_light(scene, tmp_path / "maps", {"ball": "all"}, facts=facts_of_all(scene))
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
    lamp = LAMPS["ball"] | {"name": "ball", "transport": "baked", "drawn": False}
    box = {"name": "box", "mesh": "box.obj"}
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
    first, second = (world(tmp_path, transports, **moving(key, of)) for key in keys)
    facts = facts_of_all(first, moments)
    bake_direct_light(first, tmp_path / "maps", {"ball": "all"}, facts=facts)
    path = tmp_path / "maps" / "maps.json"
    manifest = read_manifest(path.parent)
    several = {(key[0], n): file for key, file in manifest.geometry.items() for n in range(3)}
    light = {(*key[:2], n): file for key, file in manifest.light.items() for n in range(3)}
    write_manifest(path.parent, replace(manifest, moments=moments, geometry=several, light=light))
    assert changes_of(first) == []
    (note,) = changes_of(second)
    assert f"baked: {words}; andon bake" in note


def test_movers_stay_where_they_start(tmp_path):
    """Comparing them at later times moves none."""
    keys = [{"time_seconds": t, "position": [t, 1, 0]} for t in (0.0, 2.0)]
    scene = world(tmp_path, {"ball": "baked"}, **moving(keys))
    prepared = prepare(scene, maps=False)
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
