"""What each probe sees: distances in all directions, and which probes a point may believe.

A point asks each probe how far it sees in the point's direction. The probe's picture holds the mean
and the mean square of the distances in each texel; if the point is farther than the mean, the share
of what is at least as far is at most σ²/(σ² + (d − mean)²) (Chebyshev's inequality, one-sided:
Majercik et al. 2019, after the variance shadow maps of Donnelly & Lauritzen 2006).

=========================== ==================== ==================================================
what                        here                 why
=========================== ==================== ==================================================
share that counts for none  ½ (`CUT`)            the bound is loose: lit probes behind a wall that
                                                 is seen at a slant keep 1 %, and outweigh the one
                                                 on the dark side (Lauritzen 2007 cuts so, too)
power                       3                    Majercik et al.'s sharpening
least share                 0                    their implementation keeps 5 %: it leaks
lift along the normal       a tenth of the       a texel of 16² is 0.2 rad wide; walls seen at a
                            distance             slant would hide their own points
=========================== ==================== ==================================================

`andon verify probes.leaks` has the figures.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.model import Distances
from andon.harmonics import cube_directions, cube_solid_angles
from andon.octahedra import bilinear_taps, square_of

__all__ = ["CUT", "LIFT", "SHARPNESS", "distance_map", "visible"]

Float = NDArray[np.float64]

# Samples along the edge of a cube map for each texel along the edge of the octahedral picture:
# with 4, the texel that gets fewest of them gets 8 or more.
_SAMPLES = 4

# See the table above.
CUT = 0.5
SHARPNESS = 3
LIFT = 0.1

# Relative: what float32 leaves of a mean square less the square of a mean is 1e-7 of it.
LEAST_SPREAD = 1e-3
_TINY = 1e-12


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
        means.append(np.asarray(moments, np.float64))
    mean, mean_square = np.moveaxis(np.stack(means), 1, 0)
    shape = (*cube.shape[:-3], side, side)
    # Rounding leaves less than the square of the mean where all distances are equal.
    mean32 = mean.astype(np.float32)
    square32 = np.maximum(mean_square.astype(np.float32), mean32**2)
    return mean32.reshape(shape), square32.reshape(shape)


def visible(
    distances: Distances,
    capture_positions: Float,
    probes: NDArray[np.integer],
    points: Float,
    normals: Float | None = None,
    /,
    *,
    cut: float = CUT,
    sharpness: float = SHARPNESS,
    lift: float = LIFT,
) -> Float:
    """How much each point may believe each of its probes.

    Parameters
    ----------
    distances : what the probes see, (n, s, s).
    capture_positions : (n, 3) where they see it from, metres, world.
    probes : (q, k) numbers of probes.
    points : (q, 3) metres, world.
    normals : (q, 3) unit, of the surfaces that the points lie on; None: in free air.
    cut, sharpness, lift : see the module.

    Returns
    -------
    (q, k) in [0, 1]: 0 hidden, 1 seen; continuous in points and normals.
    """
    reach = points[:, None] - capture_positions[probes]
    if normals is not None:
        away = np.linalg.norm(reach, axis=-1, keepdims=True)
        reach = reach + lift * away * normals[:, None]
    distance = np.linalg.norm(reach, axis=-1)
    # A point at the probe itself is in no direction; any will do, it is nearer than all surfaces.
    reach = np.where(distance[..., None] > 0, reach, [0.0, 0.0, 1.0])
    texels, weights = bilinear_taps(reach, distances.mean_m.shape[-1])
    tap = (probes[..., None], texels)
    count = len(distances.mean_m)
    means = distances.mean_m.reshape(count, -1)[tap].astype(np.float64)
    squares = distances.mean_square_m2.reshape(count, -1)[tap].astype(np.float64)
    mean = (weights * means).sum(axis=-1)
    # The spread within texels and that between them; float32 would lose both in squares of means.
    within = np.maximum(squares - means**2, 0)
    spread = (weights * (within + (means - mean[..., None]) ** 2)).sum(axis=-1)
    behind = np.maximum(np.minimum(distance, distances.far_m) - mean, 0)
    variance = np.maximum(np.maximum(spread, LEAST_SPREAD**2 * mean**2), _TINY)
    share = variance / (variance + behind**2)
    return np.maximum((share - cut) / (1 - cut), 0) ** sharpness


@lru_cache(maxsize=4)
def _shares(size: int, side: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Float]:
    """Pairs of a cube texel and an octahedral texel that overlap, and the latter's shares.

    The shares of each octahedral texel sum to 1.
    """
    finer = max(1, -(-_SAMPLES * side // size))
    directions = cube_directions(size * finer)
    solid_angle = cube_solid_angles(size * finer)
    place = np.minimum(((square_of(directions) + 1) * (side / 2)).astype(np.int64), side - 1)
    face, row, column = np.indices(directions.shape[:-1])
    texel = (face * size + row // finer) * size + column // finer
    pair = (texel * side * side + place[..., 1] * side + place[..., 0]).ravel()
    found, which = np.unique(pair, return_inverse=True)
    overlap = np.bincount(which, np.broadcast_to(solid_angle, place.shape[:-1]).ravel())
    texels, places = np.divmod(found, side * side)
    return texels, places, overlap / np.bincount(places, overlap)[places]
