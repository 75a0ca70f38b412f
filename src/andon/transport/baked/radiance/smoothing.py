"""Light traced at some of the points, and smoothed to all of them.

Reflected light is noisy where it is traced with few rays, and smooth in itself: neighbours tell
about each other. The points are cut into cells of about as many points each, in space and in
direction at once, one point of each is traced, and every point takes the tangent plane's linear fit
of its neighbours among these, weighted by how near they are. A linear fit has no error where light
changes evenly, as it does towards a corner; a mean would have one at every border. Neighbours that
face elsewhere count as far away, so edges stay.

Paper a few millimetres behind a lattice faces as its bars do. What tells them apart is how far one
lies off the other's plane: of two points on any ball, (p₂ − p₁)·(n₁ + n₂) is 0, so that curved
surfaces may count off-plane neighbours as strictly as flat ones. Where few neighbours are left,
more points are traced: `lonely_points` finds them.

Unlike `rtrace`'s own interpolation it does not depend on the order of points: no streaks.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError

__all__ = ["chosen_points", "lonely_points", "smoothed"]

Float = NDArray[np.float64]

# Metres that a unit of normals counts as: a right angle is as far as 0.7 m.
NORMAL_M = 0.5
# Of the mean squared distance: keeps slopes from following noise, or points on a line.
RIDGE = 0.1
# Of the neighbours' reach: farther off the tangent plane they count less than half.
OFF_PLANE = 0.01
# What a neighbour off the plane still counts: where there is no other, it is better than nothing.
LEAST = 1e-4
# A point that has not as many neighbours, each counted by its weight, is lonely.
ENOUGH = 6.0
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


def lonely_points(
    position: Float, normal: Float, chosen: NDArray[np.intp], /, *, neighbours: int, most: int
) -> NDArray[np.intp]:
    """Numbers of at most `most` more points, spread evenly where the chosen ones are too few.

    Thin bars, rims, and what is seen through gaps. Parameters as of `smoothed`.
    """
    lonely: list[NDArray[np.intp]] = []
    for start, near in _neighbours(position, normal, chosen, neighbours):
        weight = near.weight
        count = weight.sum(axis=1) ** 2 / (weight**2).sum(axis=1)
        lonely.append(start + np.flatnonzero(count < ENOUGH))
    numbers = np.setdiff1d(np.concatenate(lonely), chosen)
    return numbers[chosen_points(position[numbers], normal[numbers], min(most, len(numbers)))]


def smoothed(
    position: Float,
    normal: Float,
    chosen: NDArray[np.intp],
    lux: Float,
    /,
    *,
    neighbours: int,
) -> Float:
    """(n, c) lux at all points from those `lux` (k, c) of the `chosen` (k,).

    Parameters
    ----------
    position, normal : (n, 3) metres, unit.
    neighbours : how many of the chosen each point looks at.

    Raises `MachineError` where SciPy, which finds neighbours, is missing.
    """
    result = np.empty((len(position), lux.shape[1]))
    for start, near in _neighbours(position, normal, chosen, neighbours):
        here = slice(start, start + len(near.weight))
        result[here] = _fit(near, normal[here], lux[near.index])
    return result


@dataclass(frozen=True, eq=False)
class _Near:
    """Of n points, k neighbours each: which of the chosen, how far away (n, k, 3), and weights."""

    index: NDArray[np.intp]
    offset: Float
    weight: Float


def _neighbours(
    position: Float, normal: Float, chosen: NDArray[np.intp], neighbours: int
) -> Iterator[tuple[int, _Near]]:
    """Block by block of all points: the number of the first, and their neighbours."""
    places = _places(position, normal)
    tree = _tree(places[chosen])
    nearest = range(1, min(neighbours, len(chosen)) + 1)
    for start in range(0, len(places), BLOCK):
        here = slice(start, start + BLOCK)
        distance, index = tree.query(places[here], k=nearest)
        offset = np.asarray(position[chosen][index] - position[here, None], np.float64)
        weight = _weights(offset, distance, normal[here], normal[chosen][index])
        yield start, _Near(index, offset, weight)


def _weights(offset: Float, distance: Float, normal: Float, theirs: Float) -> Float:
    """(n, k) of neighbours at offsets (n, k, 3) that face `theirs`: near ones, in one surface."""
    reach = distance[:, -1:] * 1.001 + 1e-9
    close = (1 - (distance / reach) ** 2) ** 2
    # What lies before or behind the surface is another one: a panel behind its frame.
    off = np.einsum("nki,nki->nk", offset, normal[:, None] + theirs) / 2
    along = np.clip(np.einsum("nki,ni->nk", theirs, normal), 0, 1)
    return close * (along / (1 + (off / (OFF_PLANE * reach)) ** 4) + LEAST) + 1e-9


def _fit(near: _Near, normal: Float, lux: Float) -> Float:
    """(n, c) value at offset 0 of linear fits to lux (n, k, c)."""
    weight = near.weight / near.weight.sum(axis=1, keepdims=True)
    across = _across(normal)
    flat = np.stack([np.einsum("nki,ni->nk", near.offset, axis) for axis in across], axis=-1)
    middle = np.einsum("nk,nki->ni", weight, flat)
    mean = np.einsum("nk,nkc->nc", weight, lux)
    from_middle = flat - middle[:, None]
    spread = np.einsum("nk,nki,nkj->nij", weight, from_middle, from_middle)
    ridge = RIDGE * (spread[:, 0, 0] + spread[:, 1, 1]) + 1e-12
    solved = np.linalg.solve(  # pyright: ignore[reportUnknownVariableType]
        spread + ridge[:, None, None] * np.eye(2),
        np.einsum("nk,nki,nkc->nic", weight, from_middle, lux - mean[:, None]),
    )
    slope = cast(Float, solved)
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
