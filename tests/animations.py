"""Tiny animated glTF files, whose poses are known in closed form."""

import json
import struct
from pathlib import Path

import numpy as np

__all__ = ["TRIANGLE", "GltfBuilder", "bending_arm", "moving_triangle"]

TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


class GltfBuilder:
    """Collects arrays as accessors; `document` is the JSON that `write` puts around them."""

    def __init__(self, **document):
        self.body = b""
        self.document = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "accessors": [], "bufferViews": [],
        } | document  # fmt: skip

    def add(self, values, dtype="<f4", **extra):
        """The number of a new accessor of `values` (n,) or (n, w)."""
        stored = np.asarray(values).astype(dtype)
        stored = stored.reshape(len(stored), -1)
        view = {"buffer": 0, "byteOffset": len(self.body), "byteLength": stored.nbytes}
        self.document["bufferViews"].append(view)
        self.document["accessors"].append({
            "bufferView": len(self.document["bufferViews"]) - 1, "count": len(stored),
            "componentType": COMPONENTS[stored.dtype.str[1:]], "type": KINDS[stored.shape[1]],
        } | extra)  # fmt: skip
        self.body += stored.tobytes() + b"\0" * (-stored.nbytes % 4)
        return len(self.document["accessors"]) - 1

    def animation(self, *channels, **named):
        """One more animation; channels are (node, path, times, values, interpolation[, extra])."""
        samplers, targets = [], []
        for number, (node, path, times, values, kind, *extra) in enumerate(channels):
            output = self.add(
                values, *(extra or ["<f4"]), **({"normalized": True} if extra else {})
            )
            samplers.append({"input": self.add(times), "output": output, "interpolation": kind})
            targets.append({"sampler": number, "target": {"node": node, "path": path}})
        entry = {"samplers": samplers, "channels": targets} | named
        self.document.setdefault("animations", []).append(entry)
        return entry

    def bytes(self):
        document = self.document | {"buffers": [{"byteLength": len(self.body)}]}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self.body), 0x004E4942) + self.body
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks

    def write(self, path):
        Path(path).write_bytes(self.bytes())
        return Path(path)


def moving_triangle(*channels, normals=None, nodes=None, targets=(), **named):
    """A triangle on node 0, and one animation of `channels`."""
    builder = GltfBuilder(nodes=nodes or [{"mesh": 0}])
    attributes = {"POSITION": builder.add(TRIANGLE)}
    if normals is not None:
        attributes["NORMAL"] = builder.add(normals)
    primitive = {"attributes": attributes}
    if targets:
        primitive["targets"] = [{"POSITION": builder.add(target)} for target in targets]
    builder.document["meshes"] = [{"primitives": [primitive]}]
    if channels:
        builder.animation(*channels, **named)
    return builder


def bending_arm(segments=8):
    """A flat arm of length 2 along +X; the half beyond 1 turns about Z at the elbow (1, 0, 0).

    Animation "bend": from 0 at 0 s to 90° at 1 s. Weights go over from 0.75 to 1.25.
    """
    x = np.linspace(0, 2, segments + 1)
    points = np.array([(a, b, 0.0) for a in x for b in (-0.1, 0.1)])
    corner = 2 * np.arange(segments)[:, None]
    triangles = np.concatenate([corner + np.array([0, 2, 3]), corner + np.array([0, 3, 1])])
    share = np.clip((points[:, 0] - 0.75) / 0.5, 0, 1)
    builder = GltfBuilder(
        nodes=[{"mesh": 0, "skin": 0, "translation": [50, 50, 50]},
               {"children": [2], "name": "upper"}, {"translation": [1, 0, 0], "name": "lower"}],
        scenes=[{"nodes": [0, 1]}],
    )  # fmt: skip
    bind = np.tile(np.eye(4), (2, 1, 1))
    bind[1, :3, 3] = (-1, 0, 0)
    joints = np.tile([0, 1, 0, 0], (len(points), 1))
    weights = np.stack([1 - share, share, 0 * share, 0 * share], axis=1)
    attributes = {
        "POSITION": builder.add(points),
        "NORMAL": builder.add(np.tile([0, 0, 1.0], (len(points), 1))),
        "JOINTS_0": builder.add(joints, "u1"),
        "WEIGHTS_0": builder.add(weights),
    }
    primitive = {"attributes": attributes, "indices": builder.add(triangles.ravel(), "<u4")}
    builder.document["meshes"] = [{"primitives": [primitive]}]
    matrices = bind.swapaxes(1, 2).reshape(-1, 16)
    builder.document["skins"] = [{"joints": [1, 2], "inverseBindMatrices": builder.add(matrices)}]
    half = np.sqrt(0.5)
    builder.animation(
        (2, "rotation", [0, 1], [(0, 0, 0, 1), (0, 0, half, half)], "LINEAR"), name="bend"
    )
    return builder, points, share
