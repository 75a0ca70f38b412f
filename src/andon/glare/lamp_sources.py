"""Lamps as sources of glare: direction, outline and light at the eye, by the lamp's own data.

=========================== ============================== ===================================
lamp                        outline                        light at the eye
=========================== ============================== ===================================
point, spot, luminaire      circle of its visible radius   I(γ, C) towards the eye over d²
sphere                      circle                         L·ω
disk, polygon               its own, in perspective        L·ω, ω of the outline; 0 from behind
tube, mesh                  hull of what is seen of it     L·ω; of meshes Σ L·ω of facets
directional                 circle of a stated radius      its illuminance
sky, hemisphere             none: they are no source
=========================== ============================== ===================================

The light is ∫ L dω, on a plane that faces the source. What hides the lamp is not looked at here.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.glare.model import Source, right_of
from andon.glare.shapes import circle, spherical_hull, spherical_outline
from andon.lamps import (
    DirectionalLamp,
    DiskLamp,
    Lamp,
    MeshLamp,
    PointLamp,
    PolygonLamp,
    SphereLamp,
    TubeLamp,
    body_of,
    intensity_cd,
)
from andon.lamps.areas import AreaLamp
from andon.spaces import View, perpendicular, rotate, transform_points

__all__ = ["SUN_RADIUS_DEGREES", "source_of_lamp"]

Float = NDArray[np.float64]

# The Sun's mean angular radius.
SUN_RADIUS_DEGREES = 0.2666
# An outline may not reach 90°: what is nearer to a lamp is inside its light.
WIDEST = np.radians(85.0)
RIM = 96


def source_of_lamp(
    lamp: Lamp,
    view: View,
    /,
    *,
    point_radius_m: float = 0.0,
    directional_radius_degrees: float = SUN_RADIUS_DEGREES,
) -> Source | None:
    """What the eye of `view` sees of `lamp`; None where it sees none of its light.

    Parameters
    ----------
    point_radius_m : radius of point lamps without a visible one; 0: they are not seen, as in the
        picture, and area lamps that are not drawn neither.
    directional_radius_degrees : of directional lamps, which have no size; by default the Sun's.
    """
    match lamp:
        case PointLamp():
            return _of_point(lamp, view, lamp.visible_radius_m or point_radius_m)
        case DirectionalLamp():
            towards = rotate(view.camera_from_world, -lamp.direction)
            outline = circle(float(np.radians(directional_radius_degrees)))
            return _lit(Source(towards, lamp.illuminance_lux, outline, name=lamp.name))
        case SphereLamp():
            return _of_ball(lamp, view) if lamp.drawn else None
        case AreaLamp():
            return _of_area(lamp, view) if lamp.drawn else None
        case _:
            return None


def _lit(source: Source) -> Source | None:
    light = np.asarray(source.illuminance_lux, np.float64)
    return source if np.all(light >= 0) and np.any(light > 0) else None


def _of_point(lamp: PointLamp, view: View, radius_m: float) -> Source | None:
    reach = transform_points(view.camera_from_world, lamp.position_m)
    distance = float(np.linalg.norm(reach))
    if not 0 < radius_m < distance:
        return None
    back = (view.position - lamp.position_m) / distance
    light = intensity_cd(lamp, back) / distance**2
    angle = min(float(np.arcsin(radius_m / distance)), WIDEST)
    return _lit(Source(reach / distance, light, circle(angle), name=lamp.name))


def _of_ball(lamp: SphereLamp, view: View) -> Source | None:
    reach = transform_points(view.camera_from_world, lamp.position_m)
    distance = float(np.linalg.norm(reach))
    if distance <= lamp.radius_m:
        return None
    outline = circle(min(float(np.arcsin(lamp.radius_m / distance)), WIDEST))
    light = lamp.luminance_cd_m2 * outline.solid_angle_sr
    return _lit(Source(reach / distance, light, outline, name=lamp.name))


def _of_area(lamp: AreaLamp, view: View) -> Source | None:
    corners = _corners(lamp, view)
    if corners is None:
        return None
    seen = transform_points(view.camera_from_world, corners)
    seen = seen / np.linalg.norm(seen, axis=-1, keepdims=True)
    middle = seen.sum(axis=0)
    direction = middle / np.linalg.norm(middle)
    if np.min(seen @ direction) <= np.cos(WIDEST):
        return None
    right = right_of(direction)
    local = seen @ np.stack([right, np.cross(direction, right), direction], axis=-1)
    flat = isinstance(lamp, PolygonLamp | DiskLamp)
    outline = spherical_outline(local) if flat else spherical_hull(local)
    source = Source(direction, np.zeros(3), outline, right, lamp.name)
    if isinstance(lamp, MeshLamp):
        light = _facets(lamp, view.position)
    else:
        light = lamp.luminance_cd_m2 * outline.solid_angle_sr
    return _lit(replace(source, illuminance_lux=light))


def _corners(lamp: AreaLamp, view: View) -> Float | None:
    """Points (k, 3) of the outline in order, or of the surface; None from the dark side."""
    match lamp:
        case PolygonLamp():
            normal = np.sum(np.cross(lamp.vertices_m, np.roll(lamp.vertices_m, -1, axis=0)), axis=0)
            side = (view.position - lamp.vertices_m[0]) @ normal
            return lamp.vertices_m if side > 0 or (lamp.two_sided and side < 0) else None
        case DiskLamp():
            side = (view.position - lamp.position_m) @ lamp.direction
            if not (side > 0 or (lamp.two_sided and side < 0)):
                return None
            u, v = perpendicular(lamp.direction)
            turn = 2 * np.pi * np.arange(RIM)[:, None] / RIM
            # An inscribed polygon would be smaller than its circle.
            reach = lamp.radius_m / np.sqrt(np.sinc(2 / RIM))
            return lamp.position_m + reach * (np.cos(turn) * u + np.sin(turn) * v)
        case TubeLamp() | MeshLamp():
            return body_of(lamp).geometry.positions
        case _:
            return None


def _facets(lamp: MeshLamp, eye: Float) -> Float:
    """(3,) lx of all facets that face `eye`; they do not hide one another."""
    a, b, c = np.moveaxis(lamp.positions_m[lamp.triangles] - eye, 1, 0)
    volume = -np.einsum("ij,ij->i", a, np.cross(b, c))
    la, lb, lc = (np.linalg.norm(p, axis=-1) for p in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
    solid_angle = 2 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
    luminance = lamp.facet_luminance_cd_m2
    luminance = lamp.luminance_cd_m2 if luminance is None else luminance
    return np.sum(np.maximum(solid_angle, 0)[:, None] * luminance, axis=0)
