"""Delaunay simplices of any points: no slivers on lattices, and neighbours that fit.

The Delaunay triangulation is the lower hull of points lifted to one dimension more, by
``h = |x|²``. On a lattice eight corners lie on one sphere, so their lifts lie in one plane, and a
program that has to cut it up may cross the diagonals of two neighbours, or call four points of a
plane a tetrahedron. Here the lift is

    h = |x|² + ε·xᵀQx + δ·d²·r        d: distance to the nearest other point, r in [−1, 1] seeded

- Every facet of the lower hull of *any* lift projects to a simplex with volume, and neighbours
  share whole faces: slivers and cracks do not have to be repaired, they cannot come to be. Such a
  triangulation is called regular, or weighted Delaunay; walks in it end (Edelsbrunner 1990).
- ``|x|² + ε·xᵀQx`` is Delaunay in a space that is stretched by at most ε/2, so nobody sees the
  difference; but Q is generic, so a lattice has no cospherical cells any more, and since a
  quadratic form looks the same from everywhere, all cells are cut in the same way: with negative
  off-diagonals into Kuhn's six tetrahedra around one diagonal.
- The noise decides ties that are left, as in Simulation of Simplicity (Edelsbrunner & Mücke
  1990), but with numbers that a program working in floats can see.

Qhull (Barber, Dobkin & Huhdanpaa 1996) finds the hull in float64 with tolerances, so whether all
is well is checked afterwards, and tried again with larger ε.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError

__all__ = ["ATTEMPTS", "nearest_distances", "simplices", "stretch", "volumes"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

# (ε, δ, whether the set is first stretched to a cube along its main axes), tried in turn. Qhull's
# tolerance is some 1e-14 of the extent squared; even among 46³ points of a lattice, 1/45 apart, the
# first ε moves a corner off its cell's sphere by 5e-6. Stretched cells are not Delaunay, but cells:
# for sets so thin that their thickness squared is no more than rounding.
ATTEMPTS = ((1e-2, 1e-6, False), (1e-1, 1e-3, False), (1e-2, 1e-6, True), (1e-1, 1e-3, True))

# Symmetric, eigenvalues within ±1, all off-diagonals negative, otherwise arbitrary: no ratio of two
# entries is a simple fraction.
QUADRATIC = np.array(
    [
        [0.3137, -0.2391, -0.1733],
        [-0.2391, -0.4219, -0.3163],
        [-0.1733, -0.3163, 0.1927],
    ]
)

# Facets of the lifted hull that are steeper than this stand on the silhouette: no volume below.
VERTICAL = 1e-12


def spatial() -> Any:
    """`scipy.spatial`, which joins probes; looking light up does not need it."""
    try:
        return importlib.import_module("scipy.spatial")
    except ImportError as error:
        raise MachineError(
            "joining probes to tetrahedra needs SciPy", remedy="pip install andon[probes]"
        ) from error


def nearest_distances(points: Float, /) -> tuple[Float, NDArray[np.intp]]:
    """(n,) distance from each of `points` (n, d), n ≥ 2, to the nearest other, and (n,) which."""
    found: tuple[Float, NDArray[np.intp]] = spatial().cKDTree(points).query(points, k=2)
    distances, numbers = found
    own = np.arange(len(points))
    # Of duplicates, either may come first.
    return distances[:, 1], np.where(numbers[:, 0] == own, numbers[:, 1], numbers[:, 0])


def simplices(points: Float, /, *, attempt: int = 0) -> Int:
    """Simplices (m, d + 1) of `points` (n, d), d = 2 or 3, that span d dimensions.

    Parameters
    ----------
    points : without duplicates; centred, and of an extent of about 1.
    attempt : number of the lift in `ATTEMPTS`.

    Returns
    -------
    Numbers of points, positively oriented (`volumes` > 0). Nothing of the mesh is checked here.

    Raises
    ------
    MachineError : without SciPy.
    RuntimeError : what Qhull refuses (`scipy.spatial.QhullError` is one).
    """
    count, dimensions = points.shape
    found = np.arange(count, dtype=np.int32)[None]
    if count > dimensions + 1:
        epsilon, noise, stretched = ATTEMPTS[attempt]
        placed = _stretched(points) if stretched else points
        lifted = np.column_stack([placed, _lift(placed, epsilon, noise)])
        hull = spatial().ConvexHull(lifted, qhull_options="Qt")
        lower = hull.equations[:, dimensions] < -VERTICAL
        found = hull.simplices[lower].astype(np.int32)
    volume = volumes(points, found)
    found[volume < 0] = found[volume < 0][:, [1, 0, *range(2, dimensions + 1)]]
    return found


def _stretched(points: Float) -> Float:
    """Points of extent 1 along each of their main axes."""
    middle = points - points.mean(axis=0)
    turned = middle @ np.linalg.svd(middle.T @ middle)[2].T
    return turned / np.ptp(turned, axis=0)


def _lift(points: Float, epsilon: float, noise: float) -> Float:
    """(n,) heights."""
    form = QUADRATIC[: points.shape[1], : points.shape[1]]
    nearest, _ = nearest_distances(points)
    random = np.random.default_rng(1990).uniform(-1, 1, len(points))
    return (
        np.einsum("ni,ni->n", points, points)
        + epsilon * np.einsum("ni,ij,nj->n", points, form, points)
        + noise * nearest**2 * random
    )


def stretch(dimensions: int = 3, /) -> Float:
    """A (d, d) with AᵀA = 1 + εQ: Delaunay cells of A·p are those of `simplices` at its first
    attempt, but for what only the noise decides."""
    form = np.eye(dimensions) + ATTEMPTS[0][0] * QUADRATIC[:dimensions, :dimensions]
    return np.asarray(np.linalg.cholesky(form).T, np.float64)


def volumes(points: Float, corners: Int, /) -> Float:
    """(m,) determinants of p0 − pd, …: d! times the signed volume of simplices (m, d + 1)."""
    at = points[corners]
    return np.linalg.det(at[:, :-1] - at[:, -1:])
