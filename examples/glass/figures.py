"""Makes the README's picture of glass, and frames of the eyes' way from label to board and back.

python examples/glass/figures.py -o OUT
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import andon
from andon.cli.glass import GlassOptions, overridden
from andon.display.false_colour import contact_sheet
from andon.files.pictures import write_jpeg, write_png

HERE = Path(__file__).resolve().parent
Rgb = NDArray[np.uint8]
# Columns and rows around the ball, of each eye.
CROPS = {"left": (slice(0, 720), slice(420, 1140)), "right": (slice(0, 720), slice(140, 860))}
# Moments of gaze.csv: label, on the way, board, on the way back, label.
MOMENTS = (0.8, 1.9, 2.6, 3.6, 4.6)


def looks(engine: str) -> Rgb:
    """Both eyes: looked at the label above, through the ball below."""
    rows: list[Rgb] = []
    for look in ("surface", "background"):
        options = GlassOptions(Path(), Path(), gaze=look)
        scene = overridden(andon.load_scene(HERE / "scene.toml"), options)
        renderer = andon.Renderer(scene, engine)  # type: ignore[arg-type]
        rows.append(np.hstack([renderer.picture(0.0, eye)[crop] for eye, crop in CROPS.items()]))
    return np.vstack(rows)


def moments(engine: str) -> Rgb:
    """The left eye while it looks as gaze.csv says."""
    renderer = andon.Renderer(andon.load_scene(HERE / "looking.toml"), engine)  # type: ignore[arg-type]
    tiles: list[tuple[str, Rgb]] = []
    for time in MOMENTS:
        report = renderer.render(time, "left").report.glass
        assert report is not None
        assert report.focus is not None
        caption = f"{time:g} s: {report.focus.layer}, {report.focus.dioptres:.2f} D"
        tiles.append((caption, renderer.picture(time, "left")[CROPS["left"]]))
    return contact_sheet(tiles, columns=len(tiles))


def main() -> None:
    """Writes glass.jpg and looking.png."""
    parser = argparse.ArgumentParser(description="The pictures of examples/glass.")
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder")
    parser.add_argument("--engine", default="auto", choices=("auto", "gpu", "reference"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    write_jpeg(options.out / "glass.jpg", looks(options.engine)[::2, ::2], quality=82)
    write_png(options.out / "looking.png", moments(options.engine))


if __name__ == "__main__":
    main()
