"""Area lamps: their closed forms against quadrature, and the GPU against the closed forms."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.lamps import AnyAreaLamp, DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.kinds import middle_of_area
from andon.pipeline import EngineName, Renderer
from andon.transport.direct import reference
from andon.verify.registry import Row
from andon.verify.rows.closed_forms import (
    GRAZING,
    floor_view,
    plane_points,
    tilted_floor,
)
from andon.verify.setting import prepared_of
from andon.verify.truths import cones

__all__ = ["KINDS", "ROWS", "area_floor_error", "area_lamp", "area_reference"]

Float = NDArray[np.float64]

KINDS = ("sphere", "disk", "polygon", "tube", "mesh")
WHITE = np.full(3, 1000.0)
# Metres from the lamp's middle: nearly in contact, as near as lamps are looked at, far.
DISTANCES = (0.13, 0.5, 6.0)
# Share of the lamp's size that a receiver keeps from it: the quadrature knows no inside.
CLEAR = 1.02


def area_lamp(kind: str, centre: Float, /, *, facing: Float) -> AnyAreaLamp:
    """A lamp of about 0.2 m at `centre` (3,) that shines along the unit vector `facing` (3,).

    Disk and polygon are turned 40° away from it, so that low ones dip below the horizon.
    """
    right = np.cross(facing, [0.3, 0.5, -0.8])
    right /= np.linalg.norm(right)
    up = np.cross(facing, right)
    turn = np.radians(40)
    front = np.cos(turn) * facing + np.sin(turn) * right
    side = np.cross(up, front)
    name = f"a {kind}"
    match kind:
        case "sphere":
            lamp = SphereLamp(name, WHITE, centre, 0.1)
        case "disk":
            lamp = DiskLamp(name, WHITE, centre, front, 0.1)
        case "polygon":
            angles = np.radians([0, 50, 140, 215, 290])[:, None]
            reach = np.array([0.1, 0.12, 0.08, 0.12, 0.1])[:, None]
            around = np.cos(angles) * side + np.sin(angles) * up
            corners = np.asarray(centre + reach * around, np.float64)
            lamp = PolygonLamp(name, WHITE, corners)
        case "tube":
            along = 0.8 * right + 0.6 * facing
            lamp = TubeLamp(
                name, WHITE, np.stack([centre - 0.1 * along, centre + 0.1 * along]), 0.03
            )
        case _:
            lamp = _prism(name, centre, facing, right)
    return replace(lamp, shadow=None, drawn=False)


def _prism(name: str, centre: Float, facing: Float, right: Float) -> MeshLamp:
    """A closed tapering box of 12 triangles, each of its own luminance and colour."""
    other = np.cross(facing, right)
    signs = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    size = np.where(signs[:, 2:] > 0, 0.06, 0.09)
    corners = centre + size * (signs[:, :1] * right + signs[:, 1:2] * other)
    corners = corners + 0.08 * signs[:, 2:] * facing
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (3, 2, 6, 7), (1, 3, 7, 5), (2, 0, 4, 6)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)
    facets = np.random.default_rng(3).uniform(200, 1800, (len(triangles), 3))
    return MeshLamp(name, facets.mean(axis=0), corners, triangles, facets)


@cache
def area_reference(kind: str) -> float:
    """Largest error of the closed form, from receivers that face the lamp to 120° off it.

    Relative to the light, and near the horizon to what the lamp gives at cos φ = `GRAZING`.
    """
    worst = 0.0
    for number, distance in enumerate(DISTANCES):
        towards = np.random.default_rng(number).normal(size=3)
        towards /= np.linalg.norm(towards)
        lamp = area_lamp(kind, distance * towards, facing=-towards)
        normal = _turned(towards, np.radians(np.linspace(0, 120, 41)))
        position = np.zeros_like(normal)
        truth = cones.illuminance(lamp, position, normal)
        ours = reference.illuminance(lamp, position, normal)
        least = cones.illuminance(lamp, position, _grazing(towards, normal))
        error = np.abs(ours - truth) / np.maximum(truth, least)
        worst = max(worst, float(error.max()))
    return worst


def _turned(axis: Float, angles: Float) -> Float:
    """(4k, 3) unit vectors at `angles` (k,) from `axis`, to four sides."""
    across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    across /= np.linalg.norm(across)
    other = np.cross(axis, across)
    side = [np.cos(t) * across + np.sin(t) * other for t in np.radians(np.arange(4) * 90 + 10)]
    return np.concatenate(
        [np.cos(angles)[:, None] * axis + np.sin(angles)[:, None] * s for s in side]
    )


def _grazing(towards: Float, normal: Float) -> Float:
    """(..., 3) the normals, turned until `towards` (..., 3) lies at cos φ = `GRAZING`."""
    cosine = np.einsum("...i,...i->...", towards, normal)[..., None]
    aside = normal - cosine * towards
    length: Float = np.linalg.norm(aside, axis=-1, keepdims=True)
    # Overhead any side will do.
    level = np.cross(towards, np.roll(towards, 1, axis=-1) + np.array([1.0, 0.3, 0.0]))
    level = level / np.linalg.norm(level, axis=-1, keepdims=True)
    is_overhead = length < 1e-6
    side: Float = (aside + is_overhead * (level - aside)) / np.where(is_overhead, 1.0, length)
    return GRAZING * towards + np.sqrt(1 - GRAZING**2) * side


@cache
def area_floor_error(kind: str, engine: EngineName) -> float:
    """Largest error of a picture of a tilted floor under a low, a middle and a high lamp.

    Against the closed form in float64 at each pixel, as `area_reference`; and the closed form there
    against the quadrature, in every 311th pixel. What lies inside a lamp is left out.
    """
    floor, normal = tilted_floor()
    view = floor_view(normal)
    points = plane_points(view, normal)
    aside = np.cross(normal, [0.0, 0.0, 1.0])
    worst = 0.0
    for height in (0.05, 0.5, 2.0):
        lamp = area_lamp(kind, normal * height + 0.3 * aside, facing=-normal)
        frame = Renderer(prepared_of(floor, view, (lamp,)), engine).render()
        seen = frame.surface.valid & _outside(lamp, points)
        at = points[seen]
        up = np.broadcast_to(normal, at.shape)
        truth = reference.illuminance(lamp, at, up)
        allowed = np.maximum(truth, _least(lamp, at, up))
        error = np.abs(np.asarray(frame.illuminance.lux, float)[seen] - truth) / allowed
        some = slice(None, None, 311)
        check = np.abs(cones.illuminance(lamp, at[some], up[some]) - truth[some]) / allowed[some]
        worst = max(worst, float(error.max()), float(check.max()))
    return worst


def _least(lamp: AnyAreaLamp, points: Float, normals: Float) -> Float:
    """(n, 3) lux near the horizon of receiver or lamp: what it gives at `GRAZING` from there.

    The receiver's horizon by the closed form; a flat lamp's own, where it is seen edge on, as from
    a small one.
    """
    reach = middle_of_area(lamp) - points
    square = np.einsum("ni,ni->n", reach, reach)
    towards = reach / np.sqrt(square)[:, None]
    least = reference.illuminance(lamp, points, _grazing(towards, normals))
    if not isinstance(lamp, DiskLamp | PolygonLamp):
        return least
    cosine = np.maximum(np.einsum("ni,ni->n", towards, normals), GRAZING)
    edge_on = GRAZING * cosine * _area(lamp) / (square + _area(lamp) / np.pi)
    return np.maximum(least, edge_on[:, None] * lamp.luminance_cd_m2)


def _area(lamp: DiskLamp | PolygonLamp) -> float:
    if isinstance(lamp, DiskLamp):
        return float(np.pi * lamp.radius_m**2)
    arms = lamp.vertices_m - lamp.vertices_m[0]
    return float(np.linalg.norm(np.cross(arms, np.roll(arms, -1, axis=0)).sum(axis=0))) / 2


def _outside(lamp: AnyAreaLamp, points: Float) -> NDArray[np.bool_]:
    """(...) bool: clear of the lamp's body; of a flat lamp everything is."""
    match lamp:
        case SphereLamp():
            return np.linalg.norm(points - lamp.position_m, axis=-1) > CLEAR * lamp.radius_m
        case TubeLamp():
            start, along = lamp.ends_m[0], lamp.ends_m[1] - lamp.ends_m[0]
            share = np.clip((points - start) @ along / (along @ along), 0, 1)
            beside = points - start - share[..., None] * along
            return np.linalg.norm(beside, axis=-1) > CLEAR * lamp.radius_m
        case MeshLamp():
            corners = lamp.positions_m[lamp.triangles]
            out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            out /= np.linalg.norm(out, axis=1, keepdims=True)
            height = points @ out.T - np.einsum("mi,mi->m", corners[:, 0], out)
            return height.max(axis=-1) > (CLEAR - 1) * 0.1
        case _:
            return np.ones(points.shape[:-1], bool)


def _rows(kind: str) -> tuple[Row, ...]:
    return (
        Row(
            f"relight.area.{kind}.reference",
            "relight",
            1e-6,
            "relative",
            "quadrature over the cone of directions, horizon included",
            lambda: area_reference(kind),
        ),
        Row(
            f"relight.area.{kind}.gpu",
            "relight",
            1e-3,
            "relative",
            "closed forms and quadrature on a tilted floor, horizon included",
            lambda: area_floor_error(kind, "gpu"),
        ),
    )


ROWS: tuple[Row, ...] = tuple(row for kind in KINDS for row in _rows(kind))
