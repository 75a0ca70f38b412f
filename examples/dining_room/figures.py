"""The dining room by its depth camera, relit: three pictures and a sheet.

python examples/dining_room/figures.py -o figures
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from pathlib import Path

import numpy as np

from andon.cli.depth_import import run as import_frame
from andon.cli.depth_options import ImportOptions
from andon.display.false_colour import contact_sheet, depth_picture, normal_picture
from andon.errors import AndonError
from andon.files import read_picture, write_png
from andon.pipeline import EngineName, Renderer
from andon.scene import load_scene

HERE = Path(__file__).resolve().parent
SET = "rgbd_diningroom"
SCENES = ("table_lamp", "floor_lamp_off", "night")


def draw(frame: str, engine: EngineName, out: Path) -> None:
    """A picture of each scene, and sheet.png of all; the frame's files are left beside them."""
    capture = Path(os.environ.get("ANDON_DATA", ".")) / SET
    import_frame(ImportOptions(capture, out / "frame", frame))
    tiles = [("photograph", read_picture(out / "frame" / "photo.png").values)]
    for name in SCENES:
        scene = shutil.copy(HERE / f"{name}.toml", out / "frame")
        drawn = Renderer(load_scene(scene), engine).render()
        write_png(out / f"{name}.png", drawn.image.rgb)
        if len(tiles) == 1:
            surface = drawn.surface
            tiles.append(("depth", depth_picture(surface.depth, surface.valid)))
            tiles.append(("normals", normal_picture(surface.normal, surface.valid)))
        tiles.append((name.replace("_", " "), drawn.image.rgb))
        print(out / f"{name}.png")
    pictures = [(caption, np.asarray(tile, np.uint8)) for caption, tile in tiles]
    write_png(out / "sheet.png", contact_sheet(pictures, columns=3, gap_px=6))


def main() -> int:
    """Reads the command line; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder for the pictures")
    parser.add_argument("--frame", default="1", help="of the capture: 1, 2 or 3")
    parser.add_argument("--engine", default="auto", choices=("auto", "gpu", "reference"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        draw(options.frame, options.engine, options.out)
    except AndonError as error:
        print(f"figures.py: {error}", file=sys.stderr)
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
