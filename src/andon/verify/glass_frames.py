"""A scene of glass as files, drawn here: the paper's set-up, tiles of chance behind the ball."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.pictures import write_png
from andon.responses import SRGB
from andon.scene import Scene, scene_from_dict
from andon.spaces import View
from andon.verify.glass_setting import BACKDROP, eye_views

__all__ = ["E0_LUX", "WHITE_CD_M2", "write_glass_scene"]

Float = NDArray[np.float64]

E0_LUX = 500.0
WHITE_CD_M2 = E0_LUX / np.pi
TILES = (60, 80)
TEXELS = 16
# Samples along each side of a pixel of the photographs.
OVER = 2


def write_glass_scene(folder: Path, width: int, height: int, **tables: Any) -> Scene:
    """Writes a stereo scene of `width` × `height` into `folder` and returns it.

    `tables` replace those of the scene: ``gaze = {…}``.
    """
    random = np.random.default_rng(12)
    tiles = random.uniform(0.04, 0.8, (*TILES, 3))
    board: Float = np.repeat(np.repeat(tiles, TEXELS, axis=0), TEXELS, axis=1)
    _write(folder / "board.png", board)
    for view in eye_views():
        _write(folder / f"{view.name}.png", _photograph(board, view.resized(width, height)))
    _write_label(folder / "label.png")
    right, up = BACKDROP.right_m[0], BACKDROP.up_m[1]
    z = BACKDROP.centre_m[2]
    corners = [(-right, -up), (right, -up), (right, up), (-right, up)]
    lines = [f"v {x:g} {y:g} {z:g}" for x, y in corners]
    (folder / "board.obj").write_text("\n".join([*lines, "f 1 2 3 4", ""]), encoding="utf-8")
    return scene_from_dict(_tables(width, height) | tables, folder=folder, file="glass")


def _tables(width: int, height: int) -> dict[str, Any]:
    camera = {"width": width, "height": height, "hfov_degrees": 40.0}
    camera |= {"position": [0.0, 0.0, 0.4], "look_at": [0.0, 0.0, 0.0]}
    size = 2 * float(BACKDROP.right_m[0]), 2 * float(BACKDROP.up_m[1])
    background = {"kind": "texture", "file": "board.png", "width_m": size[0], "height_m": size[1]}
    ball = {"name": "ball", "radius_m": 0.075, "texture": "label.png"}
    lamp = {"name": "lamp", "kind": "point", "position": [1.0, 1.0, 1.0], "intensity_cd": 1315.0}
    return {
        "rig": {"kind": "stereo", "camera": camera},
        "capture": {"source": {"left": "left.png", "right": "right.png"}},
        "surface": {"mesh": "board.obj"},
        "ambient": {"illuminance_lux": E0_LUX},
        "lamp": [lamp],
        "glass": [ball | {"background": background | {"position": BACKDROP.centre_m.tolist()}}],
        "observer": {"pupil_mm": 6.0, "interpupillary_mm": 63.0},
        "gaze": {"source": "surface"},
    }


def _write(path: Path, linear: Float) -> None:
    write_png(path, np.round(np.asarray(SRGB.encode(linear)) * 255).astype(np.uint8))


def _photograph(board: Float, view: View) -> Float:
    """(H, W, 3) of the board as `view` sees it."""
    origin, rays = view.resized(view.width * OVER, view.height * OVER).rays_world()
    points = origin + rays * ((BACKDROP.centre_m[2] - origin[2]) / rays[..., 2])[..., None]
    u = (points[..., 0] / BACKDROP.right_m[0] + 1) / 2 * board.shape[1]
    v = (1 - points[..., 1] / BACKDROP.up_m[1]) / 2 * board.shape[0]
    seen = board[
        np.clip(v, 0, board.shape[0] - 1).astype(int), np.clip(u, 0, board.shape[1] - 1).astype(int)
    ]
    return seen.reshape(view.height, OVER, view.width, OVER, 3).mean(axis=(1, 3))


def _write_label(path: Path) -> None:
    """Bars in two colours on the half that faces the eyes."""
    from PIL import Image

    picture = np.zeros((128, 256, 4), np.uint8)
    for column in range(88, 168, 16):
        picture[40:88, column : column + 8] = (245, 240, 230, 255)
    picture[60:68, 88:168] = (220, 60, 40, 255)
    Image.fromarray(picture).save(path)
