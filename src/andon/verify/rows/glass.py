"""Rows of refraction: Snell's law, and rays through bodies against Mitsuba's."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Solid
from andon.glass.refraction import refracted
from andon.pipeline import EngineName
from andon.verify.glass_rays import refracted_on_gpu, seen_through
from andon.verify.glass_setting import PX_M, body, drinking_glass, eye_views, rays_of
from andon.verify.registry import Row
from andon.verify.truths.mitsuba_glass import GlassScene

__all__ = ["ROWS", "against_mitsuba", "errors_px", "snell_error"]

Float = NDArray[np.float64]

ENGINES: tuple[EngineName, ...] = ("reference", "gpu")
# Every so many pixels are compared, along rows and columns.
STEP = 8
WITHIN_PX = 2.0


def snell_error(engine: EngineName) -> float:
    """Largest error of a refracted unit vector's component, 0…89°, into glass and out of it.

    Infinite where total reflection is flagged wrongly.
    """
    angles = np.radians(np.arange(0, 89.01, 0.25))
    random = np.random.default_rng(7)
    worst = 0.0
    for before, after in ((1.0, 1.51), (1.51, 1.0), (1.33, 1.51), (1.51, 1.33)):
        normal, across = _frames(random, len(angles))
        directions = np.sin(angles)[:, None] * across - np.cos(angles)[:, None] * normal
        sine = before / after * np.sin(angles)
        total = sine > 1
        inside = np.arcsin(np.where(total, 0, sine))
        wanted = np.sin(inside)[:, None] * across - np.cos(inside)[:, None] * normal
        bend = refracted_on_gpu if engine == "gpu" else refracted
        found, flagged = bend(directions, normal, before, after)
        if (flagged != total).any():
            return float("inf")
        worst = max(worst, float(np.abs(found - wanted)[~total].max()))
    return worst


def _frames(random: np.random.Generator, count: int) -> tuple[Float, Float]:
    """Two unit vectors (n, 3) each, across one another, of any direction."""
    normal, other = random.normal(size=(2, count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    across = np.cross(normal, other)
    return normal, across / np.linalg.norm(across, axis=1, keepdims=True)


@cache
def solids_named(name: str) -> tuple[Solid, ...]:
    """A body of `glass_setting`, or ``real``: the drinking glass of ANDON_DATA."""
    return drinking_glass() if name == "real" else body(name)


@cache
def _truth(name: str, step: int) -> tuple[Float, Float, Float]:
    """Origins and directions (n, 3) of both eyes' rays that meet glass, and where they land."""
    return landed_by_mitsuba(solids_named(name), step)


def landed_by_mitsuba(solids: Sequence[Solid], step: int) -> tuple[Float, Float, Float]:
    """As `_truth`, of any solids; rays that Mitsuba does not land are left out."""
    scene = GlassScene(solids)
    both = [rays_of(view, step) for view in eye_views()]
    origins, directions = (np.concatenate(parts) for parts in zip(*both, strict=True))
    landing = scene.land(origins, directions)
    kept = landing.glass & np.isfinite(landing.points[:, 0])
    return origins[kept], directions[kept], landing.points[kept]


@cache
def errors_px(engine: EngineName, name: str, step: int = STEP) -> Float:
    """(n,) how far from Mitsuba's each ray lands, in pixels of the backdrop beside the glass.

    Infinite where it does not land.
    """
    origins, directions, points = _truth(name, step)
    found = seen_through(engine, solids_named(name), origins, directions)
    off = np.linalg.norm(found.points - points, axis=1) / PX_M
    return np.where(np.isfinite(off), off, np.inf)


def against_mitsuba(engine: EngineName, name: str, step: int = STEP) -> float:
    """Median of `errors_px`."""
    return float(np.median(errors_px(engine, name, step)))


def share_near(engine: EngineName, name: str, step: int = STEP) -> float:
    """Share of the rays that land within 2 px of Mitsuba's."""
    return float((errors_px(engine, name, step) <= WITHIN_PX).mean())


TRUTHS = {
    "ball": "Ø150 mm, n = 1.51, 0.4 m from the eyes",
    "slab": "180×120×30 mm, turned by 25°",
    "lens": "two caps of 0.12 and 0.2 m; Mitsuba's is a fine mesh of it",
    "nested": "a bubble in water in glass, off the axis",
    "goblet": "a turned vessel of 30,000 triangles, smooth normals",
}


def _position_rows(engine: EngineName) -> tuple[Row, ...]:
    truth = "Mitsuba's rays refracted by its dielectric to the backdrop, both eyes, 720p; "
    medians = tuple(
        Row(
            f"glass.{name}.{engine}",
            "glass",
            0.5,
            "px",
            f"{truth}{TRUTHS[name]}; median",
            partial(against_mitsuba, engine, name),
        )
        for name in ("ball", "slab", "lens", "nested")
    )
    return medians


def _rows(engine: EngineName) -> tuple[Row, ...]:
    snell = Row(
        f"glass.refraction.{engine}",
        "glass",
        1e-12 if engine == "reference" else 1e-4,
        "of a unit vector",
        "Snell's law at 0…89°, total reflection flagged",
        partial(snell_error, engine),
    )
    mesh = Row(
        f"glass.mesh.{engine}",
        "glass",
        0.9,
        "share of pixels",
        f"Mitsuba's rays through the same mesh, within 2 px; {TRUTHS['goblet']}",
        partial(share_near, engine, "goblet"),
        at_least=True,
    )
    real = Row(
        f"glass.mesh.real.{engine}",
        "glass",
        None,
        "share of pixels",
        "Mitsuba's rays through the same mesh, within 2 px; a drinking glass of flat facets",
        partial(share_near, engine, "real"),
    )
    return (snell, *_position_rows(engine), mesh, real)


ROWS: tuple[Row, ...] = tuple(row for engine in ENGINES for row in _rows(engine))
