"""From the primaries that a file states to Rec.709 with D65."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["D65_XY", "REC709_XY", "adapt_white", "rec709_from_chromaticities", "rec709_from_xyz"]

Float = NDArray[np.float64]

# ITU-R BT.709-6, item 1.3 and 1.4: x, y of red, green, blue and white.
REC709_XY = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
D65_XY = REC709_XY[6:]

# Bradford's cone response, as in ICC.1:2022 (v4.4), annex E.
BRADFORD: Float = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)

# Files print chromaticities with 3 or 4 digits; a smaller difference is rounding, and converting
# for it would only smear the channels.
SAME_XY = 1e-3


def _xyz_of_xy(xy: tuple[float, ...] | Float) -> Float:
    """XYZ (..., 3) with Y = 1 of chromaticities (..., 2)."""
    pairs: Float = np.asarray(xy, np.float64)
    x, y = pairs[..., :1], pairs[..., 1:]
    return np.concatenate([x, y, 1 - x - y], axis=-1) / y


def _xyz_from_rgb(chromaticities: tuple[float, ...]) -> Float:
    """XYZ of unit red, green and blue in the columns, (3, 3); white has Y = 1 (SMPTE RP 177)."""
    primaries = _xyz_of_xy(np.reshape(chromaticities[:6], (3, 2))).T
    return primaries * np.linalg.solve(primaries, _xyz_of_xy(chromaticities[6:]))


def adapt_white(target_xy: tuple[float, ...], source_xy: tuple[float, ...]) -> Float:
    """XYZ under the target white from XYZ under the source white, (3, 3), by Bradford."""
    cones = (BRADFORD @ _xyz_of_xy(target_xy)) / (BRADFORD @ _xyz_of_xy(source_xy))
    scaled: Float = cones[:, None] * BRADFORD
    return np.linalg.inv(BRADFORD) @ scaled


def rec709_from_xyz(white_xy: tuple[float, ...] = D65_XY) -> Float:
    """Linear Rec.709 from XYZ with that white, (3, 3): neutral light gets equal channels."""
    return np.linalg.inv(_xyz_from_rgb(REC709_XY)) @ adapt_white(D65_XY, white_xy)


def rec709_from_chromaticities(chromaticities: tuple[float, ...], file: str) -> Float | None:
    """Linear Rec.709 from RGB of the stated primaries, (3, 3), or None where they are the same.

    Parameters
    ----------
    chromaticities : x, y of red, green, blue and white.

    Raises
    ------
    InputError
        if they are not finite or do not span a colour space.
    """
    if np.allclose(chromaticities, REC709_XY, rtol=0, atol=SAME_XY):
        return None
    with np.errstate(all="ignore"):
        try:
            matrix = rec709_from_xyz(chromaticities[6:]) @ _xyz_from_rgb(chromaticities)
        except np.linalg.LinAlgError:
            matrix = np.full((3, 3), np.nan)
    if not np.isfinite(matrix).all() or np.abs(matrix).max() > 1e3:
        raise InputError(
            f"chromaticities must be those of a colour space, got {chromaticities}", file=file
        )
    return matrix
