"""A real matte ball under twelve known lights: what its camera makes of illuminance."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.surface import KnownLight, SurfaceFit, fit_surface
from andon.verify.relit_photographs import LIGHT_LUX, photographs

__all__ = ["ball_normals", "gray_sphere", "offset_line"]

Float = NDArray[np.float64]

# Of the radius: beyond, normals of the outline's pixels are guesses.
RIM = 0.95
CLIPPED_CODES = 254
# Of the strongest light: the terminator is soft, for lights have a size and rooms walls.
LINE_FROM = 0.05


def ball_normals(mask: NDArray[np.bool_], /) -> Float:
    """(H, W, 3) unit normals, x right, y up, z to a distant camera, of a ball with this outline.

    NaN beyond `RIM` of its radius. Centre and radius are those of the disc with the mask's centre
    and area.
    """
    rows, columns = np.nonzero(mask)
    radius, middle = (len(rows) / np.pi) ** 0.5, (float(rows.mean()), float(columns.mean()))
    x = (np.arange(mask.shape[1], dtype=np.float64) - middle[1]) / radius
    y = (middle[0] - np.arange(mask.shape[0], dtype=np.float64)[:, None]) / radius
    away = np.broadcast_to(np.hypot(x, y), mask.shape)
    inside = mask & (away < RIM)
    z = np.sqrt(np.maximum(1 - away**2, 0))
    planes = np.broadcast_arrays(x, y, z)
    return np.where(inside[..., None], np.stack(planes, axis=-1), np.nan)


@cache
def gray_sphere() -> SurfaceFit:
    """The ball's curve, from E = `LIGHT_LUX`·max(0, n·l) of lights taken to be equally strong.

    Raises `NotShown` where the photographs are missing.
    """
    shots = photographs("sphere")
    normals = ball_normals(shots.mask)
    lit = [
        KnownLight(
            f"light {k}",
            np.asarray(codes / 255, np.float32),
            codes >= CLIPPED_CODES,
            np.repeat(LIGHT_LUX * np.maximum(normals @ direction, 0.0)[..., None], 3, axis=-1),
        )
        for k, (codes, direction) in enumerate(zip(shots.codes, shots.directions, strict=True))
    ]
    return fit_surface(lit, np.isfinite(normals[..., 0]), name="gray sphere")


def offset_line() -> tuple[float, float]:
    """Of green, from a twentieth of the strongest light on: largest distance from a straight line,
    and that line's value in no light, as shares of the range."""
    curve = gray_sphere().curve
    lit = curve.illuminance_lux >= LINE_FROM * curve.illuminance_lux[-1]
    lux, green = curve.illuminance_lux[lit], curve.linear[lit, 1]
    slope, start = np.asarray(np.polyfit(lux, green, 1), np.float64).tolist()
    apart = np.abs(green - start - slope * lux)
    return float(apart.max() / green[-1]), start / float(green[-1])
