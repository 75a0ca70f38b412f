"""Figure 8: the sun through leaves, as a still and as frames of its flicker."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from andon.cli.examples import example_folder
from andon.cli.figures.model import Asked, Figure, Panel
from andon.cli.glare_komorebi import KomorebiOptions
from andon.cli.komorebi_run import canopy_of, drawn_by
from andon.display.eye_response import printed
from andon.glare.komorebi import Canopy, Komorebi
from andon.glare.komorebi.seen import Seen, ambient_of
from andon.lamps.flicker import Flicker

__all__ = ["draw_komorebi"]

Rgb = NDArray[np.uint8]

# The still, and frames of the sheet, seconds.
STILL_SECONDS, FRAME_SECONDS = 0.0, tuple(0.25 * number for number in range(9))
COLUMNS, SHUTTER_SECONDS = 3, 1 / 30
STEPS_PER_SECOND, Z = 6.0, 1.8
# Pixel of the sun behind our own leaves: their middle.
OWN_SUN_AT = "480,270"
# Of the picture, each way: needles are too fine for all of it.
SHOWN = 0.6
# The printed curve is at its middle at so many times the luminance of the leaves.
HALF_AMBIENTS = 3.5


def draw_komorebi(
    leaves: Path | None,
    hfov_degrees: float | None,
    asked: Asked,
    step: Callable[[], None],
    /,
) -> tuple[Figure, ...]:
    """The figure from a picture of leaves, or a mask of the gaps between them; None: ours."""
    sun_at = OWN_SUN_AT if leaves is None else None
    path = leaves or example_folder("komorebi", "leaves.png") / "leaves.png"
    canopy = canopy_of(KomorebiOptions(path, path, hfov_degrees=hfov_degrees, sun_at=sun_at))
    step()
    eye = asked.eye(ambient_of(canopy))
    flicker = Flicker(asked.seed, Z, STEPS_PER_SECOND, len(canopy))
    seen = Seen(
        Komorebi(canopy, flicker=flicker, exposure_seconds=SHUTTER_SECONDS),
        eye,
        asked.model,
        asked.seed,
    )
    half = HALF_AMBIENTS * seen.ambient_cd_m2
    picture = drawn_by(seen, asked.engine)
    rows, columns = _around_gaps(canopy)
    frames: list[Rgb] = []
    for time in FRAME_SECONDS:
        light = picture(time)[rows, columns]
        frames.append(_sized(printed(light, half, seed=asked.seed), asked.width))
        step()
    still = frames[FRAME_SECONDS.index(STILL_SECONDS)]
    panels = (
        Panel("8-komorebi", f"{len(canopy)} gaps between leaves, each with its own flicker", still),
        Panel("8-frames", f"every {FRAME_SECONDS[1]:g} s", _sheet(frames)),
    )
    return (Figure("figure-8", "Figure 8.  The sun through leaves", "木漏れ日", panels),)


def _around_gaps(canopy: Canopy) -> tuple[slice, slice]:
    """Rows and columns of what is shown: where the sun is, `SHOWN` of the picture each way."""
    height, width = canopy.view.shape
    rows, columns = np.divmod(canopy.pixels, width)
    found: list[slice] = []
    for places, length in ((rows, height), (columns, width)):
        shown = max(1, round(SHOWN * length))
        first = int(np.clip(np.median(places) - shown / 2, 0, length - shown))
        found.append(slice(first, first + shown))
    return found[0], found[1]


def _sized(picture: Rgb, width: int) -> Rgb:
    height = max(1, round(picture.shape[0] * width / picture.shape[1]))
    method = cv2.INTER_AREA if width < picture.shape[1] else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(picture, (width, height), interpolation=method), np.uint8)


def _sheet(frames: list[Rgb]) -> Rgb:
    """Frames in rows, together as wide as one of them."""
    width = frames[0].shape[1]
    small = [_sized(each, width // COLUMNS) for each in frames]
    rows = [
        np.concatenate(small[first : first + COLUMNS], axis=1)
        for first in range(0, len(small), COLUMNS)
    ]
    return np.asarray(np.concatenate(rows), np.uint8)
