"""A bake from a scene file to the volume that it names."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from andon.bake.bake import Baked, bake_probes
from andon.bake.journal import Journal
from andon.bake.report import BakeReport
from andon.bake.runner import Progress
from andon.engines.reading import read_pictures, view_of
from andon.errors import InputError
from andon.files.atomic import write_bytes
from andon.files.volumes import ProbeVolume, read_volume, rounded, write_volume
from andon.quantities import Geometry
from andon.scene import Scene
from andon.surface.load import load_surface
from andon.surface.still import still_geometry
from andon.transport.probes.placement import Placed, place_probes
from andon.transport.probes.states import with_state

__all__ = ["Written", "bake_file", "placed_in", "scene_geometry"]


@dataclass(frozen=True)
class Written:
    """A volume on disk.

    Attributes
    ----------
    path : the file.
    report : of the bake.
    states : all of the file.
    replaced : there was a volume of other probes, which is gone.
    warnings : of the placement.
    """

    path: Path
    report: BakeReport
    states: tuple[str, ...]
    replaced: bool
    warnings: tuple[str, ...]


def bake_file(
    scene: Scene,
    /,
    *,
    engine: str = "auto",
    fresh: bool = False,
    progress: Progress | None = None,
) -> Written:
    """Places and bakes the probes of `scene`, and writes the volume that it names.

    A volume of the same probes that is there keeps its other states; one of other probes is
    replaced. Results wait in ``<volume>.bake`` beside it until it is written; with `fresh` those
    of an earlier bake are thrown away.

    Raises `InputError` and `MachineError` as `bake_probes` does, and where the volume cannot be
    written; what is there stays as it was then.
    """
    if scene.probes is None:
        raise InputError("needs a [probes] table", file=scene.file, remedy="add probes.volume")
    path = scene.path(scene.probes.volume, "probes.volume")
    if path.suffix.lower() != ".glb":
        raise InputError(
            f"must end in .glb, got {path.name!r}", file=scene.file, field="probes.volume"
        )
    if not path.parent.is_dir():
        raise InputError(
            f"the folder {str(path.parent)!r} does not exist",
            file=scene.file,
            field="probes.volume",
            remedy="make it",
        )
    folder = path.with_name(path.name + ".bake")
    _check_folder(folder)
    journal = Journal(folder)
    if fresh:
        journal.clear()
    placed = placed_in(scene)
    baked = bake_probes(scene, placed, engine=engine, progress=progress, folder=folder)
    volume, replaced = _joined(path, baked)
    write_volume(path, volume)
    journal.clear()
    return Written(path, baked.report, tuple(volume.states), replaced, placed.warnings)


def _check_folder(folder: Path) -> None:
    """A full or read-only disk is known before the first hour, not after it."""
    if not folder.is_dir():
        Journal(folder).put("0", {"writable": np.zeros(1)})
    else:
        write_bytes(folder / "0.probe", b"writable")


def placed_in(scene: Scene, /) -> Placed:
    """Where the probes of a scene go."""
    return place_probes(scene, scene_geometry(scene))


def scene_geometry(scene: Scene, /) -> Geometry:
    """What stands still in the scene; a depth image is seen from its own camera.

    Needs no volume. Raises `InputError` for files at fault.
    """
    if scene.surface is None or scene.surface.mesh is not None:
        return still_geometry(scene)
    pictures = read_pictures(scene)
    views = {name: view_of(scene, name, picture.shape) for name, picture in pictures.items()}
    return still_geometry(scene, real=load_surface(scene, views).real)


def _joined(path: Path, baked: Baked) -> tuple[ProbeVolume, bool]:
    """The volume with the other states of the file, if its probes are the same."""
    volume = baked.volume
    if not path.exists():
        return volume, False
    old = read_volume(path)
    if not _same_probes(old, rounded(volume)):
        return volume, True
    for name, coefficients in volume.states.items():
        old = with_state(old, name, coefficients)
    return replace(volume, states=old.states, notes={**old.notes, **volume.notes}), False


def _same_probes(old: ProbeVolume, new: ProbeVolume) -> bool:
    pairs = [
        (old.positions, new.positions),
        (old.capture_positions, new.capture_positions),
        (old.ranges_m, new.ranges_m),
    ]
    words = [
        (old.names, new.names),
        (old.roles, new.roles),
        (old.order, new.order),
        (old.photometry, new.photometry),
        ([zone.name for zone in old.zones], [zone.name for zone in new.zones]),
    ]
    return all(np.array_equal(a, b) for a, b in pairs) and all(a == b for a, b in words)
