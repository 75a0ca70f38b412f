"""The images that glass shows, one by one, and how much each is blurred."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, MachineError

if TYPE_CHECKING:
    from andon.pipeline import Frame

__all__ = ["write_layers"]

IMAGES = ("surface", "refracted", "reflected")


def write_layers(folder: Path, frames: list[Frame], names: tuple[str, ...], /) -> None:
    """Writes <image>-<eye>.png at the frame's exposure, sharp, and <image>-blur-<eye>.png."""
    from andon.display.false_colour import false_colour
    from andon.files.pictures import write_png

    if folder.exists() and not folder.is_dir():
        raise InputError("must be a folder, is a file", file=folder, field="--layers")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MachineError(f"{folder}: cannot be made: {error.strerror}") from error
    for frame, name in zip(frames, names, strict=True):
        assert frame.glass is not None
        layers = frame.glass.layers
        for image in IMAGES:
            write_png(folder / f"{image}-{name}.png", _encoded(frame, getattr(layers, image)))
            blur = getattr(layers, f"{image}_px")
            picture = false_colour(blur, "px", valid=layers.coverage > 0)
            write_png(folder / f"{image}-blur-{name}.png", picture)


def _encoded(frame: Frame, cd_m2: NDArray[np.float64]) -> NDArray[np.uint8]:
    share = cd_m2 / frame.captured.luminance_per_unit
    codes = frame.captured.response.encode(np.clip(share, 0, 1))
    return np.asarray(codes * 255 + 0.5, np.uint8)
