"""What is to be said of a bake of maps."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from andon.bake.maps.plan import MapsPlan

__all__ = ["BakedMapsReport"]


@dataclass(frozen=True)
class BakedMapsReport:
    """Maps on disk.

    Attributes
    ----------
    folder : with ``maps.json``.
    plan : what was baked.
    tasks : different ones; a map that several moments share is made once.
    computed, kept : tasks done now, and those that earlier bakes had done.
    damaged : kept files that were not whole, and were made again.
    removed : files of earlier bakes that no map is in any more.
    elapsed_seconds, work_seconds : by the clock, and of all workers together.
    workers : how many; 0: there was nothing to do.
    disk_bytes : of the maps.
    """

    folder: Path
    plan: MapsPlan
    tasks: int
    computed: int
    kept: int
    damaged: int
    removed: int
    elapsed_seconds: float
    work_seconds: float
    workers: int
    disk_bytes: int
