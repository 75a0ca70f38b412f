"""A bake of 64 tasks by Radiance: over one process and two, here and on a Dask cluster."""

from __future__ import annotations

import importlib
import shutil
from collections.abc import Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, Literal

import numpy as np

from andon.bake.tasks import (
    Bundle,
    DaskWorkers,
    LocalWorkers,
    Store,
    Task,
    Workers,
    bundle_digest,
    run_tasks,
    write_bundle,
)
from andon.bench.registry import BenchRow, Duel
from andon.errors import MachineError
from andon.verify.registry import NotShown

__all__ = ["ROWS", "traced"]

Side = Literal["loop", "local_1", "local_2", "dask_2"]

TASKS, POINTS = 64, 400
BOUNCES = 1
# Both sides take seconds, and start processes each time.
REPEATS = 3

WORDS: dict[Side, str] = {
    "loop": "the same work in a loop, nothing kept",
    "local_1": "one local worker",
    "local_2": "two local workers",
    "dask_2": "a local Dask cluster, two workers",
}


def traced(inputs: Mapping[str, Path], settings: Mapping[str, Any], /) -> bytes:
    """Work: lux at `POINTS` points of the furnished room's floor, float32."""
    from andon.transport.baked.radiance.quality import QUALITIES
    from andon.transport.baked.radiance.trace import traced_illuminance

    places = np.random.default_rng(settings["seed"]).uniform(-1.0, 1.0, (POINTS, 3))
    places[:, 1] = 0.0
    up = np.broadcast_to(np.array([0.0, 1.0, 0.0]), places.shape)
    lux = traced_illuminance(
        inputs["world"], places, up, quality=QUALITIES["draft"], bounces=BOUNCES
    )
    return lux.astype("<f4").tobytes()


def _world() -> Bundle:
    from andon.lamps import PolygonLamp
    from andon.transport.baked.radiance import radiance_bundle
    from andon.verify.setting import room

    corners = np.array([(-0.4, 2.9, -0.3), (0.4, 2.9, -0.3), (0.4, 2.9, 0.3), (-0.4, 2.9, 0.3)])
    lamp = PolygonLamp("panel", np.array([460.0, 330.0, 200.0]), corners, drawn=False)
    return radiance_bundle([room()], [lamp], tiles=1)


class _Bakes:
    """Bakes of the same tasks, each from nothing."""

    def __init__(self, stack: ExitStack) -> None:
        self.bundle = _world()
        digest = bundle_digest(self.bundle)
        self.tasks = [
            Task(f"part {n}", "andon.bench.bake:traced", {"world": digest}, {"seed": n})
            for n in range(TASKS)
        ]
        self.bundles = {digest: self.bundle}
        self.folder = Path(mkdtemp(prefix="andon-bench-"))
        stack.callback(shutil.rmtree, self.folder, ignore_errors=True)
        self.world = self.folder / "world"
        write_bundle(self.world, self.bundle)

    def loop(self) -> list[bytes]:
        """Without any of it."""
        return [traced({"world": self.world}, task.settings) for task in self.tasks]

    def baked(self, workers: Workers) -> list[bytes]:
        """With a store, and workers that are started if they are local."""
        store = Store(self.folder / "bake", ".lux")
        try:
            run_tasks(self.tasks, self.bundles, store, workers=workers)
            return [store.path(task.key).read_bytes() for task in self.tasks]
        finally:
            shutil.rmtree(store.folder, ignore_errors=True)


def _cluster(stack: ExitStack) -> DaskWorkers:
    """Two workers on this machine, which run before anything is timed."""
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise NotShown("Dask is missing; pip install andon[cluster]") from error
    cluster = stack.enter_context(
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        )
    )
    return DaskWorkers(cluster.scheduler_address)


def _duel(ours: Side, peer: Side) -> Duel:
    """The same bytes from both, or no time is given."""
    stack = ExitStack()
    try:
        bakes = _Bakes(stack)

        def step(side: Side) -> partial[list[bytes]]:
            if side == "loop":
                return partial(bakes.loop)
            workers = _cluster(stack) if side == "dask_2" else LocalWorkers(int(side[-1]))
            return partial(bakes.baked, workers)

        ours_step, peer_step, truth = step(ours), step(peer), bakes.loop()
        same = [a == b == c for a, b, c in zip(ours_step(), peer_step(), truth, strict=True)]
    except BaseException as error:
        stack.close()
        if isinstance(error, MachineError):
            raise NotShown(str(error)) from error
        raise
    return Duel(
        ours_step,
        peer_step,
        sum(same) / TASKS,
        1.0,
        f"{WORDS[ours]}; {TASKS} tasks of Radiance",
        close=stack.close,
        peer_repeats=REPEATS,
        ours_repeats=REPEATS,
    )


def _row(ours: Side, peer: Side) -> BenchRow:
    return BenchRow(
        f"baked.tasks.{ours}.{peer}", "baked", WORDS[peer], TASKS * POINTS,
        partial(_duel, ours, peer),
    )  # fmt: skip


ROWS: tuple[BenchRow, ...] = (
    _row("local_1", "loop"),
    _row("local_2", "local_1"),
    _row("dask_2", "local_1"),
    _row("dask_2", "local_2"),
)
