"""Light from all sides as JSON: nine spherical harmonics of luminance, world axes.

::

    {"coefficients_cd_m2": [[282, 270, 255], [35, 30, 24], …]}      nine rows of r, g, b

in the order and sign of `andon.harmonics`; ``photometry`` beside it may say ``absolute`` or
``relative``. The `LightProbe` of three.js, which has the same numbers, is read as well: as
``andon probes export --format three`` and its own ``toJSON`` write it, alone or as the object of
a file. Its `intensity` multiplies.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.paths import open_bounded
from andon.files.reader import Reader
from andon.files.tree import Tree, check_complexity

__all__ = ["HARMONIC_READERS", "read_harmonics"]

ROWS = 9
OWN_KEYS = ("coefficients_cd_m2", "photometry", "note")
# Beyond the light of the sun (1.6e9 cd/m²) by far, and squares of it are still finite in float32.
MOST_CD_M2 = 1e15


def read_harmonics(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> NDArray[np.float64]:
    """(9, 3) coefficients of luminance in cd/m².

    Raises `InputError` for what is no such JSON, has other counts, or numbers that are none.
    """
    data = open_bounded(path, limits, max_bytes=limits.max_camera_bytes)
    try:
        value = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise InputError("must be JSON in UTF-8", file=path) from error
    check_complexity(value, str(path), limits)
    top = Tree(value, "", str(path))
    if "coefficients_cd_m2" in top:
        top.only(OWN_KEYS)
        rows = top.at("coefficients_cd_m2").elements()
        if len(rows) != ROWS:
            raise InputError(
                f"must be {ROWS} rows of r, g, b, got {len(rows)}",
                file=path,
                field="coefficients_cd_m2",
            )
        numbers = [row.numbers(3) for row in rows]
    else:
        numbers = _of_three(top.get("object") or top)
    found = np.array(numbers, np.float64).reshape(ROWS, 3)
    if not (np.abs(found) < MOST_CD_M2).all():
        raise InputError(f"must be less than {MOST_CD_M2:g} cd/m²", file=path)
    return found


def _of_three(light: Tree) -> list[float]:
    """27 numbers of a `LightProbe` of three.js."""
    kind = light.get("type")
    if kind is None or kind.text() != "LightProbe":
        raise light.error(
            "must have 'coefficients_cd_m2', or be one LightProbe of three.js",
            "andon probes export VOLUME --probe NAME --format three -o light.json",
        )
    intensity = light.get("intensity")
    factor = 1.0 if intensity is None else intensity.number(0)
    return [factor * number for number in light.at("sh").numbers(3 * ROWS)]


HARMONIC_READERS = (Reader("harmonics.json", (".json",), read_harmonics),)
