"""Direct illuminance in float64, shadows by rays: the truth that the shaders are held against."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.lamps import (
    DirectionalLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    SkyLamp,
    intensity_cd,
)
from andon.lamps.areas import (
    AreaLamp,
    DiskLamp,
    MeshLamp,
    PolygonLamp,
    SphereLamp,
    TubeLamp,
)
from andon.lamps.edges import textured_edges
from andon.lamps.form_factors import (
    disk_factor,
    edges_factor,
    mesh_factor,
    polygon_factor,
    sphere_factor,
    tube_factor,
)
from andon.quantities import Surface
from andon.transport.direct.balls.model import GlassBall, served_balls
from andon.transport.direct.balls.reference import through_balls
from andon.transport.direct.casters import ShadowRays
from andon.transport.direct.soft import sample_points, sample_weights

__all__ = [
    "arriving",
    "illuminance",
    "illuminate",
    "seen_share",
    "visibility",
    "visible_share",
]

Float = NDArray[np.float64]

# Metres: what E = I/d² is cut at, so that a lamp on a surface gives no infinity.
NEAREST_M = 1e-3


def illuminance(lamp: Lamp | AreaLamp, position: Float, normal: Float, /) -> Float:
    """Unshadowed illuminance (..., 3) in lux at `position` (..., 3) with unit `normal` (..., 3).

    Source: the relighting paper, equation (1), with I(ω) of `intensity_cd`; of area lamps
    `andon.lamps.form_factors`.
    """
    match lamp:
        case AreaLamp():
            return _from_an_area(lamp, position, normal)
        case PointLamp():  # and spots and luminaires, which are points with an I(ω)
            return _from_a_place(lamp, position, normal)
        case DirectionalLamp():
            cosine = -normal @ lamp.direction
            return np.maximum(cosine, 0)[..., None] * lamp.illuminance_lux
        case SkyLamp():
            # A dome of luminance E/π seen by a surface tilted by θ: E·(1 + cos θ)/2.
            return (0.5 + 0.5 * (normal @ lamp.up))[..., None] * lamp.illuminance_lux
        case HemisphereLamp():
            sky = (0.5 + 0.5 * (normal @ lamp.up))[..., None]
            return sky * lamp.sky_illuminance_lux + (1 - sky) * lamp.ground_illuminance_lux


def _from_a_place(lamp: PointLamp, position: Float, normal: Float) -> Float:
    reach = lamp.position_m - position
    # No surface is nearer to a lamp than this; a lamp exactly on one gives it nothing.
    square = np.maximum(np.einsum("...i,...i->...", reach, reach), NEAREST_M**2)
    cosine_over_square = np.einsum("...i,...i->...", reach, normal) / square**1.5
    factor = np.maximum(cosine_over_square, 0)
    return factor[..., None] * intensity_cd(lamp, -reach / np.sqrt(square)[..., None])


def _from_an_area(lamp: AreaLamp, position: Float, normal: Float) -> Float:
    place = position, normal
    match lamp:
        case SphereLamp():
            factor = sphere_factor(*place, lamp.position_m, lamp.radius_m)
        case TubeLamp():
            factor = tube_factor(*place, lamp.ends_m, lamp.radius_m)
        case DiskLamp():
            disk = lamp.position_m, lamp.direction, lamp.radius_m
            factor = disk_factor(*place, *disk)
            if lamp.two_sided:
                factor = factor + disk_factor(*place, disk[0], -lamp.direction, lamp.radius_m)
        case PolygonLamp():
            return _from_a_polygon(lamp, position, normal)
        case MeshLamp():
            facets = lamp.facet_luminance_cd_m2
            if facets is not None:
                # Light that is taken away is negative in all facets.
                side = np.sign(lamp.luminance_cd_m2)
                return side * mesh_factor(*place, lamp.positions_m, lamp.triangles, np.abs(facets))
            factor = mesh_factor(*place, lamp.positions_m, lamp.triangles)
        case _:
            raise TypeError(f"no illuminance of {type(lamp).__name__}")
    return factor[..., None] * lamp.luminance_cd_m2


def _from_a_polygon(lamp: PolygonLamp, position: Float, normal: Float) -> Float:
    """Front and, of a two-sided lamp, back, whose picture is the front's seen through."""
    front = lamp.vertices_m
    sides = [front, front[::-1]] if lamp.two_sided else [front]
    if lamp.texture is None:
        factor = sum(polygon_factor(position, normal, side)[..., None] for side in sides)
        return factor * lamp.luminance_cd_m2
    a, b, weight = textured_edges(front, lamp.texture)
    runs = (a, b), (b, a)
    factor = sum(
        edges_factor(position, normal, side, *run, weight)
        for side, run in zip(sides, runs, strict=False)
    )
    return factor * lamp.luminance_cd_m2


def visibility(lamp: Lamp, points: Float, rays: ShadowRays, /) -> NDArray[np.bool_]:
    """(n,) bool: the lamp is seen from `points` (n, 3), already lifted off their surface.

    Sky and hemisphere lamps are ambient: they cast no shadow. Not for area lamps, which can be
    seen in part: `visible_share`.
    """
    if isinstance(lamp, SkyLamp | HemisphereLamp) or lamp.shadow is None:
        return np.ones(len(points), bool)
    casters = rays.through(lamp.shadow.through)
    if isinstance(lamp, DirectionalLamp):
        return casters.sees_infinity(points, -lamp.direction)
    assert isinstance(lamp, PointLamp)
    return casters.is_visible(points, lamp.position_m, near_m=lamp.shadow.near_m)


def visible_share(
    lamp: AreaLamp, position: Float, normal: Float, lifted: Float, rays: ShadowRays, /
) -> Float:
    """(n, 3) in [0, 1]: the share of an area lamp's light that reaches `position` (n, 3).

    `lifted` (n, 3) are the same points off their surface, from which rays start.
    """
    if lamp.shadow is None:
        return np.ones_like(position)
    casters = rays.through(lamp.shadow.through)
    samples = sample_points(lamp, lamp.shadow.samples)
    weights = sample_weights(samples, position, normal)
    near_m = lamp.shadow.near_m
    seen = np.stack([casters.is_visible(lifted, point, near_m=near_m) for point in samples.points])
    whole = weights.sum(axis=0)
    arrives = np.einsum("nm,nmc->mc", seen, weights)
    # A channel that no sample has: whatever is seen of the others.
    plain = np.broadcast_to(seen.mean(axis=0)[:, None], whole.shape)
    return np.divide(arrives, whole, out=plain.astype(np.float64), where=whole > 0)


def illuminate(
    surface: Surface,
    lamps: Sequence[Lamp],
    rays: ShadowRays,
    /,
    *,
    bias_m: NDArray[np.float64],
    bodies: Sequence[str] = (),
    balls: Sequence[GlassBall] = (),
) -> Float:
    """Illuminance (H, W, 3) in lux that `lamps` add to `surface`; 0 in holes.

    Parameters
    ----------
    rays : against what casts shadows.
    bias_m : (H, W) lift along the normal before a shadow ray starts, metres.
    bodies : names of the luminous bodies that `surface.body_id` and `surface.shell_id` count.
    balls : of glass, which bend the light of point, spot, measured and directional lamps.
    """
    total = np.zeros((*surface.view.shape, 3))
    mask = surface.valid
    position, normal = surface.position[mask], surface.normal[mask]
    lifted = position + normal * bias_m[mask][:, None]
    body = None if surface.body_id is None else surface.body_id[mask]
    shell = None if surface.shell_id is None else surface.shell_id[mask]
    added = np.zeros_like(position)
    for lamp in lamps:
        own = None
        if isinstance(lamp, AreaLamp) and lamp.body in bodies and body is not None:
            own = body == list(bodies).index(lamp.body)
        if lamp.owner in bodies and shell is not None:
            # Of a real shell the bulb's light, too, is in the light of the shell itself.
            inside = shell == list(bodies).index(lamp.owner)
            own = inside if own is None else own | inside
        added += arriving(lamp, position, normal, lifted, rays, balls, own)
    total[mask] = added
    return total


def arriving(
    lamp: Lamp,
    position: Float,
    normal: Float,
    lifted: Float,
    rays: ShadowRays,
    balls: Sequence[GlassBall] = (),
    own: NDArray[np.bool_] | None = None,
    /,
) -> Float:
    """Illuminance (n, 3) of one lamp, shadow included; 0 on its `own` body (n,)."""
    light = illuminance(lamp, position, normal)
    if own is not None:
        light[own] = 0
    lit = np.abs(light).max(axis=-1) > 0
    if served := served_balls(lamp, balls):
        # Where the lamp does not shine by itself, there is no line to it that could be hidden.
        is_open, bent = through_balls(lamp, served, position, normal)
        light = light * is_open[:, None] + bent
        lit &= np.abs(light).max(axis=-1) > 0
    light[lit] *= seen_share(lamp, position[lit], normal[lit], lifted[lit], rays)
    return light


def seen_share(
    lamp: Lamp, position: Float, normal: Float, lifted: Float, rays: ShadowRays, /
) -> Float:
    """(n, 3) or (n, 1) share of a lamp's light at `position` (n, 3) that nothing hides."""
    if not isinstance(lamp, AreaLamp):
        return visibility(lamp, lifted, rays)[:, None].astype(float)
    shares = [
        visible_share(lamp, position[part], normal[part], lifted[part], rays)
        for part in _slices(len(position))
    ]
    return np.concatenate(shares) if shares else np.ones((0, 3))


def _slices(count: int) -> list[slice]:
    # Samples × receivers × 3 float64 stay below some 100 MB.
    return [slice(start, start + (1 << 16)) for start in range(0, count, 1 << 16)]
