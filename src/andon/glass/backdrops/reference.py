"""What rays see behind the glass, in NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.atlas import premultiplied
from andon.glass.backdrops.distances import plane_axes, plane_distance, sphere_distance
from andon.glass.backdrops.march import march
from andon.glass.backdrops.model import FAR_M, Footprint, SceneOfView, Seen
from andon.glass.backdrops.projecting import moved_pixels
from andon.glass.backdrops.pyramids import Pyramid, pyramid, sampled
from andon.glass.model import Backdrop, Ball, Closed, Solid
from andon.harmonics import basis
from andon.spaces import rotate

__all__ = ["environment_light", "look", "sticker_at"]

Float = NDArray[np.float64]


def look(
    backdrop: Backdrop,
    origins: Float,
    directions: Float,
    footprint: Footprint,
    scene: SceneOfView,
    /,
    *,
    picture: Pyramid | None = None,
) -> Seen:
    """What rays from `origins` (n, 3) along unit `directions` (n, 3) see of a backdrop.

    `picture`: the pyramid of `backdrop.picture`, for callers who look more than once.
    """
    if backdrop.kind == "texture":
        return _texture(backdrop, origins, directions, footprint, scene, picture)
    if backdrop.kind == "frame":
        return _frame(backdrop.distance_m, origins, directions, footprint, scene)
    return _surface(origins, directions, footprint, scene)


def _nothing(count: int) -> Seen:
    none = np.zeros(count, np.bool_)
    return Seen(np.zeros((count, 3)), np.full(count, FAR_M), ~none, none)


def _texture(
    backdrop: Backdrop,
    origins: Float,
    directions: Float,
    footprint: Footprint,
    scene: SceneOfView,
    picture: Pyramid | None,
) -> Seen:
    """Ray and plane; both sides of it show the picture."""
    seen = _nothing(len(origins))
    if backdrop.picture is None:
        return seen
    source = picture or pyramid(backdrop.picture)
    # Of half the plane's width and height: (1, 1) is its upper right corner.
    axes = plane_axes(backdrop)
    normal = np.cross(axes[0], axes[1])
    distance = plane_distance(backdrop, origins, directions)
    with np.errstate(invalid="ignore"):
        place = (origins + distance[:, None] * directions - backdrop.centre_m) @ axes.T
        hit = np.flatnonzero((distance > 0) & (np.abs(place).max(axis=1) <= 1))
    moved = _part(footprint, hit).at(
        directions[hit], np.broadcast_to(normal, (len(hit), 3)), distance[hit]
    )
    scale = 0.5 * np.array([source.shape[1], -source.shape[0]])
    texels = 0.5 * np.array([source.shape[1], source.shape[0]]) - 0.5 + scale * place[hit]
    white = scene.luminance_per_unit * np.asarray(scene.dimming)
    seen.light[hit] = sampled(source, texels, moved @ axes.T * scale)[:, :3] * white
    seen.distance_m[hit], seen.missed[hit] = distance[hit], False
    return seen


def _frame(
    radius: float, origins: Float, directions: Float, footprint: Footprint, scene: SceneOfView
) -> Seen:
    """Ray and sphere around the eye, from inside; the frame where the hit is seen."""
    from_eye = origins - scene.view.position
    distance = sphere_distance(radius, scene.view.position, origins, directions)
    normals = (
        from_eye + np.where(np.isfinite(distance), distance, 0)[:, None] * directions
    ) / radius
    return _in_frame(distance, normals, origins, directions, footprint, scene)


def _surface(origins: Float, directions: Float, footprint: Footprint, scene: SceneOfView) -> Seen:
    """The scene's geometry; what is in no pixel of the frame counts as infinitely far away."""
    met = march(scene.surface, origins, directions)
    seen = _in_frame(met.distance_m, met.normal, origins, directions, footprint, scene)
    return replace(seen, beside=seen.beside | (met.hidden & ~seen.missed))


def _in_frame(
    distance: Float,
    normals: Float,
    origins: Float,
    directions: Float,
    footprint: Footprint,
    scene: SceneOfView,
) -> Seen:
    """Light of the frame at hits in `distance` (n,), inf for those at infinity."""
    hit = np.isfinite(distance)
    there = hit[:, None]
    from_eye = origins - scene.view.position
    reach = np.where(hit, distance, 0.0)
    place = np.where(there, from_eye + reach[:, None] * directions, directions)
    moved = footprint.at(directions, np.where(there, normals, directions), reach)
    moved = np.where(there[..., None], moved, footprint.course)
    turned = scene.view.camera_from_world
    pixels, steps = moved_pixels(scene.view, rotate(turned, place), rotate(turned, moved))
    # A pinhole does not see what is behind it.
    seen: NDArray[np.bool_] = np.asarray(np.isfinite(pixels).all(axis=1))
    light = np.zeros((len(origins), 3))
    if seen.any():
        repeats = (scene.view.projection == "latlong", False)
        light[seen] = sampled(scene.pyramid, pixels[seen], steps[seen], repeats=repeats)
    return Seen(light, np.where(hit & seen, distance, FAR_M), ~seen, seen & ~hit)


def _part(footprint: Footprint, rows: NDArray[np.int64]) -> Footprint:
    return Footprint(footprint.place[rows], footprint.course[rows])


def sticker_at(solid: Solid, uv: Float, steps: Float, /) -> Float:
    """(n, 4) reflectance times cover (premultiplied), and cover, of what sticks to a body.

    `uv` (n, 2) in [0, 1], v down; `steps` (n, 2, 2): [:, k] is how far uv moves for a step of one
    pixel along axis k. A body without a sticker has cover 0.
    """
    if solid.sticker is None:
        return np.zeros((len(uv), 4))
    source = pyramid(premultiplied(solid.sticker.picture))
    size = np.array([source.shape[1], source.shape[0]])
    # Around a ball the picture begins again, on meshes (glTF's rule) below, too.
    repeats = (isinstance(solid.shape, Ball | Closed), isinstance(solid.shape, Closed))
    return sampled(source, uv * size - 0.5, steps * size, repeats=repeats)


def environment_light(coefficients: Float, directions: Float, /) -> Float:
    """(n, 3) cd/m², ≥ 0, from unit `directions` (n, 3): harmonics (9, 3) of what is all around."""
    return np.maximum(basis(directions) @ coefficients, 0)
