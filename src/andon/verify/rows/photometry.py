"""Rows of photometric files: real luminaires against published lumens and against Radiance.

The files are product data of manufacturers and are not part of this package: ``ANDON_DATA`` names
the folder of data sets, of which ``ies_luminaires`` is one.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.photometry import Distribution, read_photometry
from andon.lamps.goniometry import candela, directions_of, flux_lm, maximum_cd
from andon.lamps.uniform import uniform_grid
from andon.verify.registry import NotShown, Row
from andon.verify.truths.luminaires import radiance_candela

__all__ = ["ROWS"]

Float = NDArray[np.float64]

# Lumens by Photometric Toolbox (Lighting Analysts), as the data set's own summary gives them.
TOOLBOX_LUMENS = {
    "cu_calc/1.IES": 9217.18,
    "cu_calc/3.IES": 13359.57,
    "cu_calc/5.IES": 753.8,
    "cu_calc/7.IES": 531.98,
}
TYPE_C = (*TOOLBOX_LUMENS, "tuberlin/HeadLight.ies")
TYPE_B = ("cu_calc/flood_2.1.IES", "cu_calc/flood_2.2.ies")

DIRECTIONS = 2000


def _file(name: str) -> Path:
    folder = os.environ.get("ANDON_DATA")
    if not folder:
        raise NotShown("ANDON_DATA is not set: the folder that holds ies_luminaires")
    path = Path(folder) / "ies_luminaires" / name
    if not path.is_file():
        raise NotShown(f"{path} is missing")
    return path


@cache
def _read(name: str) -> Distribution:
    return read_photometry(_file(name))


def _lumens() -> float:
    """Largest relative difference of our integral and the published lumens."""
    return max(abs(flux_lm(_read(name)) / lm - 1) for name, lm in TOOLBOX_LUMENS.items())


def _floodlight_lumens() -> float:
    floodlight = _read("cu_calc/flood_2.1.IES")
    return abs(flux_lm(floodlight) / (floodlight.stated_lumens or np.nan) - 1)


def _grid() -> float:
    return max(uniform_grid(_read(name)).error for name in (*TYPE_C, *TYPE_B))


def _against_ies2rad(names: tuple[str, ...], *, everywhere: bool) -> float:
    """Largest difference as a share of the maximum, in random directions within the file.

    Of a type B file only in its main planes: off them Radiance's angles are others (goniometry).
    """
    worst = 0.0
    random = np.random.default_rng(5)
    for name in names:
        lamp = _read(name)
        angles = [
            random.uniform(knots[0] + 0.5, knots[-1] - 0.5, DIRECTIONS)
            for knots in (lamp.horizontal_degrees, lamp.vertical_degrees)
        ]
        if not everywhere:
            angles[0][::2] = 0
            angles[1][1::2] = 0
        directions = directions_of(lamp, angles[0], angles[1])
        theirs = radiance_candela(_file(name), directions)
        difference = np.abs(candela(lamp, directions) - theirs).max()
        worst = max(worst, float(difference) / maximum_cd(lamp))
    return worst


ROWS: tuple[Row, ...] = (
    Row(
        "relight.photometry.lumens",
        "relight",
        0.003,
        "relative, the worst",
        "Photometric Toolbox's lumens of four real luminaires",
        _lumens,
    ),
    Row(
        "relight.photometry.lumens_type_b",
        "relight",
        None,
        "relative",
        "the lumens on the label of a type B floodlight",
        _floodlight_lumens,
    ),
    Row(
        "relight.photometry.candela",
        "relight",
        0.0002,
        "of the maximum",
        "Radiance ies2rad and rtrace, five type C files in 2000 directions each",
        lambda: _against_ies2rad(TYPE_C, everywhere=True),
    ),
    Row(
        "relight.photometry.candela_type_b",
        "relight",
        0.0002,
        "of the maximum",
        "Radiance ies2rad and rtrace, two type B floodlights in their main planes",
        lambda: _against_ies2rad(TYPE_B, everywhere=False),
    ),
    Row(
        "relight.photometry.grid",
        "relight",
        0.005,
        "of the maximum",
        "the files' own bilinear candela, from the table that the GPU reads",
        _grid,
    ),
)
