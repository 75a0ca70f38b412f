"""Bounces by Radiance: one pass that asks for all of them, at the points that probes see.

Through probes each bounce takes a pass over all of them and sees what the one before has left in
the air: nine coefficients of luminance at a few places. Radiance follows the light from surface to
surface instead, so its cost grows with what is asked, not with how often light is reflected, and
errors of the lookup do not feed each other. It is the slower way, and the one that says how good
the other is.

A probe's pass is a function of the points that it sees and of Radiance's scenes, both files: it
runs on any machine, and the same files give the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Self

import numpy as np
from numpy.typing import NDArray

from andon.bake.journal import Result
from andon.bake.radiance_points import VERSION, WORK, gathered, points_bundle
from andon.bake.runner import Runner
from andon.bake.task import Look
from andon.bake.tasks import (
    Store,
    Task,
    TasksProgress,
    Workers,
    bundle_digest,
    run_tasks,
    write_bundle,
)
from andon.engines.cubes_radiance import SeenPoints, light_scenes, seen_points
from andon.engines.digest import digest
from andon.files.radiance_programs import radiance_version
from andon.harmonics import cube_directions
from andon.scene.probes import Probes
from andon.transport.baked.radiance.quality import QUALITIES
from andon.transport.probes.capture import Seen, captured
from andon.transport.probes.placement import Placed

__all__ = ["RadianceBounces", "bounce_notes", "forget", "traced_light"]

Float = NDArray[np.float64]

# What of it people are told.
WHAT = "bounces by Radiance"
# The folder of what workers have traced, beside the results, and how its files end.
TRACED, SUFFIX = "traced", ".npy"
# Probes whose points are in memory at once, 0.3 MB each, when workers trace.
CHUNK = 256


class RadianceBounces:
    """The pass of a bake.

    Parameters
    ----------
    small : takes the pictures whose points are lit.
    placed : the probes.
    quality : a name of `QUALITIES`.
    bounces : see `light_scenes`.

    Raises `InputError` for a scene that Radiance cannot be told, see `light_scenes`.
    """

    def __init__(self, small: Look, placed: Placed, quality: str, bounces: int) -> None:
        self.small, self.placed = small, placed
        self.quality, self.bounces = QUALITIES[quality], bounces
        self.scenes = light_scenes(small.setting, bounces)
        sums = {name: bundle_digest(files) for name, files in self.scenes.items()}
        self.name = digest(
            "radiance", VERSION, radiance_version(), self.quality, bounces, small.size, sums
        )
        self._folders: dict[str, Path] = {}
        self._traced: dict[int, Path] = {}

    @contextmanager
    def written(self) -> Generator[Self]:
        """Itself, with Radiance's scenes in files meanwhile: `reflected` reads them."""
        with TemporaryDirectory(prefix="andon-probes-") as folder:
            self._folders = {
                name: write_bundle(Path(folder) / name, files)
                for name, files in self.scenes.items()
            }
            yield self

    def trace(
        self, indices: Sequence[int], folder: Path, workers: Workers, done: Callable[[], None], /
    ) -> None:
        """Has `workers` trace the light of probes, which `reflected` finds then.

        It is kept in `folder` until somebody removes it; what is there is not traced again.
        `done` is called after each probe. Raises `MachineError` as `run_tasks` does.
        """
        scenes = {bundle_digest(files): files for files in self.scenes.values()}
        store = Store(folder, SUFFIX)
        for first in range(0, len(indices), CHUNK):
            bundles, tasks = dict(scenes), dict[int, Task]()
            for index in indices[first : first + CHUNK]:
                points = points_bundle(self._points(index)[1])
                bundles[bundle_digest(points)] = points
                tasks[index] = self._task(index, bundle_digest(points))
            count = 0

            def tell(state: TasksProgress) -> None:
                nonlocal count
                for _ in range(state.done - count):
                    done()
                count = state.done

            run_tasks(list(tasks.values()), bundles, store, workers=workers, progress=tell)
            for index, task in tasks.items():
                if (path := store.get(task.key)) is not None:
                    self._traced[index] = path

    def _task(self, index: int, points: str) -> Task:
        sums = {name: bundle_digest(files) for name, files in self.scenes.items()}
        return Task(
            f"probe {self.placed.names[index]}",
            WORK,
            {"points": points} | sums,
            {
                "quality": self.quality.name,
                "options": digest(self.quality),
                "bounces": self.bounces,
                "radiance": radiance_version(),
            },
            VERSION,
        )

    def reflected(self, index: int, /) -> Result:
        """What surfaces around a probe reflect of light that was reflected, or emitted, (k, 3)."""
        seen, points = self._points(index)
        if index in self._traced:
            lux = np.load(self._traced[index], allow_pickle=False)
        else:
            lux = gathered(
                self._folders,
                points.position,
                points.normal,
                quality=self.quality,
                bounces=self.bounces,
            )
        return self._result(index, seen, points.spread(lux))

    def _points(self, index: int) -> tuple[Seen, SeenPoints]:
        seen, _ = self.small.engine.look(self.placed.capture_positions[index], lit=False)
        return seen, seen_points(seen, float(self.placed.ranges_m[index]))

    def _result(self, index: int, seen: Seen, lux: Float) -> Result:
        small = self.small
        capture = captured(
            seen,
            cube_directions(small.size),
            replace(small.setting.lighting, sky=()),
            lux=lux,
            range_m=float(self.placed.ranges_m[index]),
        )
        return {"reflected": small.projected(capture.reflected_cd_m2)}


def traced_light(
    runner: Runner,
    small: Look,
    placed: Placed,
    probes: Probes,
    own: Sequence[int],
    key: Callable[[int], str],
    /,
    workers: Workers | None = None,
) -> Float:
    """(m, k, 3) what surfaces reflect around the probes `own` (m,), each kept under its `key`.

    `workers` do the tracing; None: this process, one probe after the other. The light is the same.
    Raises `InputError` as `RadianceBounces` does, `MachineError` as `Runner.each` and `run_tasks`
    do.
    """

    def kept_as(index: int) -> str:
        return digest(traced.name, key(index))

    bounces = RadianceBounces(small, placed, probes.bounces_quality, probes.bounces)
    with bounces.written() as traced:
        if workers is not None:
            with _beside(runner.journal.folder) as folder:
                lost = [index for index in own if not runner.journal.has(kept_as(index))]
                runner.advance(len(own) - len(lost), WHAT)
                traced.trace(lost, folder, workers, lambda: runner.advance(1, WHAT))
                results = runner.each(WHAT, own, kept_as, traced.reflected)
            forget(runner.journal.folder)
        else:
            results = runner.each(WHAT, own, kept_as, traced.reflected)
    return np.stack([result["reflected"] for result in results])


@contextmanager
def _beside(folder: Path | None, /) -> Generator[Path]:
    """Where traced light waits: beside the results in `folder`, or nowhere that lasts."""
    if folder is not None:
        yield folder / TRACED
        return
    with TemporaryDirectory(prefix="andon-traced-") as name:
        yield Path(name)


def forget(folder: Path | None, /) -> None:
    """Throws away what workers have traced for the results in `folder`."""
    if folder is None or not (folder / TRACED).is_dir():
        return
    store = Store(folder / TRACED, SUFFIX)
    with store.locked():
        store.clear()
    with suppress(OSError):  # gone already, or somebody's files are in it
        (folder / TRACED).rmdir()


def bounce_notes(probes: Probes, /) -> dict[str, str]:
    """What a volume says of who computed its bounces, where it was not the probes."""
    if probes.bounces_by == "probes":
        return {}
    return {"bounces_by": probes.bounces_by, "bounces_quality": probes.bounces_quality}
