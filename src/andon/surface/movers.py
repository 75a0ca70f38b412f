"""Virtual objects that move: the same triangles and materials, elsewhere at each moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.files.meshes import AnimatedMesh
from andon.files.meshes.gltf.clips import Clip
from andon.quantities import Geometry
from andon.surface.placing import middle_of, placed, placed_vertices

__all__ = ["Mover", "Play"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Play:
    """A clip as a scene plays it.

    Attributes
    ----------
    mesh, clip : what plays.
    start_seconds : session time at which it starts; before, the pose that it starts with is held.
    speed : 1: as in the file; below 0: from its end backwards.
    loop : starts again when it is through; else the pose that it ends with is held.
    """

    mesh: AnimatedMesh
    clip: Clip
    start_seconds: float = 0.0
    speed: float = 1.0
    loop: bool = True

    def clip_seconds(self, time_seconds: float, /) -> float:
        """Time of the clip, 0 to its duration, at a time of the session."""
        duration = self.clip.duration_seconds
        if duration <= 0:
            return 0.0
        gone = max(0.0, time_seconds - self.start_seconds) * abs(self.speed)
        gone = gone % duration if self.loop else min(gone, duration)
        return duration - gone if self.speed < 0 else gone


class Mover:
    """A virtual object that moves.

    Parameters
    ----------
    geometry : in the object's own frame, metres, in its pose of rest.
    placement : session time in seconds → (4, 4) world_from_object; always mirrored, or never.
    play : the clip that moves its vertices, or None.
    casts_shadow : see `SceneObject`.
    """

    def __init__(
        self,
        geometry: Geometry,
        placement: Callable[[float], Float],
        play: Play | None = None,
        *,
        casts_shadow: bool = True,
    ) -> None:
        self.placement, self.play, self.casts_shadow = placement, play, casts_shadow
        self._rest = geometry
        self._placed = placed(geometry, placement(0.0))
        self._shown: tuple[bytes, float] | None = None
        # Files may hold vertices that no triangle has: they are no part of its box.
        self._used = np.unique(geometry.triangles)

    @property
    def geometry(self) -> Geometry:
        """Its triangles and materials, where it was asked for last."""
        return self._placed

    @property
    def middle(self) -> Float:
        """(3,) metres, the middle of its bounding box, where it was asked for last."""
        return middle_of(self._placed.positions[self._used])

    def at(self, time_seconds: float, /) -> Geometry:
        """Where it is at a time of the session; the same object as before if it did not move."""
        world_from_object = self.placement(time_seconds)
        seconds = 0.0 if self.play is None else self.play.clip_seconds(time_seconds)
        state = (world_from_object.tobytes(), seconds)
        if state != self._shown:
            positions, normals = self._rest.positions, self._rest.normals
            if self.play is not None:
                positions, normals = self.play.mesh.pose(self.play.clip, seconds)
            positions, normals = placed_vertices(positions, normals, world_from_object)
            self._placed = replace(self._placed, positions=positions, normals=normals)
            self._shown = state
        return self._placed
