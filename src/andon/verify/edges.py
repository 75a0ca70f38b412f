"""Which points lie at a shadow's edge, by rays: where a depth map may be wrong by a texel."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from andon.lamps import PointLamp
from andon.rays import RayScene

__all__ = ["EDGE_TEXELS", "near_change", "shadow_edges"]

Float = NDArray[np.float64]
Visible = Callable[[Float, Float, Float], NDArray[np.bool_]]

# Texels of the middle of the map, 4/map_size rad, where they are widest: the map is filled from
# faces whose texels are that wide in all directions.
EDGE_TEXELS = 2.0
# A body ends where the lamp looks past it by this ratio of distances.
PAST = 1.02


def shadow_edges(
    points: Float,
    normals: Float,
    lamp: PointLamp,
    visible: Visible,
    casters: RayScene,
    map_size: int,
    /,
    *,
    steps: int,
) -> NDArray[np.bool_]:
    """(n,) bool: within two texels of the map, an edge as the lamp sees it.

    Either the true shadow changes on the receiver's plane, or the body itself ends there: the lamp
    looks past it at something that is farther by more than `PAST`. Depth jumps in both cases, and
    only there may a depth map be wrong.

    Parameters
    ----------
    points, normals : (n, 3) metres and unit normals.
    visible : (points, normals, lamp position) → (n,) bool, by rays.
    casters : what the lamp sees.
    map_size : texels along a side of one disc of the dual-paraboloid map.
    steps : the ±2 texels are probed by a square grid of this many points a side.
    """
    reach = points - lamp.position_m
    distance = np.linalg.norm(reach, axis=1)
    side = np.sign(reach[:, 2])
    place = reach[:, :2] / (distance + np.abs(reach[:, 2]))[:, None]
    away = np.einsum("ij,ij->i", reach, normals)
    lit = np.zeros(len(points), np.int64)
    past = np.zeros(len(points), bool)
    # |∂direction/∂u| = 2/(1 + |u|²): equal angles are larger steps in u towards the rim.
    stretch = 1 + (place**2).sum(axis=1, keepdims=True)
    offsets = np.linspace(-EDGE_TEXELS, EDGE_TEXELS, steps) * 2 / map_size
    for dx in offsets:
        for dy in offsets:
            u = place + np.array([dx, dy]) * stretch
            square = (u**2).sum(axis=1, keepdims=True)
            ray = np.concatenate([2 * u, side[:, None] * (1 - square)], axis=1) / (1 + square)
            with np.errstate(divide="ignore", invalid="ignore"):
                along = away / np.einsum("ij,ij->i", ray, normals)
            usable = (along > 0) & np.isfinite(along)
            moved = np.where(usable[:, None], lamp.position_m + ray * along[:, None], points)
            lit += visible(moved, normals, lamp.position_m)
            lamp_at = np.broadcast_to(lamp.position_m, ray.shape)
            past |= casters.first_hits(lamp_at, ray).distance > PAST * np.where(usable, along, 0)
    return past | ((lit > 0) & (lit < steps**2))


def near_change(mask: NDArray[np.bool_], reach: int, /) -> NDArray[np.bool_]:
    """(H, W) bool: `mask` (H, W) changes within `reach` pixels."""
    import cv2

    kernel = np.ones((2 * reach + 1,) * 2, np.uint8)
    codes = mask.astype(np.uint8)
    return np.asarray(cv2.dilate(codes, kernel) != cv2.erode(codes, kernel), bool)
