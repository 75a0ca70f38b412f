"""A bake from a scene file to the volume that it names."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from andon.bake.bake import DEFAULT_STATE, bake_probes
from andon.bake.folders import check_parent, check_writable
from andon.bake.journal import Journal
from andon.bake.panoramas import check_panoramas
from andon.bake.radiance_bounces import forget
from andon.bake.report import BakeReport
from andon.bake.runner import Progress
from andon.bake.states import check_states, joined, planned
from andon.bake.tasks import Workers
from andon.bake.tasks.lock import locked
from andon.engines.reading import read_pictures, view_of
from andon.errors import InputError
from andon.files.volumes import write_volume
from andon.quantities import Geometry
from andon.scene import Scene
from andon.scene.probes import Probes
from andon.surface.load import load_surface
from andon.surface.still import still_geometry
from andon.transport.probes.placement import Placed, Tally, place_probes

__all__ = ["Written", "bake_file", "placed_in", "scene_geometry"]


@dataclass(frozen=True)
class Written:
    """A volume on disk.

    Attributes
    ----------
    path : the file.
    report : of the bake.
    states : all of the file.
    replaced : in what the probes of the volume that was there differed; it is gone. Empty: there
        was none, or it had the same.
    warnings, tally : of the placement.
    """

    path: Path
    report: BakeReport
    states: tuple[str, ...]
    replaced: tuple[str, ...]
    warnings: tuple[str, ...]
    tally: Tally


def bake_file(
    scene: Scene,
    /,
    *,
    engine: str = "auto",
    fresh: bool = False,
    replaces: bool = False,
    progress: Progress | None = None,
    workers: Workers | None = None,
) -> Written:
    """Places and bakes the probes of `scene`, and writes the volume that it names.

    A volume of the same probes that is there keeps its other states; with other probes (places,
    order, zones) it is refused before anything is captured if it has other states, unless
    `replaces`, and is replaced if it has not. Results wait in ``<volume>.bake`` beside it until it
    is written; with `fresh` those of an earlier bake are thrown away. `workers` trace bounces by
    Radiance, see `bake_probes`.

    Raises `InputError` and `MachineError` as `bake_probes` does, where another bake of the volume
    is running, and where it cannot be written; what is there stays as it was then.
    """
    probes, path = _target(scene)
    placed = placed_in(scene)
    check_panoramas(scene, placed)
    plan = planned(scene, probes, placed, probes.state or DEFAULT_STATE)
    folder = path.with_name(path.name + ".bake")
    with locked(folder, of="this volume", remedy="wait for it, or name another probes.volume"):
        check_states(path, plan, replaces=replaces)
        check_writable(folder)
        journal = Journal(folder)
        if fresh:
            journal.clear()
            forget(folder)
        baked = bake_probes(
            scene, placed, engine=engine, progress=progress, folder=folder, workers=workers
        )
        # Once more: bakes wait for each other, but other programs may have put a file there.
        replaced = check_states(path, baked.volume, replaces=replaces)
        volume = joined(path, baked.volume)
        write_volume(path, volume)
        journal.clear()
        forget(folder)
    return Written(
        path, baked.report, tuple(volume.states), replaced, placed.warnings, placed.tally
    )


def _target(scene: Scene) -> tuple[Probes, Path]:
    if scene.probes is None:
        raise InputError("needs a [probes] table", file=scene.file, remedy="add probes.volume")
    path = scene.path(scene.probes.volume, "probes.volume")
    if path.suffix.lower() != ".glb":
        raise InputError(
            f"must end in .glb, got {path.name!r}", file=scene.file, field="probes.volume"
        )
    check_parent(scene, path, "probes.volume")
    return scene.probes, path


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
