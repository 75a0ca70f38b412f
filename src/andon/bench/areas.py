"""What an area lamp costs, with and without its soft shadow, and what its samples buy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from statistics import median
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from andon.bench.registry import BenchRow, Duel
from andon.bench.relight import PIXELS, steady
from andon.lamps import AnyAreaLamp, DiskLamp, PolygonLamp, Shadow, SphereLamp, TubeLamp
from andon.lamps.areas import SOFT_SHADOW
from andon.pipeline import Renderer
from andon.verify.rooms import camera_in
from andon.verify.setting import prepared_of, room, room_lamps

__all__ = ["KINDS", "ROWS", "area_lamp", "costs_and_errors"]

Float = NDArray[np.float64]

MAP_SIZE = SOFT_SHADOW.map_size

KINDS = ("sphere", "disk", "rectangle", "tube")
# A pixel agrees within this share of the truth, or this share of the brightest.
RELATIVE, OF_BRIGHTEST = 0.05, 0.01


def area_lamp(kind: str, shadow: Shadow | None) -> AnyAreaLamp:
    """A lamp of about 0.2 m where the furnished room's first lamp hangs."""
    at, light = room_lamps(1)[0].position_m, np.array([900.0, 800.0, 600.0])
    down, across = np.array([0.0, -1.0, 0.0]), np.array([0.1, 0.0, 0.0])
    along = np.array([0.0, 0.0, 0.1])
    match kind:
        case "sphere":
            return SphereLamp(kind, light, at, 0.1, shadow=shadow)
        case "disk":
            return DiskLamp(kind, light, at, down, 0.1, shadow=shadow)
        case "rectangle":
            corners = [-across - along, across - along, across + along, along - across]
            return PolygonLamp(kind, light, at + np.stack(corners), shadow=shadow)
        case _:
            return TubeLamp(kind, light, at + np.stack([-4 * across, 4 * across]), 0.02,
                            shadow=shadow)  # fmt: skip


def _renderer(lamps: tuple[AnyAreaLamp, ...], width: int, height: int, engine: str) -> Renderer:
    view = camera_in(room(), width, height)
    return Renderer(prepared_of(room(), view, lamps), engine)  # type: ignore[arg-type]


def _duel(kind: str, samples: int | None) -> Duel:
    """One area lamp in the furnished room, less the frame without it, beside the reference."""
    shadow = None if samples is None else Shadow(MAP_SIZE, samples=samples)
    lamps = (area_lamp(kind, shadow),)
    ours = _renderer(lamps, 1280, 720, "gpu")
    peer = _renderer(lamps, 320, 180, "reference")
    small = _renderer(lamps, 320, 180, "gpu")
    fast, slow = (np.asarray(r.render().illuminance.lux, float) for r in (small, peer))
    close = np.abs(fast - slow) <= RELATIVE * slow + OF_BRIGHTEST * slow.max()
    return Duel(
        steady(ours),
        lambda: [steady(peer)() for _ in range(16)],
        float(close.mean()),
        0.95,
        ours._engine.adapter,  # pyright: ignore[reportPrivateUsage]
        peer_repeats=1,
        ours_less=steady(_renderer((), 1280, 720, "gpu")),
    )


def _median_seconds(step: Callable[[], object], repeats: int) -> float:
    step()
    times: list[float] = []
    for _ in range(repeats):
        start = perf_counter()
        step()
        times.append(perf_counter() - start)
    return median(times)


def costs_and_errors(
    kind: str, counts: tuple[int, ...], /, *, truth_samples: int = 256, repeats: int = 5
) -> list[tuple[int, float, float]]:
    """For each count of samples: the lamp's milliseconds at 1280×720, and its error.

    The error is the RMS difference to `truth_samples` rays a pixel (the reference), as a share of
    the RMS of the light itself, on 320×180 pixels. A count of 0 is the lamp without a shadow,
    whose error is that of leaving the shadow out.
    """
    fine = area_lamp(kind, Shadow(MAP_SIZE, samples=truth_samples))
    truth = _lux(_renderer((fine,), 320, 180, "reference"))
    base = _median_seconds(steady(_renderer((), 1280, 720, "gpu")), repeats)
    found: list[tuple[int, float, float]] = []
    for count in counts:
        shadow = Shadow(MAP_SIZE, samples=count) if count else None
        lamps = (replace(fine, shadow=shadow),)
        seconds = _median_seconds(steady(_renderer(lamps, 1280, 720, "gpu")), repeats)
        lux = _lux(_renderer(lamps, 320, 180, "gpu"))
        error = np.sqrt(np.mean((lux - truth) ** 2) / np.mean(truth**2))
        found.append((count, (seconds - base) * 1e3, float(error)))
    return found


def _lux(renderer: Renderer) -> Float:
    return np.asarray(renderer.render().illuminance.lux, np.float64)


ROWS: tuple[BenchRow, ...] = tuple(
    BenchRow(
        f"relight.area.{kind}.{'plain' if samples is None else f'{samples}_samples'}",
        "relight",
        "our reference engine (NumPy, Embree), as many pixels",
        PIXELS,
        partial(_duel, kind, samples),
    )
    for kind in KINDS
    for samples in (None, 16)
)
