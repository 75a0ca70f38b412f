"""The surface as a view sees it, in float64: depth images as they are, triangles by Embree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.lamps.bodies import Body
from andon.quantities import Geometry, Material, Surface
from andon.rays import Hits, RayScene, face_normals
from andon.spaces import View, transform_points
from andon.surface.model import SurfaceModel
from andon.surface.shells import ShellsInView
from andon.surface.textures import sample_bilinear

__all__ = [
    "empty_surface",
    "from_depth",
    "from_normals",
    "nearest",
    "see",
    "see_real",
    "trace",
    "trace_body",
    "trace_rays",
    "with_bodies",
    "with_movers",
]

Float = NDArray[np.float64]


def see(model: SurfaceModel, view: View, /, shells: ShellsInView | None = None) -> Surface:
    """The surface of `view`: the real geometry, and virtual objects where they are nearer.

    Of objects only those that stand still; see `with_movers`. `shells` says which of its pixels
    show real shells.
    """
    real = see_real(model, view)
    real = real if shells is None else shells.marked(real)
    if len(model.objects.triangles) == 0:
        return real
    return nearest(real, trace(model.objects, view, is_object=True))


def with_movers(surface: Surface, model: SurfaceModel, movers: Sequence[Geometry], /) -> Surface:
    """The surface with the objects of `model` that move, where they are nearer."""
    for info, geometry in zip(model.moving_table, movers, strict=True):
        seen = trace(geometry, surface.view, is_object=True)
        slots = np.where(seen.valid, seen.material_id + info.first_slot, -1)
        surface = nearest(surface, replace(seen, material_id=slots.astype(np.int32)))
    return surface


def with_bodies(surface: Surface, bodies: Sequence[Body], /) -> Surface:
    """The surface with luminous bodies where they are nearer, each with its own light.

    Real shells are there already.
    """
    for number, body in enumerate(bodies):
        if not body.real:
            surface = nearest(surface, trace_body(body, number, surface.view))
    return surface


def trace_body(body: Body, number: int, view: View, /) -> Surface:
    """One luminous body as `view` sees it, with the luminance of the side that is seen."""
    geometry = body.geometry
    surface, hits, rays = _traced(RayScene(geometry), view, view.rays_world()[1])
    mask = surface.valid
    corners = geometry.triangles[hits.triangle]
    outside = np.einsum("ni,nij->nj", hits.barycentric, body.outside_cd_m2[corners])
    inside = np.einsum("ni,nij->nj", hits.barycentric, body.inside_cd_m2[corners])
    facing = np.einsum("ij,ij->i", face_normals(geometry)[hits.triangle], rays) < 0
    surface.emitted_cd_m2[mask] = np.where(facing[:, None], outside, inside)
    surface.is_object[mask] = True
    surface.reflectance[mask] = body.reflectance
    return replace(surface, body_id=np.where(mask, np.int32(number), np.int32(-1)))


def see_real(model: SurfaceModel, view: View, /) -> Surface:
    """The real geometry alone."""
    if view.name in model.depth:
        return from_depth(model.depth[view.name], model.normals[view.name], view)
    if model.is_distant_only:
        return from_normals(model.normals[view.name], view)
    return trace(model.real, view, is_object=False)


def empty_surface(view: View, /) -> Surface:
    """A surface that is a hole everywhere."""
    shape = view.shape
    return Surface(
        position=np.full((*shape, 3), np.nan),
        normal=np.full((*shape, 3), np.nan),
        depth=np.full(shape, np.nan),
        valid=np.zeros(shape, bool),
        is_object=np.zeros(shape, bool),
        reflectance=np.zeros((*shape, 3)),
        material_id=np.full(shape, -1, np.int32),
        emitted_cd_m2=np.zeros((*shape, 3)),
        view=view,
    )


def from_depth(depth: Float, normal: Float, view: View, /) -> Surface:
    """The real surface of a depth image (H, W) with its world normals (H, W, 3)."""
    points = transform_points(view.world_from_camera, view.rays_planar() * depth[..., None])
    valid = np.isfinite(depth) & np.isfinite(normal).all(axis=-1)
    return Surface(
        position=np.where(valid[..., None], points, np.nan),
        normal=np.where(valid[..., None], normal, np.nan),
        depth=np.where(valid, depth, np.nan),
        valid=valid,
        is_object=np.zeros(view.shape, bool),
        reflectance=np.zeros((*view.shape, 3)),
        material_id=np.full(view.shape, -1, np.int32),
        emitted_cd_m2=np.zeros((*view.shape, 3)),
        view=view,
        cover=_cover(np.where(valid, depth, np.inf)),
    )


# A hole is a gap in the depth, not in the world: what lies behind both its rims stays behind. Gaps
# with a rim on one side only within this many pixels (the sky beside a tree) are left open.
COVER_PX = 8


def _cover(depth: Float) -> Float:
    """(H, W) depth behind which a hole hides things, inf where it does not; holes are inf.

    Of the two rims to its left and right, or above and below, the farther; of these the nearer.
    """
    pairs = [np.maximum(_rim(depth, axis, 1), _rim(depth, axis, -1)) for axis in (0, 1)]
    return np.where(np.isfinite(depth), np.inf, np.minimum(*pairs))


def _rim(depth: Float, axis: int, way: int) -> Float:
    """(H, W) depth of the first surface met along an axis within `COVER_PX`, or inf."""
    found = np.full(depth.shape, np.inf)
    for step in range(1, min(COVER_PX, depth.shape[axis] - 1) + 1):
        there = np.roll(depth, -way * step, axis)
        beyond = slice(-step, None) if way > 0 else slice(None, step)
        there[(beyond, slice(None)) if axis == 0 else (slice(None), beyond)] = np.inf
        found = np.where(np.isinf(found), there, found)
    return found


def from_normals(normal: Float, view: View, /) -> Surface:
    """A normals-only surface: valid where the normal (H, W, 3) is, positions unknown."""
    surface = from_depth(np.ones(view.shape), normal, view)
    unknown = np.full((*view.shape, 3), np.nan)
    return replace(surface, position=unknown, cover=None)


def trace(geometry: Geometry, view: View, /, *, is_object: bool) -> Surface:
    """Triangles as `view` sees them, one ray through each pixel's centre."""
    return trace_rays(RayScene(geometry), view, view.rays_world()[1], is_object=is_object)


def trace_rays(scene: RayScene, view: View, directions: Float, /, *, is_object: bool) -> Surface:
    """Triangles as unit `directions` (H, W, 3) from the place of `view` meet them."""
    surface, hits, _ = _traced(scene, view, directions)
    surface.is_object[surface.valid] = is_object
    _fill_material(surface, surface.valid, scene.geometry, hits.triangle, hits.barycentric)
    return surface


def _traced(scene: RayScene, view: View, directions: Float) -> tuple[Surface, Hits, Float]:
    """Where the pixels' rays meet triangles: the surface, and hits and rays of its valid pixels."""
    geometry, origin = scene.geometry, view.position
    flat = directions.reshape(-1, 3)
    hits = scene.first_hits(np.broadcast_to(origin, flat.shape), flat)
    valid = hits.triangle >= 0
    rays = flat[valid]
    hits = Hits(hits.triangle[valid], hits.distance[valid], hits.barycentric[valid])
    surface = empty_surface(view)
    mask = valid.reshape(view.shape)
    points = origin + rays * hits.distance[:, None]
    normals = shading_normals(geometry, hits.triangle, hits.barycentric)
    surface.position[mask] = points
    surface.normal[mask] = _towards(normals, rays)
    surface.depth[mask] = _depth(points, view)
    surface.valid[mask] = True
    return surface, hits, rays


def _depth(points: Float, view: View) -> Float:
    camera = transform_points(view.camera_from_world, points)
    return camera[:, 2] if view.projection == "pinhole" else np.linalg.norm(camera, axis=1)


def _towards(normals: Float, rays: Float) -> Float:
    """The normals, turned so that they face the viewer."""
    return normals * np.where(np.einsum("ij,ij->i", normals, rays) > 0, -1.0, 1.0)[:, None]


def shading_normals(geometry: Geometry, triangle: NDArray[np.int32], weights: Float, /) -> Float:
    """Unit normals (n, 3) at barycentric `weights` (n, 3): interpolated, or flat."""
    if geometry.normals is None:
        return face_normals(geometry)[triangle]
    corners = geometry.normals[geometry.triangles[triangle]]
    blended = np.einsum("nij,ni->nj", corners, weights)
    length = np.linalg.norm(blended, axis=1, keepdims=True)
    flat = face_normals(geometry)[triangle]
    return np.where(length > 1e-9, blended / np.maximum(length, 1e-9), flat)


def _fill_material(
    surface: Surface,
    mask: NDArray[np.bool_],
    geometry: Geometry,
    triangle: NDArray[np.int32],
    weights: Float,
) -> None:
    ids = np.zeros(len(geometry.triangles), np.int32)
    ids = ids if geometry.material_ids is None else geometry.material_ids
    chosen = ids[triangle]
    base = np.array([m.reflectance for m in geometry.materials])[chosen]
    emitted = np.array([m.emissive_cd_m2 for m in geometry.materials])[chosen]
    if geometry.uvs is not None:
        uv = np.einsum("nij,ni->nj", geometry.uvs[geometry.triangles[triangle]], weights)
        base = base * _textures(geometry.materials, chosen, uv)
    surface.reflectance[mask] = np.clip(base, 0, 1)
    surface.material_id[mask] = chosen
    surface.emitted_cd_m2[mask] = emitted


def _textures(materials: tuple[Material, ...], chosen: NDArray[Any], uv: Float) -> Float:
    factor = np.ones((len(chosen), 3))
    for index, material in enumerate(materials):
        if material.texture is not None:
            here = chosen == index
            factor[here] = sample_bilinear(material.texture, uv[here])
    return factor


def nearest(real: Surface, objects: Surface, /) -> Surface:
    """Pixel by pixel, whichever is nearer; objects stand before holes without a nearer cover."""
    with np.errstate(invalid="ignore"):
        there = real.depth if real.cover is None else np.where(real.valid, real.depth, real.cover)
        front = objects.valid & (~np.isfinite(there) | (objects.depth < there))

    def choose(name: str) -> NDArray[Any]:
        behind: NDArray[Any] = getattr(real, name)
        mask = front.reshape(*front.shape, *[1] * (behind.ndim - 2))
        return np.where(mask, getattr(objects, name), behind)

    bodies = [real.body_id, objects.body_id]
    nobody = np.full(real.view.shape, -1, np.int32)
    behind, before = (nobody if body is None else body for body in bodies)
    return Surface(
        position=choose("position"),
        normal=choose("normal"),
        depth=choose("depth"),
        valid=choose("valid"),
        is_object=choose("is_object"),
        reflectance=choose("reflectance"),
        material_id=choose("material_id"),
        emitted_cd_m2=choose("emitted_cd_m2"),
        view=real.view,
        cover=real.cover,
        body_id=None if all(body is None for body in bodies) else np.where(front, before, behind),
        shell_id=None if real.shell_id is None else np.where(front, np.int32(-1), real.shell_id),
    )
