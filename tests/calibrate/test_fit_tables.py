"""Fitted light in the tables of a scene: what was fitted is what the file draws."""

from dataclasses import replace

import numpy as np
import pytest

from andon.calibrate.lamps import FitSettings, fit_lamps
from andon.calibrate.lamps.report import fit_report, stated_light
from andon.calibrate.lamps.terms import Painter, Term, prepared_with
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.pipeline import Renderer
from andon.quantities import photometric
from andon.scene import load_scene, scene_from_dict
from photometry_files import ldt
from worlds import write_scene_files

FACTOR = np.array([1.6, 0.9, 0.3])
PLACE = [-0.5, 0.3, -1.2]

LAMPS = {
    "flux of a point": {"kind": "point", "position": PLACE, "flux_lm": 300.0},
    "intensity of a spot, in kelvin": {
        "kind": "spot", "position": PLACE, "direction": [0, 0, -1], "intensity_cd": 60.0,
        "temperature_k": 3000.0,
    },
    "luminance of a ball": {
        "kind": "sphere", "position": PLACE, "radius_m": 0.1, "luminance_cd_m2": 2000.0,
        "rgb": [1.0, 0.8, 0.6],
    },
    "a bulb in a shell": {
        "kind": "point", "position": PLACE, "flux_lm": 400.0,
        "shell": {"radius_m": 0.1, "transmittance": [0.6, 0.5, 0.3]},
    },
    "lux of parallel light": {
        "kind": "directional", "direction": [0.3, -0.2, -1], "illuminance_lux": 80.0,
        "chromaticity_xy": [0.33, 0.35],
    },
    "sky and ground": {
        "kind": "hemisphere", "illuminance_lux": 50.0, "ground_illuminance_lux": 30.0,
        "ground_rgb": [1.0, 0.5, 0.2],
    },
    "a luminaire that states nothing": {
        "kind": "ies", "position": PLACE, "direction": [0, 0, -1], "file": "lamp.ldt",
    },
}  # fmt: skip


def scene_with(folder, table, **more):
    (folder / "lamp.ldt").write_text(ldt())
    tables = write_scene_files(folder, lamp=[{"name": "fitted", **table}], **more)
    return scene_from_dict(tables, folder=folder, file="scene.toml")


def reference_of(scene):
    """What the photograph is with `FACTOR` times the lamp, linear."""
    changed = prepared_with(prepare(scene), [Term("lamp", "fitted")], FACTOR[None])
    return Painter.linear(Renderer(changed, "reference").render()).astype(np.float32)


@pytest.mark.parametrize("table", LAMPS.values(), ids=LAMPS)
def test_the_fitted_scene_draws_the_fitted_picture(tmp_path, table):
    scene = scene_with(tmp_path, table)
    reference = reference_of(scene)
    found = fit_lamps(scene, reference, settings=FitSettings(engine="reference"))
    assert found.lamps[0].factor == pytest.approx(FACTOR, rel=2e-3)
    (tmp_path / "fitted.toml").write_text(found.scene.to_toml())
    again = Renderer(load_scene(tmp_path / "fitted.toml"), "reference").render()
    assert again.luminance.cd_m2 == pytest.approx(found.frame.luminance.cd_m2, rel=1e-6)
    stated = stated_light(found, "fitted")
    assert "temperature_k" not in stated
    assert "rgb" in stated
    assert photometric(np.array(stated["rgb"])) == pytest.approx(1)


def test_dimming_bounce_and_response_are_in_the_tables(tmp_path):
    scene = scene_with(tmp_path, LAMPS["flux of a point"])
    reference = 0.6 * reference_of(scene) + np.float32(0.02)
    codes = np.round(255 * np.clip(reference, 0, 1) ** (1 / 1.8)).astype(np.uint8)
    settings = FitSettings(
        dimming="one", bounce=True, response=True, engine="reference", align="none"
    )
    found = fit_lamps(scene, codes, settings=settings)
    (tmp_path / "fitted.toml").write_text(found.scene.to_toml())
    loaded = load_scene(tmp_path / "fitted.toml")
    again = Renderer(loaded, "reference").render()
    codes_off = again.image.rgb.astype(int) - found.frame.image.rgb
    assert np.abs(codes_off).max() <= 1
    assert loaded.ambient.dimming == pytest.approx(tuple(found.dimming.factor))
    assert again.captured.response == found.response


def test_a_lamp_that_is_not_in_the_reference_gets_zero_and_keeps_its_colour(tmp_path):
    scene = scene_with(tmp_path, LAMPS["intensity of a spot, in kelvin"])
    photograph = np.asarray(prepare(scene).frames["mono"].linear)
    found = fit_lamps(scene, photograph, settings=FitSettings(engine="reference"))
    (table,) = found.scene.lamp
    assert table.intensity_cd == pytest.approx(0, abs=1e-4)
    assert stated_light(found, "fitted")["intensity_cd"] == table.intensity_cd


def test_the_report_is_json_with_units_in_its_names(tmp_path):
    import json

    scene = scene_with(tmp_path, LAMPS["flux of a point"])
    found = fit_lamps(scene, reference_of(scene), settings=FitSettings(engine="reference"))
    text = json.dumps(fit_report(replace(found)), allow_nan=False)
    report = json.loads(text)
    (lamp,) = report["lamps"]
    assert lamp["name"] == "fitted"
    assert lamp["flux_lm"] == pytest.approx(300 * photometric(FACTOR), rel=2e-3)
    assert report["photometry"] == "absolute"
    assert report["errors"]["whole"]["unchanged"]["gain"] is None
    assert len(report["errors"]["whole"]["gain_one"]["gain"]) == 3


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"flux_lm": 0.0}, "flux_lm is 0"),
        ({"key": [{"time_seconds": 1.0, "flux_lm": 5.0}]}, "keys animate flux_lm"),
        ({"transport": "baked"}, "transport is 'baked'"),
    ],
)
def test_lamps_that_cannot_be_fitted_are_refused(tmp_path, change, words):
    table = LAMPS["flux of a point"] | change
    baked = {"folder": "maps", "lamps": ["fitted"]} if "transport" in change else None
    more = {} if baked is None else {"baked": baked}
    tables = write_scene_files(tmp_path) | {"lamp": [{"name": "fitted", **table}]} | more
    scene = scene_from_dict(tables, folder=tmp_path, file="scene.toml")
    with pytest.raises(InputError, match=words):
        fit_lamps(scene, tmp_path / "photo.png", settings=FitSettings(engine="reference"))


def test_a_scene_without_a_photograph_is_refused():
    scene = scene_from_dict({"lamp": [{"kind": "point", "position": PLACE, "flux_lm": 3.0}]})
    with pytest.raises(InputError, match="no photograph to fit"):
        fit_lamps(scene, "reference.png")
