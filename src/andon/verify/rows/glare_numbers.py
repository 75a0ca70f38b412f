"""Rows of the numbers of glare: Radiance's programs on the same light, and the CIE's own values."""

from __future__ import annotations

import os
import re
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.files.pictures import read_picture
from andon.glare.calibration import calibrated
from andon.glare.cleaning import cleaned
from andon.glare.kernel import Kernel
from andon.glare.numbers import position_index, unified_glare_rating, veil_towards
from andon.glare.numbers.evalglare import Evalglare, evalglare
from andon.glare.numbers.measure import GlareNumbers, measured
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye
from andon.quantities import photometric
from andon.spaces import View
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS"]

Float = NDArray[np.float64]
AHEAD = np.array([0.0, 0.0, 1.0])
# The published view of Radiance's list of sources.
LISTED_VIEW, LISTED_UP = np.array([-0.703298, 0.706112, 0.0]), np.array([0.0, 0.0, 1.0])
SOURCE = re.compile(r"^\t" + r"\s+".join([r"(-?[\d.]+)"] * 5) + r"$", re.MULTILINE)
PAIR = re.compile(r"^\s*(-?[\d.]+)\t(-?[\d.]+)$", re.MULTILINE)


def _data(*parts: str) -> Path:
    path = Path(os.environ.get("ANDON_DATA", "")).joinpath(*parts)
    if not os.environ.get("ANDON_DATA") or not path.exists():
        raise NotShown(f"needs {'/'.join(parts)} in the folder that ANDON_DATA names")
    return path


@cache
def _sunset() -> tuple[GlareNumbers, Evalglare]:
    """A photographed sunset (fish-eye, 180°), measured here and by evalglare."""
    seen = calibrated(read_picture(_data("radiance_tests", "px", "ref", "test.hdr")))
    light = cleaned(seen.luminance_cd_m2, seen.view, seen.shows).light
    kernel = Kernel(spread_function("cie146-stiles-holladay"))
    numbers = measured(light, seen.view, kernel, AHEAD, seen.photometry)
    try:
        return numbers, evalglare(photometric(light), seen.view)
    except MachineError as error:
        raise NotShown(str(error)) from error


def _off(name: str, own: float | None) -> float:
    if own is None:
        raise NotShown(f"the sunset has no {name}")
    return abs(own - _sunset()[1].values[name])


def _listed_ugr() -> float:
    """Largest difference of UGR over 19 directions in an office of 30 sources."""
    folder = _data("radiance_tests", "util")
    text = (folder / "glaresrc.txt").read_text(encoding="ascii")
    sources = np.array(SOURCE.findall(text), np.float64)
    indirect = np.array(PAIR.findall(text.split("BEGIN indirect")[1]), np.float64)
    known = dict(
        np.array(
            PAIR.findall((folder / "ref" / "ugr.txt").read_text(encoding="ascii")), np.float64
        ).tolist()
    )
    directions = sources[:, :3] / np.linalg.norm(sources[:, :3], axis=1, keepdims=True)
    view = LISTED_VIEW / np.linalg.norm(LISTED_VIEW)
    worst = 0.0
    for degrees, lux in indirect.tolist():
        turn = np.radians(degrees)
        gaze = view * np.cos(turn) + np.cross(LISTED_UP, view) * np.sin(turn)
        index = position_index(directions, gaze, LISTED_UP, below=False)
        ugr = unified_glare_rating(sources[:, 4], sources[:, 3], index, lux / np.pi)
        worst = max(worst, abs((ugr or 0.0) - known[degrees]))
    return worst


def _veil_of_a_lamp() -> float:
    """Largest relative error of the veil of one pixel against E·10/θ²·(1 + (A/70)⁴)."""
    view = View("latlong", 720, 360)
    light = np.zeros((*view.shape, 3))
    light[180, 400] = 3000.0
    lux = 3000 * float(view.solid_angles()[180, 400])
    lamp = view.directions()[180, 400]
    across = np.cross(lamp, [0.0, 1, 0])
    worst = 0.0
    for age in (25.0, 70.0):
        kernel = Kernel(spread_function("cie146-stiles-holladay", Eye(age)))
        for degrees in (5.0, 10.0, 30.0):
            turn = np.radians(degrees)
            gaze = np.cos(turn) * lamp + np.sin(turn) * across
            veil = float(photometric(veil_towards(gaze[None], light, view, kernel)[0]))
            worst = max(worst, abs(veil * degrees**2 / (10 * lux * (1 + (age / 70) ** 4)) - 1))
    return worst


def _vertical() -> float:
    numbers, other = _sunset()
    return abs(numbers.vertical_lux / other.values["E_v"] - 1)


ROWS = (
    Row("glare.numbers.veil", "glare", 2e-3, "rel.", "CIE 146: 10·E/θ²", _veil_of_a_lamp),
    Row(
        "glare.numbers.ugr.listed",
        "glare",
        1e-5,
        "UGR",
        "Radiance's glarendx, published",
        _listed_ugr,
    ),
    Row("glare.numbers.vertical", "glare", None, "rel.", "evalglare, a sunset", _vertical),
    Row(
        "glare.numbers.ugr",
        "glare",
        None,
        "UGR",
        "evalglare, a sunset",
        lambda: _off("ugr", _sunset()[0].ugr),
    ),
    Row(
        "glare.numbers.dgp",
        "glare",
        None,
        "DGP",
        "evalglare, a sunset",
        lambda: _off("dgp", _sunset()[0].dgp),
    ),
)
