"""Glass in front of a board that is photographed: files and scenes for tests of whole frames.

The eye is 0.4 m before the origin and looks along −z, the board is 0.2 m behind the origin: the
distances of the paper on glass by gaze.
"""

from pathlib import Path

import numpy as np
from PIL import Image

from andon.files.pictures import write_png
from andon.responses import SRGB
from andon.spaces import View, look_at
from worlds import sheet, write_obj

__all__ = [
    "BACKDROP",
    "BALL",
    "BOARD_Z",
    "EYE_Z",
    "HEIGHT",
    "WIDTH",
    "board",
    "glass_scene",
    "glass_tables",
    "write_glass_files",
]  # fmt: skip

EYE_Z, BOARD_Z = 0.4, -0.2
WIDTH, HEIGHT, FOCAL = 128, 80, 176.0
# Metres of the board's picture.
BOARD_M = (0.8, 0.6)

BACKDROP = {
    "kind": "texture", "file": "board.png", "position": [0.0, 0.0, BOARD_Z],
    "width_m": BOARD_M[0], "height_m": BOARD_M[1],
}  # fmt: skip
BALL = {"shape": "sphere", "radius_m": 0.075, "name": "ball", "background": BACKDROP}


def board(x, y):
    """(…, 3) linear light of the board at x, y in metres: soft squares, and a red disc up right."""
    waves = np.sin((x - 0.01) * 2 * np.pi / 0.06) * np.sin((y - 0.01) * 2 * np.pi / 0.06)
    light = 0.35 + 0.25 * np.tanh(8 * waves)
    squares = light[..., None] * [1.0, 0.95, 0.8]
    disc = 0.5 - 0.5 * np.tanh((np.hypot(x - 0.04, y - 0.03) - 0.025) / 0.004)
    return squares + disc[..., None] * ([0.6, 0.05, 0.05] - squares)


def _codes(linear):
    return np.asarray(SRGB.encode(linear) * 255 + 0.5, np.uint8)


def photograph(view):
    """The board as `view` sees it."""
    eye, rays = view.rays_world()
    reach = (BOARD_Z - eye[2]) / rays[..., 2]
    return _codes(board(eye[0] + reach * rays[..., 0], eye[1] + reach * rays[..., 1]))


def write_glass_files(folder, *, eyes=((0.0, "mono"),), width=WIDTH, height=HEIGHT):
    """<eye>.png for each (x, eye); board.obj, board.png and label.png: a ring, and an arrow up."""
    for x, name in eyes:
        pose = look_at(np.array([x, 0, EYE_Z]), np.array([x, 0.0, 0.0]))
        middle = ((width - 1) / 2, (height - 1) / 2)
        focal = FOCAL * width / WIDTH
        view = View("pinhole", width, height, focal, focal, *middle, world_from_camera=pose)
        write_png(Path(folder) / f"{name}.png", photograph(view))
    half, high = 0.9, 0.6
    write_obj(
        Path(folder) / "board.obj",
        sheet((-half, -high, BOARD_Z), (2 * half, 0, 0), (0, 2 * high, 0)),
    )
    across, up = np.meshgrid((np.arange(512) + 0.5) / 512 - 0.5, 0.5 - (np.arange(384) + 0.5) / 384)
    write_png(Path(folder) / "board.png", _codes(board(across * BOARD_M[0], up * BOARD_M[1])))
    Image.fromarray(_label()).save(Path(folder) / "label.png")


def _label():
    """(128, 256, 4): what sticks to a ball, its front in the middle."""
    rows, columns = np.mgrid[:128, :256]
    x, y = (columns - 127.5) / 256 * 360, (63.5 - rows) / 128 * 180  # degrees
    ring = np.abs(np.hypot(x, y) - 26) < 3.5
    arrow = (np.abs(x) < 3) & (np.abs(y) < 14) | (y > 4) & (y < 18) & (np.abs(x) < (18 - y) * 0.7)
    picture = np.zeros((128, 256, 4), np.uint8)
    picture[ring] = [235, 225, 90, 255]
    picture[arrow] = [220, 60, 40, 255]
    return picture


def glass_tables(*glass, width=WIDTH, height=HEIGHT, **tables):
    """The tables of a scene of one eye, for files of `write_glass_files`."""
    camera = {
        "width": width, "height": height, "fx": FOCAL * width / WIDTH,
        "position": [0.0, 0.0, EYE_Z], "look_at": [0.0, 0.0, 0.0],
    }  # fmt: skip
    base = {
        "rig": {"camera": camera},
        "capture": {"source": "mono.png", "luminance_per_unit": 240.0},
        "surface": {"mesh": "board.obj"},
        "ambient": {"illuminance_lux": 500.0},
        "observer": {"pupil_mm": 6.0},
        "glass": list(glass),
    }
    return {key: value for key, value in (base | tables).items() if value != []}


def glass_scene(folder, *glass, **tables):
    """The scene of `glass_tables`; its files are in `folder` already."""
    from andon.scene import scene_from_dict

    return scene_from_dict(glass_tables(*glass, **tables), folder=folder)
