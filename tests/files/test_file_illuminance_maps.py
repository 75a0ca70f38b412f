"""Folders of baked illuminance maps: what is written is read, and nothing else is."""

import hashlib
import json
import re
import tempfile
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from andon.errors import InputError
from andon.files.illuminance_maps import (
    MapFile,
    geometry_bytes,
    light_bytes,
    read_geometry,
    read_lux,
    read_manifest,
    read_moment,
    write_manifest,
)
from andon.spaces import transform_points
from map_files import CAMERAS, map_geometry, map_lux, small_manifest, small_maps, write_maps

from .specimens import huge_exr


def test_what_is_written_is_read(tmp_path):
    write_maps(tmp_path)
    manifest = read_manifest(tmp_path)
    for ours, theirs in zip(manifest.cameras, CAMERAS, strict=True):
        np.testing.assert_allclose(ours.rays_planar(), theirs.rays_planar())
        np.testing.assert_array_equal(ours.world_from_camera, theirs.world_from_camera)
    for moment in range(2):
        for camera, stored in enumerate(read_moment(tmp_path, manifest, moment)):
            depth, normal = map_geometry(camera)
            np.testing.assert_array_equal(stored.depth_m, depth)
            np.testing.assert_array_equal(stored.normal, normal)
            assert stored.view is manifest.cameras[camera]
            assert list(stored.lux) == ["lantern", "lamp at the window"]
            for number, lux in enumerate(stored.lux.values()):
                np.testing.assert_array_equal(lux, map_lux(number, camera, moment))
                assert lux.dtype == depth.dtype == np.float32


def test_the_manifest_keeps_everything(tmp_path):
    written = write_maps(tmp_path)
    read = read_manifest(tmp_path)
    for key in ("moments", "lamps", "geometry", "light", "quality", "bounces", "photometry",
                "facts", "generator"):  # fmt: skip
        assert getattr(read, key) == getattr(written, key), key
    write_manifest(tmp_path, read)
    assert (tmp_path / "maps.json").read_bytes() == small_maps()["maps.json"]


def test_equal_maps_are_equal_bytes():
    assert small_maps() == small_maps()
    depth, normal = map_geometry(0)
    other = depth.copy()
    other.view(np.uint32)[2, 3] = 0xFFC01234  # another NaN
    assert geometry_bytes(other, normal) == geometry_bytes(depth, normal)


def edited(folder, change):
    """The manifest in the folder, changed as JSON."""
    path = folder / "maps.json"
    document = json.loads(path.read_text("utf-8"))
    change(document)
    path.write_text(json.dumps(document), "utf-8")


def read_all(folder):
    manifest = read_manifest(folder)
    for moment in range(len(manifest.moments)):
        read_moment(folder, manifest, moment)


def refusal(folder, field=None):
    """What reading all of the folder's maps is refused with; one line that names a file."""
    with pytest.raises(InputError) as caught:
        read_all(folder)
    error = caught.value
    assert error.file
    assert "\n" not in str(error)
    assert field is None or field in str(error.field)
    return error


def stands_in(folder, name, contents):
    """Puts other contents in the place of a picture, with a manifest that knows of it."""
    (folder / name).write_bytes(contents)

    def change(document):
        for entry in [*document["geometry"], *document["light"]]:
            if entry["file"] == name:
                entry["sha256"] = hashlib.sha256(contents).hexdigest()
                entry["bytes"] = len(contents)

    edited(folder, change)


def test_no_maps_yet(tmp_path):
    for folder in (tmp_path, tmp_path / "nowhere"):
        assert "andon bake" in str(refusal(folder).remedy)
    file = tmp_path / "file"
    file.write_bytes(b"x")
    assert "is a file" in refusal(file).rule


def test_a_picture_of_another_size_is_refused_before_it_is_decoded(tmp_path):
    write_maps(tmp_path)
    stands_in(tmp_path, "light-0-0-0.exr", light_bytes(np.ones((7, 9, 3))))
    assert "must have 9×6 pixels, has 9×7" in refusal(tmp_path).rule
    write_maps(tmp_path)
    stands_in(tmp_path, "geometry-1.exr", geometry_bytes(*map_geometry(0)))
    assert "must have 7×7 pixels, has 9×6" in refusal(tmp_path).rule


def test_a_huge_picture_is_refused_by_its_header(tmp_path):
    write_maps(tmp_path)
    stands_in(tmp_path, "light-0-0-0.exr", huge_exr(60_000))
    stands_in(tmp_path, "geometry-0.exr", huge_exr(20_000))
    tracemalloc.start()
    assert "20000" in refusal(tmp_path).rule
    edited(tmp_path, lambda document: document["cameras"][0].update(width=60_000, height=60_000))
    assert "pixels" in refusal(tmp_path).rule
    assert tracemalloc.get_traced_memory()[1] < 50e6
    tracemalloc.stop()


def test_missing_damaged_and_half_written_pictures(tmp_path):
    write_maps(tmp_path)
    path = tmp_path / "light-1-1-1.exr"
    sound = path.read_bytes()
    path.unlink()
    assert "missing" in refusal(tmp_path).rule
    path.write_bytes(sound[: len(sound) // 2])
    assert refusal(tmp_path, "bytes").remedy
    path.write_bytes(sound[:-1] + bytes([sound[-1] ^ 1]))
    assert refusal(tmp_path, "sha256").remedy
    path.write_bytes(b"")
    assert "empty" in refusal(tmp_path).rule


@pytest.mark.parametrize("value", [np.nan, np.inf, -1e-3])
def test_light_that_cannot_be(value, tmp_path):
    lux = np.ones((6, 9, 3), np.float32)
    lux[4, 2, 1] = value
    with pytest.raises(InputError, match="row 4, column 2, G"):
        light_bytes(lux)
    write_maps(tmp_path)
    stands_in(
        tmp_path, "light-0-0-0.exr", raw_exr({"R": lux[..., 0], "G": lux[..., 1], "B": lux[..., 2]})
    )
    assert "bake again" in refusal(tmp_path, "row 4, column 2, G").remedy


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lambda depth, normal: depth.__setitem__((1, 2), -1), "row 1, column 2, Z"),
        (lambda depth, normal: depth.__setitem__((1, 2), np.inf), "row 1, column 2, Z"),
        (lambda depth, normal: normal.__setitem__((1, 2), (0, 0, 0)), "row 1, column 2, N"),
        (lambda depth, normal: normal.__setitem__((1, 2), np.nan), "row 1, column 2, N"),
        (lambda depth, normal: normal.__setitem__((2, 3), (0, 1, 0)), "row 2, column 3, N"),
    ],
)
def test_geometry_that_cannot_be(change, field, tmp_path):
    write_maps(tmp_path)
    depth, normal = map_geometry(0)
    change(depth, normal)
    planes = {"Z": depth, **{f"N.{axis}": normal[..., i] for i, axis in enumerate("XYZ")}}
    stands_in(tmp_path, "geometry-0.exr", raw_exr(planes))
    refusal(tmp_path, field)


def raw_exr(planes, **attributes):
    """An EXR file of any channels, as other programs may write it."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **attributes}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        channels = {name: np.ascontiguousarray(plane) for name, plane in planes.items()}
        OpenEXR.File(header, channels).write(str(path))
        return path.read_bytes()


def test_other_channels_units_and_words(tmp_path):
    lux = map_lux(0, 0, 0)
    planes = dict(zip("RGB", np.moveaxis(lux, -1, 0), strict=True))
    for contents, words in (
        (raw_exr({"Y": lux[..., 0]}), "lacks R, G, B"),
        (raw_exr(planes, **{"andon:unit": "cd/m2"}), "must be 'lx'"),
        (light_bytes(lux, photometry="relative"), "must be absolute"),
    ):
        write_maps(tmp_path)
        stands_in(tmp_path, "light-0-0-0.exr", contents)
        assert words in refusal(tmp_path).rule
    write_maps(tmp_path)
    edited(tmp_path, lambda document: document.update(photometry="relative"))
    assert "must be relative" in refusal(tmp_path).rule


@pytest.mark.parametrize(
    "name",
    ["../light.exr", "/etc/passwd", "a/../../light.exr", "file:///etc/passwd", "http://x/a.exr",
     "C:\\a.exr", "..\\light.exr", "~/a.exr", "", "a\0b", "link.exr", "inner/../../light.exr"],
)  # fmt: skip
def test_names_that_leave_the_folder(name, tmp_path):
    folder = tmp_path / "maps"
    folder.mkdir()
    write_maps(folder)
    sound = (folder / "light-0-0-0.exr").read_bytes()
    (tmp_path / "light.exr").write_bytes(sound)  # it is there, and sound: only its place is wrong
    (folder / "link.exr").symlink_to(tmp_path / "light.exr")

    def change(document):
        document["light"][0]["file"] = name

    edited(folder, change)
    assert "reference" in refusal(folder).rule


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.update(version=2), "newer"),
        (lambda d: d.update(format="other"), "format"),
        (lambda d: d.update(unit="cd"), "'lx'"),
        (lambda d: d.update(bounces=-1), "0…16"),
        (lambda d: d.update(moments_seconds=[]), "rising"),
        (lambda d: d.update(moments_seconds=[0.0, 0.0]), "rising"),
        (lambda d: d.update(moments_seconds=[1.0, "x"]), "number"),
        (lambda d: d.update(cameras=[]), "one or more"),
        (lambda d: d.update(lamps=[]), "one or more"),
        (lambda d: d.pop("light"), "must have 'light'"),
        (lambda d: d["lamps"][0].update(part="some"), "all or bounce"),
        (lambda d: d["lamps"][1].update(name="lantern"), "differ"),
        (lambda d: d["lamps"][0].update(name="a\nb"), "characters"),
        (lambda d: d["cameras"][0].update(distortion=[0.1, 0, 0, 0]), "distorted"),
        (lambda d: d["cameras"][0].update(fx=-1), "> 0 px"),
        (lambda d: d["cameras"][0].pop("world_from_camera"), "world_from_camera"),
        (lambda d: d["cameras"][0].update(world_from_camera=[[2, 0, 0, 0]] * 4), "rigid"),
        (lambda d: d["cameras"][1].update(name="door"), "differ"),
        (lambda d: d["geometry"][0].update(camera=2), "camera must be 0…1"),
        (lambda d: d["geometry"][0].update(moment=2), "moment must be 0…1"),
        (lambda d: d["geometry"].append(d["geometry"][0]), "twice"),
        (lambda d: d["light"].append(d["light"][0]), "twice"),
        (lambda d: d["light"][0].update(lamp="sun"), "does not list"),
        (lambda d: d["light"][0].update(sha256="A" * 64), "hexadecimal"),
        (lambda d: d["light"][0].update(bytes=0), "1…"),
        (lambda d: d["light"][0].update(bytes=10**15), "1…"),
        (lambda d: d["geometry"][1].update(sha256="0" * 64), "one sum"),
        (lambda d: d["facts"].update(surfaces=3), "text"),
    ],
)
def test_manifests_that_break_a_rule(change, words, tmp_path):
    write_maps(tmp_path)
    edited(tmp_path, change)
    error = refusal(tmp_path)
    assert words in str(error)
    assert error.file.endswith("maps.json")


def test_a_truncated_manifest(tmp_path):
    write_maps(tmp_path)
    path = tmp_path / "maps.json"
    path.write_bytes(path.read_bytes()[:-3])
    assert "sound JSON" in refusal(tmp_path).rule


def test_unknown_keys_are_ignored(tmp_path):
    write_maps(tmp_path)

    def change(document):
        document["later"] = document["cameras"][0]["later"] = document["light"][0]["later"] = 1

    edited(tmp_path, change)
    assert len(read_moment(tmp_path, read_manifest(tmp_path), 0)) == 2


def test_maps_that_are_not_baked_yet(tmp_path):
    write_maps(tmp_path)
    manifest = read_manifest(tmp_path)
    assert list(manifest.missing()) == []
    light = {key: file for key, file in manifest.light.items() if key != ("lantern", 1, 0)}
    geometry = {key: file for key, file in manifest.geometry.items() if key != (0, 1)}
    write_manifest(tmp_path, replace(manifest, light=light, geometry=geometry))
    manifest = read_manifest(tmp_path)
    assert list(manifest.missing()) == ["light of lantern, ceiling, 0 s", "geometry of door, 0.5 s"]
    with pytest.raises(InputError, match="light of lantern, ceiling, 0 s is not baked"):
        read_lux(tmp_path, manifest, "lantern", 1, 0)
    with pytest.raises(InputError, match=r"geometry of door, 0\.5 s is not baked"):
        read_geometry(tmp_path, manifest, 0, 1)


def test_a_manifest_is_checked_before_it_is_written():
    manifest, _ = small_manifest()
    with pytest.raises(InputError, match="hexadecimal"):
        replace(manifest, geometry={(0, 0): MapFile("a.exr", "x", 1)})
    with pytest.raises(InputError, match="distorted"):
        replace(manifest, cameras=(replace(CAMERAS[0], distortion=(0.1, 0, 0, 0)), CAMERAS[1]))


def test_other_programs_read_the_pictures(tmp_path):
    """OpenEXR's own reader, without this package: channels, kinds, unit, and every bit."""
    write_maps(tmp_path)
    part = OpenEXR.File(str(tmp_path / "geometry-0.exr"), separate_channels=True).parts[0]
    depth, normal = map_geometry(0)
    expected = {"Z": depth, **{f"N.{axis}": normal[..., i] for i, axis in enumerate("XYZ")}}
    assert set(part.channels) == set(expected)
    for name, values in expected.items():
        assert part.channels[name].pixels.dtype == np.float32
        np.testing.assert_array_equal(part.channels[name].pixels, values)
    assert np.isnan(part.channels["Z"].pixels[2, 3])
    assert part.header["andon:unit"] == "m"
    part = OpenEXR.File(str(tmp_path / "light-1-0-1.exr"), separate_channels=True).parts[0]
    for i, name in enumerate("RGB"):
        np.testing.assert_array_equal(part.channels[name].pixels, map_lux(1, 0, 1)[..., i])
    assert part.header["andon:unit"] == "lx"
    assert part.header["andon:photometry"] == "absolute"


MANUAL = (Path(__file__).parents[2] / "docs" / "illuminance-maps.md").read_text("utf-8")


def test_the_manual_shows_what_is_written():
    """But for sums and sizes, which are the OpenEXR library's."""
    shown = re.findall(r"```json\n(.*?)```", MANUAL, re.DOTALL)[0]
    own = r'"sha256": "[0-9a-f]{64}", "bytes": \d+'
    assert re.sub(own, "", shown) == re.sub(own, "", small_maps()["maps.json"].decode())
    assert len(re.findall(own, shown)) == 12


def test_the_example_of_the_manual_runs(tmp_path):
    write_maps(tmp_path)
    (program,) = re.findall(r"```python\n(.*?)```", MANUAL, re.DOTALL)
    names = {}
    exec(program.replace('Path("room.maps")', f"Path({str(tmp_path)!r})"), names)
    np.testing.assert_array_equal(names["lux"], map_lux(0, 0, 0) + map_lux(1, 0, 0))
    rays = CAMERAS[0].rays_planar() * map_geometry(0)[0][..., None]
    points = transform_points(CAMERAS[0].world_from_camera, rays)
    np.testing.assert_allclose(names["points"], points, rtol=1e-6, equal_nan=True)


def test_tables_of_the_manual():
    keys = re.findall(r"^\| `(\w+)` ", MANUAL, re.MULTILINE)
    assert keys[keys.index("format") : keys.index("light") + 1] == list(
        json.loads(small_maps()["maps.json"])
    )
