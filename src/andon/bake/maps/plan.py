"""What a bake will do: cameras, moments, lamps, and how long that takes, about."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from andon.bake.folders import check_parent
from andon.bake.maps.cameras import found_views, stated_views, watching_views
from andon.bake.maps.moments import moments_of
from andon.bake.maps.world import BakedWorld
from andon.engines.baked_light import part_of
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.radiance_text import read_included
from andon.quantities import Geometry
from andon.scene import Scene
from andon.scene.ambient import Baked
from andon.spaces import View
from andon.transport.baked.model import Part
from andon.transport.baked.placement import Suggested
from andon.transport.baked.radiance.bodies import unsaid
from andon.transport.baked.radiance.quality import QUALITIES, Quality

__all__ = ["MapsPlan", "Planned", "plan_maps", "planned", "searched_cameras"]


@dataclass(frozen=True, eq=False)
class MapsPlan:
    """What a bake of a scene is.

    Attributes
    ----------
    folder : of the maps.
    views : where the maps are seen from.
    seen : for each view its share of pixels that show a surface, 0…1, at the first moment.
    coverage : share of the surface that views that were found see together; None: they are those
        of [[baked.camera]].
    moments : seconds.
    parts : name of each baked lamp → what of its light is baked.
    quality : how exactly.
    bounces : how often light is reflected.
    unsaid : what frames compute otherwise than Radiance does, a sentence for each lamp of which
        there is something to say.
    """

    folder: Path
    views: tuple[View, ...]
    seen: tuple[float, ...]
    coverage: float | None
    moments: tuple[float, ...]
    parts: dict[str, Part]
    quality: Quality
    bounces: int
    unsaid: tuple[str, ...] = ()

    @property
    def light_tasks(self) -> int:
        """Maps of light: one for each lamp, camera and moment."""
        return len(self.parts) * len(self.views) * len(self.moments)

    @property
    def points(self) -> int:
        """On which light is computed, all maps together, about."""
        once = sum(
            share * view.width * view.height
            for share, view in zip(self.seen, self.views, strict=True)
        )
        return round(once * len(self.parts) * len(self.moments))

    @property
    def estimated_seconds(self) -> float:
        """Of one core, if nothing is done yet; within a factor of some three.

        Rays cost what the room costs: the figure lies between those of a furnished room and of one
        lit by a lantern of paper, which take 2.3 times less and more.
        """
        return self.points / 1e5 * self.quality.seconds_per_100k_points


@dataclass(frozen=True, eq=False)
class Planned:
    """A plan with all that it needs read."""

    plan: MapsPlan
    world: BakedWorld
    include: dict[str, bytes]


def plan_maps(scene: Scene, /, *, trust: bool = False) -> MapsPlan:
    """What `bake_maps` would do; nothing is computed, nothing written.

    Raises `InputError` as `bake_maps` does.
    """
    return planned(scene, trust=trust).plan


def planned(scene: Scene, /, *, trust: bool = False) -> Planned:
    """The plan of a bake and what it is of. Raises `InputError` for all that the scene gets wrong.

    `trust` : included Radiance files may start programs.
    """
    baked = _table(scene)
    _check_skies(scene, baked)
    folder = _folder(scene, baked)
    included = [
        scene.path(name, f"baked.include[{number}]") for number, name in enumerate(baked.include)
    ]
    include = read_included(included, trust=trust)
    moments = moments_of(scene)
    stated = stated_views(scene, baked)
    world = BakedWorld(scene, prepare(scene, drawn=False))
    views, coverage = stated, None
    if not stated:
        found = _found(scene, baked, world, world.visible(0.0))
        views, coverage = found.views, found.coverage
    seen = tuple(
        _seen_share(scene, world, view, number, moments) for number, view in enumerate(views)
    )
    transports = {table.name: table.transport for table in scene.lamp}
    parts: dict[str, Part] = {name: _part(transports[name]) for name in baked.lamps}
    quality = QUALITIES[baked.quality]
    shining = [lamp for lamps in world.lamps(0.0).values() for lamp in lamps]
    differs = unsaid(shining, world.bodies(0.0))
    plan = MapsPlan(folder, views, seen, coverage, moments, parts, quality, baked.bounces, differs)
    return Planned(plan, world, include)


def _check_skies(scene: Scene, baked: Baked) -> None:
    """Refuses a sky of which the maps have what is reflected alone: in Radiance walls hide it."""
    for index, table in enumerate(scene.lamp):
        is_sky = table.kind in ("sky", "hemisphere")
        if is_sky and table.transport == "direct+bounce" and table.name in baked.lamps:
            raise InputError(
                f"the {table.kind} {table.name!r} has no shadow in frames, and what walls hide of "
                "it would be in its direct light and not in what is reflected",
                file=scene.file,
                field=f"lamp[{index}].transport",
                remedy='state transport = "baked": then its maps have all of it',
            )


def searched_cameras(scene: Scene, /) -> tuple[Geometry, Suggested]:
    """What maps see, and the cameras that a bake finds for it where the scene states none.

    Raises `InputError` without [baked], and where nothing can be seen.
    """
    if scene.baked is None:
        raise _missing(scene)
    world = BakedWorld(scene, prepare(scene, drawn=False))
    geometry = world.visible(0.0)
    return geometry, _found(scene, scene.baked, world, geometry)


def _found(scene: Scene, baked: Baked, world: BakedWorld, geometry: Geometry) -> Suggested:
    prepared = world.prepared
    shapes = {name: frame.view.shape for name, frame in prepared.frames.items()}
    one_sided = bool(prepared.surface.depth)
    return found_views(scene, baked, geometry, watching_views(scene, shapes), one_sided=one_sided)


def _part(transport: str) -> Part:
    part = part_of(transport)
    assert part is not None  # the scene's own rules
    return part


def _table(scene: Scene) -> Baked:
    if scene.baked is None:
        raise _missing(scene)
    if not scene.baked.lamps:
        raise InputError(
            "names no lamp, so there is no light to bake",
            file=scene.file,
            field="baked.lamps",
            remedy="name lamps whose transport is 'baked' or 'direct+bounce'",
        )
    for index, name in enumerate(scene.baked.lamps):
        if name in scene.baked.lamps[:index]:
            raise InputError(
                f"names {name!r} twice", file=scene.file, field=f"baked.lamps[{index}]"
            )
    return scene.baked


def _missing(scene: Scene) -> InputError:
    return InputError(
        "is missing: nothing says what to bake",
        file=scene.file,
        field="baked",
        remedy='add [baked] with folder = "maps" and lamps = ["…"]',
    )


def _folder(scene: Scene, baked: Baked) -> Path:
    folder = scene.path(baked.folder, "baked.folder")
    if folder.exists() and not folder.is_dir():
        raise InputError(
            f"must be a folder, and {folder.name!r} is a file",
            file=scene.file,
            field="baked.folder",
            remedy="choose another name",
        )
    check_parent(scene, folder, "baked.folder")
    return folder


def _seen_share(
    scene: Scene, world: BakedWorld, view: View, number: int, moments: tuple[float, ...]
) -> float:
    """Of pixels with a surface; 0 only where the view sees one later. Refuses a blind camera."""
    first = 0.0
    for index, moment in enumerate(moments):
        share = float(world.seen(view, moment).valid.mean())
        first = share if index == 0 else first
        if share > 0:
            return first
    raise InputError(
        "sees no surface",
        file=scene.file,
        field=f"baked.camera[{number}]",
        remedy="look_at a place on the surface, from where nothing is before it",
    )
