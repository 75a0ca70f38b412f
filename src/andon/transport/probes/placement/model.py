"""Placed probes, before anything is captured."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes.model import ProbeRole

__all__ = ["Panorama", "Placed", "Tally"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Panorama:
    """A picture that stands for what a probe would capture.

    Attributes
    ----------
    reference : the file, relative to the scene's folder and confined to it.
    field : where the scene names it, for messages.
    heading_degrees : turn around +Y, from −Z towards +X.
    luminance_per_unit : cd/m² of its linear value 1, > 0.
    white : (3,) its linear values of a neutral surface, > 0.
    """

    reference: str
    field: str
    heading_degrees: float = 0.0
    luminance_per_unit: float = 1.0
    white: tuple[float, float, float] = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Tally:
    """What became of the places that were asked for.

    Attributes
    ----------
    merged : probes that lay where another one does, and are left out.
    in_walls : names of probes that are kept and lie inside walls: those that were placed by hand.
    near_walls : names of those placed by hand, not inside walls, that lie nearer to a surface than
        a centimetre.
    moved : generated probes that were taken out of a wall, or away from a surface.
    dropped_in_walls : generated probes with no free place near, and places inside walls that were
        passed over.
    too_near : generated probes, and places passed over, that lie nearer to a surface than the
        offset and have no place near that does not.
    hidden : places off a vertex that another wall hides from it, passed over.
    crowded : places nearer to a probe than the least distance, passed over.
    """

    merged: int = 0
    in_walls: tuple[str, ...] = ()
    near_walls: tuple[str, ...] = ()
    moved: int = 0
    dropped_in_walls: int = 0
    too_near: int = 0
    hidden: int = 0
    crowded: int = 0


@dataclass(frozen=True, eq=False)
class Placed:
    """Where probes go, and why.

    Attributes
    ----------
    positions : (n, 3) where they count, metres, world; as float32 holds them, as do files.
    capture_positions : (n, 3) where they are captured, metres, world.
    names : n, unique.
    roles : n.
    ranges_m : (n,) farthest surface captured, metres; inf: no limit.
    panoramas : n; None: captured from the scene.
    tally : what was merged, moved and dropped.
    warnings : what whoever placed them should know, one sentence each.
    """

    positions: Float
    capture_positions: Float
    names: tuple[str, ...]
    roles: tuple[ProbeRole, ...]
    ranges_m: Float
    panoramas: tuple[Panorama | None, ...]
    tally: Tally = field(default_factory=Tally)
    warnings: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Probes."""
        return len(self.positions)
