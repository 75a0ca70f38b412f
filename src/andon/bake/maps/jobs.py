"""The tasks of a bake: one for what each camera sees at each moment, one for each lamp on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from andon.bake.maps.bundles import Bundles
from andon.bake.maps.plan import Planned
from andon.bake.maps.work import (
    GEOMETRY,
    LIGHT,
    VERSION,
    points_bundle,
    quality_settings,
    view_settings,
)
from andon.bake.tasks.model import Bundle, Task
from andon.engines.digest import digest
from andon.files.radiance_programs import radiance_version
from andon.lamps import Lamp
from andon.quantities import Photometry
from andon.spaces import View
from andon.transport.baked.radiance.lamps import is_distant_glow
from andon.transport.baked.radiance.scene import radiance_bundle

__all__ = ["Jobs", "jobs_of"]


@dataclass(eq=False)
class Jobs:
    """All tasks of a bake, and which map each makes.

    Attributes
    ----------
    geometry : (camera, moment) → task; numbers count in the plan's lists.
    light : (lamp, camera, moment) → task.
    bundles : what they read.
    """

    geometry: dict[tuple[int, int], Task] = field(default_factory=dict[tuple[int, int], Task])
    light: dict[tuple[str, int, int], Task] = field(
        default_factory=dict[tuple[str, int, int], Task]
    )
    bundles: Bundles = field(default_factory=Bundles)

    @property
    def tasks(self) -> list[Task]:
        """Moment after moment, and in each lamp after lamp: what a lamp lights is the largest of
        what tasks read, and is kept while they follow each other. Geometry is the first: it is
        quick, and shows early that the folder can be written.
        """
        geometry = [
            ((moment, -1, camera), task) for (camera, moment), task in self.geometry.items()
        ]
        numbers = {
            lamp: number for number, lamp in enumerate({lamp: 0 for lamp, _, _ in self.light})
        }
        light = [
            ((moment, numbers[lamp], camera), task)
            for (lamp, camera, moment), task in self.light.items()
        ]
        return [task for _, task in sorted([*geometry, *light], key=lambda each: each[0])]


def jobs_of(
    planned: Planned,
    photometry: Photometry,
    /,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> Jobs:
    """The tasks of a plan; what they read is made once here, to be named.

    `progress` is told after each moment how many are ready, and of how many. Raises `InputError`
    for what Radiance cannot be told, `MachineError` where its programs fail.
    """
    jobs = Jobs()
    maker = _Maker(planned, photometry, jobs.bundles)
    for moment, seconds in enumerate(planned.plan.moments):
        worlds = maker.worlds(seconds)
        for camera, view in enumerate(planned.plan.views):
            points = maker.points(view, seconds)
            where = f"{view.name}, {seconds:g} s"
            jobs.geometry[camera, moment] = Task(
                f"geometry, {where}", GEOMETRY, {"points": points}, version=VERSION
            )
            for lamp, (world, direct_bounces) in worlds.items():
                jobs.light[lamp, camera, moment] = Task(
                    f"{lamp}, {where}",
                    LIGHT,
                    {"world": world, "points": points},
                    maker.settings(lamp, view, direct_bounces),
                    VERSION,
                )
        if progress is not None:
            progress(moment + 1, len(planned.plan.moments))
    return jobs


class _Maker:
    """Names what tasks read."""

    def __init__(self, planned: Planned, photometry: Photometry, bundles: Bundles) -> None:
        self.plan, self.world, self.include = planned.plan, planned.world, planned.include
        self.bundles, self.photometry = bundles, photometry
        self.programs = radiance_version()
        self.still = digest(list(self.world.still))

    def settings(self, lamp: str, view: View, direct_bounces: int) -> dict[str, object]:
        return {
            "view": view_settings(view),
            "quality": quality_settings(self.plan.quality.name),
            "bounces": self.plan.bounces,
            "part": self.plan.parts[lamp],
            "direct_bounces": direct_bounces,
            "photometry": self.photometry,
            "radiance": self.programs,
        }

    def worlds(self, seconds: float) -> dict[str, tuple[str, int]]:
        """Lamp → the bundle of what it lights at a time, and the ``-ab`` of its own light."""
        stands = self._standing(seconds)
        bodies = digest(self.world.bodies(seconds))
        found: dict[str, tuple[str, int]] = {}
        for name, lamps in self.world.lamps(seconds).items():
            source = digest("world", stands, bodies, name, lamps, self.plan.quality.tiles)
            bundle = self.bundles.add(source, partial(self._world, name, seconds))
            found[name] = bundle, _direct_bounces(lamps)
        return found

    def points(self, view: View, seconds: float) -> str:
        """The bundle of what a view sees at a time."""
        source = digest("points", self._seen(seconds), view.name)
        return self.bundles.add(source, partial(self._points, view, seconds))

    def _world(self, name: str, seconds: float) -> Bundle:
        lamps = self.world.lamps(seconds)[name]
        parts, bodies = self.world.parts(seconds), self.world.bodies(seconds)
        tiles = self.plan.quality.tiles
        return radiance_bundle(parts, lamps, bodies, include=self.include, detail_tiles=tiles)

    def _points(self, view: View, seconds: float) -> Bundle:
        return points_bundle(self.world.seen(view, seconds))

    def _standing(self, seconds: float) -> str:
        """The name of what Radiance is told of surfaces."""
        return digest(self.still, list(self.world.moving(seconds)))

    def _seen(self, seconds: float) -> str:
        """The name of what moves before the cameras; all else they see stands still."""
        return digest([mover.at(seconds) for mover in self.world.prepared.surface.movers])


def _direct_bounces(lamps: tuple[Lamp, ...]) -> int:
    """Rays of the hemisphere find a sky of glow; every other lamp is aimed at."""
    return int(any(is_distant_glow(lamp) for lamp in lamps))
