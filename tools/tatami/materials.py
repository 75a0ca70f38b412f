"""The room's materials: a texture, and the linear reflectance that it is multiplied by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tatami import textures


@dataclass(frozen=True)
class Look:
    """`factor` (3,) linear Rec.709 in 0…1; `texture` is a key of `texture_files`, or None."""

    factor: tuple[float, float, float]
    texture: str | None = None


LOOKS: dict[str, Look] = {
    # One mat looks greener than its neighbour, since its rush lies the other way to the light.
    "mat.along": Look((0.88, 0.98, 0.84), "tatami.jpg"),
    "mat.across": Look((0.80, 0.88, 0.73), "tatami.jpg"),
    "border": Look((1.0, 1.0, 1.0), "border.jpg"),
    "wood.cypress": Look((0.86, 0.66, 0.44), "wood"),
    "wood.cedar": Look((0.50, 0.33, 0.20), "wood"),
    "wood.smoked": Look((0.17, 0.105, 0.068), "wood"),
    "wood.zelkova": Look((0.56, 0.325, 0.18), "wood"),
    "wood.floor": Look((0.48, 0.30, 0.17), "wood"),
    "plaster.sand": Look((0.86, 0.76, 0.57), "plaster"),
    "plaster.moss": Look((0.62, 0.64, 0.47), "plaster"),
    "paper.shoji": Look((0.66, 0.66, 0.64), "paper"),
    "frame": Look((0.12, 0.072, 0.046)),
    "lattice": Look((0.62, 0.48, 0.32)),
    "landscape": Look((0.92, 0.92, 0.92), "landscape"),
    "scroll": Look((1.0, 1.0, 1.0), "scroll"),
    "lacquer": Look((0.030, 0.024, 0.022)),
    "brass": Look((0.42, 0.30, 0.13)),
    "cloth.indigo": Look((0.075, 0.12, 0.26), "cloth"),
    "celadon": Look((0.42, 0.54, 0.45)),
    "raku": Look((0.11, 0.075, 0.06)),
    "tea": Look((0.20, 0.30, 0.06)),
    "bark": Look((0.13, 0.085, 0.06)),
    "blossom": Look((0.85, 0.42, 0.45)),
}

_MADE: dict[str, Callable[[], textures.Float]] = {
    "wood": textures.wood,
    "plaster": textures.plaster,
    "paper": textures.paper,
    "cloth": textures.cloth,
    "landscape": textures.landscape,
    "scroll": textures.scroll,
}


def texture_files(mat_folder: Path) -> dict[str, bytes]:
    """JPEG files by name; `mat_folder` holds tatami.jpg and border.jpg of the CC0 mat."""
    given = {name: (mat_folder / name).read_bytes() for name in ("tatami.jpg", "border.jpg")}
    return given | {name: textures.jpeg(make()) for name, make in _MADE.items()}
