"""Exports, evaluated by the formulas of the programs that they are for."""

import csv
import io
import json
import struct

import numpy as np
import pytest
from PIL import Image

from andon.errors import InputError
from andon.harmonics import basis, convolved, cube_directions, deringed, irradiance, smallest
from andon.harmonics.conventions import from_cmgen_text, from_gltf, from_three, from_unity
from andon.responses import srgb_decode
from andon.transport.probes.export import (
    EXPORTS,
    ExportUnit,
    PlacedLight,
    chosen_probe,
    csv_text,
    exported_lights,
    filament_text,
    image_based_glb,
    probe_lights,
    three_json,
    unity_json,
)
from andon.transport.probes.export.image_based import SIZES, band_factors
from andon.transport.probes.light import light_between, probe_coefficients
from volume_files import light, two_rooms

from .volumes import POSITIONS, unit_vectors, volume_at

SEED = 7
MEASURED = ExportUnit()
RELATIVE = ExportUnit("absolute", 50.0)


def normals(count=200):
    values = np.random.default_rng(SEED).normal(size=(count, 3))
    return values / np.linalg.norm(values, axis=1, keepdims=True)


def probe(order=2, seed=3):
    """Light that is nowhere negative by much, at a place that tells the axes apart."""
    values = light(1, order, seed)[0]
    values[1:] *= 0.3
    return PlacedLight("門 a", np.array([1.0, 2.0, -3.0]), values)


def expected(found, directions):
    """Illuminance in lux of bands 0 to 2, by the reference."""
    return irradiance(found.coefficients[:9], directions)


def three_irradiance(numbers, directions):
    """`SphericalHarmonics3.getIrradianceAt` of three.js, with its rounded constants."""
    c = np.array(numbers).reshape(9, 3)
    x, y, z = directions.T[..., None]
    return (
        c[0] * 0.886227
        + 2 * 0.511664 * (c[1] * y + c[2] * z + c[3] * x)
        + 2 * 0.429043 * (c[4] * x * y + c[5] * y * z + c[7] * x * z)
        + c[6] * (0.743125 * z * z - 0.247708)
        + c[8] * 0.429043 * (x * x - y * y)
    )


@pytest.mark.parametrize("order", [0, 1, 2, 4])
def test_three_by_its_own_formula(order):
    found = probe(order)
    document = json.loads(three_json([found], MEASURED))
    top = document["object"]
    assert document["metadata"]["type"] == "Object"
    assert (top["type"], top["name"], top["intensity"]) == ("LightProbe", "門 a", 1)
    assert top["matrix"][12:15] == [1, 2, -3]
    assert len(top["sh"]) == 27
    lux = three_irradiance(top["sh"], normals())
    # Its constants have six digits.
    np.testing.assert_allclose(lux, expected(found, normals()), atol=2e-6 * lux.max())
    if order == 2:
        np.testing.assert_array_equal(
            np.reshape(top["sh"], (9, 3)), found.coefficients
        )  # comes back as it left


def test_three_of_several_is_one_hidden_group():
    """Visible, the probes would add up."""
    volume = two_rooms()
    top = json.loads(three_json(probe_lights(volume, volume.states["day"]), MEASURED))["object"]
    assert (top["type"], top["visible"]) == ("Group", False)
    assert [child["name"] for child in top["children"]] == list(volume.names)
    assert len({child["uuid"] for child in top["children"]}) == volume.count
    np.testing.assert_array_equal(
        [child["sh"] for child in top["children"]], volume.states["day"].reshape(10, 27)
    )


def polynomial_value(c, directions):
    """Filament's shader and Unity's `SphericalHarmonicsL2.Evaluate`."""
    x, y, z = directions.T[..., None]
    return (
        c[0] + c[1] * y + c[2] * z + c[3] * x + c[4] * x * y + c[5] * y * z
        + c[6] * (3 * z * z - 1) + c[7] * x * z + c[8] * (x * x - y * y)
    )  # fmt: skip


def unity_shader_value(sh, directions):
    """The same by the vectors that Unity hands to shaders: unity_SHA, unity_SHB, unity_SHC."""
    x, y, z = directions.T
    result = np.empty((len(directions), 3))
    for channel in range(3):
        c = sh[channel]
        a = np.array([c[3], c[1], c[2], c[0] - c[6]])
        b = np.array([c[4], c[5], 3 * c[6], c[7]])
        result[:, channel] = (
            np.stack([x, y, z, np.ones_like(x)], axis=-1) @ a
            + np.stack([x * y, y * z, z * z, z * x], axis=-1) @ b
            + c[8] * (x * x - y * y)
        )
    return result


def filament_numbers(text):
    rows = [line.partition(";")[0].strip("() ").split(",") for line in text.splitlines()]
    return np.array(rows, float)


@pytest.mark.parametrize("order", [0, 2, 3])
def test_filament_by_its_own_formula(order):
    found = probe(order)
    text = filament_text([found], MEASURED).decode()
    numbers = filament_numbers(text)
    assert numbers.shape == (9, 3)
    assert text.splitlines()[5].endswith("); // L2-1, irradiance, pre-scaled base")
    np.testing.assert_allclose(
        polynomial_value(numbers, normals()), expected(found, normals()) / np.pi, rtol=1e-12
    )


def test_filament_is_one_probe():
    with pytest.raises(InputError, match="holds one probe; choose one with --probe"):
        filament_text([probe(), probe()], MEASURED)


def test_unity_by_its_own_formula():
    """Its axes are left-handed: what lies at x in glTF lies at −x there, light and place alike."""
    found = probe()
    document = json.loads(unity_json([found], MEASURED))
    entry = document["probes"][0]
    assert entry["position"] == {"x": -1, "y": 2, "z": -3}
    sh = np.array(entry["sh"]).reshape(3, 9)
    mirrored = normals() * [-1, 1, 1]
    want = expected(found, normals()) / np.pi
    np.testing.assert_allclose(unity_shader_value(sh, mirrored), want, rtol=1e-12)
    np.testing.assert_allclose(polynomial_value(sh.T, mirrored), want, rtol=1e-12)


def test_white_light_from_all_sides_is_white():
    """Luminance 50 everywhere, white 50: a white diffuse surface is 1 in every program."""
    flat = np.zeros((9, 3))
    flat[0] = 50 * np.sqrt(4 * np.pi)
    found = PlacedLight("a", np.zeros(3), flat)
    three = json.loads(three_json([found], RELATIVE))["object"]["sh"]
    np.testing.assert_allclose(three_irradiance(three, normals()) / np.pi, 1, rtol=1e-6)
    sh = np.array(json.loads(unity_json([found], RELATIVE))["probes"][0]["sh"]).reshape(3, 9)
    np.testing.assert_allclose(polynomial_value(sh.T, normals()), 1, rtol=1e-13)
    numbers = filament_numbers(filament_text([found], RELATIVE).decode())
    np.testing.assert_allclose(polynomial_value(numbers, normals()), 1, rtol=1e-13)
    entry = image_based(image_based_glb([found], RELATIVE))[0][0]
    lux = basis(normals(), 2) @ np.array(entry["irradianceCoefficients"]) * entry["intensity"]
    np.testing.assert_allclose(lux / np.pi, 1, rtol=1e-13)
    for level in image_based(image_based_glb([found], RELATIVE))[1][0]:
        np.testing.assert_allclose(level * entry["intensity"], 1, rtol=1e-12)


def image_based(data):
    """The lights of a GLB file and, of each, its levels (6, s, s, 3) in linear light."""
    length = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + length]), data[28 + length :]
    assert document["extensionsUsed"] == ["EXT_lights_image_based"]
    lights = document["extensions"]["EXT_lights_image_based"]["lights"]

    def picture(index):
        entry = document["images"][index]
        view = document["bufferViews"][entry["bufferView"]]
        part = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        with Image.open(io.BytesIO(part)) as image:
            assert (image.format, image.mode, entry["mimeType"]) == ("PNG", "RGB", "image/png")
            return srgb_decode(np.asarray(image) / 255.0)

    levels = [
        [np.stack([picture(face) for face in level]) for level in entry["specularImages"]]
        for entry in lights
    ]
    for entry, found in zip(lights, levels, strict=True):
        assert entry["specularImageSize"] == len(found[0][0])
        assert [level.shape for level in found] == [(6, size, size, 3) for size in SIZES]
    for number, scene in enumerate(document["scenes"]):
        assert scene["extensions"]["EXT_lights_image_based"] == {"light": number}
    return lights, levels, document


def test_gltf_holds_what_its_schema_demands():
    """The required properties and shapes of the extension's JSON schema."""
    volume = two_rooms()
    lights, levels, document = image_based(
        image_based_glb(probe_lights(volume, volume.states["day"])[:2], MEASURED)
    )
    assert len(lights) == len(levels) == len(document["scenes"]) == 2
    for entry in lights:
        assert np.shape(entry["irradianceCoefficients"]) == (9, 3)
        assert np.shape(entry["specularImages"]) == (len(SIZES), 6)
        assert set(entry) <= {
            "name", "rotation", "intensity", "irradianceCoefficients", "specularImages",
            "specularImageSize",
        }  # fmt: skip
    assert [scene["name"] for scene in document["scenes"]] == ["probe 0", "probe 1"]
    np.testing.assert_array_equal(document["nodes"][1]["translation"], volume.positions[1])


def test_gltf_gives_the_illuminance():
    found = probe(4)
    entry = image_based(image_based_glb([found], MEASURED))[0][0]
    lux = basis(normals(), 2) @ np.array(entry["irradianceCoefficients"]) * entry["intensity"]
    np.testing.assert_allclose(lux, expected(found, normals()), rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_gltf_pictures_show_the_light_as_one_sees_it(order):
    """Level 0 is the luminance itself, the last one E/π; each image is that of an onlooker."""
    found = probe(order)
    lights, levels, _ = image_based(image_based_glb([found], MEASURED))
    intensity = lights[0]["intensity"]
    for level, light_of in (
        (0, lambda d: basis(d, order) @ found.coefficients),
        (-1, lambda d: basis(d, order) @ convolved(found.coefficients) / np.pi),
    ):
        seen = levels[0][level] * intensity
        want = np.maximum(light_of(cube_directions(SIZES[level])), 0)[:, :, ::-1]
        # Half a step of 8 bits in sRGB: its steepest place is white, 2.4·(1/1.055) per unit.
        np.testing.assert_allclose(seen, want, atol=0.5 / 255 * 2.3 * intensity)
    # −Z, face 5: who looks there has +X on the right and +Y on top.
    size = SIZES[0]
    direction = cube_directions(size)[5][:, ::-1]
    assert direction[0, -1] @ [1, 0, 0] > 0.5
    assert direction[0, -1] @ [0, 1, 0] > 0.5


def test_blur_goes_from_a_mirror_to_the_cosine():
    np.testing.assert_array_equal(band_factors(0.0, 4), np.ones(5))
    cosine = np.array([1, 2 / 3, 1 / 4, 0, -1 / 24])
    np.testing.assert_allclose(band_factors(1.0, 4), cosine, atol=1e-14)
    half = band_factors(0.5, 4)
    assert np.all(np.diff(half) < 0)
    assert np.all((cosine[1:] < half[1:]) & (half[1:] < 1))


def test_black_light():
    found = PlacedLight("a", np.zeros(3), np.zeros((9, 3)))
    lights, levels, _ = image_based(image_based_glb([found], MEASURED))
    assert lights[0]["intensity"] == 1
    assert all(level.max() == 0 for level in levels[0])


@pytest.mark.parametrize("unit", [MEASURED, RELATIVE, ExportUnit("relative")])
def test_csv_comes_back(unit):
    volume = two_rooms(order=3)
    lights = probe_lights(volume, volume.states["night"])
    rows = list(csv.reader(io.StringIO(csv_text(lights, unit).decode())))
    assert len(rows) == 11
    assert rows[0][:5] == ["name", "x_m", "y_m", "z_m", rows[0][4]]
    assert rows[0][4].startswith("L0_0_red_")
    assert rows[0][-1].startswith("L3_3_blue_")
    assert rows[0][4].endswith("_relative") == (unit.photometry == "relative")
    assert rows[-1][0] == "門"
    values = np.array([row[4:] for row in rows[1:]], float).reshape(10, 16, 3)
    np.testing.assert_allclose(values, volume.states["night"] * unit.scale, rtol=1e-15)
    np.testing.assert_array_equal(np.array([row[1:4] for row in rows[1:]], float), volume.positions)


@pytest.mark.parametrize("name", EXPORTS)
def test_the_same_light_gives_the_same_bytes(name):
    lights = [probe()]
    assert EXPORTS[name].write(lights, RELATIVE) == EXPORTS[name].write(lights, RELATIVE)


def test_what_leaves_comes_back():
    """By the conversions in the other direction, in world axes and cd/m²."""
    found, white = probe(), RELATIVE.white_cd_m2
    three = json.loads(three_json([found], RELATIVE))["object"]["sh"]
    unity = json.loads(unity_json([found], RELATIVE))["probes"][0]["sh"]
    entry = image_based(image_based_glb([found], RELATIVE))[0][0]
    for back in (
        from_three(three),
        from_unity(np.reshape(unity, (3, 9)), mirror="x"),
        from_cmgen_text(filament_text([found], RELATIVE).decode()),
        from_gltf(entry["irradianceCoefficients"]) * entry["intensity"],
    ):
        np.testing.assert_allclose(white * back, found.coefficients, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("white", [0.0, -1.0, float("nan"), float("inf")])
def test_white_is_a_luminance(white):
    with pytest.raises(InputError, match="white_cd_m2: must be > 0 cd/m²"):
        ExportUnit("absolute", white)


def test_probes_are_chosen_by_name_or_number():
    names = ("a", "b", "b", "3", "x")
    assert [chosen_probe(names, typed) for typed in ("a", "3", "4", "0")] == [0, 3, 4, 0]
    for typed, message in (
        ("b", "2 probes are called 'b'; give a number: 1, 2"),
        ("5", "must be 0…4, got 5"),
        ("99999999999999999999", "no probe is called"),
        ("-1", "no probe is called '-1'"),
    ):
        with pytest.raises(InputError, match=message):
            chosen_probe(names, typed)
    with pytest.raises(InputError, match="did you mean 'kitchen'"):
        chosen_probe(("kitchen", "hall"), "kichen")


# ── which light ───────────────────────────────────────────────────────────────────────────────


def ringing_volume(order=2, distances=None):
    """Probes with a lone small lamp each: as sharp as the bands are."""
    values = 40 * basis(unit_vectors(64, seed=order), order)[..., None] * [1.0, 0.8, 0.5]
    return volume_at(POSITIONS["lattice"], values, distances)


def least(coefficients):
    """The smallest illuminance of light (k, 3), relative to the mean."""
    return (smallest(coefficients) / (np.pi * coefficients[0] / np.sqrt(4 * np.pi))).min()


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize("name", EXPORTS)
def test_what_is_exported_does_not_ring(name, order):
    """Neither with all bands nor with those that the format holds; as captured, both would."""
    volume = ringing_volume(order)
    export, light_of = EXPORTS[name], volume.states["day"]
    raw = exported_lights(volume, light_of, export, dering=False)
    smooth = exported_lights(volume, light_of, export)
    assert len(raw) == len(smooth) == 64
    for before, after, own in zip(raw, smooth, light_of, strict=True):
        np.testing.assert_array_equal(before.coefficients, own)
        assert least(before.coefficients) < -0.05 / order
        assert least(after.coefficients) > -1e-9
        if export.cuts_bands:
            assert least(after.coefficients[:9]) > -1e-9
    if order == 2 or not export.cuts_bands:
        given = np.stack([found.coefficients for found in smooth])
        np.testing.assert_allclose(given, deringed(light_of), rtol=1e-12, atol=1e-12)


def test_light_that_does_not_ring_is_exported_bit_for_bit():
    volume = two_rooms(order=2)
    lights = exported_lights(volume, volume.states["day"], EXPORTS["csv"])
    given = np.stack([found.coefficients for found in lights])
    np.testing.assert_array_equal(given, volume.states["day"])


def test_walls_count_at_a_point():
    """What frames look up there; without visibility, the four probes of the cell."""
    hidden = np.where(np.arange(64) % 2 == 0, 0.05, 9.0)[:, None, None, None]
    volume = ringing_volume(distances=np.broadcast_to(hidden, (64, 6, 8, 8)))
    smooth, at = deringed(volume.states["day"]), np.array([0.4, 1.3, 2.2])
    expected = {
        walls: probe_coefficients(light_between(volume, smooth, visibility=walls), at[None])[0]
        for walls in (True, False)
    }
    assert np.abs(expected[True] - expected[False]).max() > 1
    for walls, light_there in expected.items():
        (found,) = exported_lights(
            volume, volume.states["day"], EXPORTS["three"], at=at, visibility=walls
        )
        np.testing.assert_allclose(found.coefficients, light_there, rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(found.position_m, at)
        assert found.name == "light at 0.4 1.3 2.2"


def test_a_point_or_a_probe():
    volume = ringing_volume()
    (found,) = exported_lights(volume, volume.states["day"], EXPORTS["csv"], probe="probe 5")
    np.testing.assert_array_equal(found.position_m, volume.positions[5])
    with pytest.raises(InputError, match="one of probe and at"):
        exported_lights(
            volume, volume.states["day"], EXPORTS["csv"], probe="probe 5", at=np.zeros(3)
        )
