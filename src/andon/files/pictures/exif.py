"""What a photograph's EXIF data tell us: which way is up, how wide it sees, how it was exposed."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["ExifFacts", "apply_orientation", "hfov_degrees", "parse_exif"]

# Exif 2.32 (CIPA DC-008-2019): 4.6.4 Orientation, 4.6.5 Exif IFD pointer, FocalLengthIn35mmFilm.
ORIENTATION, EXIF_IFD, FOCAL_35MM = 0x0112, 0x8769, 0xA405
# Exif 2.32, 4.6.5: ExposureTime (s), FNumber, PhotographicSensitivity (ISO).
EXPOSURE = {"exposure_seconds": 0x829A, "f_number": 0x829D, "iso": 0x8827}

# The equivalence is by the diagonal angle of view; a 36 mm × 24 mm frame's diagonal in mm.
FILM_DIAGONAL_MM = math.hypot(36.0, 24.0)


@dataclass(frozen=True)
class ExifFacts:
    """What an EXIF block states.

    Attributes
    ----------
    orientation : 1…8 as in EXIF.
    focal_35mm : mm, or None where not stated.
    exposure : those of `exposure_seconds`, `f_number` and `iso` that are stated, each > 0.
    """

    orientation: int = 1
    focal_35mm: float | None = None
    exposure: dict[str, float] = field(default_factory=dict[str, float])


def parse_exif(data: bytes | None, file: str) -> ExifFacts:
    """Facts from an EXIF block (with or without its ``Exif\\0\\0`` prefix); None has none."""
    if not data:
        return ExifFacts()
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow's remarks on odd but harmless entries
            exif = Image.Exif()
            exif.load(data)
            orientation: Any = exif.get(ORIENTATION, 1)
            details: Any = exif.get_ifd(EXIF_IFD)
            focal = _number(details.get(FOCAL_35MM))
            exposure = {name: _number(details.get(tag)) for name, tag in EXPOSURE.items()}
    except Exception as error:  # a damaged block raises almost anything in there
        raise InputError(
            "its EXIF block must be sound", file=file, remedy="strip the EXIF data"
        ) from error
    # 0 means "unknown" in the standard for both entries.
    if orientation not in range(1, 9):
        orientation = 1
    return ExifFacts(orientation, focal, {k: v for k, v in exposure.items() if v is not None})


def _number(value: Any) -> float | None:
    """A finite number > 0, of several the first; None for what is not stated, or unknown (0)."""
    if isinstance(value, tuple):
        value = next(iter(cast("tuple[Any, ...]", value)), None)
    number = float(value) if value is not None else 0.0
    return number if math.isfinite(number) and number > 0 else None


def apply_orientation(values: NDArray[Any], orientation: int) -> NDArray[Any]:
    """The upright picture (H, W, …) of a stored one with EXIF orientation 1…8.

    5…8 store rows as columns: those are transposed first, then all are flipped.
    """
    if orientation >= 5:
        values = values.swapaxes(0, 1)
    flip_rows = orientation in (3, 4, 7, 8)
    flip_columns = orientation in (2, 3, 6, 7)
    values = values[::-1] if flip_rows else values
    values = values[:, ::-1] if flip_columns else values
    return np.ascontiguousarray(values)


def hfov_degrees(facts: ExifFacts, width: int, height: int) -> float | None:
    """Horizontal field of view of an upright, undistorted, uncropped picture, or None."""
    if facts.focal_35mm is None:
        return None
    focal_px = facts.focal_35mm * math.hypot(width, height) / FILM_DIAGONAL_MM
    return math.degrees(2 * math.atan(width / (2 * focal_px)))
