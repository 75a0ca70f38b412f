"""What every picture reader returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.responses import srgb_decode

__all__ = ["Picture"]


@dataclass(frozen=True)
class Picture:
    """A picture as read, upright, in Rec.709 primaries.

    Attributes
    ----------
    values : (H, W, 3) uint8 or uint16 (full range, encoded) or float32 (linear), row 0 on top.
        Gray pictures have three equal channels. Alpha is kept apart: PNG colour is stored
        straight, so it is left as it is and not composited on anything; EXR colour is
        premultiplied, which *is* the light that arrives.
    encoding : ``srgb`` (IEC 61966-2-1 transfer function) or ``linear``.
    icc : name of the embedded profile that `values` were converted *from*, or None.
    hfov_degrees : horizontal field of view from EXIF, of the upright picture, or None.
    view_line : Radiance's VIEW line without the keyword, or None.
    attributes : header entries that are numbers or text, by name: of EXR and HDR all, EXR's
        ``envmap`` as ``latlong`` or ``cube``; PNG's ``gamma``; of EXIF ``exposure_seconds``,
        ``f_number`` and ``iso`` where stated.
    alpha : (H, W) float32, cover (PNG: 0…1; EXR: as stored), or None where the file has none.
    """

    values: NDArray[Any]
    encoding: Literal["srgb", "linear"]
    icc: str | None = None
    hfov_degrees: float | None = None
    view_line: str | None = None
    attributes: dict[str, Any] = field(default_factory=dict[str, Any])
    alpha: NDArray[np.float32] | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width) in pixels."""
        return self.values.shape[0], self.values.shape[1]

    def linear(self) -> NDArray[np.float64]:
        """(H, W, 3) linear light: codes are decoded (1 is their white), floats as they are."""
        if self.encoding == "linear":
            return np.asarray(self.values, np.float64)
        encoded = np.asarray(self.values, np.float64) / np.iinfo(self.values.dtype).max
        return np.asarray(srgb_decode(encoded), np.float64)

    @property
    def is_painted(self) -> NDArray[np.bool_]:
        """(H, W) pixels of a mask: lighter, in the mean of their codes, than middle grey.

        Of codes and not of light: the grey that an editor shows in the middle.
        """
        white = 1.0 if self.encoding == "linear" else float(np.iinfo(self.values.dtype).max)
        return np.asarray(np.asarray(self.values, np.float64).mean(axis=-1) > white / 2, bool)
