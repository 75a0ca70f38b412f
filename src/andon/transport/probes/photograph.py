"""The photograph as a texture on the real surface: light and reflectance of points it shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, transform_points

__all__ = ["Photograph", "Picture", "Shown"]

Float = NDArray[np.float64]

# A point is the one that the picture shows if its depth lies among those of the four pixels around
# it, give or take this share: float32 of a rasterised depth, and bends between pixel centres.
SAME_DEPTH = 0.01


@dataclass(frozen=True, eq=False)
class Shown:
    """What a photograph shows at n points.

    Attributes
    ----------
    luminance_cd_m2 : (n, 3) in what is left of its own light, after dimming.
    reflectance : (n, 3) ρ = π·L/E0, ≥ 0; above 1 where something shone by itself.
    seen : (n,) bool; False: both are the picture's means.
    """

    luminance_cd_m2: Float
    reflectance: Float
    seen: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Picture:
    """What one view's photograph holds.

    Attributes
    ----------
    view : undistorted.
    depth : (H, W) of the real surface as the view sees it, metres; NaN in holes.
    light : (H, W, 6) float32, ≥ 0: luminance in cd/m² of what is left of the photograph's own
        light, and reflectance.
    """

    view: View
    depth: Float
    light: NDArray[np.float32]


class Photograph:
    """The pictures of one view or two, looked up by points of the world."""

    def __init__(self, pictures: Sequence[Picture]) -> None:
        self.pictures = tuple(pictures)
        known = [p.light[np.isfinite(p.depth)].astype(np.float64) for p in self.pictures]
        every = np.concatenate([np.zeros((0, 6)), *known])
        self.mean: Float = every.mean(axis=0) if len(every) else np.zeros(6)

    def at(self, points: Float, /) -> Shown:
        """What is shown at `points` (n, 3) of the real surface, metres, world."""
        found = np.broadcast_to(self.mean, (len(points), 6)).copy()
        seen = np.zeros(len(points), bool)
        for picture in self.pictures:
            left = np.flatnonzero(~seen)
            shown, light = _look_up(picture, points[left])
            found[left[shown]] = light
            seen[left[shown]] = True
        return Shown(found[:, :3], found[:, 3:], seen)


def _look_up(picture: Picture, points: Float) -> tuple[NDArray[np.bool_], Float]:
    """Which of the points the picture shows, and the light (k, 6) of these."""
    view = picture.view
    camera = transform_points(view.camera_from_world, points)
    depth = camera[:, 2] if view.projection == "pinhole" else np.linalg.norm(camera, axis=1)
    pixel = view.project(camera)
    with np.errstate(invalid="ignore"):
        within = (pixel > -0.5).all(axis=1) & (pixel < (view.width - 0.5, view.height - 0.5)).all(1)
    number = np.flatnonzero(within)
    x, y = np.clip(pixel[number].T, 0, [[view.width - 1], [view.height - 1]])
    left, top = np.floor(x).astype(np.intp), np.floor(y).astype(np.intp)
    columns = (left, np.minimum(left + 1, view.width - 1))
    rows = (top, np.minimum(top + 1, view.height - 1))
    around = np.stack([picture.depth[row, column] for row in rows for column in columns])
    near = np.where(np.isnan(around), np.inf, around).min(axis=0)
    far = np.where(np.isnan(around), -np.inf, around).max(axis=0)
    own = depth[number]
    same = (own >= near * (1 - SAME_DEPTH)) & (own <= far * (1 + SAME_DEPTH))
    right, down = (x - left)[same, None], (y - top)[same, None]
    a, b = (picture.light[rows[0], column][same] for column in columns)
    c, d = (picture.light[rows[1], column][same] for column in columns)
    light = (a * (1 - right) + b * right) * (1 - down) + (c * (1 - right) + d * right) * down
    shown = np.zeros(len(points), bool)
    shown[number[same]] = True
    return shown, np.asarray(light, np.float64)
