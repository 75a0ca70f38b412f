"""Lights of glTF files as lamps of the scene."""

import json

import numpy as np
import pytest

from andon.errors import InputError
from andon.lamps import DirectionalLamp, PointLamp, SpotLamp, resolve_lamps
from andon.quantities import photometric
from andon.scene import scene_from_dict

HALF = np.sqrt(0.5)
LIGHTS = [
    {"type": "point", "intensity": 80, "color": [1, 0.5, 0.25], "range": 3},
    {"type": "spot", "intensity": 200, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.6}},
    {"type": "directional", "intensity": 1000},
]
# A scaled parent: it moves the places of its children, and leaves their light alone.
NODES = [
    {"name": "room", "scale": [2, 2, 2], "translation": [0, 1, 0], "children": [1, 2, 3, 4]},
    {"name": "bulb", "translation": [1, 0, 0], "light": 0},
    # −90° about x turns −Z to −Y: straight down.
    {"name": "spot", "rotation": [-HALF, 0, 0, HALF], "light": 1},
    {"name": "sun", "rotation": [-HALF, 0, 0, HALF], "scale": [1, 3, 0.1], "light": 2},
    {"name": "bulb", "translation": [-1, 0, 0], "light": 0},
]


def write(path, nodes=NODES, lights=LIGHTS):
    entries = [dict(node) for node in nodes]
    for entry in entries:
        if "light" in entry:
            entry["extensions"] = {"KHR_lights_punctual": {"light": entry.pop("light")}}
    path.write_text(
        json.dumps(
            {
                "asset": {"version": "2.0"},
                "scenes": [{"nodes": [0]}],
                "nodes": entries,
                "extensionsUsed": ["KHR_lights_punctual"],
                "extensions": {"KHR_lights_punctual": {"lights": lights}},
            }
        )
    )


@pytest.fixture
def folder(tmp_path):
    write(tmp_path / "room.gltf")
    return tmp_path


def resolve(folder, **tables):
    return resolve_lamps(scene_from_dict(tables, folder=folder), 0.0)


SURFACE = {"surface": {"mesh": "room.gltf", "lamps": True}}


def test_kinds_units_and_places(folder):
    bulb, spot, sun, other = resolve(folder, **SURFACE)
    assert type(bulb) is PointLamp
    assert bulb.position_m == pytest.approx([2, 1, 0])
    # Exactly colour × intensity: cd per channel, its photometric value below 80.
    assert bulb.intensity_cd.tolist() == [80, 40, 20]
    assert photometric(bulb.intensity_cd) == pytest.approx(80 * 0.2126 + 40 * 0.7152 + 20 * 0.0722)
    assert type(spot) is SpotLamp
    assert spot.direction == pytest.approx([0, -1, 0])
    assert spot.position_m == pytest.approx([0, 1, 0])
    assert spot.intensity_cd.tolist() == [200] * 3
    assert (spot.inner_radians, spot.outer_radians) == (0.2, 0.6)
    assert type(sun) is DirectionalLamp
    assert sun.direction == pytest.approx([0, -1, 0])
    assert sun.illuminance_lux.tolist() == [1000] * 3
    assert [lamp.name for lamp in (bulb, spot, sun, other)] == ["bulb", "spot", "sun", "bulb-2"]
    assert other.position_m == pytest.approx([-2, 1, 0])


def test_the_scenes_placement_counts(folder):
    turned = [[0, 0, 1, 5], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]  # +X to −Z
    surface = {"mesh": "room.gltf", "lamps": True, "world_from_mesh": turned}
    bulb, spot, *_ = resolve(folder, surface=surface)
    assert bulb.position_m == pytest.approx([5, 1, -2])
    assert bulb.intensity_cd[0] == 80
    assert spot.direction == pytest.approx([0, -1, 0])


def test_of_objects_after_the_scenes_own_lamps(folder):
    own = {"kind": "point", "name": "bulb", "position": [0, 0, 0], "flux_lm": 1}
    thing = {"mesh": "room.gltf", "lamps": True, "position": [0, 0, -3], "scale": 0.5}
    lamps = resolve(folder, lamp=[own], object=[thing, thing | {"lamps": False}], **SURFACE)
    names = [lamp.name for lamp in lamps]
    assert names[:5] == ["bulb", "bulb-2", "spot", "sun", "bulb-3"]
    assert len(set(names)) == len(names) == 9
    assert lamps[5].position_m == pytest.approx([1, 0.5, -3])
    assert lamps[5].intensity_cd[0] == 80, "a scaled object keeps its candela"


def test_only_where_it_is_asked_for(folder):
    assert resolve(folder, surface={"mesh": "room.gltf"}) == ()


@pytest.mark.parametrize(
    ("nodes", "lights", "expected"),
    [
        ([{"name": "a"}], LIGHTS, "has no lights of KHR_lights_punctual"),
        ([{"name": "a", "light": 9}], LIGHTS, "must be 0…2"),
        ([{"name": "a", "light": 2, "scale": [0, 0, 0]}], LIGHTS, "light 'a': has no direction"),
        (
            [{"name": "a", "light": 0}],
            [{"type": "point", "intensity": 1e300, "color": [1e300, 1, 1]}],
            "light 'a': is too large",
        ),
        (
            [{"name": "a", "light": 0}],
            [{"type": "spot", "spot": {"outerConeAngle": 1e-4}}],
            "light 'a': needs 0 ≤ inner < outer and 0.1 ≤ outer",
        ),
    ],
)
def test_what_is_wrong_is_named(folder, nodes, lights, expected):
    write(folder / "room.gltf", nodes, lights)
    with pytest.raises(InputError) as caught:
        resolve(folder, **SURFACE)
    assert expected in str(caught.value)
    assert "room.gltf" in str(caught.value)


def test_other_formats_have_no_lights(folder):
    (folder / "a.obj").write_text("x")
    with pytest.raises(InputError, match="only glTF files have lights"):
        resolve(folder, surface={"mesh": "a.obj", "lamps": True})
    with pytest.raises(InputError, match=r"surface\.lamps: needs a mesh"):
        resolve(folder, surface={"depth": "d.npy", "lamps": True})
    with pytest.raises(InputError, match="must exist"):
        resolve(folder, surface={"mesh": "missing.glb", "lamps": True})
