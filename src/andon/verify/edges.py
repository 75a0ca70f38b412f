"""Which points lie at a shadow's edge, by rays: where a depth map may be wrong by a texel."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from andon.lamps import PointLamp

__all__ = ["EDGE_TEXELS", "shadow_edges"]

Float = NDArray[np.float64]
Visible = Callable[[Float, Float, Float], NDArray[np.bool_]]

EDGE_TEXELS = 2.0


def shadow_edges(
    points: Float, normals: Float, lamp: PointLamp, visible: Visible, map_size: int, /, *, steps: int
) -> NDArray[np.bool_]:
    """(n,) bool: on the receiver's plane, the true shadow changes within two texels of the map.

    Parameters
    ----------
    points, normals : (n, 3) metres and unit normals.
    visible : (points, normals, lamp position) → (n,) bool, by rays.
    map_size : texels along a side of one disc of the dual-paraboloid map.
    steps : the ±2 texels are probed by a square grid of this many points a side.
    """
    reach = points - lamp.position_m
    distance = np.linalg.norm(reach, axis=1)
    side = np.sign(reach[:, 2])
    place = reach[:, :2] / (distance + np.abs(reach[:, 2]))[:, None]
    away = np.einsum("ij,ij->i", reach, normals)
    lit = np.zeros(len(points), np.int64)
    offsets = np.linspace(-EDGE_TEXELS, EDGE_TEXELS, steps) * 2 / map_size
    for dx in offsets:
        for dy in offsets:
            u = place + np.array([dx, dy])
            square = (u**2).sum(axis=1, keepdims=True)
            ray = np.concatenate([2 * u, side[:, None] * (1 - square)], axis=1) / (1 + square)
            with np.errstate(divide="ignore", invalid="ignore"):
                along = away / np.einsum("ij,ij->i", ray, normals)
            usable = (along > 0) & np.isfinite(along)
            moved = np.where(usable[:, None], lamp.position_m + ray * along[:, None], points)
            lit += visible(moved, normals, lamp.position_m)
    return (lit > 0) & (lit < steps**2)
