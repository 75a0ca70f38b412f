"""The files of a bundle: the same bytes every time, names without a path, failures told."""

import re

import numpy as np
import pytest
from asked import lux_of
from test_radiance_lamps import LAMPS

from andon.errors import MachineError
from andon.files import radiance_programs
from andon.lamps import GoniometricLamp, PointLamp, PolygonLamp, SphereLamp, body_of
from andon.quantities import Geometry, Material
from andon.surface.objects import joined
from andon.transport.baked.radiance import OCTREE, radiance_bundle
from andon.transport.baked.radiance.scene import DETAIL_OCTREE
from requirements import required
from worlds import block, open_room

required("pyradiance")

AT, LIGHT = np.array([0.9, 1.7, 0.9]), np.array([9.0, 7.0, 4.0])


def painted():
    """A triangle with a texture."""
    texture = np.random.default_rng(1).integers(0, 256, (7, 5, 3)).astype(np.uint8)
    return Geometry(
        np.array([[-1, 1, 0], [0, 1, 0], [0, 2, 0.0]]), np.array([[0, 1, 2]], np.int32),
        uvs=np.array([[0, 0], [2, 0], [0, 1.0]]), materials=(Material("t", texture=texture),),
    )  # fmt: skip


def whole():
    ball = SphereLamp("ball", LIGHT, np.array([-1, 1, 0.5]), 0.1)
    lamps = [PointLamp("p", AT, LIGHT), LAMPS["type C"], LAMPS["spot"]]
    include = {"more.rad": b"void plastic red 0 0 5 .5 0 0 0 0\nred sphere s 0 0 4 0 1 0 .1\n"}
    return radiance_bundle([open_room(), painted()], lamps, [body_of(ball)], include=include)


def test_the_same_scene_gives_the_same_bytes(tmp_path, monkeypatch):
    """In another temporary folder, from another working folder, and a year later."""
    first = whole()
    for name in ("a", "another"):
        (tmp_path / name).mkdir()
        monkeypatch.setenv("TMPDIR", str(tmp_path / name))
        monkeypatch.setattr("tempfile.tempdir", None)
        monkeypatch.chdir(tmp_path / name)
        assert whole() == first
    assert {"surfaces.rad", OCTREE, "more.rad", "part1.0.rtm", "part1.0.hdr"} <= set(first)


def test_nothing_in_a_bundle_tells_where_or_when_it_was_made():
    for name, contents in whole().items():
        assert re.fullmatch(r"[A-Za-z0-9.]+", name)
        for word in (b"/tmp", b"andon-radiance", b"CAPDATE", b"/home", b"site-packages"):
            assert word not in contents, (name, word)


def test_surfaces_travel_once_and_octrees_are_small():
    """Laths on a wall, where `oconv` cuts cells as long as it may: 4.8 MB with its own limit."""
    laths = joined(
        [block((0.004, 2, 0.004), (x, 1, z)) for x in np.arange(-1, 1, 0.02) for z in (-1, 1)]
    )
    bundle = radiance_bundle([laths], [PointLamp("p", AT, LIGHT)])
    texts = [contents for name, contents in bundle.items() if name.endswith(".rad")]
    assert sum(text.count(b"polygon") for text in texts) == len(laths.triangles)
    assert len(bundle[OCTREE]) < 2 * len(bundle["surfaces.rad"])


def test_included_things_stand_in_the_scene():
    """A black sphere around the lamp."""
    points, normals = np.array([[0.9, 0.0, 0.9]]), np.array([[0, 1.0, 0]])
    lamp = PointLamp("p", AT, LIGHT)
    ball = b"void plastic black 0 0 5 0 0 0 0 0\nblack sphere s 0 0 4 0.9 1.7 0.9 .3\n"
    lit = lux_of(radiance_bundle([open_room()], [lamp]), points, normals)
    dark = lux_of(radiance_bundle([open_room()], [lamp], include={"b.rad": ball}), points, normals)
    assert (lit > 0).all()
    assert not dark.any()


def test_included_text_that_is_none_of_radiances_is_told():
    with pytest.raises(MachineError, match="oconv failed"):
        radiance_bundle([open_room()], [], include={"bad.rad": b"void plastic\n"})


def test_missing_programs_are_told(monkeypatch):
    monkeypatch.setattr(radiance_programs, "find_spec", lambda name: None)
    with pytest.raises(MachineError, match=r"pip install 'andon\[radiance\]'"):
        radiance_bundle([open_room()], [PointLamp("p", AT, LIGHT)])


def test_a_scene_without_anything_or_with_flat_triangles_is_no_failure():
    nothing = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    lamp = PointLamp("p", AT, LIGHT)
    flat = Geometry(np.zeros((3, 3)), np.array([[0, 1, 2]], np.int32), uvs=np.zeros((3, 2)),
                    materials=(Material(texture=np.ones((2, 2, 3))),))  # fmt: skip
    lux = lux_of(radiance_bundle([nothing, flat], [lamp]), AT[None] - [0, 1, 0], np.eye(3)[1:2])
    np.testing.assert_allclose(lux[0], LIGHT, rtol=1e-3)
    assert OCTREE in radiance_bundle([], [])


def test_names_with_spaces_and_umlauts_do_no_harm():
    lamp = PointLamp("Lampe für den Flur\nvoid light x", AT, LIGHT)
    part = Geometry(np.eye(3), np.array([[0, 1, 2]], np.int32), materials=(Material("ä b\n!rm"),))
    bundle = radiance_bundle([part], [lamp])
    assert b"rm" not in bundle["surfaces.rad"] + bundle["lamps.rad"]
    assert isinstance(LAMPS["type C"], GoniometricLamp)


def test_octrees_of_many_tiles():
    """Only of lamps that have more of them; the others are the same."""
    corners = np.array([[-1.0, 2, -1], [1, 2, -1], [1, 2, 1], [-1, 2, 1]])
    panel = PolygonLamp("panel", np.full(3, 100.0), corners)
    few, many = (radiance_bundle([open_room()], [panel], detail_tiles=n) for n in (0, 256))
    assert DETAIL_OCTREE not in few
    assert {name: many[name] for name in few} == few
    assert many["detail.rad"].count(b" polygon ") == 256
    point = PointLamp("p", np.array([0, 1.0, 0]), np.full(3, 90.0))
    assert DETAIL_OCTREE not in radiance_bundle([open_room()], [point], detail_tiles=256)
