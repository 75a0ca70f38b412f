"""Latlong panoramas: where their pixels look, what is wrong in them, and cube maps from them.

The middle of the picture is −Z, to the right is +X, up is +Y; no pose applies.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.cubes import check_cube_size, face_directions

__all__ = [
    "Clipped",
    "NonNegative",
    "check_latlong",
    "clipped",
    "cube_from_latlong",
    "latlong_pixels",
    "latlong_solid_angles",
    "nonnegative",
]

Float = NDArray[np.float64]

# Samples of a panorama that are looked up at once: some 100 MB.
_CHUNK_SAMPLES = 1 << 20


def check_latlong(picture: NDArray[Any], /, *, field: str = "panorama") -> None:
    """Refuses what is no (H, 2H, 3) picture."""
    if picture.ndim != 3 or picture.shape[2] != 3:
        raise InputError(f"must be (H, 2H, 3), got {picture.shape}", field=field)
    height, width = picture.shape[:2]
    if height < 1 or width != 2 * height:
        raise InputError(
            f"must be twice as wide as high, got {width}×{height} px",
            field=field,
            remedy="a latlong panorama shows 360° × 180°; crop, pad or stitch it to 2:1",
        )


def latlong_solid_angles(height: int, /) -> Float:
    """(height,) solid angle in sr of each pixel of a row, of a picture 2·height pixels wide.

    Exact: a row is a zone of the sphere, whose area is 2π times the difference of the cosines of
    its angles from the pole.
    """
    edges = np.cos(np.linspace(0, np.pi, height + 1))
    return (edges[:-1] - edges[1:]) * (np.pi / height)


def latlong_pixels(directions: NDArray[Any], height: int, /) -> Float:
    """Pixel coordinates (..., 2), column and row, of directions (..., 3) of any length.

    In a picture of `height` × 2·`height` pixels with centres at integers.
    """
    x, y, z = np.moveaxis(np.asarray(directions, np.float64), -1, 0)
    column = (np.arctan2(x, -z) / np.pi + 1) * height - 0.5
    row = (0.5 - np.arctan2(y, np.hypot(x, z)) / np.pi) * height - 0.5
    return np.stack([column, row], axis=-1)


def cube_from_latlong(
    picture: NDArray[Any], size: int, /, *, samples: int | None = None
) -> NDArray[np.float32]:
    """Cube map (6, size, size, 3) float32 of a panorama (H, 2H, 3).

    Each texel is the mean over `samples`² points in it, weighted by solid angle; each point is
    bilinear in the panorama. By default as many as keep neighbours, which are farthest apart in
    the middle of a face, within a pixel of the equator: no small sun there is lost between them.
    Near the poles pixels are narrower: one of them alone may count for too much or too little.
    """
    check_latlong(picture)
    check_cube_size(size)
    height = picture.shape[0]
    count = samples if samples is not None else ceil(2 * height / (np.pi * size))
    if count < 1:
        raise InputError(f"must be ≥ 1, got {samples}", field="samples")
    padded = _padded(picture)
    at = np.asarray((np.arange(size * count) + 0.5) * (2 / (size * count)) - 1, np.float64)
    faces = np.empty((6, size, size, 3), np.float32)
    rows = max(1, _CHUNK_SAMPLES // (6 * size * count * count))
    for start in range(0, size, rows):
        stop = min(size, start + rows)
        v = at[start * count : stop * count, None]
        light = _bilinear(padded, latlong_pixels(face_directions(at[None, :], v), height))
        weight = (1 + at[None, :] ** 2 + v * v) ** -1.5
        blocks = (stop - start, count, size, count)
        total = (light * weight[..., None]).reshape(6, *blocks, 3).sum(axis=(2, 4))
        faces[:, start:stop] = total / weight.reshape(blocks).sum(axis=(1, 3))[..., None]
    return faces


def _padded(picture: NDArray[Any]) -> NDArray[Any]:
    """With one pixel more on all sides: around the seam, and across the poles."""
    half = picture.shape[1] // 2
    over = np.roll(picture[:1], half, axis=1)
    under = np.roll(picture[-1:], half, axis=1)
    tall = np.concatenate([over, picture, under])
    return np.concatenate([tall[:, -1:], tall, tall[:, :1]], axis=1)


def _bilinear(padded: NDArray[Any], pixels: Float) -> Float:
    """(..., 3) values at pixel coordinates (..., 2) of the picture without its padding."""
    whole = np.floor(pixels).astype(np.intp)
    share = pixels - whole
    column = np.clip(whole[..., 0] + 1, 0, padded.shape[1] - 2)
    row = np.clip(whole[..., 1] + 1, 0, padded.shape[0] - 2)
    right, down = share[..., :1], share[..., 1:]
    top = padded[row, column] * (1 - right) + padded[row, column + 1] * right
    bottom = padded[row + 1, column] * (1 - right) + padded[row + 1, column + 1] * right
    return top * (1 - down) + bottom * down


@dataclass(frozen=True)
class NonNegative:
    """A picture whose negative values were set to 0.

    Attributes
    ----------
    values : of the shape given.
    count : how many values were negative.
    lost_share : their sum over the sum of the positive ones, ≥ 0.
    """

    values: NDArray[Any]
    count: int
    lost_share: float


def nonnegative(values: NDArray[Any], /) -> NonNegative:
    """`values` (...) with negative ones, which no light has, set to 0, and counted.

    Resamplers that overshoot (Lanczos) leave them in panoramas. NaN and inf stay; `project_cube`
    and `project_latlong` refuse them.
    """
    negative = values < 0
    count = int(np.count_nonzero(negative))
    if count == 0:
        return NonNegative(values, 0, 0.0)
    lost = -float(values[negative].sum(dtype=np.float64))
    kept = np.where(negative, np.zeros((), values.dtype), values)
    total = float(kept.sum(dtype=np.float64))
    return NonNegative(kept, count, lost / total if total > 0 else float("inf"))


@dataclass(frozen=True)
class Clipped:
    """Texels of a panorama that are at the end of its range.

    Attributes
    ----------
    count : how many pixels.
    share : of the sphere, 0…1. A sun has 5.4e-6 of it; lamps and skies that are cut off count too.
    """

    count: int
    share: float


def clipped(picture: NDArray[Any], limit: float, /) -> Clipped:
    """What of a panorama (H, 2H, 3) has a channel at or above `limit`.

    The end of the range: 255 of 8 bits, 1.0 of linearised 8 bits. Light is missing there: a sun in
    a low-dynamic-range panorama is some 10⁴ times too dark.
    """
    check_latlong(picture)
    at_end = (picture >= limit).any(axis=-1)
    share = at_end.sum(axis=1) @ latlong_solid_angles(len(picture)) / (4 * np.pi)
    return Clipped(int(np.count_nonzero(at_end)), float(share))
