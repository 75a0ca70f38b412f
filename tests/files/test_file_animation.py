"""glTF that moves: keyframes, skins and morph targets in closed form, and what is refused."""

import copy
import json
import struct
import warnings
from dataclasses import replace

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS
from andon.files.meshes import read_animated, read_mesh
from animations import TRIANGLE, bending_arm, moving_triangle
from comparison import assert_agree
from worlds import block, write_obj

HALF = np.sqrt(0.5)
QUARTER_TURN = [(0, 0, 0, 1), (0, 0, HALF, HALF)]  # about +Z


def posed(builder, folder, seconds, name="0"):
    mesh = read_animated(builder.write(folder / "a.glb"))
    return mesh.pose(mesh.clip(name), seconds)


def about_z(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


# ── between keys ──────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("seconds", "expected"), [(0, 0), (1, 0), (1.5, 1), (2.5, 2), (9, 2)])
def test_linear_translation(tmp_path, seconds, expected):
    """Held before the first key and after the last."""
    keys = [(0, 0, 0), (2, 0, 0), (2, 0, 0)]
    builder = moving_triangle((0, "translation", [1, 2, 3], keys, "LINEAR"))
    positions, normals = posed(builder, tmp_path, seconds)
    assert_agree(positions, TRIANGLE + np.array([expected, 0, 0]), atol=1e-12)
    assert normals is None


@pytest.mark.parametrize("seconds", [0, 0.1, 0.25, 0.5, 0.9, 1])
@pytest.mark.parametrize("sign", [1, -1], ids=["same", "negated"])
def test_rotation_turns_at_a_constant_rate(tmp_path, seconds, sign):
    """q and −q are one rotation, so the shorter way is taken."""
    keys = [QUARTER_TURN[0], sign * np.array(QUARTER_TURN[1])]
    builder = moving_triangle((0, "rotation", [0, 1], keys, "LINEAR"))
    positions, _ = posed(builder, tmp_path, seconds)
    assert_agree(positions, TRIANGLE @ about_z(90 * seconds).T, atol=1e-7)


@pytest.mark.parametrize(("seconds", "size"), [(0, 1), (0.999, 1), (1, 3), (1.5, 3), (4, 5)])
def test_step_holds_each_key(tmp_path, seconds, size):
    keys = np.array([1, 3, 5])[:, None] * np.ones(3)
    builder = moving_triangle((0, "scale", [0, 1, 2], keys, "STEP"))
    assert_agree(posed(builder, tmp_path, seconds)[0], size * TRIANGLE, atol=1e-12)


@pytest.mark.parametrize("seconds", np.linspace(0.5, 3, 11))
def test_cubic_spline_is_the_cubic_itself(tmp_path, seconds):
    """Hermite's form reproduces every polynomial of degree 3 from its values and slopes."""
    cubic = np.polynomial.Polynomial([0.3, -1, 2, -0.5])
    times = np.array([0.5, 1, 3])
    slopes, values = cubic.deriv()(times), cubic(times)
    keys = np.stack([slopes, values, slopes], axis=1)[..., None] * (1, 0, 2)
    builder = moving_triangle((0, "translation", times, keys.reshape(-1, 3), "CUBICSPLINE"))
    found = posed(builder, tmp_path, seconds)[0]
    assert_agree(found, TRIANGLE + cubic(seconds) * np.array([1, 0, 2]), atol=2e-6)


def test_cubic_rotation_is_normalised(tmp_path):
    none = (0, 0, 0, 0)
    keys = [none, QUARTER_TURN[0], none, none, QUARTER_TURN[1], none]
    builder = moving_triangle((0, "rotation", [0, 1], keys, "CUBICSPLINE"))
    found = posed(builder, tmp_path, 0.5)[0]
    assert_agree(found, TRIANGLE @ about_z(45).T, atol=1e-7)  # by symmetry
    found = posed(builder, tmp_path, 0.3)[0]
    assert_agree(np.linalg.norm(found, axis=1), [0, 1, 1], atol=1e-12)


def test_normalised_integers_are_quaternions(tmp_path):
    keys = np.rint(np.array(QUARTER_TURN) * 32767)
    builder = moving_triangle((0, "rotation", [0, 1], keys, "LINEAR", "<i2"))
    assert_agree(posed(builder, tmp_path, 1)[0], TRIANGLE @ about_z(90).T, atol=1e-4)


def test_parents_carry_their_children(tmp_path):
    nodes = [{"children": [1], "translation": [0, 5, 0]}, {"mesh": 0, "translation": [1, 0, 0]}]
    builder = moving_triangle((0, "rotation", [0, 1], QUARTER_TURN, "LINEAR"), nodes=nodes)
    found = posed(builder, tmp_path, 1)[0]
    turned = (TRIANGLE + np.array([1, 0, 0])) @ about_z(90).T
    assert_agree(found, turned + np.array([0, 5, 0]), atol=1e-7)


def test_morph_targets_are_added_by_weight(tmp_path):
    targets = [np.array([[0, 0, 1.0]] * 3), np.array([[0, 0, 0], [1.0, 0, 0], [0, 0, 0]])]
    nodes = [{"mesh": 0, "weights": [0.5, 0]}]
    keys = [0, 0, 1, 0.5]  # two weights a key
    builder = moving_triangle((0, "weights", [0, 1], keys, "LINEAR"), nodes=nodes, targets=targets)
    at_rest = read_mesh(builder.write(tmp_path / "a.glb")).geometry
    assert_agree(at_rest.positions, TRIANGLE + 0.5 * targets[0], atol=1e-12)
    found = posed(builder, tmp_path, 0.5)[0]
    assert_agree(found, TRIANGLE + 0.5 * targets[0] + 0.25 * targets[1], atol=1e-12)


def test_normals_go_by_the_inverse_transpose(tmp_path):
    """A plane x + z = c, squeezed along x by 4, leans towards x."""
    normal = np.tile(np.array([HALF, 0, HALF]), (3, 1))
    keys = [(1, 1, 1), (0.25, 1, 1)]
    builder = moving_triangle((0, "scale", [0, 1], keys, "LINEAR"), normals=normal)
    _, normals = posed(builder, tmp_path, 1)
    assert_agree(normals, np.tile(np.array([4, 0, 1]) / np.sqrt(17), (3, 1)), atol=1e-6)


# ── skins ─────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("seconds", [0, 0.5, 1])
def test_skin_blends_linearly(tmp_path, seconds):
    """The mesh's own node is ignored; the elbow stays, beyond it the arm turns."""
    builder, points, share = bending_arm()
    positions, normals = posed(builder, tmp_path, seconds, "bend")
    elbow = np.array([1.0, 0, 0])
    turned = (points - elbow) @ about_z(90 * seconds).T + elbow
    expected = (1 - share)[:, None] * points + share[:, None] * turned
    assert_agree(positions, expected, atol=1e-6)
    assert_agree(normals, np.tile([0, 0, 1.0], (len(points), 1)), atol=1e-6)


def test_flattened_normals_are_those_at_rest(tmp_path):
    normals = np.tile([0, 0, 1.0], (3, 1))
    keys = [(1, 1, 1), (0, 0, 0)]
    builder = moving_triangle((0, "scale", [0, 1], keys, "LINEAR"), normals=normals)
    assert_agree(posed(builder, tmp_path, 1)[1], normals)


def test_a_real_skin_against_a_loop(data_dir):
    """The walk of a public model, vertex by vertex from the bytes of the file."""
    path = data_dir / "gltf_models" / "CesiumMan.glb"
    mesh = read_animated(path)
    (clip,) = mesh.clips
    assert clip.name == "0"
    assert clip.duration_seconds == pytest.approx(2.0, abs=1e-6)
    model = SlowModel(path.read_bytes())
    chosen = range(0, len(mesh.geometry.positions), 97)
    for seconds in (0.0, 0.3, 1.0, 1.71):
        positions, normals = mesh.pose(clip, seconds)
        world = model.world(seconds)
        expected = [model.vertex(world, index) for index in chosen]
        assert_agree(positions[list(chosen)], expected, atol=1e-6, what="positions")
        assert_agree(np.linalg.norm(normals, axis=1), np.ones(len(normals)), atol=1e-9)
        a, b, c = (positions[mesh.geometry.triangles[:, i]] for i in range(3))
        corner = normals[mesh.geometry.triangles].sum(axis=1)
        outwards = np.einsum("ni,ni->n", np.cross(b - a, c - a), corner) > 0
        assert outwards.mean() > 0.99, "normals follow the triangles"
        low, high = positions.min(axis=0), positions.max(axis=0)
        assert -0.02 < low[1] < 0.03, "feet on the floor"
        assert 1.4 < high[1] < 1.6, "upright"
    assert np.ptp([mesh.pose(clip, t)[0][:, 2].max() for t in (0, 0.5)]) > 0.05, "it walks"


class SlowModel:
    """glTF read and posed without the package: JSON, struct and one matrix after the other."""

    def __init__(self, data):
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + length])
        self.body = data[28 + length :]
        primitive = self.json["meshes"][0]["primitives"][0]["attributes"]
        names = ("POSITION", "JOINTS_0", "WEIGHTS_0")
        self.points, self.joints, self.weights = (self.rows(primitive[name]) for name in names)
        self.bind = self.rows(self.json["skins"][0]["inverseBindMatrices"])

    def rows(self, number):
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
        kind = {5126: "f", 5123: "H", 5121: "B"}[accessor["componentType"]]
        size = struct.calcsize(kind) * width
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        step = view.get("byteStride", size)
        count = accessor["count"]
        return [struct.unpack_from(f"<{width}{kind}", self.body, start + i * step)
                for i in range(count)]  # fmt: skip

    def value(self, sampler, seconds, is_rotation):
        times = [row[0] for row in self.rows(sampler["input"])]
        values = [np.array(row) for row in self.rows(sampler["output"])]
        if seconds <= times[0]:
            return values[0]
        if seconds >= times[-1]:
            return values[-1]
        after = next(i for i, time in enumerate(times) if time > seconds)
        share = (seconds - times[after - 1]) / (times[after] - times[after - 1])
        a, b = values[after - 1], values[after]
        if not is_rotation:
            return a + share * (b - a)
        b = -b if a @ b < 0 else b
        angle = np.arccos(min(1.0, a @ b))
        if angle < 1e-6:
            return a
        return (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)

    def world(self, seconds):
        """node → 4×4."""
        nodes = copy.deepcopy(self.json["nodes"])
        animation = self.json["animations"][0]
        for channel in animation["channels"]:
            path, sampler = channel["target"]["path"], animation["samplers"][channel["sampler"]]
            value = self.value(sampler, seconds, path == "rotation")
            nodes[channel["target"]["node"]][path] = value
        found = {}

        def visit(number, parent):
            node = nodes[number]
            found[number] = parent @ self.local(node)
            for child in node.get("children", []):
                visit(child, found[number])

        for root in self.json["scenes"][0]["nodes"]:
            visit(root, np.eye(4))
        return found

    @staticmethod
    def local(node):
        if "matrix" in node:
            return np.array(node["matrix"]).reshape(4, 4).T
        x, y, z, w = np.array(node.get("rotation", (0, 0, 0, 1)), float)
        # Columns of a rotation are what it makes of the axes: v + 2 q × (q × v + w v).
        q = np.array([x, y, z])
        matrix = np.eye(4)
        for axis, size in enumerate(node.get("scale", (1, 1, 1))):
            v = np.eye(3)[axis]
            matrix[:3, axis] = size * (v + 2 * np.cross(q, np.cross(q, v) + w * v))
        matrix[:3, 3] = node.get("translation", (0, 0, 0))
        return matrix

    def vertex(self, world, index):
        total = np.zeros(4)
        for joint, weight in zip(self.joints[index], self.weights[index], strict=True):
            bind = np.array(self.bind[joint]).reshape(4, 4).T
            node = self.json["skins"][0]["joints"][joint]
            total += weight * (world[node] @ bind @ np.array([*self.points[index], 1.0]))
        return total[:3] / sum(self.weights[index])


# ── names, and what is refused ────────────────────────────────────────────────────────────────


def test_clips_have_names_or_numbers(tmp_path):
    builder = moving_triangle((0, "translation", [0, 1], [(0, 0, 0)] * 2, "LINEAR"), name="Walk")
    builder.animation((0, "translation", [0, 2.5], [(0, 0, 0)] * 2, "LINEAR"))
    mesh = read_animated(builder.write(tmp_path / "a.glb"))
    assert [(clip.name, clip.duration_seconds) for clip in mesh.clips] == [("Walk", 1), ("1", 2.5)]
    assert mesh.clip("0") is mesh.clip("Walk") is mesh.clips[0]
    with pytest.raises(InputError, match=r"'walk'.*'Walk', '1'; did you mean 'Walk'"):
        mesh.clip("walk")
    with pytest.raises(InputError, match="no animation '7', the file has"):
        mesh.clip("7")
    still = read_animated(moving_triangle().write(tmp_path / "b.glb"))
    with pytest.raises(InputError, match="the file has no animation"):
        still.clip("0")


def test_other_formats_have_no_animations(tmp_path):
    write_obj(tmp_path / "a.obj", block((1, 1, 1), (0, 0, 0)))
    with pytest.raises(InputError, match="only glTF files have animations"):
        read_animated(tmp_path / "a.obj")


def change(document, path, value):
    *parents, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    for key in parents:
        document = document[key]
    document[last] = value


SAMPLER, TARGET = "animations.0.samplers.0", "animations.0.channels.0.target"
MOVE = ("translation", [0, 1], [(0, 0, 0), (1, 0, 0)], "LINEAR")


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (f"{TARGET}.path", "colour", "must have a path of translation, rotation"),
        (f"{TARGET}.node", 5, "must be 0…0, got 5"),
        (f"{TARGET}.path", "rotation", "must be VEC4, is 'VEC3'"),
        ("animations.0.channels.0.sampler", 3, "must be 0…0, got 3"),
        ("animations.0.samplers", [], "must have samplers, has none"),
        (f"{SAMPLER}.interpolation", "BEZIER", "must be one of LINEAR, STEP, CUBICSPLINE"),
        (f"{SAMPLER}.interpolation", "CUBICSPLINE", "must have 6 values of 2 keys, has 2"),
        (f"{SAMPLER}.input", 1, "must be SCALAR"),
        (f"{SAMPLER}.input", 99, "must be 0…2"),
        ("nodes.0", {"mesh": 0, "matrix": [*np.eye(4).ravel()]}, "must not have a matrix"),
        ("accessors.1.componentType", 5125, "must be floats, or normalised integers"),
    ],
)  # fmt: skip
def test_broken_animations_are_refused(tmp_path, path, value, message):
    builder = moving_triangle((0, *MOVE))
    change(builder.document, path, value)
    with pytest.raises(InputError, match=message.replace(".", r"\.")):
        read_animated(builder.write(tmp_path / "a.glb"))
    assert len(read_mesh(tmp_path / "a.glb").geometry.triangles) == 1, "at rest nothing is wrong"


@pytest.mark.parametrize("times", [(0, 0), (1, 0.5), (-1, 0), (0, np.nan), (0, np.inf)])
def test_times_must_rise(tmp_path, times):
    builder = moving_triangle((0, MOVE[0], times, *MOVE[2:]))
    with pytest.raises(InputError, match=r"must be (times ≥ 0 that rise|finite)"):
        read_animated(builder.write(tmp_path / "a.glb"))


def test_one_channel_moves_one_thing(tmp_path):
    builder = moving_triangle((0, *MOVE), (0, *MOVE))
    with pytest.raises(InputError, match="must be the only one that moves the translation"):
        read_animated(builder.write(tmp_path / "a.glb"))


def test_no_quaternion_of_length_0(tmp_path):
    builder = moving_triangle((0, "rotation", [0, 1], [(0, 0, 0, 1), (0, 0, 0, 0)], "LINEAR"))
    with pytest.raises(InputError, match="must be unit quaternions"):
        read_animated(builder.write(tmp_path / "a.glb"))


def test_what_points_elsewhere_moves_nothing(tmp_path):
    """Channels without a node, and of nodes outside the scene (3.11)."""
    nodes = [{"mesh": 0}, {}]
    builder = moving_triangle((0, *MOVE), (1, *MOVE), nodes=nodes)
    target = builder.document["animations"][0]["channels"][0]["target"]
    del target["node"]
    target["path"] = "pointer"
    assert_agree(posed(builder, tmp_path, 1)[0], TRIANGLE)


def test_too_many_keys_are_refused(tmp_path):
    """Many channels may show the same few bytes: what they add up to is counted."""
    nodes = [{"mesh": 0, "children": [*range(1, 9)]}, *[{} for _ in range(8)]]
    builder = moving_triangle(*[(node, *MOVE) for node in range(9)], nodes=nodes)
    path = builder.write(tmp_path / "a.glb")
    limits = replace(DEFAULT_LIMITS, max_vertices=71)  # 9 × (2 times + 6 values) = 72
    with pytest.raises(InputError, match="at most 71 numbers in animations"):
        read_animated(path, limits=limits)
    assert read_animated(path, limits=replace(limits, max_vertices=72)).clips


@pytest.mark.parametrize("seed", range(4))
def test_damaged_files_are_read_or_refused(tmp_path, seed):
    generator = np.random.default_rng(seed)
    data = bending_arm()[0].bytes()
    path = tmp_path / "a.glb"
    refused, messages = 0, []
    for _ in range(60):
        bad = bytearray(data)
        for at in generator.integers(0, len(bad), generator.integers(1, 5)):
            bad[at] = generator.integers(256)
        path.write_bytes(bad[: generator.integers(1, len(bad))] if seed == 0 else bad)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                mesh = read_animated(path)
                for clip in mesh.clips:
                    positions, _ = mesh.pose(clip, 0.4 * clip.duration_seconds)
                    assert np.isfinite(positions).all()
            except InputError as error:
                refused += 1
                messages.append(str(error))
    assert refused >= (50 if seed == 0 else 5)
    assert not any("\n" in message for message in messages)
