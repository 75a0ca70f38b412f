"""Probe volumes: what is written is read again, and what is wrong is refused by name."""

import json
import struct
import tracemalloc
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from andon.errors import InputError
from andon.files import DEFAULT_LIMITS, read_mesh, read_volume, write_volume
from andon.files.volumes import Zone, check_volume, plain_volume, rounded
from andon.files.volumes.write import volume_bytes
from andon.transport.probes.cells import build_cells
from andon.transport.probes.space import ProbeSpace
from requirements import required
from volume_files import bipyramid, flat_volume, light, two_rooms

from .specimens import GLTF_BINARY, glb, gltf_json

EXTENSION = "ANDON_light_probes"
SEED = 5
KINDS = ("plane", "line", "point", "cells")


def assert_same(a, b, place="volume"):
    """Equal in every field, arrays bit by bit and of one dtype."""
    if isinstance(a, np.ndarray):
        assert a.dtype == b.dtype, place
        np.testing.assert_array_equal(a, b, err_msg=place)
    elif hasattr(a, "__dataclass_fields__"):
        assert type(a) is type(b), place
        for item in fields(a):
            assert_same(getattr(a, item.name), getattr(b, item.name), f"{place}.{item.name}")
    elif isinstance(a, dict):
        assert list(a) == list(b), place
        for key in a:
            assert_same(a[key], b[key], f"{place}[{key}]")
    elif isinstance(a, tuple):
        assert len(a) == len(b), place
        for i, (one, other) in enumerate(zip(a, b, strict=True)):
            assert_same(one, other, f"{place}[{i}]")
    else:
        assert a == b, place


def parsed(data):
    """The JSON of a GLB file and its binary chunk."""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def volumes():
    return [two_rooms(order) for order in (0, 2, 4)] + [flat_volume(kind) for kind in KINDS]


@pytest.mark.parametrize("volume", volumes(), ids=["L0", "L2", "L4", *KINDS])
def test_what_is_written_is_read(volume, tmp_path):
    path = write_volume(tmp_path / "a.glb", volume)
    found = read_volume(path)
    assert_same(rounded(volume), found)
    assert write_volume(tmp_path / "b.glb", found).read_bytes() == path.read_bytes()


def test_rounding_is_that_of_float32_and_no_more():
    volume = two_rooms()
    thin = rounded(volume)
    assert np.abs(thin.states["day"] / volume.states["day"] - 1).max() <= 2.0**-24
    assert thin.positions.dtype == np.float64
    assert_same(rounded(thin), thin)


def test_the_file_is_sound_gltf_for_any_viewer(tmp_path):
    """By the rules of glTF 2.0 for what is used here; read anew, without our own reader."""
    data = volume_bytes(two_rooms())
    document, binary = parsed(data)
    assert struct.unpack_from("<4sII", data) == (b"glTF", 2, len(data))
    assert document["extensionsUsed"] == [EXTENSION, "KHR_materials_unlit"]
    assert "extensionsRequired" not in document
    for view in document["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= document["buffers"][0]["byteLength"]
    assert document["buffers"][0]["byteLength"] <= len(binary)

    def array(number):
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        kind = {5121: "u1", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        found = np.frombuffer(binary, kind, accessor["count"] * width, view["byteOffset"])
        return found.reshape(-1, width)

    for number in range(len(document["accessors"])):
        assert np.isfinite(array(number)).all()
    points, lines = document["meshes"][0]["primitives"]
    assert (points["mode"], lines["mode"]) == (0, 1)
    positions = document["accessors"][points["attributes"]["POSITION"]]
    assert positions["min"] == array(points["attributes"]["POSITION"]).min(axis=0).tolist()
    assert positions["max"] == array(points["attributes"]["POSITION"]).max(axis=0).tolist()
    colours = array(points["attributes"]["COLOR_0"])
    assert colours.shape == (10, 3)
    assert colours.min() >= 0
    assert colours.max() <= 1
    edges = array(lines["indices"]).reshape(-1, 2)
    assert len(edges) == 2 * 9  # 9 edges of each bipyramid
    assert len({frozenset(edge) for edge in edges.tolist()}) == 18


def test_brighter_probes_are_brighter_points():
    volume = flat_volume("line")
    values = light(3)
    values[:, 0] = np.array([[1, 1, 1], [10, 10, 10], [100, 10, 1.0]])
    document, binary = parsed(volume_bytes(replace(volume, states={"a": values})))
    primitive = document["meshes"][0]["primitives"][0]
    view = document["bufferViews"][
        document["accessors"][primitive["attributes"]["COLOR_0"]]["bufferView"]
    ]
    colours = np.frombuffer(binary, "<f4", 9, view["byteOffset"]).reshape(3, 3)
    assert colours[0, 0] < colours[1, 0] < colours[2, 0]
    assert colours[2, 0] > colours[2, 1] > colours[2, 2]
    assert colours[1, 0] == pytest.approx(0.5)  # the median


def test_a_mesh_reader_says_that_there_are_no_faces(tmp_path):
    with pytest.raises(InputError, match="must have faces"):
        read_mesh(write_volume(tmp_path / "a.glb", two_rooms()))


def test_a_mesh_is_no_volume(tmp_path):
    path = tmp_path / "a.glb"
    path.write_bytes(glb(gltf_json(None), GLTF_BINARY))
    with pytest.raises(InputError, match="is a glTF file without probes"):
        read_volume(path)


def test_other_suffixes_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"must have the suffix \.glb"):
        write_volume(tmp_path / "a.json", two_rooms())


def changed(tmp_path, change, volume=None):
    """The file of a volume whose extension's table `change` has altered."""
    document, binary = parsed(volume_bytes(volume or two_rooms()))
    change(document["extensions"][EXTENSION], document)
    path = tmp_path / "changed.glb"
    path.write_bytes(glb(document, binary))
    return path


def test_a_newer_version_is_refused_by_its_number(tmp_path):
    path = changed(tmp_path, lambda table, _: table.update(version=2))
    with pytest.raises(InputError, match=r"is version 2 .* reads up to 1; update Andon"):
        read_volume(path)


@pytest.mark.parametrize("key", ["quantity", "unit", "channels", "basis", "sign", "index", "axes"])
def test_other_conventions_are_refused(tmp_path, key):
    path = changed(tmp_path, lambda table, _: table["conventions"].update({key: "other"}))
    with pytest.raises(InputError, match=rf"conventions\.{key}: must be .* not read here"):
        read_volume(path)


def test_unknown_keys_are_left_alone(tmp_path):
    path = changed(tmp_path, lambda table, _: table.update(later={"a": 1}))
    assert_same(read_volume(path), rounded(two_rooms()))


WRONG_TABLES = {
    "no version": (lambda t, d: t.pop("version"), "must have 'version'"),
    "order": (lambda t, d: t.update(order=3), r"coefficients: must have 160 elements, 16 for each"),
    "order 5": (lambda t, d: t.update(order=5), r"order: must be 0…4"),
    "names": (lambda t, d: t["names"].pop(), "names: must be 10, one for each probe, are 9"),
    "role": (lambda t, d: t["roleNames"].__setitem__(0, "moon"), "roleNames.0.: must be one of"),
    "roles": (lambda t, d: t.update(roleNames=["general"]), "roles: must be below 1"),
    "photometry": (lambda t, d: t.update(photometry="x"), "must be absolute or relative"),
    "state": (lambda t, d: t["states"][1].update(name="day"), "'day' is there already"),
    "states": (lambda t, d: t.update(states=[]), "states: must be 1…256, are 0"),
    "type": (lambda t, d: t.update(positions=t["roles"]), "must be VEC3, is 'SCALAR'"),
    "accessor": (lambda t, d: t.update(positions=10**6), "positions: must be 0…"),
    "zone": (lambda t, d: t["zones"].pop(), "must be runs that follow one another"),
    "zone run": (lambda t, d: t["zones"][0].update(cells=[1, 2]), "must be runs that follow"),
    "zone name": (lambda t, d: t["zones"][0].update(name="east"), "must have different names"),
    "box": (lambda t, d: t["zones"][0].update(boxes=[[[0, 0, 0]]]), "must be two corners, are 1"),
    "low box": (
        lambda t, d: t["zones"][0].update(boxes=[[[0, 0, 0], [1, -1, 1]]]), "must be below"),
    "no box": (lambda t, d: t["zones"][0].pop("boxes"), "must have boxes, since there are other"),
    "far": (lambda t, d: t["distances"].update(far=0), "distances.far: must be > 0 m"),
    "size": (lambda t, d: t["distances"].update(size=5), "must have 250 elements, 5×5 for each"),
    "floats": (
        lambda t, d: t["zones"][0].update(probes=t["ranges"]), "of component type 5125"),
    "facets": (lambda t, d: t["cells"].pop("facets"), "must have 'facets'"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG_TABLES)
def test_wrong_tables(tmp_path, name):
    change, message = WRONG_TABLES[name]
    path = changed(tmp_path, change)
    with pytest.raises(InputError, match=message) as found:
        read_volume(path)
    assert str(path) in str(found.value)


def with_cells(volume, **arrays):
    return replace(volume, cells=replace(volume.cells, **arrays))


def altered(values, at, value):
    copy = np.array(values)
    copy[at] = value
    return copy


def altered_state(volume, at, value):
    return replace(volume, states={"day": altered(volume.states["day"], at, value)})


def swapped_corners(volume):
    """A tetrahedron turned round, its neighbours with it: only the volume's sign is wrong."""
    cells = volume.cells
    corners, neighbours = cells.corners.copy(), cells.neighbours.copy()
    corners[0, [0, 1]], neighbours[0, [0, 1]] = corners[0, [1, 0]], neighbours[0, [1, 0]]
    return with_cells(volume, corners=corners, neighbours=neighbours)


def cells_of(name):
    return lambda v, at, value: with_cells(v, **{name: altered(getattr(v.cells, name), at, value)})


WRONG_VOLUMES = {
    "nan": (lambda v: altered_state(v, (3, 2, 1), np.nan), r"states\[0\].coefficients\[3\]: must"),
    "infinite": (lambda v: altered_state(v, (3, 2, 1), 1e39), "must be finite"),
    "negative": (lambda v: altered_state(v, (4, 0, 2), -1), "probe 4 must have a mean luminance ≥"),
    "position": (
        lambda v: replace(v, positions=altered(v.positions, (1, 0), np.inf)),
        r"positions\[1\]: must be finite"),
    "range": (lambda v: replace(v, ranges_m=altered(v.ranges_m, 1, -2)), "distances > 0 m"),
    "no probes": (
        lambda v: replace(v, positions=np.zeros((0, 3))), "must have a probe or more"),
    "zone probe": (
        lambda v: replace(v, zones=(v.zones[0], replace(v.zones[1], probes=np.array([3, 10])))),
        r"zones\[1\].probes: must be 0…9, names the probe 10"),
    "zone order": (
        lambda v: replace(v, zones=(v.zones[0], replace(v.zones[1], probes=np.array([3, 3])))),
        "must be rising numbers"),
    "corner": (lambda v: cells_of("corners")(v, (1, 2), 10), r"cells.corners\[1\]: must be 0…9"),
    "foreign corner": (
        lambda v: cells_of("corners")(v, (1, 3), 7), r"has a probe outside its zone, zones\[0\]"),
    "turned": (swapped_corners, "must have a positive determinant"),
    "flat": (
        lambda v: replace(v, positions=altered(v.positions, (3, 1), 0)), "the tetrahedron is flat"),
    "neighbour": (
        lambda v: cells_of("neighbours")(v, (0, 0), 1), "do not share that face"),
    "far neighbour": (lambda v: cells_of("neighbours")(v, (0, 0), 3), "must lie in the same zone"),
    "one-sided": (
        lambda v: with_cells(v, neighbours=np.where(
            v.cells.neighbours == 0, -1, v.cells.neighbours)), "do not share that face"),
    "facet behind": (
        lambda v: cells_of("facet_cells")(v, 0, 1), "must agree with the facet 0"),
    "facet of none": (
        lambda v: with_cells(v, facet_neighbours=altered(v.cells.facet_neighbours, (0, 0), 0)),
        "do not share that edge"),
    "facet turned": (
        lambda v: cells_of("facets")(v, 2, v.cells.facets[2][[1, 0, 2]]),
        r"cells.facets\[2\]: must run counter-clockwise"),
    "distances": (
        lambda v: replace(v, distances=replace(
            v.distances, mean_m=altered(v.distances.mean_m, (2, 0, 0), -1))), "finite and ≥ 0"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG_VOLUMES)
def test_wrong_volumes_are_neither_checked_nor_written_nor_read(tmp_path, monkeypatch, name):
    change, message = WRONG_VOLUMES[name]
    volume = change(two_rooms())
    with pytest.raises(InputError, match=message):
        check_volume(rounded(volume))
    with pytest.raises(InputError, match=message):
        write_volume(tmp_path / "a.glb", volume)
    assert list(tmp_path.iterdir()) == []
    if name in ("no probes", "position"):
        return  # JSON has no infinite bounds, and glTF no empty arrays
    monkeypatch.setattr("andon.files.volumes.write.check_volume", lambda volume: None)
    path = write_volume(tmp_path / "a.glb", volume)
    with pytest.raises(InputError, match=message) as found:
        read_volume(path)
    assert str(path) in str(found.value)


def test_too_many_probes(tmp_path):
    path = write_volume(tmp_path / "a.glb", two_rooms())
    with pytest.raises(InputError, match="at most 9 probes, the file claims 10"):
        read_volume(path, limits=replace(DEFAULT_LIMITS, max_probes=9))


def test_arrays_that_share_bytes_count_each_time(tmp_path):
    """A small file must not become large in memory by naming one array often."""

    def change(table, document):
        one = table["states"][0]
        table["states"] = [{**one, "name": str(i)} for i in range(200)]

    path = changed(tmp_path, change)
    with pytest.raises(InputError, match="at most 20000 numbers in its arrays"):
        read_volume(path, limits=replace(DEFAULT_LIMITS, max_pixels=20_000))


def test_a_zone_may_share_a_probe_with_another():
    """A probe at a door."""
    positions, cells = bipyramid()
    volume = flat_volume("cells")
    zones = (
        Zone("a", np.array([0, 1]), np.array([[[0, 0, 0], [1, 1, 1.0]]])),
        Zone("b", np.array([1]), np.array([[[1, 0, 0], [2, 1, 1.0]]])),
    )
    check_volume(replace(volume, zones=zones))
    assert len(positions) == 5
    assert len(cells.facets) == 6


JSON_VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-2, 12),
    st.sampled_from([2**31, 10**30, 1e308, -0.5, "", "x", "absolute", "VEC3", 5125, 5126, "day"]),
    st.lists(st.integers(0, 12), max_size=4),
    st.dictionaries(st.sampled_from(["name", "probes", "count"]), st.integers(0, 3)),
)


@settings(
    max_examples=200,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    in_extension=st.booleans(),
    place=st.lists(st.integers(0, 20), min_size=1, max_size=5),
    value=JSON_VALUES,
)
def test_wrong_values_in_any_place_are_refused_or_read(tmp_path, in_extension, place, value):
    document, binary = parsed(volume_bytes(two_rooms(0)))
    at = document["extensions"][EXTENSION] if in_extension else document
    for step in place:
        keys = list(at) if isinstance(at, dict) else list(range(len(at)))
        key = keys[step % len(keys)]
        if step == place[-1] or not isinstance(at[key], dict | list) or not at[key]:
            at[key] = value
            break
        at = at[key]
    path = tmp_path / "a.glb"
    path.write_bytes(glb(document, binary))
    message = ""
    try:
        check_volume(read_volume(path))
    except InputError as error:
        message = str(error)
    assert "\n" not in message


@settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(changes=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), min_size=1, max_size=3))
def test_damaged_numbers_never_give_cells_that_do_not_fit(tmp_path, changes):
    """Only the binary chunk: the JSON is sound, what the arrays say is not."""
    document, binary = parsed(volume_bytes(two_rooms(0)))
    data = bytearray(binary)
    for place, value in changes:
        data[min(int(place * len(data)), len(data) - 1)] = value
    path = tmp_path / "a.glb"
    path.write_bytes(glb(document, bytes(data)))
    try:
        volume = read_volume(path)
    except InputError:
        return
    assert np.isfinite(ProbeSpace(volume).locate(np.zeros((1, 3))).weights).all()


@pytest.mark.parametrize("kind", ["lattice", "random", "plane", "line"])
def test_cells_of_rounded_positions_pass(kind, tmp_path):
    """What is joined here is what the reader accepts, lattices with their slivers too."""
    required("scipy")
    generator = np.random.default_rng(SEED)
    positions = {
        "lattice": np.stack(np.meshgrid(*[np.arange(6) * 0.7 + 0.1] * 3), axis=-1).reshape(-1, 3),
        "random": generator.uniform(-20, 20, (300, 3)),
        "plane": generator.uniform(-5, 5, (60, 3)) * [1, 0, 1],
        "line": generator.uniform(-5, 5, (20, 1)) * np.array([[1, 2, 3.0]]),
    }[kind]
    thin = rounded(plain_volume(positions, light(len(positions))))
    volume = replace(thin, cells=build_cells(thin.positions, thin.zones))
    assert_same(read_volume(write_volume(tmp_path / "a.glb", volume)), volume)


def test_ten_thousand_probes_are_checked_and_read_in_moderate_memory(tmp_path):
    """A file's worth of memory, some times over; nothing grows with the square of the probes."""
    required("scipy")
    generator = np.random.default_rng(SEED)
    positions = generator.uniform(0, 50, (10_000, 3))
    thin = rounded(plain_volume(positions, light(len(positions))))
    path = write_volume(
        tmp_path / "a.glb", replace(thin, cells=build_cells(thin.positions, thin.zones))
    )
    tracemalloc.start()
    found = read_volume(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found.count == 10_000
    assert len(found.cells.corners) > 5 * 10_000
    assert peak < 20 * path.stat().st_size


def test_a_volume_is_one_line_on_the_screen():
    assert repr(two_rooms()) == (
        "ProbeVolume(10 probes; order 2; states 'day', 'night'; zones 'west', 'east'; 4 cells; "
        "distances; absolute)"
    )
    bare = replace(two_rooms(), states={}, cells=None, distances=None, zones=two_rooms().zones[:1])
    assert repr(bare) == (
        "ProbeVolume(10 probes; no light; zones 'west'; not joined; no distances; absolute)"
    )
