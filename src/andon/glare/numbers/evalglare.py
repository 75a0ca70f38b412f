"""Radiance's `evalglare` on the same luminances, as a cross-check of UGR, DGP and E_v.

It gets a grey picture of the photometric values: its own weights of red, green and blue differ from
Rec.709's by up to 3 % of coloured light, which would be compared instead of the indices.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, MachineError
from andon.files.pictures import write_hdr
from andon.files.pictures.radiance_view import line_of_view
from andon.files.radiance_programs import run_radiance
from andon.spaces import View

__all__ = ["Evalglare", "evalglare"]

LUMENS_PER_WATT = 179.0
LIMIT_SECONDS = 120.0
# Its picture is RGBE, whose smallest number this is about; 0 would be no number to its logarithms.
LEAST_CD_M2 = 1e-9


@dataclass(frozen=True)
class Evalglare:
    """What it printed.

    Attributes
    ----------
    values : by its own names: ``dgp``, ``E_v`` (lx), ``ugr``, ``lum_backg`` (cd/m²), ``dgi``,
        ``Lveil_cie`` (cd/m², Stiles–Holladay's veil of its sources) and others.
    sources : how many it found.
    """

    values: dict[str, float]
    sources: int


def evalglare(
    luminance_cd_m2: NDArray[np.float64], view: View, /, *, threshold_cd_m2: float = 2000.0
) -> Evalglare:
    """Runs it on photometric luminance (H, W) in cd/m², seen by a pinhole or fish-eye `view`.

    The line of sight is the optical axis, which must be in the picture's middle.

    Raises
    ------
    InputError
        for a latlong view, or one whose axis is off the middle.
    MachineError
        if Radiance is not installed (``pip install 'andon[radiance]'``) or the program fails.
    """
    words = [*_view_words(view), "-b", f"{threshold_cd_m2:.6g}", "-d"]
    grey = np.maximum(luminance_cd_m2, LEAST_CD_M2) / LUMENS_PER_WATT
    with tempfile.TemporaryDirectory(prefix="andon-evalglare-") as folder:
        path = Path(folder) / "picture.hdr"
        write_hdr(path, np.repeat(grey[..., None], 3, axis=-1))
        printed = run_radiance("evalglare", [*words, str(path)], b"", LIMIT_SECONDS)
    return _parsed(printed.decode(errors="replace"))


def _view_words(view: View) -> list[str]:
    if view.projection == "latlong":
        raise InputError(
            "evalglare takes pinhole and fish-eye pictures",
            field="view",
            remedy="resample the panorama to a fish-eye first",
        )
    middle = ((view.width - 1) / 2, (view.height - 1) / 2)
    if abs(view.cx - middle[0]) > 1 or abs(view.cy - middle[1]) > 1:
        raise InputError("the axis must be in the middle for evalglare", field="view")
    line = line_of_view(view)
    assert line is not None  # latlong was refused
    return line.split()[:5]


def _parsed(printed: str) -> Evalglare:
    lines = [line for line in printed.splitlines() if line.strip()]
    if not lines or ":" not in lines[-1]:
        raise MachineError("evalglare printed no numbers")
    names, numbers = lines[-1].split(":", 1)
    try:
        values = dict(zip(names.strip().split(","), map(float, numbers.split()), strict=False))
        found = int(lines[0].split()[0]) if "Omega_s" in lines[0] else 0
    except ValueError as error:
        raise MachineError(f"evalglare printed {lines[-1][:120]!r}") from error
    return Evalglare(values, found)
