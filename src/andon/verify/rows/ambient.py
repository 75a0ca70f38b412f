"""E0 estimated from one photograph and its geometry, against Radiance's, beside one E0 everywhere.

Errors are |E0 / true E0 − 1| over all pixels and channels after the best scale of each channel,
which the photograph does not tell; one E0 everywhere has the same advantage.

``ANDON_SHEETS`` names a folder for a sheet of each room: photograph, true E0, and the estimate.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.ambient import AmbientEstimate, estimate_ambient
from andon.capture.still import frame_from_picture
from andon.files.pictures import Picture, write_png
from andon.quantities import CameraFrame, photometric
from andon.responses import SRGB
from andon.transport.direct import reference as direct
from andon.verify.lit_rooms import ROOMS, Photographed, photographed
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS", "error_of", "estimated", "relit_error"]

Float = NDArray[np.float64]

DIMMING = 0.3
# A median of rooms lies within this many times what is stated, or the statement is of no use.
MOST_OF_STATED = 1.5


def _photograph(room: str) -> tuple[CameraFrame, Photographed]:
    try:
        found = photographed(room)
    except ImportError as error:
        raise NotShown("Radiance is missing: pip install 'andon[radiance]'") from error
    picture = Picture(found.codes, "srgb")
    return frame_from_picture(picture, found.seen.view, SRGB, luminance_per_unit=1.0), found


@cache
def estimated(room: str, *, sources: bool = False) -> AmbientEstimate:
    """What is found of a room, with or without the lamps that its scene states."""
    frame, found = _photograph(room)
    known = [
        np.nan_to_num(direct.illuminance(lamp, found.seen.position, found.seen.normal))
        for lamp in (found.known if sources else ())
    ]
    estimate = estimate_ambient(frame, found.seen, sources_lux=known)
    if not sources:
        _sheet(room, estimate)
    return estimate


def _scaled(room: str, e0: Float) -> tuple[Float, Float]:
    """An E0 (H, W, 3) times the best factor of each channel, and the true one: (n, 3) lux each."""
    _, found = _photograph(room)
    ours, truth = e0[found.seen.valid], found.e0_lux[found.seen.valid]
    return ours * np.median(truth / ours, axis=0), truth


def error_of(room: str, quantile: float, *, constant: bool = False, sources: bool = False) -> float:
    """A quantile of the error of the estimate, or of one E0 everywhere."""
    e0 = estimated(room, sources=sources).relative
    ours, truth = _scaled(room, np.ones_like(e0) if constant else e0)
    return float(np.quantile(np.abs(ours / truth - 1), quantile))


def relit_error(room: str, *, constant: bool = False) -> float:
    """Median error of what pixels are multiplied by: a lamp is added, and E0 dimmed to 30 %.

    The lamp shines as a point at the camera's place plus (0.8, 0.6, −1) m and gives as much light
    in the mean as there is.
    """
    e0 = estimated(room).relative
    ours, truth = _scaled(room, np.ones_like(e0) if constant else e0)
    _, found = _photograph(room)
    seen = found.seen
    reach = seen.view.position + np.array([0.8, 0.6, -1.0]) - seen.position[seen.valid]
    square = (reach**2).sum(axis=1)
    cosine = np.maximum((reach * seen.normal[seen.valid]).sum(axis=1), 0)
    added = (cosine / square**1.5)[:, None] * np.ones(3)
    added *= photometric(truth).mean() / added.mean()
    factors = (DIMMING + added / ours) / (DIMMING + added / truth)
    return float(np.median(np.abs(factors - 1)))


def _of_stated(room: str) -> float:
    """The median error over what is stated of it."""
    return error_of(room, 0.5) / estimated(room).stated_error


def _sheet(room: str, estimate: AmbientEstimate) -> None:
    folder = os.environ.get("ANDON_SHEETS")
    if not folder:
        return
    _, found = _photograph(room)
    ours = np.where(np.isfinite(found.e0_lux), estimate.relative, np.nan)
    ours *= np.nanmedian(found.e0_lux / ours, axis=(0, 1))
    white = np.nanquantile(found.e0_lux, 0.98)
    shown = [
        np.asarray(SRGB.encode(np.clip(np.nan_to_num(lux / white), 0, 1)) * 255 + 0.5, np.uint8)
        for lux in (found.e0_lux, ours)
    ]
    Path(folder).mkdir(parents=True, exist_ok=True)
    sheet = np.concatenate([found.codes, *shown], axis=1)
    write_png(Path(folder) / f"ambient-{room}.png", sheet)


AGAINST = "Radiance's E0 with three reflections, 160×120, 8-bit photograph"


def _rows(room: str) -> tuple[Row, ...]:
    def beside(ours: Callable[[], float], plain: Callable[[], float]) -> Callable[[], float]:
        return lambda: ours() / plain()

    name, share = f"relight.ambient.{room}", "of the error of one E0"
    median, tail, relit = (
        beside(lambda: error_of(room, 0.5), lambda: error_of(room, 0.5, constant=True)),
        beside(lambda: error_of(room, 0.95), lambda: error_of(room, 0.95, constant=True)),
        beside(lambda: relit_error(room), lambda: relit_error(room, constant=True)),
    )
    ours = f"{AGAINST}: median of |E0/truth − 1|"
    return (
        Row(f"{name}.error", "relight", None, "share of E0", ours, lambda: error_of(room, 0.5)),
        Row(f"{name}.median", "relight", 1.0, share, f"{AGAINST}: its median", median),
        Row(f"{name}.p95", "relight", 1.0, share, f"{AGAINST}: its 95th percentile", tail),
        Row(f"{name}.relit", "relight", 1.0, share, f"{AGAINST}: the relit ratio's median", relit),
        Row(
            f"{name}.stated",
            "relight",
            MOST_OF_STATED,
            "of the stated error",
            ours,
            lambda: _of_stated(room),
        ),
    )


ROWS: tuple[Row, ...] = (
    *(row for room in ROOMS for row in _rows(room)),
    Row(
        "relight.ambient.flash.named",
        "relight",
        1.0,
        "of the error of one E0",
        f"{AGAINST}: its 95th percentile, the lamp at the camera being named",
        lambda: error_of("flash", 0.95, sources=True) / error_of("flash", 0.95, constant=True),
    ),
)
