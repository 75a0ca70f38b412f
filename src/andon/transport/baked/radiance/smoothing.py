"""Light traced at some of the points, and smoothed to all of them.

Reflected light is noisy where it is traced with few rays, and smooth in itself: neighbours tell
about each other. The points are cut into cells of about as many points each, in space and in
direction at once, one point of each is traced, and every point takes the tangent plane's linear fit
of its neighbours among these, weighted by how near they are. A linear fit has no error where light
changes evenly, as it does towards a corner; a mean would have one at every border. Neighbours that
face elsewhere count as far away, so edges stay.

Unlike `rtrace`'s own interpolation it does not depend on the order of points: no streaks.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError

__all__ = ["chosen_points", "smoothed"]

Float = NDArray[np.float64]

# Metres that a unit of normals counts as: a right angle is as far as 0.7 m.
NORMAL_M = 0.5
# Of the mean squared distance: keeps slopes from following noise, or points on a line.
RIDGE = 0.1
# Of the neighbours' reach: farther off the tangent plane they count less than half.
OFF_PLANE = 0.05
# Points of which neighbours are looked up at a time, for memory.
BLOCK = 16384


def chosen_points(position: Float, normal: Float, count: int, /) -> NDArray[np.intp]:
    """(count,) increasing numbers of points that are spread evenly among all of them.

    The points are parted across the widest of position and direction until there are `count` cells
    of as many each; of each the point nearest to the middle is taken. All, if there are no more.
    """
    places = _places(position, normal)
    if count >= len(places):
        return np.arange(len(places))
    chosen: list[int] = []
    cells = [(np.arange(len(places)), count)]
    while cells:
        cell, parts = cells.pop()
        if parts == 1:
            off = places[cell] - places[cell].mean(axis=0)
            chosen.append(int(cell[np.argmin(np.sum(off**2, axis=1))]))
            continue
        first = parts // 2
        one, other = _parted(places, cell, round(len(cell) * first / parts))
        cells += [(one, first), (other, parts - first)]
    return np.sort(np.array(chosen, np.intp))


def smoothed(
    position: Float,
    normal: Float,
    chosen: NDArray[np.intp],
    lux: Float,
    /,
    *,
    neighbours: int,
) -> Float:
    """(n, 3) lux at all points from those `lux` (k, 3) of the `chosen` (k,).

    Parameters
    ----------
    position, normal : (n, 3) metres, unit.
    neighbours : how many of the chosen each point looks at.

    Raises `MachineError` where SciPy, which finds neighbours, is missing.
    """
    places = _places(position, normal)
    near = min(neighbours, len(chosen))
    tree = _tree(places[chosen])
    result = np.empty((len(places), 3))
    for start in range(0, len(places), BLOCK):
        block = slice(start, start + BLOCK)
        distance, index = tree.query(places[block], k=range(1, near + 1))
        offset = position[chosen][index] - position[block, None]
        result[block] = _fit(offset, normal[block], distance, lux[index])
    return result


def _fit(offset: Float, normal: Float, distance: Float, lux: Float) -> Float:
    """(n, 3) value at offset 0 of linear fits to lux (n, k, 3) at offsets (n, k, 3)."""
    reach = distance[:, -1:] * 1.001 + 1e-9
    weight = (1 - (distance / reach) ** 2) ** 2
    # What lies before or behind the tangent plane is another surface: a panel behind its frame.
    off = np.abs(np.einsum("nki,ni->nk", offset, normal))
    weight = weight / (1 + (off / (OFF_PLANE * reach)) ** 4) + 1e-6
    weight = weight / weight.sum(axis=1, keepdims=True)
    across = _across(normal)
    flat = np.stack([np.einsum("nki,ni->nk", offset, axis) for axis in across], axis=-1)
    middle = np.einsum("nk,nki->ni", weight, flat)
    mean = np.einsum("nk,nkc->nc", weight, lux)
    from_middle = flat - middle[:, None]
    spread = np.einsum("nk,nki,nkj->nij", weight, from_middle, from_middle)
    ridge = RIDGE * np.trace(spread, axis1=1, axis2=2) + 1e-12
    slope = np.linalg.solve(
        spread + ridge[:, None, None] * np.eye(2),
        np.einsum("nk,nki,nkc->nic", weight, from_middle, lux - mean[:, None]),
    )
    fitted = mean - np.einsum("ni,nic->nc", middle, slope)
    # A slope does not make light that no neighbour has.
    return np.clip(fitted, lux.min(axis=1), lux.max(axis=1))


def _across(normal: Float) -> tuple[Float, Float]:
    """Two unit vectors (n, 3) in the tangent plane."""
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    first = np.asarray(np.cross(normal, axis), np.float64)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.asarray(np.cross(normal, first), np.float64)


def _places(position: Float, normal: Float) -> Float:
    return np.concatenate([position, NORMAL_M * normal], axis=1)


def _parted(
    places: Float, cell: NDArray[np.intp], count: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The first `count` of a cell along its widest axis, and the others."""
    inside = places[cell]
    widest = int(np.argmax(inside.max(axis=0) - inside.min(axis=0)))
    order = np.argsort(inside[:, widest], kind="stable")
    return cell[order[:count]], cell[order[count:]]


def _tree(places: Float) -> Any:
    try:
        return import_module("scipy.spatial").cKDTree(places)
    except ImportError as error:
        raise MachineError(
            "SciPy is missing", remedy="install it with: pip install 'andon[radiance]'"
        ) from error
