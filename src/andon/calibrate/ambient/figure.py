"""A sheet of an estimate: what was given, what was found, and what is left as reflectance."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.ambient.model import AmbientEstimate
from andon.calibrate.ambient.scale import Placed
from andon.display.false_colour import contact_sheet, false_colour
from andon.quantities import CameraFrame, Surface, photometric
from andon.responses import SRGB

__all__ = ["ambient_figure"]

# Of light and reflectance, what is white in the sheet.
WHITE_QUANTILE = 0.98


def ambient_figure(
    frame: CameraFrame, seen: Surface, estimate: AmbientEstimate, found: Placed, /
) -> NDArray[np.uint8]:
    """(h, w, 3): photograph, E0 in colours, photograph / E0, E0 and its error in false colours."""
    valid = seen.valid
    unit = "lx" if found.photometry == "absolute" else "relative"
    left = np.asarray(frame.linear, np.float64) / found.lux
    tiles = [
        ("photograph", _shown(np.asarray(frame.linear, np.float64), valid, holes=True)),
        ("E0, its colours", _shown(found.lux, valid)),
        ("photograph / E0", _shown(left, valid)),
        (f"E0, {unit}", false_colour(photometric(found.lux), unit, valid=valid)),
        (
            "stated error of E0, %",
            false_colour(100 * np.expm1(np.nan_to_num(estimate.log_error)), "%", valid=valid),
        ),
    ]
    return contact_sheet(tiles)


def _shown(
    light: NDArray[Any], valid: NDArray[np.bool_], *, holes: bool = False
) -> NDArray[np.uint8]:
    """(H, W, 3) sRGB; holes are black unless they show something."""
    white = float(np.quantile(light[valid], WHITE_QUANTILE))
    codes = np.asarray(SRGB.encode(np.clip(light / white, 0, 1)) * 255 + 0.5).astype(np.uint8)
    return codes if holes else np.where(valid[..., None], codes, np.uint8(0))
