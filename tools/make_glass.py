"""Makes the files of examples/glass: a pattern behind a glass ball, as photographed by two eyes.

    PYTHONPATH=src python tools/make_glass.py examples/glass

The pattern is printed on a board of 0.8 m × 0.6 m whose reflectances are the linear values of its
colours. Each eye's photograph is the exact homography of the board into its picture, averaged over
each pixel. The rectified picture of the board is what is seen through the glass; it was taken
with the scene's lamp switched on, since pictures on planes are not lit by the lamps of a scene.
"""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from glass_ball.gaze import gaze_rows
from glass_ball.label import label
from glass_ball.pattern import pattern
from numpy.typing import NDArray
from PIL import Image

from andon.files.pictures import write_jpeg
from andon.responses import SRGB
from andon.spaces import View, look_at, pinhole_view

Float = NDArray[np.float64]

BOARD_M = (0.8, 0.6)
BOARD_Z_M = -0.2
# Of the drawing; the file is half as large. A pixel of the eyes' pictures is 0.34 mm of the board.
DRAWN = (4096, 3072)
SEED = 20211
# Samples along each side of a pixel of the photographs.
OVER = 4
LABEL_PX = 2048
QUALITY, PATTERN_QUALITY = 74, 63


def eyes(scene: dict[str, Any]) -> list[View]:
    """Left and right of the scene file, in parallel."""
    camera = scene["rig"]["camera"]
    width, height = camera["width"], camera["height"]
    focal = width / 2 / np.tan(np.radians(camera["hfov_degrees"]) / 2)
    half = scene["observer"]["interpupillary_mm"] / 2000
    views: list[View] = []
    for name, side in (("left", -half), ("right", half)):
        offset = np.array([side, 0, 0])
        eye = np.array(camera["position"]) + offset
        pose = look_at(eye, np.array(camera["look_at"]) + offset)
        views.append(pinhole_view(width, height, focal, pose, name=name))
    return views


def photograph(board: NDArray[np.float32], view: View) -> Float:
    """(H, W, 3) reflectance of the board (h, w, 3) in each pixel of `view`."""
    large = view.resized(view.width * OVER, view.height * OVER)
    # Three pixels of the picture fix the plane's homography: columns are its origin and axes.
    axes = np.array([[BOARD_M[0], 0, -BOARD_M[0] / 2], [0, -BOARD_M[1], BOARD_M[1] / 2]])
    on_board = np.vstack([axes, [0, 0, BOARD_Z_M], [0, 0, 1]])
    rows, columns = board.shape[:2]
    share = np.array([[1 / columns, 0, 0.5 / columns], [0, 1 / rows, 0.5 / rows], [0, 0, 1]])
    intrinsics = np.array([[large.fx, 0, large.cx], [0, large.fy, large.cy], [0, 0, 1]])
    picture_from_board = intrinsics @ large.camera_from_world[:3] @ on_board @ share
    seen = cv2.warpPerspective(
        board, picture_from_board, (large.width, large.height), flags=cv2.INTER_LINEAR
    )
    blocks = seen.reshape(view.height, OVER, view.width, OVER, 3)
    return blocks.mean(axis=(1, 3), dtype=np.float64)


def lamp_lux(scene: dict[str, Any], shape: tuple[int, int]) -> Float:
    """(h, w) illuminance of the scene's point lamp on the board, I·cos/d²."""
    lamp = scene["lamp"][0]
    rows, columns = shape
    x = ((np.arange(columns) + 0.5) / columns - 0.5) * BOARD_M[0]
    y = (0.5 - (np.arange(rows) + 0.5) / rows) * BOARD_M[1]
    reach = np.array(lamp["position"]) - np.stack(
        [*np.meshgrid(x, y), np.full(shape, BOARD_Z_M)], axis=-1
    )
    distance = np.linalg.norm(reach, axis=-1)
    return lamp["intensity_cd"] * reach[..., 2] / distance**3


def main() -> None:
    """Writes the two photographs, pattern.jpg, label.png, gaze.csv and board.obj."""
    parser = argparse.ArgumentParser(description="Makes the files of examples/glass.")
    parser.add_argument("out", type=Path, help="folder with scene.toml")
    folder = parser.parse_args().out
    scene = tomllib.loads((folder / "scene.toml").read_text(encoding="utf-8"))
    e0, white = scene["ambient"]["illuminance_lux"], scene["capture"]["luminance_per_unit"]
    drawn = pattern(*DRAWN, SEED)
    board = np.asarray(SRGB.decode(drawn / 255), np.float32)
    for view in eyes(scene):
        seen = photograph(board, view) * e0 / np.pi / white
        print(write_jpeg(folder / f"{view.name}.jpg", _codes(seen), quality=QUALITY))
    rows, columns = DRAWN[1] // 2, DRAWN[0] // 2
    rectified = board.reshape(rows, 2, columns, 2, 3).mean(axis=(1, 3), dtype=np.float64)
    light = e0 + lamp_lux(scene, (rows, columns))
    rectified = rectified * light[..., None] / np.pi / white
    print(write_jpeg(folder / "pattern.jpg", _codes(rectified), quality=PATTERN_QUALITY))
    # Andon writes no pictures with alpha.
    Image.fromarray(label(LABEL_PX)).save(folder / "label.png", optimize=True)
    names, lines = gaze_rows(scene["observer"]["interpupillary_mm"] / 1000)
    (folder / "gaze.csv").write_text("\n".join([",".join(names), *lines, ""]), encoding="utf-8")
    x, y = BOARD_M[0] / 2, BOARD_M[1] / 2
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    lines = ["# The board, metres: tools/make_glass.py"]
    lines += [f"v {a:g} {b:g} {BOARD_Z_M:g}" for a, b in corners]
    (folder / "board.obj").write_text("\n".join([*lines, "f 1 2 3 4", ""]), encoding="utf-8")


def _codes(linear: Float) -> NDArray[np.uint8]:
    return np.round(np.asarray(SRGB.encode(np.clip(linear, 0, 1))) * 255).astype(np.uint8)


if __name__ == "__main__":
    main()
