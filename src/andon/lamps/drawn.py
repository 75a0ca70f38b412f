"""What is seen of an area lamp: its geometry, with its luminance on the sides that emit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.lamps.areas import DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.bodies import Body
from andon.lamps.kinds import AnyAreaLamp
from andon.lamps.polygons import polygon_triangles
from andon.lamps.solids import capsule, disk, grid, icosphere
from andon.quantities import Geometry

__all__ = ["body_of"]

Float = NDArray[np.float64]

# 5120 triangles: the outline of a ball is then within 0.1 % of its radius of a circle.
SPHERE_CUTS = 4
# Vertices along a textured rectangle: what is seen of a picture is no finer than this.
TEXTURE_STEPS = 64


def body_of(lamp: AnyAreaLamp, /) -> Body:
    """The body of an area lamp; the back of a flat one-sided lamp has luminance 0.

    Raises `InputError` for a polygon that crosses itself.
    """
    if isinstance(lamp, SphereLamp):
        ball = icosphere(SPHERE_CUTS)
        at = lamp.position_m + lamp.radius_m * ball.positions
        return _body(lamp, replace(ball, positions=at))
    if isinstance(lamp, TubeLamp):
        return _body(lamp, capsule(lamp.ends_m, lamp.radius_m))
    if isinstance(lamp, DiskLamp):
        round_ = disk(lamp.position_m, lamp.direction, lamp.radius_m)
        return _body(lamp, round_, two_sided=lamp.two_sided)
    if isinstance(lamp, PolygonLamp):
        return _polygon(lamp)
    return _mesh(lamp)


def _body(
    lamp: AnyAreaLamp,
    geometry: Geometry,
    luminance: Float | None = None,
    *,
    two_sided: bool = False,
) -> Body:
    outside = np.empty((len(geometry.positions), 3))
    outside[:] = lamp.luminance_cd_m2 if luminance is None else luminance
    inside = outside if two_sided else np.zeros_like(outside)
    return Body(lamp.name, geometry, outside, inside)


def _polygon(lamp: PolygonLamp) -> Body:
    vertices = np.asarray(lamp.vertices_m, np.float64)
    if lamp.texture is None:
        flat = Geometry(vertices, polygon_triangles(vertices))
        return _body(lamp, flat, two_sided=lamp.two_sided)
    across, along = vertices[1] - vertices[0], vertices[3] - vertices[0]
    steps = TEXTURE_STEPS
    tiles = grid(vertices[0], across, along, steps, steps)
    rows, columns = np.divmod(np.arange(len(tiles.positions)), steps + 1)
    # Row 0 of the picture is the top, where the grid ends.
    factors = _bilinear(lamp.texture, 1 - rows / steps, columns / steps)
    return _body(lamp, tiles, lamp.luminance_cd_m2 * factors, two_sided=lamp.two_sided)


def _bilinear(picture: Float, down: Float, right: Float) -> Float:
    """Values (n, 3) at shares of the height and width of `picture` (h, w, 3), edges repeated."""
    height, width = picture.shape[:2]
    y = np.clip(down * height - 0.5, 0, height - 1)
    x = np.clip(right * width - 0.5, 0, width - 1)
    top, left = y.astype(int), x.astype(int)
    low, far = np.minimum(top + 1, height - 1), np.minimum(left + 1, width - 1)
    v, u = (y - top)[:, None], (x - left)[:, None]
    upper = (1 - u) * picture[top, left] + u * picture[top, far]
    lower = (1 - u) * picture[low, left] + u * picture[low, far]
    return (1 - v) * upper + v * lower


def _mesh(lamp: MeshLamp) -> Body:
    if lamp.facet_luminance_cd_m2 is None:
        return _body(lamp, Geometry(lamp.positions_m, lamp.triangles))
    corners = lamp.positions_m[lamp.triangles].reshape(-1, 3)
    own = Geometry(corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3))
    return _body(lamp, own, np.repeat(lamp.facet_luminance_cd_m2, 3, axis=0))
