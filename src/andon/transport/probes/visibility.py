"""What each probe sees: distances in all directions, and which probes a point may believe."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.transport.probes.octahedra import square_of

__all__ = ["distance_map"]

Float = NDArray[np.float64]

# Samples along the edge of a cube map for each texel along the edge of the octahedral picture:
# with 4, the texel that gets fewest of them gets 8 or more.
_SAMPLES = 4


def distance_map(
    cube_distances_m: NDArray[np.floating], /, side: int = 16, *, far_m: float = 1e4
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Means of the distances, and of their squares, in an octahedral picture.

    Each texel is the mean over its part of the sphere; the cube map counts as constant over each
    of its own texels.

    Parameters
    ----------
    cube_distances_m : (..., 6, s, s) distances along the rays (not planar depth), metres; inf or
        NaN where there is no surface.
    side : texels along the edge of the picture.
    far_m : what counts for no surface, and the largest distance; metres. The nearer it is, the
        less does a far background beside an edge blur the edge: give the largest distance that
        will ever be asked for.

    Returns
    -------
    (..., side, side) means in metres, and (..., side, side) means of squares, in square metres.

    Raises
    ------
    InputError
        Where the shape is no cube map, `side` < 4, or distances are negative.
    """
    cube = np.asarray(cube_distances_m, np.float64)
    if cube.ndim < 3 or cube.shape[-3] != 6 or cube.shape[-1] != cube.shape[-2]:
        raise InputError(f"must be (..., 6, s, s), got {cube.shape}", field="cube_distances_m")
    if side < 4 or not far_m > 0:
        raise InputError(f"needs side ≥ 4 and far_m > 0, got {side}, {far_m}", field="side")
    if (cube < 0).any():
        raise InputError("must be ≥ 0 m, or inf for no surface", field="cube_distances_m")
    size = cube.shape[-1]
    distances = np.where(np.isfinite(cube), np.minimum(cube, far_m), far_m)
    texels, places, shares = _shares(size, side)
    means: list[Float] = []
    for one in distances.reshape(-1, 6 * size * size):
        seen = one[texels]
        moments = [np.bincount(places, shares * value) for value in (seen, seen**2)]
        means.append(np.stack(moments))
    mean, mean_square = np.moveaxis(np.stack(means), 1, 0)
    shape = (*cube.shape[:-3], side, side)
    # Rounding leaves less than the square of the mean where all distances are equal.
    mean32 = mean.astype(np.float32)
    square32 = np.maximum(mean_square.astype(np.float32), mean32**2)
    return mean32.reshape(shape), square32.reshape(shape)


@lru_cache(maxsize=4)
def _shares(size: int, side: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Float]:
    """Pairs of a cube texel and an octahedral texel that overlap, and the latter's shares.

    The shares of each octahedral texel sum to 1.
    """
    finer = max(1, -(-_SAMPLES * side // size))
    directions, solid_angle = _samples(size * finer)
    place = np.minimum(((square_of(directions) + 1) * (side / 2)).astype(np.int64), side - 1)
    face, row, column = np.indices(directions.shape[:-1])
    texel = (face * size + row // finer) * size + column // finer
    pair = (texel * side * side + place[..., 1] * side + place[..., 0]).ravel()
    found, which = np.unique(pair, return_inverse=True)
    overlap = np.bincount(which, np.broadcast_to(solid_angle, place.shape[:-1]).ravel())
    texels, places = np.divmod(found, side * side)
    return texels, places, overlap / np.bincount(places, overlap)[places]


def _samples(size: int) -> tuple[Float, Float]:
    """Directions (6, size, size, 3) of a cube map's texels, and solid angles (size, size) in sr."""
    at = (np.arange(size) + 0.5) * (2 / size) - 1
    v, u = np.meshgrid(at, at, indexing="ij")
    one = np.ones_like(u)
    faces = [(one, -v, -u), (-one, -v, u), (u, one, v), (u, -one, -v), (u, -v, one), (-u, -v, -one)]
    directions = np.stack([np.stack(face, axis=-1) for face in faces])
    return directions, (4 / size**2) * (1 + u**2 + v**2) ** -1.5
