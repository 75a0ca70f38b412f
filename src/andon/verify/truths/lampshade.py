"""A lampshade's light by Radiance: paper as a *trans* material, all bounces in it traced.

Radiance wants what the paper does per hit, people state what it does in the end: t of the light
that meets it leaves through it, a is lost. `per_hit` finds the one from the other by following
rays that never die: p_k of those that meet the paper are still in it after k reflections, so that
(τ₀ + α₀)·Σ ρ₀ᵏ p_k = t + a has one solution.

A wall that looks at a lampshade from 2 m finds it with one in a hundred of its rays: `rtrace -I`
would be all noise. So the rays are aimed: those of each point fill the cone around the shade, and
Radiance says what each brings.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.files.radiance_programs import run_radiance
from andon.lamps import PointLamp
from andon.quantities import Geometry
from andon.rays import RayScene, face_normals
from andon.transport.baked.radiance.luminaires import POINT_RADIUS_M, point_text
from andon.transport.baked.radiance.text import LUMENS_PER_WATT, polygons_text

__all__ = ["Paper", "Walk", "lampshade_lux", "per_hit", "walk"]

Float = NDArray[np.float64]

WALKERS, STEPS = 200_000, 60
OFFSET_M = 1e-5
LIMIT_SECONDS = 300.0


@dataclass(frozen=True)
class Walk:
    """Rays of a bulb in a shade that reflects all.

    Attributes
    ----------
    met : share of the bulb's rays that meet the shade.
    stays : (k,) share of these that meet it again after 0, 1, 2… reflections.
    """

    met: float
    stays: Float


@dataclass(frozen=True)
class Paper:
    """Shares of the light at every hit: through, and back."""

    passes: float
    reflects: float


def walk(shade: Geometry, /, *, seed: int = 5) -> Walk:
    """Follows rays from the origin through `shade`, a layer without holes around it."""
    random = np.random.default_rng(seed)
    scene, normals = RayScene(shade), face_normals(shade)
    direction = _unit(random.normal(size=(WALKERS, 3)))
    place = np.zeros_like(direction)
    counts: list[int] = []
    for _ in range(STEPS):
        hits = scene.first_hits(place, direction)
        hit = np.isfinite(hits.distance)
        counts.append(int(hit.sum()))
        if not counts[-1]:
            break
        normal = normals[hits.triangle[hit]]
        towards = np.asarray(np.einsum("ij,ij->i", normal, direction[hit]), np.float64)
        normal = -np.sign(towards)[:, None] * normal
        along = hits.distance[hit][:, None] * direction[hit]
        place = np.asarray(place[hit] + along + OFFSET_M * normal, np.float64)
        # Lambert's law: a point on a unit sphere that touches the surface.
        direction = _unit(normal + _unit(random.normal(size=normal.shape)))
    return Walk(counts[0] / WALKERS, np.array(counts) / counts[0])


def per_hit(walk: Walk, /, *, t: float, a: float) -> Paper:
    """What the paper does at every hit so that t leaves through it and a is lost in the end."""
    low, high = 0.0, 1.0 if t + a < 1 else 0.0
    for _ in range(50):
        middle = (low + high) / 2
        kept = (1 - middle) * float(walk.stays @ middle ** np.arange(len(walk.stays)))
        low, high = (middle, high) if kept > t + a else (low, middle)
    reflects = (low + high) / 2
    return Paper((1 - reflects) * t / (t + a), reflects)


def lampshade_lux(
    shade: Geometry,
    paper: Paper,
    intensity_cd: float,
    points: Float,
    normals: Float,
    /,
    *,
    rays: int,
    bounces: int = 6,
    accuracy: float = 0.2,
    divisions: int = 512,
    seed: int = 1,
) -> tuple[Float, Float]:
    """(n,) lux of the bulb itself, and (n,) of the lit paper, at `points` (n, 3).

    The bulb is at the origin, a ball of 0.1 mm.

    Parameters
    ----------
    rays : of each point into the cone around the shade, a square number.
    bounces : reflections within the shade.
    accuracy, divisions : ``-aa`` and ``-ad`` of the light that goes round in it.
    """
    ask, weight = _aimed(shade, points, normals, rays, seed)
    with TemporaryDirectory(prefix="andon-radiance-") as name:
        folder = Path(name)
        octree = _octree(folder, shade, paper, intensity_cd)
        feed = np.concatenate([points - 1e-4 * normals, normals], axis=1)
        bulb = _traced(["-I", "-ab", "0"], octree, feed)
        fine = ["-aa", repr(accuracy), "-ad", str(divisions), "-as", str(divisions // 4)]
        deep = ["-ab", str(bounces), "-lr", "20", "-lw", "1e-6", "-dv-", "-ar", "200", *fine]
        lit = _traced(deep, octree, ask.reshape(-1, 6)).reshape(len(points), rays)
    return bulb, (lit * weight).sum(axis=1)


def _aimed(
    shade: Geometry, points: Float, normals: Float, rays: int, seed: int
) -> tuple[Float, Float]:
    """Rays (n, k, 6) that fill the cone around the shade, and cos φ·Δω (n, k) of each."""
    side = round(float(np.sqrt(rays)))
    random = np.random.default_rng(seed)
    radius = float(np.linalg.norm(shade.positions, axis=1).max()) * 1.001
    distance = np.linalg.norm(points, axis=1)
    axis = np.asarray(-points / distance[:, None], np.float64)
    least = np.sqrt(1 - (radius / distance) ** 2)
    row = np.arange(side)
    grid = np.stack([np.tile(row, side), np.repeat(row, side)], axis=1)
    jitter = random.uniform(size=(len(points), rays, 2))
    u, v = np.moveaxis((grid + jitter) / side, -1, 0)
    cosine = 1 - u * (1 - least)[:, None]
    sine = np.sqrt(np.maximum(1 - cosine**2, 0))
    right = _unit(np.cross(axis, np.eye(3)[np.abs(axis).argmin(axis=1)]))
    up = np.cross(axis, right)
    turn = 2 * np.pi * v
    w = (
        cosine[..., None] * axis[:, None]
        + (sine * np.cos(turn))[..., None] * right[:, None]
        + (sine * np.sin(turn))[..., None] * up[:, None]
    )
    weight = np.maximum(np.einsum("nki,ni->nk", w, normals), 0)
    weight = weight * (2 * np.pi * (1 - least) / rays)[:, None]
    starts = np.broadcast_to(points[:, None], w.shape)
    return np.concatenate([starts, w], axis=2), weight


def _octree(folder: Path, shade: Geometry, paper: Paper, intensity_cd: float) -> str:
    both = paper.passes + paper.reflects
    text = f"void trans paper 0 0 7 {both!r} {both!r} {both!r} 0 0 {paper.passes / both!r} 0\n"
    text += polygons_text(shade.positions[shade.triangles], "paper")
    bulb = PointLamp("bulb", np.zeros(3), np.full(3, intensity_cd))
    text += point_text(bulb, "bulb", hides=True, radius_m=POINT_RADIUS_M)[0]
    (folder / "scene.rad").write_text(text, encoding="ascii")
    scene = run_radiance("oconv", ["-w", str(folder / "scene.rad")], b"", LIMIT_SECONDS)
    (folder / "scene.oct").write_bytes(scene)
    return str(folder / "scene.oct")


def _traced(mode: list[str], octree: str, rays: Float) -> Float:
    """(n,) the first channel of what rays (n, 6) bring, in photometric units."""
    fixed = ["-h", "-w", "-fd", "-dt", "0", "-dc", "1", "-dj", "0", "-ds", "0"]
    feed = np.ascontiguousarray(rays, np.float64).tobytes()
    answer = run_radiance("rtrace", [*mode, *fixed, octree], feed, LIMIT_SECONDS)
    return np.frombuffer(answer, np.float64).reshape(-1, 3)[:, 1] * LUMENS_PER_WATT


def _unit(vectors: Float) -> Float:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
