"""Which objects of a scene mirror, by their files and by their keys."""

import json
import struct

import numpy as np
import pytest

from andon.engines.highlights import finish_of, highlights_of
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.glare.highlights.model import LEAST_ALPHA
from andon.pipeline import Renderer
from andon.quantities import Material
from andon.scene import scene_from_dict
from andon.scene.objects import SceneObject
from worlds import ball, write_glb

STEEL = Material(metallic=1.0, roughness=0.4, metallic_stated=True)


def entry(**keys):
    return SceneObject.model_validate({"mesh": "thing.glb"} | keys)


def with_material(path, **material):
    """A ball's file with another `pbrMetallicRoughness`."""
    write_glb(path, ball(0.5, (0, 0, -2), 3))
    data = path.read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20 : 20 + size])
    document["materials"][0]["pbrMetallicRoughness"] = material
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    head = struct.pack("<III", 0x46546C67, 2, 20 + len(text) + len(rest))
    path.write_bytes(head + struct.pack("<II", len(text), 0x4E4F534A) + text + rest)


def scene_of(folder, **keys):
    return scene_from_dict(
        {
            "rig": {"camera": {"width": 24, "height": 24, "fx": 24.0}},
            "lamp": [{"kind": "directional", "direction": [0, 0, -1], "illuminance_lux": 100.0}],
            "object": [{"mesh": "thing.glb"} | keys],
        },
        folder=folder,
    )


@pytest.mark.parametrize(
    ("material", "mirrors"),
    [
        ({}, False),
        ({"roughnessFactor": 0.1}, False),
        ({"metallicFactor": 0.0, "roughnessFactor": 0.1}, False),
        ({"metallicFactor": 1.0}, True),
        ({"metallicFactor": 0.5, "roughnessFactor": 0.1}, True),
    ],
)
def test_by_default_only_stated_metal_mirrors(tmp_path, material, mirrors):
    """glTF's default is all metal: files that do not say stay as diffuse as they were."""
    with_material(tmp_path / "thing.glb", **material)
    scene = scene_of(tmp_path)
    assert (prepare(scene).highlights is not None) == mirrors
    frame = Renderer(scene, "reference").render()
    assert (frame.highlights is not None) == mirrors
    plain = Renderer(scene_of(tmp_path, highlights="none"), "reference").render()
    assert np.array_equal(frame.luminance.cd_m2, plain.luminance.cd_m2) != mirrors


def test_the_files_metal_as_cook_torrance():
    finish = finish_of(entry(), STEEL, 0)
    assert finish.kind == "cook-torrance"
    assert finish.alpha == pytest.approx((0.16, 0.16))
    assert finish.metallic == 1
    smooth = finish_of(entry(roughness=0.0), STEEL, 0)
    assert smooth.alpha == (LEAST_ALPHA, LEAST_ALPHA)


def test_keys_stand_in_for_the_file():
    assert finish_of(entry(highlights="none"), STEEL, 0) is None
    assert finish_of(entry(metallic=0.0), STEEL, 0) is None
    plaster = Material(metallic=1.0)
    assert finish_of(entry(), plaster, 0) is None
    assert finish_of(entry(metallic=0.7), plaster, 0).metallic == 0.7
    assert finish_of(entry(highlights="cook-torrance"), plaster, 0).metallic == 0
    phong = finish_of(
        entry(highlights="phong", phong_exponent=50.0, phong_reflectance=0.3), STEEL, 0
    )
    assert (phong.kind, phong.exponent, phong.reflectance) == ("phong", 50.0, (0.3, 0.3, 0.3))


def test_anisotropy_by_key_and_by_file():
    brushed = finish_of(
        entry(highlights="anisotropic", anisotropy=0.5, brush=(2.0, 0.0, 0.0)), STEEL, 0
    )
    assert brushed.alpha == pytest.approx((0.16 + 0.84 * 0.25, 0.16))
    np.testing.assert_allclose(brushed.axis, [1, 0, 0])
    extension = {"KHR_materials_anisotropy": {"anisotropyStrength": 1.0}}
    file = Material(metallic=1.0, roughness=0.4, metallic_stated=True, extensions=extension)
    assert finish_of(entry(highlights="anisotropic"), file, 0).alpha == pytest.approx((1.0, 0.16))


def test_a_brush_turns_with_its_object(tmp_path):
    with_material(tmp_path / "thing.glb", metallicFactor=1.0)
    half = np.sqrt(0.5)
    scene = scene_of(tmp_path, highlights="anisotropic", rotation_xyzw=[0, 0, half, half])
    found = highlights_of(scene, prepare(scene).surface)
    np.testing.assert_allclose(found.at(0.0)[0].axis, [-1, 0, 0], atol=1e-12)


def test_water_has_ripples_of_the_scenes_seed():
    water = {"slope": 0.1, "waves": 9}
    first = finish_of(entry(water=water), Material(), 3)
    assert first.kind == "water"
    assert len(first.waves.slope) == 9
    same = finish_of(entry(water=water | {"seed": 3}), Material(), 8)
    np.testing.assert_array_equal(first.waves.phase, same.waves.phase)


@pytest.mark.parametrize(
    ("keys", "rule"),
    [
        ({"highlights": "shiny"}, "highlights"),
        ({"roughness": 1.2}, "roughness"),
        ({"brush": [0, 0, 0]}, "zero vector"),
        ({"phong_exponent": 0.0}, "phong_exponent"),
        ({"water": {}, "highlights": "phong"}, "highlights"),
        ({"water": {"index": 1.0}}, "index"),
        ({"water": {"wavelength_m": [1.0, 0.1]}}, "wavelength_m"),
        ({"water": {"waves": 65}}, "waves"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, keys, rule):
    with pytest.raises(InputError, match=rule):
        scene_of(tmp_path, **keys)
