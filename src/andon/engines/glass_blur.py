"""Between which diameters the blurs of a view's glass lie: passes that none needs are not drawn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glass.defocus.kernels import MAX_BLUR_PX
from andon.glass.model import Backdrop, Ball, Focus, GlassModel
from andon.glass.paths import LOST, trace
from andon.glass.pencils import blur_radians, vergence
from andon.glass.screen import pixels_per_radian
from andon.spaces import View, perpendicular

__all__ = ["BlurBounds"]

Float = NDArray[np.float64]
# Of what is refracted, sticks to the surface, is mirrored, px.
Diameters = tuple[float, float, float]

# Rays through a ball: circles around its middle, and rays on each. From one to the next a diameter
# changes by less than the margin, which is a share and so many pixels.
CIRCLES, ON_CIRCLE = 33, 32
SHARE, MARGIN_PX = 0.1, 0.5
# Circles end where the outline's rays are drawn in to (silhouette_ball.wgsl).
RIM = 0.99999
# How far away a ray goes that meets no backdrop (seen.wgsl).
FAR_M = 1e6


class BlurBounds:
    """Largest and smallest diameters of one view's layers, for any focus.

    Of a ball alone before a picture from a sheaf of rays that is traced once. Other bodies have
    edges and folds that a sheaf misses: there nothing is known but how far away the bodies are.
    """

    def __init__(self, model: GlassModel, view: View) -> None:
        self.model, self.view = model, view
        # Pixels of a pinhole are the larger angles the nearer they are to its middle.
        self._most_per_radian = pixels_per_radian(view)
        self._least_per_radian = float(np.sqrt(view.fx * view.fy))
        self._matrices: tuple[Float, Float, Float] | None = None
        if view.projection == "pinhole" and model.blur in ("optical", "gaussian"):
            self._matrices = _sheaf(model, view)
        self._known: dict[float, tuple[Diameters, Diameters]] = {}

    def of(self, focus: Focus) -> tuple[Diameters, Diameters]:
        """No disc of refracted, surface, reflected is larger than the first, smaller than the
        second, px."""
        key = focus.dioptres
        if key not in self._known:
            # A gaze that wanders must not fill the memory.
            self._known = {key: self._measured(focus.dioptres)}
        return self._known[key]

    def _measured(self, dioptres: float) -> tuple[Diameters, Diameters]:
        if self._matrices is None:
            return (MAX_BLUR_PX, self._around(dioptres), MAX_BLUR_PX), (0.0, 0.0, 0.0)
        ranges = [
            (float(wide.min()), float(wide.max()))
            for wide in (blur_radians(one, dioptres, self.model.pupil_m) for one in self._matrices)
        ]
        most = [high * self._most_per_radian * (1 + SHARE) + MARGIN_PX for _, high in ranges]
        least = [low * self._least_per_radian * (1 - SHARE) - MARGIN_PX for low, _ in ranges]
        large, small = np.minimum(most, MAX_BLUR_PX), np.clip(least, 0.0, MAX_BLUR_PX)
        return _three(large), _three(small)

    def _around(self, dioptres: float) -> float:
        """Of what sticks to bodies: none is nearer or farther than the balls around them."""
        spans: list[float] = []
        for solid in self.model.solids:
            middle, radius = solid.ball_around
            away = float(np.linalg.norm(middle - self.view.position))
            ends = (1 / max(away - radius, 1e-3), 1 / (away + radius))
            spans += [abs(end - dioptres) for end in ends]
        wide = max(spans) * self.model.pupil_m * self._most_per_radian
        return min(wide, MAX_BLUR_PX)


def _three(values: Float) -> Diameters:
    return float(values[0]), float(values[1]), float(values[2])


def _sheaf(model: GlassModel, view: View) -> tuple[Float, Float, Float] | None:
    """(n, 2, 2) vergences of refracted, surface, reflected; None where a sheaf does not do."""
    solid, *others = model.solids
    if others or not isinstance(solid.shape, Ball) or solid.backdrop.kind != "texture":
        return None
    to_middle = solid.world_from_glass[:3, 3] - view.position
    distance = float(np.linalg.norm(to_middle))
    right, down = perpendicular(to_middle / distance)
    sines = np.linspace(0, RIM, CIRCLES)[:, None, None] * solid.shape.radius_m / distance
    turns = (np.arange(ON_CIRCLE) * (2 * np.pi / ON_CIRCLE))[:, None]
    aside = np.cos(turns) * right + np.sin(turns) * down
    rays = (np.sqrt(1 - sines**2) * to_middle / distance + sines * aside).reshape(-1, 3)
    seen = trace((solid,), np.broadcast_to(view.position, rays.shape), rays)
    kept = (seen.solid == 0) & (seen.status != LOST)
    through = _appears(
        solid.backdrop, seen.exit_point[kept], seen.exit_direction[kept], seen.pencil[kept]
    )
    away = _appears(
        solid.backdrop, seen.point[kept], seen.mirrored[kept], seen.mirrored_pencil[kept]
    )
    near = np.eye(2) / seen.distance_m[kept][:, None, None]
    return (through, near, away) if kept.any() else None


def _appears(backdrop: Backdrop, origins: Float, directions: Float, pencil: Float) -> Float:
    """(n, 2, 2) vergences of a picture on a plane, and of what is beside it."""
    normal = np.cross(backdrop.right_m, backdrop.up_m)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = ((backdrop.centre_m - origins) @ normal) / (directions @ normal)
        place = origins + reach[:, None] * directions - backdrop.centre_m
        across = np.abs(place @ backdrop.right_m) / (backdrop.right_m @ backdrop.right_m)
        along = np.abs(place @ backdrop.up_m) / (backdrop.up_m @ backdrop.up_m)
    hit = (reach > 0) & (across <= 1) & (along <= 1)
    return vergence(pencil, np.where(hit, reach, FAR_M), directions)
