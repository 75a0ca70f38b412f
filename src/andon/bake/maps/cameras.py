"""Where maps are seen from: the cameras that [baked] states, or those that see most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from andon.engines.reading import view_names_of, view_of
from andon.errors import InputError
from andon.files.cameras import read_camera
from andon.quantities import Geometry
from andon.scene import Scene
from andon.scene.ambient import Baked
from andon.spaces import View
from andon.transport.baked.placement import Suggested, suggested_views

__all__ = ["MOST_PIXELS", "found_views", "map_name", "stated_views", "watching_views"]

# Of a map. Beyond it a task would need more memory than a worker may be expected to have.
MOST_PIXELS = 4096 * 4096


def map_name(number: int, /) -> str:
    """What camera `number`, from 0, is called; never as a view of the rig is."""
    return f"camera-{number + 1}"


def stated_views(scene: Scene, baked: Baked, /) -> tuple[View, ...]:
    """The views of [[baked.camera]], in their order; without distortion.

    Raises `InputError` for cameras and camera files at fault.
    """
    return tuple(_stated(scene, baked, number) for number in range(len(baked.camera)))


def _stated(scene: Scene, baked: Baked, number: int) -> View:
    camera, field, name = baked.camera[number], f"baked.camera[{number}]", map_name(number)
    if camera.file is not None:
        size = None
        if camera.width is not None and camera.height is not None:
            size = camera.width, camera.height
        view = read_camera(scene.path(camera.file, f"{field}.file"), size=size)
        if camera.has_pose:
            view = replace(view, world_from_camera=camera.pose())
    else:
        try:
            view = camera.view(name)
        except InputError as error:
            place = (error.field or "").removeprefix(f"rig.{name}").removeprefix("camera")
            raise InputError(
                error.rule, file=scene.file, field=f"{field}{place}", remedy=error.remedy
            ) from error
    if view.width * view.height > MOST_PIXELS:
        raise InputError(
            f"has {view.width}×{view.height} pixels, a map at most {MOST_PIXELS // 2**20} Mpix",
            file=scene.file,
            field=f"{field}.width",
            remedy="light varies slowly: some 400 pixels a side are plenty",
        )
    return replace(view.undistorted(), name=name)


def watching_views(scene: Scene, shapes: dict[str, tuple[int, int]], /) -> tuple[View, ...]:
    """The views of the rig, from which the surface is looked at; none where there is no rig.

    `shapes` has (height, width) of the pictures of those that have one.
    """
    if scene.rig is None or not scene.rig.cameras:
        return ()
    views = [view_of(scene, name, shapes.get(name)) for name in view_names_of(scene)]
    return tuple(view.undistorted() for view in views)


def found_views(
    scene: Scene,
    baked: Baked,
    geometry: Geometry,
    watching: Sequence[View],
    /,
    *,
    one_sided: bool = False,
) -> Suggested:
    """Views that together see `geometry`, those of the rig first, with the names of maps.

    `one_sided` : backs of the surface are unknown, as those of a depth image. Raises `InputError`
    where nothing can be seen.
    """
    try:
        suggested = suggested_views(
            geometry,
            watching,
            coverage=baked.coverage,
            most_cameras=baked.most_cameras,
            map_size_px=baked.map_size_px,
            seed=scene.scene.seed,
            one_sided=one_sided,
        )
    except InputError as error:
        raise InputError(
            error.rule,
            file=scene.file,
            field=error.field,
            remedy=error.remedy or "state [[baked.camera]] with position and look_at",
        ) from error
    views = enumerate(suggested.views)
    return replace(
        suggested, views=tuple(replace(view, name=map_name(number)) for number, view in views)
    )
