"""Beside figure 7: the same of a photograph of lamps by night."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from andon.cli.figures.model import Asked, Figure
from andon.cli.figures.steps import panels_of, seen_in_steps
from andon.files.pictures import read_picture
from andon.glare.calibration import calibrated, projected
from andon.glare.cleaning import cleaned
from andon.glare.sources.find import background_luminance
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["Photograph", "draw_photograph"]

Float = NDArray[np.float64]

# What the background of a photograph is taken for that says nothing of light: a lit street.
NIGHT_CD_M2 = 1.0


@dataclass(frozen=True, eq=False)
class Photograph:
    """A photograph as light.

    Attributes
    ----------
    light_cd_m2 : (H, W, 3) finite, ≥ 0. Of an uncalibrated one the background is taken for
        `NIGHT_CD_M2`.
    view : where its pixels look.
    name : of its file.
    warnings : what was assumed.
    """

    light_cd_m2: Float
    view: View
    name: str
    warnings: tuple[str, ...]

    @classmethod
    def read(
        cls,
        path: Path,
        width: int,
        /,
        *,
        hfov_degrees: float | None = None,
        cd_m2_per_unit: float | None = None,
    ) -> Photograph:
        """From a file, at most `width` pixels wide. Raises `InputError`."""
        picture = read_picture(path)
        stated = None
        if hfov_degrees is not None:
            stated = projected("pinhole", hfov_degrees, picture.shape[1], picture.shape[0])
        seen = calibrated(picture, view=stated, cd_m2_per_unit=cd_m2_per_unit, file=str(path))
        light = cleaned(seen.luminance_cd_m2, seen.view, seen.shows).light
        view, warnings = seen.view, seen.warnings
        if view.width > width:
            view = view.resized(width, max(1, round(view.height * width / view.width)))
            size = view.width, view.height
            light = np.asarray(cv2.resize(light, size, interpolation=cv2.INTER_AREA))
        if seen.photometry == "relative":
            background = background_luminance(photometric(light), view.solid_angles())
            light = light * (NIGHT_CD_M2 / max(background, 1e-30))
            warnings = (
                *warnings,
                f"{path.name}: the background is taken for {NIGHT_CD_M2:g} cd/m²",
            )
        return cls(np.asarray(light, np.float64), view, path.name, warnings)


def draw_photograph(
    photo: Photograph, asked: Asked, step: Callable[[], None], /
) -> tuple[Figure, ...]:
    """The panels of figure 7, from a photograph."""
    steps = seen_in_steps(photo.light_cd_m2, photo.view, asked, step)
    panels = panels_of(steps, "7-photo", finer=1, seed=asked.seed)
    return (Figure("figure-7-photo", f"Figure 7.  Lamps by night: {photo.name}", "", panels),)
