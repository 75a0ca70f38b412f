"""What probes stand in and what they show: the scene under a headlight, the hull, the balls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.display.probe_pictures.canvas import IN_SURFACE, SEEN_THROUGH, Canvas, Colour
from andon.harmonics import basis, convolved, order_of
from andon.quantities import Geometry
from andon.rays import Hits, RayScene, face_normals
from andon.spaces import View, transform_points

__all__ = ["RING", "draw_balls", "draw_geometry", "draw_hull", "shown_light"]

Float = NDArray[np.float64]

# A headlight, so that edges show, over an even light; and the whole dimmer than the balls.
EVEN, HEADLIGHT, DIMNESS = 0.35, 0.65, 0.62
# Share of the reflectance's hue that the scene keeps: colours belong to the balls.
HUE = 0.55
# The hull's tint where it is seen straight on, and at its rim.
HULL_ALPHA, HULL_RIM_ALPHA = 0.025, 0.14
# Share of the probes that a surface must stand before to be left out, how many are asked at most,
# and triangles at once.
NEARLY_ALL, MOST_ASKED, CHUNK = 0.95, 256, 1 << 16
# Width of the ring that tells a probe's role, of the ball's radius.
RING = 0.16


def draw_geometry(canvas: Canvas, geometry: Geometry, probes: Float | None = None, /) -> None:
    """Surfaces, but for those that stand between the eye and the probes (n, 3), as a doll's house.

    A triangle is left out where its plane has the eye on one side and nearly all probes on the
    other: near walls, ceilings from above. What shows its back is drawn where nothing shows its
    front: far walls that are turned outwards. Without probes, only fronts are drawn.
    """
    corners = geometry.positions[geometry.triangles[:, 0]]
    normals = face_normals(geometry)
    turned = np.einsum("ij,ij->i", normals, canvas.view.position - corners)
    if probes is None:
        _draw_faces(canvas, geometry, turned > 0)
        return
    towards = np.where(turned[:, None] < 0, -normals, normals)
    kept = ~_between(corners, towards, probes)
    _draw_faces(canvas, geometry, kept & (turned < 0))
    _draw_faces(canvas, geometry, kept & (turned > 0))


def _draw_faces(canvas: Canvas, geometry: Geometry, shown: NDArray[np.bool_]) -> None:
    """The triangles that are `shown` (t,), over all that is there."""
    if not shown.any():
        return
    ids = geometry.material_ids
    some = replace(
        geometry,
        triangles=geometry.triangles[shown],
        material_ids=None if ids is None else ids[shown],
    )
    hits, seen, directions = _cast(canvas.view, some)
    normals = face_normals(some)[hits.triangle[seen]]
    cosine = np.abs(np.einsum("ij,ij->i", directions[seen], normals))
    base = _reflectance(some, hits.triangle[seen], hits.barycentric[seen])
    grey = base.mean(axis=1, keepdims=True)
    shade = DIMNESS * (EVEN + HEADLIGHT * cosine)[:, None] * (grey + HUE * (base - grey))
    canvas.colour.reshape(-1, 3)[seen] = shade
    along = directions @ canvas.view.world_from_camera[:3, 2]
    canvas.depth.ravel()[seen] = (hits.distance * along)[seen]


def _between(corners: Float, normals: Float, probes: Float) -> NDArray[np.bool_]:
    """(t,) whether nearly all probes lie behind the plane of a triangle."""
    some = probes[:: max(1, -(-len(probes) // MOST_ASKED))]
    behind = np.empty(len(corners), bool)
    for first in range(0, len(corners), CHUNK):
        part = slice(first, first + CHUNK)
        plane = np.einsum("ij,ij->i", normals[part], corners[part])
        behind[part] = (normals[part] @ some.T <= plane[:, None]).mean(axis=1) >= NEARLY_ALL
    return behind


def _cast(view: View, geometry: Geometry) -> tuple[Hits, NDArray[np.bool_], Float]:
    origin, directions = view.rays_world()
    directions = directions.reshape(-1, 3)
    hits = RayScene(geometry).first_hits(np.broadcast_to(origin, directions.shape), directions)
    return hits, hits.triangle >= 0, directions


def _reflectance(geometry: Geometry, triangle: NDArray[np.int32], weights: Float) -> Float:
    """(n, 3) linear reflectance where rays met; the nearest texel of textures in linear light."""
    ids = geometry.material_ids
    material = np.zeros(len(triangle), np.int32) if ids is None else ids[triangle]
    base = np.array([m.reflectance for m in geometry.materials])[material]
    if geometry.uvs is None:
        return base
    uv = np.einsum("ij,ijk->ik", weights, geometry.uvs[geometry.triangles[triangle]]) % 1
    for number, entry in enumerate(geometry.materials):
        here = material == number
        if entry.texture is None or entry.texture.dtype == np.uint8 or not here.any():
            continue
        height, width = entry.texture.shape[:2]
        column = np.minimum((uv[here, 0] * width).astype(np.int64), width - 1)
        row = np.minimum((uv[here, 1] * height).astype(np.int64), height - 1)
        base[here] *= entry.texture[row, column, :3]
    return base


def draw_hull(canvas: Canvas, positions: Float, facets: NDArray[np.int32], tint: Colour, /) -> None:
    """A veil over what lies behind the hull, thicker at its rim."""
    hull = Geometry(positions, facets)
    hits, seen, directions = _cast(canvas.view, hull)
    if not seen.any():
        return
    normals = face_normals(hull)[hits.triangle[seen]]
    rim = 1 - np.abs(np.einsum("ij,ij->i", directions[seen], normals))
    alpha = np.zeros(canvas.depth.size)
    alpha[seen] = HULL_ALPHA + (HULL_RIM_ALPHA - HULL_ALPHA) * rim**2
    along = directions @ canvas.view.world_from_camera[:3, 2]
    depth = np.where(seen, hits.distance, 0) * along
    alpha[depth > canvas.depth.ravel() * (1 + IN_SURFACE)] = 0
    layer = np.broadcast_to(np.array(tint), canvas.colour.shape)
    canvas.blend(slice(None), slice(None), layer, alpha.reshape(canvas.depth.shape))


def shown_light(coefficients: Float, normals: Float, /, *, irradiance: bool) -> Float:
    """(..., 3) cd/m² of a ball's points: luminance from there, or irradiance/π; never below 0.

    `coefficients` (k, 3) of luminance, `normals` (..., 3) unit.
    """
    shown = convolved(coefficients) / np.pi if irradiance else coefficients
    values: Float = basis(normals, order_of(len(shown))) @ shown
    return np.maximum(values, 0)


def draw_balls(
    canvas: Canvas,
    positions: Float,
    radius_m: float,
    light: Float | None,
    rings: list[Colour],
    /,
    *,
    irradiance: bool,
) -> None:
    """Balls at `positions` (n, 3), far ones first.

    `light` (n, k, 3) are display values as spherical harmonics; None: white under a headlight.
    """
    places = transform_points(canvas.view.camera_from_world, positions)
    for index in np.argsort(-places[:, 2]).tolist():
        one = None if light is None else light[index]
        ring: Colour = rings[int(index)]
        _draw_ball(canvas, places[index], radius_m, one, ring, irradiance)


def _draw_ball(
    canvas: Canvas,
    place: Float,
    radius: float,
    light: Float | None,
    ring: Colour,
    irradiance: bool,
) -> None:
    view = canvas.view
    if place[2] <= 2 * radius:
        return
    box = _window(view, place, radius * (1 + RING))
    if box is None:
        return
    rows, columns = box
    normals, away, depth = _seen_ball(view, place, radius, rows, columns)
    pixel = place[2] / view.fx  # metres a pixel is wide at the ball
    hidden = place[2] - radius > canvas.depth[rows, columns] * (1 + IN_SURFACE)
    ink = np.where(hidden, SEEN_THROUGH, 1.0)
    outer = np.clip((radius * (1 + RING) - away) / pixel + 0.5, 0, 1)
    inner = np.clip((radius - away) / pixel + 0.5, 0, 1)
    canvas.blend(rows, columns, np.broadcast_to(np.array(ring), normals.shape), ink * outer)
    if light is None:
        shade = 0.8 * (EVEN + HEADLIGHT * np.abs(normals @ view.world_from_camera[:3, 2]))
        colour = np.broadcast_to(shade[..., None], normals.shape)
    else:
        colour = shown_light(light, normals, irradiance=irradiance)
    canvas.blend(rows, columns, colour, ink * inner)
    mine = (outer > 0.5) & ~hidden
    canvas.depth[rows, columns] = np.where(mine, depth, canvas.depth[rows, columns])


def _window(view: View, place: Float, radius: float) -> tuple[slice, slice] | None:
    """Rows and columns that a ball may touch."""
    column, row = view.project(place).tolist()
    # A ball off the axis is drawn as an ellipse, longer by the slant.
    slant = float(np.linalg.norm(place)) / place[2]
    reach = view.fx * radius / (place[2] - radius) * slant + 2
    left, right = max(int(column - reach), 0), min(int(column + reach) + 2, view.width)
    top, bottom = max(int(row - reach), 0), min(int(row + reach) + 2, view.height)
    return (slice(top, bottom), slice(left, right)) if left < right and top < bottom else None


def _seen_ball(
    view: View, place: Float, radius: float, rows: slice, columns: slice
) -> tuple[Float, Float, Float]:
    """World normals (h, w, 3), the rays' distance from the centre (h, w), depth (h, w)."""
    y, x = np.mgrid[rows, columns].astype(np.float64)
    rays = np.stack([(x - view.cx) / view.fx, (y - view.cy) / view.fy, np.ones_like(x)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    along = rays @ place
    away = np.sqrt(np.maximum(place @ place - along**2, 0))
    reach = along - np.sqrt(np.maximum(radius**2 - away**2, 0))
    points = rays * reach[..., None]
    normals = points - place
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    return normals @ view.world_from_camera[:3, :3].T, away, points[..., 2]
