"""How far away the layers of a glass appear, and what the eyes focus on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Blur, Focus, Solid
from andon.glass.paths import Traced, trace
from andon.glass.pencils import vergence
from andon.observer.gaze.fixation import meeting
from andon.spaces import perpendicular

__all__ = ["Distances", "LayerVergences", "crossing_dioptres", "focus_on", "layer_vergences"]

Float = NDArray[np.float64]
# (origins (n, 3), directions (n, 3)) → (n,) metres to the backdrop, inf where there is none.
Distances = Callable[[Float, Float], Float]

# Newton's steps towards the direction in which a backdrop's point is seen; each squares the error.
STEPS = 24
HALVINGS = 12
# Rings of rays around the middle of a body, for one that has a hole there.
RINGS = 16
# Of the backdrop's point, in metres: far below what a pixel shows.
CLOSE_M = 1e-7


@dataclass(frozen=True)
class LayerVergences:
    """Vergences in dioptres, straight ahead at the middle of the glass, of one eye.

    Attributes
    ----------
    surface : 1/distance of the glass's first boundary.
    background : (2,) of the refracted backdrop, its eigenvalues; equal on the axis of a ball.
        Negative: light that converges behind the eye, which nobody sees sharply.
    background_straight : 1/distance of the backdrop on the way through the glass as if it were
        straight: the paper's d_b. 0: there is none.
    """

    surface: float
    background: tuple[float, float]
    background_straight: float

    @property
    def background_mean(self) -> float:
        """The mean of tangential and sagittal vergence."""
        return (self.background[0] + self.background[1]) / 2


def layer_vergences(
    solids: tuple[Solid, ...], eye: Float, distances: Distances, /
) -> LayerVergences:
    """Where the layers of the first of `solids` appear to an eye (3,) that looks at its middle."""
    direction, seen = _towards_middle(solids, eye)
    far = float(distances(seen.exit_point, seen.exit_direction)[0])
    between = float(distances(eye[None], direction)[0])
    straight = 0.0 if not np.isfinite(between) else 1 / between
    if seen.status[0] != 0 or not np.isfinite(far):
        # Parallel light: a backdrop that is nowhere is as far as can be.
        far = 1e9
    matrix = vergence(seen.pencil, np.array([far]), seen.exit_direction)[0]
    low, high = np.linalg.eigvalsh((matrix + matrix.T) / 2)
    # A ray that meets no glass has gone infinitely far.
    return LayerVergences(1 / float(seen.distance_m[0]), (float(low), float(high)), straight)


def _towards_middle(solids: tuple[Solid, ...], eye: Float) -> tuple[Float, Traced]:
    """A ray (1, 3) from the eye that hits the first solid as near to its middle as can be."""
    middle, reach = solids[0].ball_around
    ahead = middle - eye
    wide = reach / np.linalg.norm(ahead)
    ahead /= np.linalg.norm(ahead)
    right, down = perpendicular(ahead)
    # The middle itself, then rings around it: a torus has nothing in its middle.
    for ring in range(RINGS):
        angles = np.arange(max(1, 8 * ring)) * (2 * np.pi / max(1, 8 * ring))
        around = np.cos(angles)[:, None] * right + np.sin(angles)[:, None] * down
        rays = ahead + ring / RINGS * wide * around
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
        seen = trace(solids, np.broadcast_to(eye, rays.shape), rays)
        good = np.flatnonzero((seen.solid == 0) & (seen.status == 0))
        if len(good):
            ray = rays[good[:1]]
            return ray, trace(solids, eye[None], ray)
    return ahead[None], trace(solids, eye[None], ahead[None])


def focus_on(
    layer: str, vergences: LayerVergences, blur: Blur, limit_dioptres: float, state: str = "seen"
) -> Focus:
    """The focus of eyes that look at a layer, ``surface`` or ``background``.

    ``paper`` takes the backdrop's straight distance, and eyes that focus on anything. Otherwise the
    layer's own vergence, brought into [0, `limit_dioptres`].
    """
    if blur == "paper":
        seen = vergences.surface if layer == "surface" else vergences.background_straight
        return Focus(seen, layer, state)  # type: ignore[arg-type]
    wanted = vergences.surface if layer == "surface" else vergences.background_mean
    reached = float(np.clip(wanted, 0, limit_dioptres))
    return Focus(reached, layer, state, clamped=reached != wanted)  # type: ignore[arg-type]


def crossing_dioptres(
    solids: tuple[Solid, ...], eyes: tuple[Float, Float], distances: Distances, /
) -> float:
    """Vergence at which both eyes' rays to one point of the backdrop cross; NaN: nowhere.

    The point is what the middle of both eyes (3,) sees through the middle of the glass. Rays that
    part cross behind the eyes: < 0. Where it lies has a say in how far away the image *looks*; how
    sharp it is does not ask it (`LayerVergences`).
    """
    middle = (eyes[0] + eyes[1]) / 2
    start, seen = _towards_middle(solids, middle)
    far = float(distances(seen.exit_point, seen.exit_direction)[0])
    if seen.status[0] != 0 or not np.isfinite(far):
        return np.nan
    point = (seen.exit_point + far * seen.exit_direction)[0]
    found = [_direction_to(solids, eye, start[0], point) for eye in eyes]
    if found[0] is None or found[1] is None:
        return np.nan
    return _vergence_of_rays(eyes, (found[0], found[1]))


def _direction_to(
    solids: tuple[Solid, ...], eye: Float, start: Float, point: Float
) -> Float | None:
    """The direction (3,) in which `eye` sees `point` (3,), by Newton's method from `start`.

    A step that would lead beside the glass, or no nearer, is halved.
    """
    here = _aim(solids, eye, start, point)
    for _ in range(STEPS):
        if here is None or np.linalg.norm(here.missed) < CLOSE_M:
            break
        step = here.step
        for _ in range(HALVINGS):
            there = _aim(solids, eye, here.direction + step, point)
            if there is not None and np.linalg.norm(there.missed) < np.linalg.norm(here.missed):
                break
            step = step / 2
        else:
            return None
        here = there
    if here is None or np.linalg.norm(here.missed) >= CLOSE_M:
        return None
    return here.direction


@dataclass(frozen=True)
class _Aim:
    """A ray of an eye: by how many metres it misses a point, and the turn that would mend that."""

    direction: Float
    missed: Float
    step: Float


def _aim(solids: tuple[Solid, ...], eye: Float, towards: Float, point: Float) -> _Aim | None:
    """A ray towards a direction (3,) of any length; None if it does not get through the glass."""
    direction: Float = towards / float(np.linalg.norm(towards))
    right, down = perpendicular(direction)
    seen = trace(solids, eye[None], direction[None], frame=(right[None], down[None]))
    if seen.solid[0] < 0 or seen.status[0] != 0:
        return None
    origin, last = seen.exit_point[0], seen.exit_direction[0]
    along = float((point - origin) @ last)
    missed = point - origin - along * last
    moves = seen.pencil[0, 2:, 0] + along * seen.pencil[0, 2:, 1]  # (2, 3) per radian
    turn: Float = np.asarray(np.linalg.lstsq(moves.T, missed, rcond=None)[0], np.float64)
    return _Aim(direction, missed, turn[0] * right + turn[1] * down)


def _vergence_of_rays(eyes: tuple[Float, Float], directions: tuple[Float, Float]) -> float:
    """1/distance of the middle of the shortest segment between two rays; < 0 behind the eyes."""
    crossing = meeting(np.array(eyes)[None], np.array(directions)[None]).points_m[0]
    if np.isnan(crossing).any():
        return 0.0  # parallel
    reach = crossing - (eyes[0] + eyes[1]) / 2
    sign = 1.0 if reach @ (directions[0] + directions[1]) > 0 else -1.0
    return sign / float(np.linalg.norm(reach))
