"""What the photograph shows, averaged to few pixels: log light, place and normal of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import CameraFrame, Surface

__all__ = ["Observed", "Whereabouts", "observe"]

Float = NDArray[np.float64]

# Share of the 99th percentile of light below which noise and 8 bits drown the ratio of channels.
BLACK = 4e-3
# Blocks of pixels across an edge are left out: their normals differ, or their distances.
LEAST_MEAN_NORMAL, MOST_SPREAD = 0.9, 1.1
# Fewer usable blocks than this are no picture.
FEWEST = 64


@dataclass(frozen=True)
class Whereabouts:
    """How places become numbers of the order of 1: (x − middle) / extent_m.

    The middle is the median of the places, the extent their root mean square distance from it.
    """

    middle: Float
    extent_m: float

    def of(self, position: Float, /) -> Float:
        """(n, 3) without unit; 0 where no place is known."""
        return np.nan_to_num((position - self.middle) / self.extent_m)


@dataclass(frozen=True, eq=False)
class Observed:
    """Blocks of pixels, those that can be used.

    Attributes
    ----------
    number : (h, w) int, the row of each block in the others; −1 where it cannot be used.
    log_light : (n, 3).
    position, normal : (n, 3), without unit (`where`) and unit length.
    sources : for each known source (n, 3), what it gives directly, in lux.
    used_share : of the blocks with a surface.
    """

    number: NDArray[np.int64]
    log_light: Float
    position: Float
    normal: Float
    sources: tuple[Float, ...]
    used_share: float
    where: Whereabouts


def observe(
    frame: CameraFrame, seen: Surface, sources: Sequence[Float], longest_px: int, /
) -> Observed:
    """The blocks of a photograph. `sources` are (H, W, 3) lux each.

    Raises `InputError` where hardly a block has light and a surface.
    """
    side = -(-max(seen.view.shape) // longest_px)
    clipped = np.zeros(seen.view.shape, bool) if frame.clipped is None else frame.clipped
    linear = np.where(clipped[..., None], np.nan, np.asarray(frame.linear, np.float64))
    light = _means(linear, side, whole=True)
    lit = np.isfinite(light).all(axis=-1)
    bright = np.quantile(light[lit], 0.99) if lit.any() else np.inf
    lit &= np.nan_to_num(light).min(axis=-1) > BLACK * bright
    valid, position, normal = _geometry(seen, side)
    used = valid & lit
    if np.count_nonzero(used) < FEWEST:
        raise InputError(
            f"{np.count_nonzero(valid)} of {valid.size} parts of the picture have a surface, "
            f"{np.count_nonzero(lit)} are neither clipped nor black, and "
            f"{np.count_nonzero(used)} are both: at least {FEWEST} are needed",
            field="photograph",
            remedy="give a depth of this picture, and a photograph that is exposed well",
        )
    where = _whereabouts(position[used])
    number = np.full(used.shape, -1)
    number[used] = np.arange(np.count_nonzero(used))
    return Observed(
        number,
        np.log(light[used]),
        where.of(position[used]),
        normal[used],
        tuple(np.nan_to_num(_means(source, side)[used]) for source in sources),
        float(np.count_nonzero(used) / np.count_nonzero(valid)),
        where,
    )


def _geometry(seen: Surface, side: int) -> tuple[NDArray[np.bool_], Float, Float]:
    """Which blocks show one surface (h, w), and where it is and faces (h, w, 3)."""
    valid = seen.valid[..., None]
    normal = _means(np.where(valid, seen.normal, np.nan), side)
    length = np.linalg.norm(normal, axis=-1)
    position = _means(np.where(valid, seen.position, np.nan), side)
    one = np.nan_to_num(length) > LEAST_MEAN_NORMAL
    one &= _means(valid.astype(float), side)[..., 0] > 0.5
    distance = np.where(np.isfinite(seen.distance_m) & seen.valid, seen.distance_m, np.nan)
    blocks = _blocks(distance[..., None], side)
    near = np.fmin.reduce(blocks, axis=(1, 3))[..., 0]
    far = np.fmax.reduce(blocks, axis=(1, 3))[..., 0]
    one &= ~(far > MOST_SPREAD * near)
    with np.errstate(invalid="ignore"):
        return one, position, normal / length[..., None]


def _whereabouts(position: Float) -> Whereabouts:
    known = position[np.isfinite(position).all(axis=1)]
    if not len(known):  # normals alone have no place
        return Whereabouts(np.zeros(3), 1.0)
    middle = np.median(known, axis=0)
    extent = float(np.sqrt(((known - middle) ** 2).sum(axis=1).mean()))
    return Whereabouts(middle, extent or 1.0)


def _blocks(picture: Float, side: int) -> Float:
    """(h, side, w, side, c), NaN beyond the picture's edges."""
    height, width, channels = picture.shape
    rows, columns = -(-height // side), -(-width // side)
    padding = ((0, rows * side - height), (0, columns * side - width), (0, 0))
    padded = np.pad(picture, padding, constant_values=np.nan)
    return padded.reshape(rows, side, columns, side, channels)


def _means(picture: Float, side: int, *, whole: bool = False) -> Float:
    """(h, w, c) means of blocks, of what is known in them; with `whole` NaN where a part is not."""
    blocks = _blocks(picture, side)
    known = np.isfinite(blocks)
    count = known.sum(axis=(1, 3))
    total = np.where(known, blocks, 0).sum(axis=(1, 3))
    if whole:
        inside = _blocks(np.zeros((*picture.shape[:2], 1)), side)
        count = np.where(count == np.isfinite(inside).sum(axis=(1, 3)), count, 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return total / np.where(count > 0, count, np.nan)
