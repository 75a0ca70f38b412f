"""Makes the demonstration's virtual object: an andon, a paper lantern with a wooden frame.

    python tools/make_lantern.py src/andon/data/motorcycle/andon.glb

Two materials (cedar, paper), flat faces, about 0.24 × 0.24 × 0.42 m, standing on y = 0.
"""

from __future__ import annotations

import json
import struct
import sys
from pathlib import Path

import numpy as np

WIDTH_M, HEIGHT_M, POST_M = 0.24, 0.42, 0.018
CEDAR, PAPER = (0.30, 0.155, 0.075), (0.82, 0.79, 0.70)


def box(low: list[float], high: list[float]) -> np.ndarray:
    """(12, 3, 3) triangles of an axis-aligned box, counter-clockwise from outside."""
    corners = np.array([[(low, high)[i >> a & 1][a] for a in range(3)] for i in range(8)])
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return np.array([[corners[q[i]] for i in t] for q in quads for t in ((0, 1, 2), (0, 2, 3))])


def lantern() -> tuple[np.ndarray, np.ndarray]:
    """Triangles of the frame and of the paper."""
    half, post = WIDTH_M / 2, POST_M
    wood = [
        box([x - post / 2, 0, z - post / 2], [x + post / 2, HEIGHT_M, z + post / 2])
        for x in (-half, half)
        for z in (-half, half)
    ]
    for y in (0.05, HEIGHT_M * 0.5, HEIGHT_M - 0.03):
        for side in (-half, half):
            inner, bar = half - post / 2, post / 2
            wood.append(box([-inner, y - bar, side - bar], [inner, y + bar, side + bar]))
            wood.append(box([side - bar, y - bar, -inner], [side + bar, y + bar, inner]))
    wood.append(box([-half - 0.03, 0.0, -half - 0.03], [half + 0.03, 0.012, half + 0.03]))
    wood.append(
        box([-half - 0.02, HEIGHT_M, -half - 0.02], [half + 0.02, HEIGHT_M + 0.015, half + 0.02])
    )
    inset, sheet = half - post * 0.35, 0.001
    low, high = 0.055, HEIGHT_M - 0.035
    paper = [box([-inset, low, s - sheet], [inset, high, s + sheet]) for s in (-inset, inset)]
    paper += [box([s - sheet, low, -inset], [s + sheet, high, inset]) for s in (-inset, inset)]
    return np.concatenate(wood), np.concatenate(paper)


def glb(parts: list[tuple[str, tuple[float, float, float], np.ndarray]]) -> bytes:
    """A binary glTF of flat triangles, one primitive a material."""
    blob, views, accessors, primitives, materials = b"", [], [], [], []
    for name, colour, triangles in parts:
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        attributes = {}
        for key, values in (
            ("POSITION", triangles.reshape(-1, 3)),
            ("NORMAL", np.repeat(normals, 3, axis=0)),
        ):
            data = values.astype("<f4")
            entry = {"bufferView": len(views), "componentType": 5126, "type": "VEC3"}
            entry |= {"count": len(data)}
            if key == "POSITION":
                entry |= {"min": data.min(0).tolist(), "max": data.max(0).tolist()}
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": data.nbytes})
            attributes[key] = len(accessors)
            accessors.append(entry)
            blob += data.tobytes()
        primitives.append({"attributes": attributes, "material": len(materials)})
        look = {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9}
        materials.append({"name": name, "pbrMetallicRoughness": look, "doubleSided": True})
    document = {
        "asset": {"version": "2.0", "generator": "Andon tools/make_lantern.py"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "andon", "mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(blob), 0x004E4942) + blob
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


if __name__ == "__main__":
    wood, paper = lantern()
    Path(sys.argv[1]).write_bytes(glb([("cedar", CEDAR, wood), ("paper", PAPER, paper)]))
