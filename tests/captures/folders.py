"""Captures of one world in each format, written as their programs write them.

A camera stands at `EYE` of our world, turned by `TURN` about +Y; a red pixel of its picture shows a
point that every format must put at the same place.
"""

import json
import struct
import zipfile

import numpy as np

from andon.files.pictures import write_jpeg, write_png
from andon.spaces import WORLD_FROM_CAMERA_DEFAULT

__all__ = [
    "DEPTH_M", "INTRINSICS", "PIXEL", "POINT", "SIZE", "WRITERS", "lzfse_stored", "quaternion",
    "world_from_camera", "write_colmap", "write_record3d", "write_snapshot",
]  # fmt: skip

SIZE, INTRINSICS = (64, 48), (60.0, 62.0, 30.5, 25.5)
EYE, TURN = np.array([0.5, 1.5, -2.0]), np.radians(20)
# (column, row) and depth z of the point.
PIXEL, DEPTH_M = (40, 12), 2.5

Y_UP_FROM_Z_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
FLIP = np.diag([1.0, -1.0, -1.0])


def world_from_camera():
    """The camera's pose in our world."""
    turn = np.array([[np.cos(TURN), 0, np.sin(TURN)], [0, 1, 0], [-np.sin(TURN), 0, np.cos(TURN)]])
    pose = WORLD_FROM_CAMERA_DEFAULT.copy()
    pose[:3, :3] = turn @ pose[:3, :3]
    pose[:3, 3] = EYE
    return pose


def _point(intrinsics):
    fx, fy, cx, cy = intrinsics
    ray = np.array([(PIXEL[0] - cx) / fx, (PIXEL[1] - cy) / fy, 1.0])
    pose = world_from_camera()
    return pose[:3, :3] @ ray * DEPTH_M + pose[:3, 3]


POINT = _point(INTRINSICS)


def quaternion(rotation):
    """(x, y, z, w) of a rotation of less than half a turn, or of one by its largest entry."""
    k = np.array([
        1 + rotation[0, 0] - rotation[1, 1] - rotation[2, 2],
        1 - rotation[0, 0] + rotation[1, 1] - rotation[2, 2],
        1 - rotation[0, 0] - rotation[1, 1] + rotation[2, 2],
        1 + np.trace(rotation),
    ])  # fmt: skip
    i = int(np.argmax(k))
    r = rotation
    rows = [
        [k[0], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]],
        [r[0, 1] + r[1, 0], k[1], r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]],
        [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], k[2], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], k[3]],
    ]
    return np.array(rows[i]) / np.linalg.norm(rows[i])


def _picture(size=SIZE):
    picture = np.full((size[1], size[0], 3), 90, np.uint8)
    x, y = PIXEL
    picture[y - 2 : y + 3, x - 2 : x + 3] = (255, 0, 0)  # so that JPEG and video keep it
    return picture


def _depth(units_per_metre, size=SIZE):
    depth = np.full((size[1], size[0]), 4 * units_per_metre)
    depth[PIXEL[1], PIXEL[0]] = DEPTH_M * units_per_metre
    depth[0, 0] = 0
    return np.round(depth).astype(np.uint16)


def _line(*values):
    return " ".join(f"{value:.9g}" for value in values)


def write_tum(folder):
    """Poses in a world whose z is up; ROS's intrinsics are those of the picture's size alone."""
    for name in ("rgb", "depth"):
        (folder / name).mkdir()
    size = (640, 480)
    write_png(folder / "rgb" / "1.000000.png", _picture(size))
    write_png(folder / "depth" / "1.005000.png", _depth(5000, size))
    (folder / "rgb.txt").write_text("# color images\n1.000000 rgb/1.000000.png\n9.0 rgb/none.png\n")
    (folder / "depth.txt").write_text("# depth maps\n1.005000 depth/1.005000.png\n")
    rotation = Y_UP_FROM_Z_UP.T @ world_from_camera()[:3, :3]
    row = _line(1.01, *(Y_UP_FROM_Z_UP.T @ EYE), *quaternion(rotation))
    (folder / "groundtruth.txt").write_text(
        f"# timestamp tx ty tz qx qy qz qw\n0 0 0 0 0 0 0 1\n{row}\n"
    )
    return (525.0, 525.0, 319.5, 239.5)


def write_slambook(folder):
    """The world's y is down, as the cameras' is."""
    for name in ("color", "depth"):
        (folder / name).mkdir()
    size = (640, 480)
    write_png(folder / "color" / "2.png", _picture(size))
    header = f"P5\n{size[0]} {size[1]}\n65535\n".encode()
    (folder / "depth" / "2.pgm").write_bytes(header + _depth(1000, size).astype(">u2").tobytes())
    row = _line(*(FLIP @ EYE), *quaternion(FLIP @ world_from_camera()[:3, :3]))
    (folder / "pose.txt").write_text(f"0 0 0 0 0 0 1\n{row}\n")
    return (518.0, 519.0, 325.5, 253.5)


def write_realsense(folder):
    """Open3D's recorder."""
    for name in ("color", "depth"):
        (folder / name).mkdir()
    write_jpeg(folder / "color" / "000003.jpg", _picture())
    write_png(folder / "depth" / "000003.png", _depth(1000))
    fx, fy, cx, cy = INTRINSICS
    matrix = [fx, 0, 0, 0, fy, 0, cx, cy, 1]
    table = {"width": SIZE[0], "height": SIZE[1], "intrinsic_matrix": matrix}
    (folder / "camera_intrinsic.json").write_text(json.dumps(table))
    return INTRINSICS


def write_snapshot(folder, depth_fx=INTRINSICS[0]):
    """The viewer's; depth of another camera has another `depth_fx`."""
    write_png(folder / "desk_Color.png", _picture())
    (folder / "desk_Depth.raw").write_bytes(_depth(1000).astype("<u2").tobytes())
    for stream, focal in (("Color", INTRINSICS[0]), ("Depth", depth_fx)):
        _, fy, cx, cy = INTRINSICS
        lines = [
            "Frame Info:", f"Type,{stream}", "Format,Z16", f"Resolution x,{SIZE[0]}",
            f"Resolution y,{SIZE[1]}", "", "Intrinsic:,", f"Fx,{focal:.6f}", f"Fy,{fy:.6f}",
            f"PPx,{cx:.6f}", f"PPy,{cy:.6f}", "Distorsion,Brown Conrady",
        ]  # fmt: skip
        (folder / f"desk_{stream}_metadata.csv").write_text("\n".join(lines))
    return INTRINSICS


def lzfse_stored(data):
    """LZFSE with its bytes as they are: a block "bvx-" of their number, then the end."""
    return b"bvx-" + struct.pack("<I", len(data)) + data + b"bvx$"


def write_record3d(folder, zipped=None):
    """ARKit's camera looks along −z with y up. Into a folder, or into the file `zipped`."""
    fx, fy, cx, cy = INTRINSICS
    pose = world_from_camera()[:3, :3] @ FLIP
    metadata = {
        "w": SIZE[0], "h": SIZE[1], "dw": SIZE[0], "dh": SIZE[1], "fps": 60,
        "K": [fx, 0, 0, 0, fy, 0, cx, cy, 1],
        "poses": [[0, 0, 0, 1, 0, 0, 0], [*quaternion(pose), *EYE]],
    }  # fmt: skip
    write_jpeg(folder / "p.jpg", _picture())
    depth = (_depth(1000) / 1000).astype("<f4")
    depth[0, 1] = np.nan
    confidence = np.full(depth.shape, 2, np.uint8)
    confidence[0, 2] = 0
    files = {
        "metadata": json.dumps(metadata).encode(),
        "rgbd/1.jpg": (folder / "p.jpg").read_bytes(),
        "rgbd/1.depth": lzfse_stored(depth.tobytes()),
        "rgbd/1.conf": lzfse_stored(confidence.tobytes()),
    }
    if zipped is not None:
        with zipfile.ZipFile(zipped, "w") as archive:
            for name, data in files.items():
                archive.writestr(name, data)
        return INTRINSICS
    (folder / "rgbd").mkdir()
    for name, data in files.items():
        (folder / name).write_bytes(data)
    return INTRINSICS


def write_stray(folder):
    """Poses by columns, named; a video of two frames, of which the second is the one."""
    import cv2

    (folder / "depth").mkdir()
    (folder / "confidence").mkdir()
    video = cv2.VideoWriter(str(folder / "rgb.mp4"), cv2.VideoWriter_fourcc(*"mp4v"), 30, SIZE)
    for picture in (np.zeros_like(_picture()), _picture()):
        video.write(picture[..., ::-1].copy())
    video.release()
    write_png(folder / "depth" / "000001.png", _depth(1000))
    confidence = np.full((SIZE[1], SIZE[0]), 2, np.uint8)
    confidence[0, 2] = 0
    write_png(folder / "confidence" / "000001.png", confidence)
    fx, fy, cx, cy = INTRINSICS
    (folder / "camera_matrix.csv").write_text(f"{fx}, 0, {cx}\n0, {fy}, {cy}\n0, 0, 1\n")
    values = [*EYE, *quaternion(world_from_camera()[:3, :3])]
    row = ", ".join(f"{value:.9g}" for value in values)
    header = "timestamp, frame, x, y, z, qx, qy, qz, qw"
    (folder / "odometry.csv").write_text(
        f"{header}\n0.0, 000000, 0, 0, 0, 0, 0, 0, 1\n0.1, 000001, {row}\n"
    )
    return INTRINSICS


def write_arkitscenes(folder):
    """Rotation vectors of camera from world, whose z is up."""
    for name in ("lowres_wide", "lowres_depth", "lowres_wide_intrinsics"):
        (folder / name).mkdir()
    write_png(folder / "lowres_wide" / "41048190_3386.117.png", _picture())
    write_png(folder / "lowres_depth" / "41048190_3386.117.png", _depth(1000))
    (folder / "lowres_wide_intrinsics" / "41048190_3386.117.pincam").write_text(
        _line(*SIZE, *INTRINSICS)
    )
    pose = np.eye(4)
    pose[:3, :3] = Y_UP_FROM_Z_UP.T @ world_from_camera()[:3, :3]
    pose[:3, 3] = Y_UP_FROM_Z_UP.T @ EYE
    inverse = np.linalg.inv(pose)
    x, y, z, w = quaternion(inverse[:3, :3])
    angle = 2 * np.arctan2(np.linalg.norm([x, y, z]), w)
    vector = np.array([x, y, z]) / np.linalg.norm([x, y, z]) * angle
    (folder / "lowres_wide.traj").write_text(_line(3386.11804, *vector, *inverse[:3, 3]) + "\n")
    return INTRINSICS


def write_colmap(folder, binary=False, unit_m=1.0):
    """Camera from world, scalar first; pixel centres at a half; a unit of its own."""
    for name in ("images", "sparse", "stereo/depth_maps"):
        (folder / name).mkdir(parents=True)
    write_png(folder / "images" / "a b.png", _picture())
    pose = np.eye(4)
    pose[:3, :3] = FLIP @ world_from_camera()[:3, :3]
    pose[:3, 3] = FLIP @ EYE / unit_m
    inverse = np.linalg.inv(pose)
    x, y, z, w = quaternion(inverse[:3, :3])
    fx, fy, cx, cy = INTRINSICS
    parameters = (fx, fy, cx + 0.5, cy + 0.5)
    own, camera = 7, 3
    if binary:
        cameras = struct.pack("<QiiQQ4d", 1, camera, 1, *SIZE, *parameters)
        images = struct.pack("<Qi7di", 1, own, w, x, y, z, *inverse[:3, 3], camera)
        images += b"a b.png\0" + struct.pack("<Q2dq", 1, 5.0, 6.0, -1)
        (folder / "sparse" / "cameras.bin").write_bytes(cameras)
        (folder / "sparse" / "images.bin").write_bytes(images)
    else:
        text = f"# one\n{camera} PINHOLE {SIZE[0]} {SIZE[1]} {_line(*parameters)}\n"
        (folder / "sparse" / "cameras.txt").write_text(text)
        row = _line(own, w, x, y, z, *inverse[:3, 3], camera)
        text = f"# two lines each\n{row} a b.png\n\n{row.replace('7', '8', 1)} gone.png\n1 2 -1\n"
        (folder / "sparse" / "images.txt").write_text(text)
    depth = (_depth(1000) / 1000 / unit_m).astype("<f4")
    header = f"{SIZE[0]}&{SIZE[1]}&1&".encode()
    path = folder / "stereo" / "depth_maps" / "a b.png.geometric.bin"
    path.write_bytes(header + depth.tobytes())
    return INTRINSICS


# Format → writer; each returns fx, fy, cx, cy with pixel centres at integers.
WRITERS = {
    "tum": write_tum,
    "slambook": write_slambook,
    "realsense": write_realsense,
    "realsense-snapshot": write_snapshot,
    "record3d": write_record3d,
    "stray": write_stray,
    "arkitscenes": write_arkitscenes,
    "colmap": write_colmap,
}
