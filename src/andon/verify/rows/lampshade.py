"""An open lampshade in a black room against Radiance.

::

    ┌──────── 4 m ────────┐     A drum of paper, 0.3 m wide and 0.35 m high, open above and below,
    │          ▁          │     around a bulb of 800 lm in the middle of a room of 4 × 4 × 2.6 m
    │         │•│         │     that reflects nothing: what its surfaces get is what the lamp
    │          ▔          │     sends there, directly, through the paper, or out of the openings
    └─────────────────────┘     after reflections in the shade.

Excluded are points within 2 cm of the bulb's own hard shadow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.lamps import Body, Lamp, PointLamp, Shadow, Shell, expand
from andon.quantities import Geometry, Surface
from andon.rays import RayScene
from andon.spaces import View
from andon.transport.direct import reference
from andon.transport.direct.casters import Casters, ShadowRays
from andon.verify.registry import Row
from andon.verify.truths.lampshade import Walk, lampshade_lux, per_hit, walk

__all__ = ["CASES", "ROWS", "Lit", "against_radiance", "flux_error", "our_lux"]

Float = NDArray[np.float64]
Mode = Literal["exact", "paper"]

LUMENS = 800.0
INTENSITY_CD = LUMENS / (4 * np.pi)
HALF_M = np.array([2.0, 1.3, 2.0])
RADIUS_M, HEIGHT_M = 0.15, 0.35
AROUND, ALONG = 24, 4
# Net shares t and a: half of the light is let through, and what is left leaves by the openings;
# or nothing is reflected at all.
CASES = {"open": (0.5, 0.1), "dark": (0.5, 0.5)}
# Points along the short and the long sides of a wall; for sums over walls three times as many.
GRID = (8, 12)
NEAR_EDGE_M = 0.02
RAYS = 900


@dataclass(frozen=True)
class Lit:
    """Regular points on the six walls: `points`, `normals` (n, 3), and `areas` (n,) in m²."""

    points: Float
    normals: Float
    areas: Float


@cache
def drum() -> Geometry:
    """The shade: 24 × 4 quads around the origin, outside counter-clockwise."""
    turn = np.linspace(0, 2 * np.pi, AROUND + 1)
    rise = np.linspace(-HEIGHT_M / 2, HEIGHT_M / 2, ALONG + 1)
    ring = np.stack([RADIUS_M * np.sin(turn), 0 * turn, RADIUS_M * np.cos(turn)], axis=1)
    points = ring[None] + rise[:, None, None] * np.array([0.0, 1.0, 0.0])
    first = (np.arange(ALONG)[:, None] * (AROUND + 1) + np.arange(AROUND)).ravel()
    above = first + AROUND + 1
    quads = [first, first + 1, above + 1, first, above + 1, above]
    triangles = np.stack(quads, axis=1).reshape(-1, 3)
    return Geometry(points.reshape(-1, 3), triangles.astype(np.int32))


@cache
def _walk() -> Walk:
    return walk(drum())


@cache
def _walls(finer: int) -> Lit:
    parts: list[tuple[Float, Float, Float]] = []
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        counts = [finer * (GRID[0] if side == 1 else GRID[1]) for side in (first, second)]
        u, v = (
            ((np.arange(count) + 0.5) / count * 2 - 1) * float(HALF_M[side])
            for count, side in zip(counts, (first, second), strict=True)
        )
        for sign in (-1.0, 1.0):
            points = np.zeros((counts[0] * counts[1], 3))
            points[:, first], points[:, second] = np.tile(u, len(v)), np.repeat(v, len(u))
            points[:, axis] = sign * HALF_M[axis]
            normals = np.zeros_like(points)
            normals[:, axis] = -sign
            area = 4 * HALF_M[first] * HALF_M[second] / len(points)
            parts.append((points, normals, np.full(len(points), area)))
    points, normals, areas = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Lit(points, normals, areas)


def _expanded(case: str, mode: Mode) -> tuple[tuple[Lamp, ...], Body]:
    t, a = CASES[case]
    bulb = PointLamp("lamp", np.zeros(3), np.full(3, INTENSITY_CD), Shadow(filter="none"))
    return expand(bulb, Shell(mesh=drum(), transmittance=np.full(3, t), absorptance=a, mode=mode))


def our_lux(case: str, mode: Mode, walls: Lit, /) -> Float:
    """(n,) lux on the walls by the reference."""
    lamps, body = _expanded(case, mode)
    count = len(walls.points)
    surface = Surface(
        position=walls.points[None],
        normal=walls.normals[None],
        depth=np.ones((1, count)),
        valid=np.ones((1, count), bool),
        is_object=np.zeros((1, count), bool),
        reflectance=np.zeros((1, count, 3)),
        material_id=np.zeros((1, count), np.int32),
        emitted_cd_m2=np.zeros((1, count, 3)),
        view=View("latlong", count, 1),
    )
    rays = ShadowRays(Casters(((body.name, body.geometry),)))
    bias = np.full((1, count), 1e-4)
    return reference.illuminate(surface, lamps, rays, bias_m=bias, bodies=(body.name,))[0, :, 1]


@cache
def _truth(case: str) -> tuple[Float, Float]:
    """(n,) lux of the bulb, and of the paper, on the coarse walls by Radiance."""
    t, a = CASES[case]
    walls = _walls(1)
    paper = per_hit(_walk(), t=t, a=a)
    return lampshade_lux(drum(), paper, INTENSITY_CD, walls.points, walls.normals, rays=RAYS)


@cache
def _at_the_edge() -> NDArray[np.bool_]:
    """(n,) of the coarse walls: the bulb is hidden there and seen 2 cm from there, or the like."""
    walls, scene = _walls(1), RayScene(drum())
    seen: list[NDArray[np.bool_]] = []
    for shift in np.concatenate([np.eye(3), -np.eye(3), np.zeros((1, 3))]) * NEAR_EDGE_M:
        flat = shift - (walls.normals @ shift)[:, None] * walls.normals
        seen.append(scene.is_visible(walls.points + flat, np.zeros(3)))
    return np.any(seen, axis=0) != np.all(seen, axis=0)


@cache
def against_radiance(case: str, mode: Mode) -> tuple[float, float]:
    """Median and 95th percentile of the relative error on the walls."""
    kept = ~_at_the_edge()
    truth = np.sum(_truth(case), axis=0)[kept]
    error = np.abs(our_lux(case, mode, _walls(1))[kept] - truth) / truth
    return float(np.median(error)), float(np.percentile(error, 95))


def flux_error(case: str, mode: Mode) -> float:
    """How far the flux on all walls is from what the bulb sends out less what is absorbed."""
    walls = _walls(5)
    return abs(float(our_lux(case, mode, walls) @ walls.areas) / _expected_lm(case) - 1)


def _expected_lm(case: str) -> float:
    return LUMENS * (1 - CASES[case][1] * _walk().met)


def truth_flux_error(case: str) -> float:
    """The same of Radiance: the paper's light on the coarse walls, and what the bulb sends past."""
    past = LUMENS * (1 - _walk().met)
    _, paper = _truth(case)
    return abs((float(paper @ _walls(1).areas) + past) / _expected_lm(case) - 1)


@cache
def truth_noise(case: str) -> float:
    """Median difference of the truth from one by other rays, and coarser light in the shade."""
    (t, a), walls = CASES[case], _walls(1)
    paper, place = per_hit(_walk(), t=t, a=a), (walls.points, walls.normals)
    other = lampshade_lux(
        drum(), paper, INTENSITY_CD, *place, rays=RAYS, accuracy=0.3, divisions=256, seed=2
    )
    truth = np.sum(_truth(case), axis=0)
    return float(np.median(np.abs(np.sum(other, axis=0) - truth) / truth))


RADIANCE = "Radiance, paper as trans with all bounces in the shade; drum, 800 lm, black room"
BALANCE = "the bulb's lumens less what is absorbed"


def _rows(case: str, mode: Mode) -> tuple[Row, ...]:
    name, (t, a) = f"relight.lampshade.{case}.{mode}", CASES[case]
    against = f"{RADIANCE}; t = {t:g}, a = {a:g}"
    is_exact = mode == "exact"  # the other is the source paper's, and is what it is
    return (
        Row(
            f"{name}.median",
            "relight",
            0.03 if is_exact else None,
            "relative",
            against,
            lambda: against_radiance(case, mode)[0],
        ),
        Row(
            f"{name}.p95",
            "relight",
            None,
            "relative",
            against,
            lambda: against_radiance(case, mode)[1],
        ),
        Row(
            f"{name}.flux",
            "relight",
            0.01 if is_exact else None,
            "relative",
            BALANCE,
            lambda: flux_error(case, mode),
        ),
    )


ROWS: tuple[Row, ...] = (
    *(row for case in CASES for mode in ("exact", "paper") for row in _rows(case, mode)),
    *(
        Row(
            f"relight.lampshade.{case}.truth_flux",
            "relight",
            0.01,
            "relative",
            f"Radiance's light on the walls, {BALANCE}",
            lambda case=case: truth_flux_error(case),
        )
        for case in CASES
    ),
    *(
        Row(
            f"relight.lampshade.{case}.truth_noise",
            "relight",
            None,
            "relative, the median",
            "the truth by other rays and coarser light in the shade",
            lambda case=case: truth_noise(case),
        )
        for case in CASES
    ),
    Row(
        "relight.lampshade.left_out",
        "relight",
        None,
        "share",
        "points within 2 cm of the bulb's hard shadow",
        lambda: float(_at_the_edge().mean()),
    ),
)
