"""Remakes figures 3 and 5 of the paper on the tatami room, and the andon's picture.

python examples/tatami/figures.py -o OUT
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import andon
from andon.display.false_colour import contact_sheet, false_colour
from andon.files.pictures import write_png
from andon.responses import srgb_encode

HERE = Path(__file__).resolve().parent
Rgb = NDArray[np.uint8]


def drawn(name: str, engine: str) -> andon.Frame:
    """The frame of a scene file beside this one."""
    return andon.render(andon.load_scene(HERE / name), engine=engine)  # type: ignore[arg-type]


def figure3(frame: andon.Frame) -> Rgb:
    """Input, illuminance map, relit."""
    lux = andon.photometric(frame.illuminance.lux)
    added = false_colour(lux, "lx", valid=frame.surface.valid)
    tiles = [
        ("(a) input", shown(frame, frame.captured.linear * frame.captured.luminance_per_unit)),
        ("(b) illuminance that the ball adds", added),
        ("(c) relit", frame.image.rgb),
    ]
    return contact_sheet(tiles)


def figure5(frame: andon.Frame) -> Rgb:
    """The body alone, filtered, composed."""
    tiles = [
        ("(a) the luminous body", shown(frame, _light(frame, "bodies"))),
        ("(b) filtered", shown(frame, _light(frame, "glow"))),
        ("(c) relit with its glow", frame.image.rgb),
    ]
    return contact_sheet(tiles)


def _light(frame: andon.Frame, name: str) -> NDArray[Any]:
    """Luminance (H, W, 3) of one layer of the frame, in cd/m²."""
    layer = getattr(frame, name)
    if layer is None:
        raise SystemExit(f"the frame has no {name}")
    return layer.cd_m2


def shown(frame: andon.Frame, luminance: NDArray[Any]) -> Rgb:
    """Luminance in cd/m² at the exposure of the photograph."""
    linear = np.clip(luminance / frame.captured.luminance_per_unit, 0, 1)
    return np.round(srgb_encode(linear) * 255).astype(np.uint8)


def main() -> None:
    """Writes figure3.png, figure5.png and andon.png."""
    parser = argparse.ArgumentParser(description="Remakes the figures.")
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder to write to")
    parser.add_argument("--engine", default="auto", help="auto, gpu or reference")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, scene, make in (
        ("figure3.png", "figure3.toml", figure3),
        ("figure5.png", "figure5.toml", figure5),
        ("andon.png", "andon.toml", lambda frame: frame.image.rgb),
    ):
        print(write_png(arguments.out / name, make(drawn(scene, arguments.engine))))


if __name__ == "__main__":
    main()
