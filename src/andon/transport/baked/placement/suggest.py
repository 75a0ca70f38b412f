"""Cameras that together see the surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Geometry
from andon.rays import RayScene
from andon.spaces import View
from andon.transport.baked.placement.choose import Chosen
from andon.transport.baked.placement.frames import map_view, shown_points
from andon.transport.baked.placement.greedy import looks_from
from andon.transport.baked.placement.model import Ended, Suggested
from andon.transport.baked.placement.samples import Samples, surface_samples
from andon.transport.baked.placement.sight import LIFT, Sight, in_picture, seen_from_point, texels_m
from andon.transport.baked.placement.space import free_places
from andon.transport.probes.placement.walls import Walls

__all__ = ["suggested_views"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# Points of the surface that cameras are chosen by: 0.99 is known to 0.1 % (standard deviation).
SAMPLES = 8192
# Texels may be this many times as long as one that is seen squarely from the typical distance: the
# radius of the sphere with the reachable area. Of maps with 384 px that is a 24th of it, at the
# typical distance down to 66° off the normal.
TEXELS = 2.5
# Where the frame sees a point they may be this many of its pixels, if that is more.
FRAME_PIXELS = 8.0
# A further camera of the frame has to show at least this share that the others do not.
LEAST_OF_FRAME = 0.01


def suggested_views(
    geometry: Geometry,
    seen_from: Sequence[View] = (),
    *,
    coverage: float,
    most_cameras: int,
    map_size_px: int,
    seed: int = 0,
    one_sided: bool = False,
) -> Suggested:
    """Cameras that together see at least the share `coverage` of what can be seen at all.

    Parameters
    ----------
    seen_from : the frame's cameras. Maps from there come first, a little wider; one that shows
        nothing, or nothing that others do not, is left out.
    coverage : 0…1 of the reachable area: of each side of the surface that is seen from anywhere
        in free space.
    most_cameras : ≥ 1, those of the frame included.
    map_size_px : of the longer side of each map.
    one_sided : only fronts count, and places that see backs are not free: for the triangles of a
        depth image, whose backs nobody knows.

    Raises `InputError` where there is no surface, or no place that sees it.
    """
    samples = surface_samples(geometry, SAMPLES, seed)
    if samples.area_m2 == 0:
        raise InputError("has no area that light could fall on", field="surface")
    walls = Walls(geometry)
    starts = np.array([view.position for view in seen_from]).reshape(-1, 3)
    places = np.concatenate(
        [starts, free_places(geometry, walls, starts, seed, one_sided=one_sided)]
    )
    size = float(np.ptp(samples.points, axis=0).max())
    sights = [
        seen_from_point(place, samples, walls.rays, size, fronts_only=one_sided) for place in places
    ]
    reachable = np.zeros(2 * len(samples.points), bool)
    for sight in sights:
        reachable[sight.sides] = True
    if not reachable.any():
        raise InputError(
            "cannot be seen from anywhere: no place is both free and before it", field="surface"
        )
    limit = _limits(samples, reachable, seen_from, sights, map_size_px)
    chosen = Chosen(len(reachable), int(np.count_nonzero(reachable)), coverage, most_cameras)
    for number in _of_frame(seen_from, walls.rays)[:most_cameras]:
        small = map_view(seen_from[number], map_size_px)
        chosen.add(small, _well_seen(small, sights[number], limit))
    frame_count = len(chosen.views)
    looks = [
        looks_from(place, sight, limit, map_size_px)
        for place, sight in zip(places, sights, strict=True)
    ]
    ended = chosen.fill(looks, map_size_px)
    # What was left out makes room for others.
    while chosen.prune(frame_count):
        ended = chosen.fill(looks, map_size_px)
    return _suggested(chosen, samples, reachable, places, ended, frame_count)


def _limits(
    samples: Samples,
    reachable: Bool,
    seen_from: Sequence[View],
    sights: Sequence[Sight],
    map_size_px: int,
) -> Float:
    """(2n,) metres, the longest texel in which each side is seen well."""
    radius = np.sqrt(np.count_nonzero(reachable) * samples.area_m2 / (4 * np.pi))
    limit = np.full(len(reachable), TEXELS * radius * 2 * np.pi / map_size_px)
    for view, sight in zip(seen_from, sights, strict=False):
        view = view.undistorted()
        shown = in_picture(view, sight.points)
        sides, points = sight.sides[shown], sight.points[shown]
        pixels = texels_m(view, points, sight.cosine[shown])
        limit[sides] = np.maximum(limit[sides], FRAME_PIXELS * pixels)
    return limit


def _well_seen(view: View, sight: Sight, limit: Float) -> NDArray[np.int64]:
    """Sides of what is seen from a view's position that the view's picture shows well."""
    fine = texels_m(view, sight.points, sight.cosine) <= limit[sight.sides]
    return sight.sides[fine & in_picture(view, sight.points)]


def _of_frame(seen_from: Sequence[View], rays: RayScene) -> list[int]:
    """Numbers of the frame's cameras that show something that those before them do not.

    Two eyes see nearly the same: judged by what their pixels show, since a small view takes a
    small part of the surface's samples.
    """
    kept: list[int] = []
    lift = LIFT * float(np.ptp(rays.geometry.positions, axis=0).max())
    for number, view in enumerate(seen_from):
        points, normals = shown_points(view, rays)
        new = np.ones(len(points), bool)
        for other in (map_view(seen_from[i], max(view.shape)) for i in kept):
            shown = in_picture(other, points)
            new &= ~(shown & rays.is_visible(points + lift * normals, other.position))
        if np.count_nonzero(new) > LEAST_OF_FRAME * len(points):
            kept.append(number)
    return kept


def _suggested(
    chosen: Chosen,
    samples: Samples,
    reachable: Bool,
    places: Float,
    ended: Ended,
    frame_count: int,
) -> Suggested:
    first = np.full(len(reachable), -1, np.int64)
    for number in reversed(range(len(chosen.views))):
        first[chosen.well[number]] = number
    sides = np.flatnonzero(reachable)
    first = first[sides]
    counts = np.bincount(first[first >= 0], minlength=len(chosen.views))
    return Suggested(
        views=tuple(chosen.views),
        coverage=float(counts.sum() / len(sides)),
        reachable_area_m2=float(len(sides) * samples.area_m2),
        adds_m2=tuple(float(count * samples.area_m2) for count in counts),
        ended=ended,
        frame_count=frame_count,
        candidates=places,
        points=samples.side_points(sides),
        normals=samples.side_normals(sides),
        first_seen_by=first,
    )
