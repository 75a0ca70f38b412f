"""Folders of baked illuminance maps: what is written is read, and nothing else is."""

import json

import numpy as np

from andon.files.illuminance_maps import (
    geometry_bytes,
    read_manifest,
    read_moment,
    same_rays,
    write_manifest,
)
from map_files import CAMERAS, map_geometry, map_lux, small_maps, write_maps


def test_what_is_written_is_read(tmp_path):
    write_maps(tmp_path)
    manifest = read_manifest(tmp_path)
    assert all(map(same_rays, manifest.cameras, CAMERAS))
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
