"""Which body lies in which, and whether an eye lies in one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glass.lens import cap_heights
from andon.glass.model import Ball, Closed, LensShape, Slab, Solid
from andon.glass.paths import insides
from andon.glass.shapes import Shape, contains, scale_of
from andon.spaces import invert_rigid, transform_points

__all__ = ["boundary_points", "check_eye", "outermost_first"]

Float = NDArray[np.float64]

# A boundary that touches another from inside is inside: this share of the size is no distance.
TOUCH = 1e-6
POINTS = 200
MAX_VERTICES = 2000
GOLDEN_ANGLE = np.pi * (3 - 5**0.5)


def boundary_points(shape: Shape, /) -> Float:
    """Points (n, 3) on the boundary of a shape, spread over all of it, in its own frame."""
    match shape:
        case Ball(radius):
            z = 1 - (2 * np.arange(POINTS) + 1) / POINTS
            angle, across = GOLDEN_ANGLE * np.arange(POINTS), np.sqrt(1 - z * z)
            return radius * np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)
        case Slab(half):
            grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 5)] * 3), axis=-1).reshape(-1, 3)
            return half * grid[np.abs(grid).max(axis=1) == 1]
        case LensShape(rim):
            across, angle = np.meshgrid(np.linspace(0, rim, 8), np.linspace(0, 2 * np.pi, 24))
            flat = [across * np.cos(angle), across * np.sin(angle)]
            caps = [np.stack([*flat, z], axis=-1) for z in cap_heights(shape, across)]
            return np.concatenate(caps).reshape(-1, 3)
        case Closed(geometry):
            used = np.unique(geometry.triangles)
            return geometry.positions[used[:: -(-len(used) // MAX_VERTICES)]]


def _contains(outer: Solid, inner: Solid) -> bool:
    points = transform_points(inner.world_from_glass, boundary_points(inner.shape))
    local = transform_points(invert_rigid(outer.world_from_glass), points)
    return bool(contains(outer.shape, local, margin_m=-TOUCH * scale_of(outer.shape)).all())


def outermost_first(solids: Sequence[Solid], /) -> tuple[Solid, ...]:
    """The bodies in an order in which what contains another comes before it.

    Others keep theirs: where two overlap without one being inside, the later one is what the light
    is in. Two that contain each other are one in the same place, and keep their order, too.
    """
    count = len(solids)
    holds = [
        [a != b and _contains(solids[a], solids[b]) for b in range(count)] for a in range(count)
    ]
    order: list[int] = []

    def take(place: int) -> None:
        if place in order:
            return
        for outer in range(count):
            if holds[outer][place] and not holds[place][outer]:
                take(outer)
        order.append(place)

    for place in range(count):
        take(place)
    return tuple(solids[place] for place in order)


def check_eye(solids: Sequence[Solid], positions: Float, /) -> None:
    """Raise `InputError` where an eye, `positions` (n, 3) in metres, is inside glass."""
    inside = insides(solids, np.asarray(positions, np.float64).reshape(-1, 3))
    for place, solid in enumerate(solids):
        if inside[:, place].any():
            raise InputError(
                f"the eye is inside the glass {solid.name!r}",
                field="glass",
                remedy="move the camera or the glass: both are in world coordinates, metres",
            )
