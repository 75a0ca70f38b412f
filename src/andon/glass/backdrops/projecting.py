"""Where in the frame a point is seen, and how far its pixel moves when the point does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View

__all__ = ["moved_pixels"]

Float = NDArray[np.float64]


def moved_pixels(view: View, points: Float, moves: Float, /) -> tuple[Float, Float]:
    """Pixels (n, 2) of camera-frame `points` (n, 3); (n, k, 2) pixels per move (n, k, 3) of them.

    The moves are derivatives: not what a long one gives. NaN behind a pinhole and straight behind a
    fisheye.
    """
    pixels = view.project(points)
    x, y, z = points[:, None, 0], points[:, None, 1], points[:, None, 2]
    dx, dy, dz = np.moveaxis(moves, -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        if view.projection == "pinhole":
            across, down = (dx - x / z * dz) / z * view.fx, (dy - y / z * dz) / z * view.fy
        elif view.projection == "fisheye":
            across, down = _fisheye(view, (x, y, z), (dx, dy, dz))
        else:
            across, down = _latlong(view, (x, y, z), (dx, dy, dz))
    return pixels, np.stack([across, down], axis=-1)


def _fisheye(view: View, place: tuple[Float, ...], move: tuple[Float, ...]) -> tuple[Float, Float]:
    """(x, y)·θ/r with r = |(x, y)|, θ = atan2(r, z)."""
    (x, y, z), (dx, dy, dz) = place, move
    planar = np.hypot(x, y)
    squared = planar * planar + z * z
    away = planar > 1e-9 * np.abs(z)
    scale = np.where(away, np.arctan2(planar, z) / np.where(away, planar, 1), 1 / z)
    radial = (x * dx + y * dy) / np.where(away, planar, 1)
    # dθ/r − θ·dr/r²: what the scale grows by.
    turned = (z * radial - planar * dz) / squared
    growth = np.where(away, (turned - scale * radial) / np.where(away, planar, 1), -dz / (z * z))
    return (dx * scale + x * growth) * view.fx, (dy * scale + y * growth) * view.fy


def _latlong(view: View, place: tuple[Float, ...], move: tuple[Float, ...]) -> tuple[Float, Float]:
    (x, y, z), (dx, dy, dz) = place, move
    # At a pole every azimuth is as good.
    level = np.maximum(x * x + z * z, 1e-20)
    azimuth = (z * dx - x * dz) / level
    fallen = (dy * level - y * (x * dx + z * dz)) / (np.sqrt(level) * (level + y * y))
    return azimuth * view.width / (2 * np.pi), fallen * view.height / np.pi
