"""Small things for tests: pictures, cameras, meshes and the files that hold them."""

import json
import struct
from pathlib import Path

import numpy as np

from andon.files.pictures import write_png
from andon.quantities import Geometry
from andon.surface.objects import joined

__all__ = [
    "ALL_CODES",
    "ball",
    "block",
    "open_room",
    "points_on",
    "scene",
    "sheet",
    "sphere_depth",
    "unit",
    "write_glb",
    "write_obj",
    "write_relight_files",
    "write_scene_files",
]


def unit(vectors):
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _all_codes():
    """(16, 48, 3): every one of the 256 codes in every channel, beside every other's."""
    codes = np.arange(256).reshape(16, 16)
    ramps = np.concatenate([codes, codes[::-1], codes.T], axis=1)
    return np.stack([ramps, np.roll(ramps, 16, axis=1), ramps[::-1]], axis=-1).astype(np.uint8)


ALL_CODES = _all_codes()


def ball(radius, centre, frequency=8):
    """A faceted ball that faces outwards."""
    from andon.verify.solids import icosphere

    solid = icosphere(radius, frequency)
    return Geometry(solid.positions + np.asarray(centre, float), solid.triangles.astype(np.int32))


def block(size, centre, *, inwards=False):
    """A box of `size` (3,) around `centre` (3,); `inwards` makes a room of it."""
    x, y, z = np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij")
    positions = np.stack([x, y, z], axis=-1).reshape(-1, 3) * size + np.asarray(centre, float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)
    return Geometry(positions, triangles[:, ::-1] if inwards else triangles)


def sheet(corner, along, across):
    """A parallelogram of two triangles."""
    corner, along, across = (np.asarray(v, float) for v in (corner, along, across))
    positions = np.array([corner, corner + along, corner + along + across, corner + across])
    return Geometry(positions, np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def open_room():
    """Floor and two walls (light may come from outside), a block and a ball."""
    floor = block((6, 0.2, 6), (0, -0.1, 0))
    back = block((6, 3, 0.2), (0, 1.5, -2.6))
    side = block((0.2, 3, 6), (-2.6, 1.5, 0))
    return joined(
        [floor, back, side, block((0.6, 1.0, 0.6), (-0.6, 0.5, -0.8)), ball(0.4, (0.6, 0.4, 0), 8)]
    )


def points_on(geometry, count, seed=1):
    """(count, 3) points spread evenly over the triangles, and the normals there."""
    random = np.random.default_rng(seed)
    corners = geometry.positions[geometry.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    chosen = random.choice(len(corners), count, p=area / area.sum())
    points = np.einsum("ij,ijk->ik", random.dirichlet((1, 1, 1), count), corners[chosen])
    return points, across[chosen] / area[chosen][:, None]


def sphere_depth(view, centre, radius):
    """(depth (H, W), camera-frame normals (H, W, 3)) of a ball in the camera frame, NaN beside."""
    rays, centre = view.directions(), np.asarray(centre, float)
    along = rays @ centre
    square = along**2 - (centre @ centre - radius**2)
    with np.errstate(invalid="ignore"):
        distance = np.where((square > 0) & (along > 0), along - np.sqrt(square), np.nan)
    points = rays * distance[..., None]
    depth = points[..., 2] if view.projection == "pinhole" else distance
    return depth, (points - centre) / radius


def write_obj(path, geometry, extra=""):
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in geometry.positions]
    lines += [f"f {a} {b} {c}" for a, b, c in geometry.triangles + 1]
    Path(path).write_text("\n".join([*lines, extra]) + "\n")


def write_glb(path, geometry, *, colour=(0.8, 0.4, 0.2), emissive=None, uvs=None, texture=None):
    """A binary glTF of one mesh with one material; `texture` is PNG bytes."""
    parts = [
        geometry.positions.astype("<f4").tobytes(),
        geometry.triangles.astype("<u4").tobytes(),
    ]
    attributes = {"POSITION": 0}
    accessors = [
        {
            "bufferView": 0, "componentType": 5126, "count": len(geometry.positions),
            "type": "VEC3", "min": geometry.positions.min(axis=0).tolist(),
            "max": geometry.positions.max(axis=0).tolist(),
        },
        {
            "bufferView": 1, "componentType": 5125, "count": geometry.triangles.size,
            "type": "SCALAR",
        },
    ]  # fmt: skip
    material = {"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0}}
    if emissive is not None:
        material["emissiveFactor"] = list(emissive)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "materials": [material],
        "accessors": accessors,
    }
    if uvs is not None:
        attributes["TEXCOORD_0"] = 2
        parts.append(np.asarray(uvs, "<f4").tobytes())
        accessors.append(
            {"bufferView": 2, "componentType": 5126, "count": len(uvs), "type": "VEC2"}
        )
    if texture is not None:
        parts.append(texture)
        document["images"] = [{"bufferView": len(parts) - 1, "mimeType": "image/png"}]
        document["textures"] = [{"source": 0}]
        material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    document["meshes"] = [{"primitives": [{"attributes": attributes, "indices": 1, "material": 0}]}]
    body, views = b"", []
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(body), "byteLength": len(part)})
        body += part + b"\0" * (-len(part) % 4)
    document["bufferViews"], document["buffers"] = views, [{"byteLength": len(body)}]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(body), 0x004E4942) + body
    Path(path).write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)


def write_relight_files(folder, *, width=64, height=48):
    """photo.png, depth.npy and camera.toml of a wall with a ball before it, 2 m away."""
    from andon.spaces import View

    view = View(
        "pinhole", width, height, width * 0.9, width * 0.9, (width - 1) / 2, (height - 1) / 2
    )
    depth = np.full(view.shape, 2.5)
    ball_depth = sphere_depth(view, (0.2, 0.1, 2.0), 0.4)[0]
    depth = np.where(np.isfinite(ball_depth), ball_depth, depth)
    depth[:3, :5] = np.nan
    generator = np.random.default_rng(5)
    tint = np.where(np.isfinite(ball_depth)[..., None], [150, 60, 50], [120, 125, 110])
    photo = (tint + generator.integers(-20, 20, (*view.shape, 3))).astype(np.uint8)
    folder = Path(folder)
    write_png(folder / "photo.png", photo)
    np.save(folder / "depth.npy", depth)
    (folder / "camera.toml").write_text(
        f"[camera]\nwidth = {width}\nheight = {height}\nfx = {view.fx}\n"
    )
    return photo, depth, view


def write_scene_files(folder, **tables):
    """The files of `write_relight_files`, and the tables of a scene that names them."""
    write_relight_files(folder)
    base = {
        "rig": {"camera": {"fx": 57.6}},
        "capture": {"source": "photo.png"},
        "surface": {"depth": "depth.npy"},
        "ambient": {"illuminance_lux": 200.0},
    }
    return base | tables


def scene(folder, **tables):
    """The scene of `write_scene_files`, with its files in `folder`."""
    from andon.scene import scene_from_dict

    return scene_from_dict(write_scene_files(folder, **tables), folder=folder)
