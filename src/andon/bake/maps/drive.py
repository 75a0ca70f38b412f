"""A bake of maps from a scene to the folder that it names."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from andon.bake.folders import WRITABLE, check_writable
from andon.bake.maps.jobs import Jobs, jobs_of
from andon.bake.maps.plan import Planned, planned
from andon.bake.maps.report import BakedMapsReport
from andon.bake.tasks import LocalWorkers, Store, TasksProgress, Workers, run_tasks
from andon.bake.tasks.model import Task
from andon.engines.baked_light import map_facts
from andon.errors import InputError
from andon.files.illuminance_maps import (
    MANIFEST,
    BakedLamp,
    Manifest,
    MapFile,
    map_file,
    write_manifest,
)
from andon.scene import Scene

__all__ = ["SUFFIX", "Progress", "bake_maps"]

SUFFIX = ".exr"
# (done, of, what is being done or was last, seconds that are left if that is known)
Progress = Callable[[int, int, str, float | None], None]


def bake_maps(
    scene: Scene,
    /,
    *,
    workers: Workers | None = None,
    progress: Progress | None = None,
    fresh: bool = False,
    trust: bool = False,
) -> BakedMapsReport:
    """Bakes the illuminance maps that the [baked] table of `scene` asks for.

    What earlier bakes have computed and still holds is kept: a bake that was stopped goes on, and
    one of a changed scene computes what changed. ``maps.json`` is written last, so that readers
    find the maps of the bake before until these are complete; then files go that it does not name.

    Parameters
    ----------
    workers : who computes; default: this machine, a process for each core.
    progress : called while inputs are made, and after each task.
    fresh : nothing of earlier bakes is kept.
    trust : Radiance files that the scene includes may start programs.

    Raises
    ------
    InputError
        for all that the scene gets wrong: before anything is computed or written.
    MachineError
        for tasks that failed three times (all others are kept, ``maps.json`` is as it was), where
        another bake of the folder is running, where nothing can be written, and where Radiance's
        programs are missing.
    """
    start = perf_counter()
    plan = planned(scene, trust=trust)
    store = Store(plan.plan.folder, SUFFIX, beside=(MANIFEST, WRITABLE))
    with store.locked():
        check_writable(store.folder)
        if fresh:
            (store.folder / MANIFEST).unlink(missing_ok=True)
            store.clear()
        jobs = _jobs(scene, plan, progress)
        done = run_tasks(
            jobs.tasks,
            jobs.bundles,
            store,
            workers=LocalWorkers() if workers is None else workers,
            progress=_working(progress),
        )
        manifest = _manifest(scene, plan, jobs, store)
        write_manifest(store.folder, manifest)
        removed = store.remove_others({task.key for task in jobs.tasks})
    files = {
        file.name: file.size for file in (*manifest.geometry.values(), *manifest.light.values())
    }
    return BakedMapsReport(
        folder=store.folder,
        plan=plan.plan,
        tasks=done.planned,
        computed=done.computed,
        kept=done.kept,
        damaged=done.damaged,
        removed=removed,
        elapsed_seconds=perf_counter() - start,
        work_seconds=done.seconds,
        workers=done.workers,
        disk_bytes=sum(files.values()),
    )


def _jobs(scene: Scene, plan: Planned, progress: Progress | None) -> Jobs:
    try:
        return jobs_of(plan, scene.photometry, progress=_preparing(progress))
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(
            error.rule, file=scene.file, field=error.field, remedy=error.remedy
        ) from error


def _preparing(progress: Progress | None) -> Callable[[int, int], None] | None:
    if progress is None:
        return None
    return lambda done, of: progress(done, of, "what lamps light", None)


def _working(progress: Progress | None) -> Callable[[TasksProgress], None] | None:
    if progress is None:
        return None
    return lambda now: progress(now.done, now.of, now.name or "maps", now.seconds_left)


def _manifest(scene: Scene, planned: Planned, jobs: Jobs, store: Store) -> Manifest:
    plan, files = planned.plan, _Files(store)
    return Manifest(
        cameras=plan.views,
        moments=plan.moments,
        lamps=tuple(BakedLamp(name, part) for name, part in plan.parts.items()),
        geometry={place: files.of(task) for place, task in jobs.geometry.items()},
        light={place: files.of(task) for place, task in jobs.light.items()},
        quality=plan.quality.name,
        bounces=plan.bounces,
        photometry=scene.photometry,
        facts=_facts(planned),
        generator=_generator(),
    )


class _Files:
    """What a manifest says of artefacts; each is read once."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._known: dict[str, MapFile] = {}

    def of(self, task: Task) -> MapFile:
        if task.key not in self._known:
            path = self._store.path(task.key)
            self._known[task.key] = map_file(path.name, path.read_bytes())
        return self._known[task.key]


def _facts(planned: Planned) -> dict[str, str]:
    """What the light depends on; frames compare it with theirs."""
    prepared = planned.world.prepared
    return map_facts(
        planned.world.scene,
        prepared.surface,
        prepared.lamps(0.0),
        moments=planned.plan.moments,
        frames=prepared.frames,
        ambient=prepared.ambient,
        measured=prepared.measured,
    )


def _generator() -> str:
    from andon import __version__

    return f"Andon {__version__}"
