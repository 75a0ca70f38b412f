"""Light of cube maps and panoramas → coefficients: L_lm = Σ L·Y_lm·A, normalised by 4π/ΣA.

A cube's sum is a matrix product with a cached matrix; Y is taken at the texel's centre. Its error
for smooth light falls as h²: 2.5e-5 at 128². With the paper's solid angles, which are those at the
centre, too, it is half of that; exact ones are right for light that is constant in a texel.

Of a panorama Y is integrated over each pixel, exactly: pixels at the poles are long triangles, and
a constant sky must give a constant. Its rows are circles around y, on which a harmonic of band l
is a trigonometric polynomial of degree l and known from 2·order + 1 values. So each row is first
reduced to that many numbers (Dirichlet's kernel), and the large picture meets 5 weights, not 9.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.basis import basis, coefficient_count
from andon.harmonics.cubes import SolidAngle, cube_directions, cube_solid_angles
from andon.harmonics.panoramas import check_latlong

__all__ = ["project_cube", "project_latlong"]

Float = NDArray[np.float64]

# Values that are converted to float64 and multiplied at once: 32 MB.
_CHUNK_VALUES = 1 << 22
# Points in each row of a panorama.
_GAUSS = 8


def project_cube(
    faces: NDArray[Any],
    order: int = 2,
    /,
    solid_angle: SolidAngle = "exact",
    *,
    signed: bool = False,
) -> Float:
    """Coefficients (..., (order + 1)², 3) of cube maps (..., 6, s, s, 3), in their unit.

    `faces` are of any real type, ≥ 0 and finite, in the layout of `cube_directions`; only a
    difference of lights is `signed`. `solid_angle` as in `cube_solid_angles`. Memory beside
    `faces`: 32 MB and the matrix, (order + 1)²·6·s² numbers.

    Source: Ramamoorthi & Hanrahan 2001, equation 10.
    """
    count = coefficient_count(order)
    if faces.ndim < 4 or faces.shape[-4] != 6 or faces.shape[-1] != 3:
        raise InputError(f"must be (..., 6, s, s, 3), got {faces.shape}", field="cube map")
    if faces.shape[-3] != faces.shape[-2]:
        raise InputError(f"faces must be square, got {faces.shape}", field="cube map")
    size = faces.shape[-2]
    cubes = faces.reshape(-1, 6, size * size, 3)
    result = np.zeros((len(cubes), count, 3))
    for face in range(6):
        weights = _face_weights(size, order, solid_angle, face)
        step = max(1, _CHUNK_VALUES // (3 * size * size))
        for start in range(0, len(cubes), step):
            chunk = cubes[start : start + step, face].astype(np.float64)
            _check_light(chunk, "cube map", signed)
            result[start : start + step] += weights @ chunk
    return result.reshape(*faces.shape[:-4], count, 3)


@lru_cache(maxsize=12)
def _face_weights(size: int, order: int, kind: SolidAngle, face: int) -> Float:
    """(k, size²) Y·A·4π/ΣA of the texels of a face."""
    angles = cube_solid_angles(size, kind)
    values = basis(cube_directions(size)[face], order)
    scaled = values * (angles * (4 * np.pi / (6 * angles.sum())))[..., None]
    return np.ascontiguousarray(scaled.reshape(size * size, -1).T)


def project_latlong(picture: NDArray[Any], order: int = 2, /, *, signed: bool = False) -> Float:
    """Coefficients ((order + 1)², 3) of a latlong panorama (H, 2H, 3), in its unit.

    `picture` is of any real type, ≥ 0 and finite; only a difference of lights is `signed`. The
    integral of Y over a light that is constant in each pixel. The middle of the picture is −Z;
    turn the coefficients (`rotated`) where it is not.
    """
    check_latlong(picture)
    count = coefficient_count(order)
    height, width = picture.shape[:2]
    nodes = 2 * order + 1
    kernel = _dirichlet(width, nodes)
    reduced = np.empty((height, nodes, 3))
    step = max(1, _CHUNK_VALUES // (3 * width))
    for start in range(0, height, step):
        chunk = picture[start : start + step].astype(np.float64)
        _check_light(chunk, "panorama", signed)
        np.matmul(kernel, chunk, out=reduced[start : start + step])
    weights = _row_weights(height, order)
    return weights.reshape(-1, count).T @ reduced.reshape(-1, 3)


def _dirichlet(width: int, nodes: int) -> Float:
    """(nodes, width): means over columns of trigonometric polynomials that are known at `nodes`.

    f(φ) = Σ f(φ_j)·D(φ − φ_j), D(t) = (1 + 2 Σ_{m ≤ (nodes−1)/2} cos mt)/nodes, `nodes` odd; over a
    column of width w the mean of cos mt is its middle times sin(mw/2)/(mw/2).
    """
    azimuth = (np.arange(width) + 0.5) / width * (2 * np.pi)
    node = np.arange(nodes) / nodes * (2 * np.pi)
    kernel = np.ones((nodes, width))
    for degree in range(1, nodes // 2 + 1):
        wave = np.cos(degree * (azimuth[None, :] - node[:, None]))
        kernel += 2 * np.sinc(degree / width) * wave
    return kernel / nodes


def _row_weights(height: int, order: int) -> Float:
    """(height, nodes, k) integrals of Y over the polar angle of each row, at the nodes' azimuths.

    Times the width of a pixel. Gauss–Legendre in each row; the rule's error is below rounding from
    4 rows on. Azimuth 0 is the left border, +Z; it rises towards −X, −Z (the middle) and +X.
    """
    nodes = 2 * order + 1
    place, share = np.polynomial.legendre.leggauss(_GAUSS)
    polar = (np.arange(height)[:, None, None] + (place[:, None] + 1) / 2) * (np.pi / height)
    azimuth = np.arange(nodes) * (2 * np.pi / nodes)
    x, z = -np.sin(polar) * np.sin(azimuth), np.sin(polar) * np.cos(azimuth)
    directions = np.stack([x, np.broadcast_to(np.cos(polar), x.shape), z], axis=-1)
    area = np.sin(polar[..., 0]) * share * (np.pi / height) ** 2 / 2
    return np.einsum("rg,rgnk->rnk", area, basis(directions, order))


def _check_light(values: Float, what: str, signed: bool) -> None:
    """Refuses NaN, ±inf and, unless `signed`, negative light."""
    if values.size == 0:
        return
    low, high = values.min(), values.max()  # NaN wins both
    if not (np.isfinite(low) and np.isfinite(high)):
        bad = int(values.size - np.count_nonzero(np.isfinite(values)))
        raise InputError(f"must be finite, {bad} values are NaN or infinite", field=what)
    if low < 0 and not signed:
        count = np.count_nonzero(values < 0)
        raise InputError(
            f"light must be ≥ 0, {count} values are negative, down to {low:g}",
            field=what,
            remedy="andon.harmonics.nonnegative sets them to 0 and counts them",
        )
