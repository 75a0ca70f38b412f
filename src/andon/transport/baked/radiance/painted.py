"""A reflectance for each triangle, as a bounded number of materials.

Radiance has no colour per polygon. Reflectances are sorted into cells of a grid in RGB, and those
of a cell get one material with their mean: no triangle is off by more than the width of a cell, and
what a patch reflects on the whole is exact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Geometry, Material

__all__ = ["LEVELS", "with_triangle_reflectance"]

LEVELS = 32


def with_triangle_reflectance(
    geometry: Geometry, rgb: NDArray[Any], /, *, levels: int = LEVELS
) -> Geometry:
    """`geometry` with materials so that triangle i has about the reflectance `rgb`[i].

    Parameters
    ----------
    rgb : (m, 3) diffuse reflectance of each triangle, 0…1; NaN takes the mean of the others.
    levels : 2…64 cells along each channel. A triangle is off by at most 1/levels, and by about a
        quarter of that on the average where reflectances are spread evenly within cells.

    Raises
    ------
    InputError : another number of triangles, or reflectances outside 0…1.
    """
    if not 2 <= levels <= 64:
        raise InputError(f"must be 2…64, got {levels}", field="levels")
    values = np.asarray(rgb, np.float64)
    count = len(geometry.triangles)
    if values.shape != (count, 3):
        raise InputError(f"must be ({count}, 3), got {values.shape}", field="rgb")
    known = np.asarray(np.isfinite(values).all(axis=1))
    if ((values[known] < 0) | (values[known] > 1)).any():
        raise InputError("must be 0…1", field="rgb", remedy="divide luminance·π by illuminance")
    mean = values[known].mean(axis=0) if known.any() else np.full(3, 0.5)
    values = np.where(known[:, None], values, mean)
    cells = np.minimum((values * levels).astype(np.int64), levels - 1)
    key = (cells[:, 0] * levels + cells[:, 1]) * levels + cells[:, 2]
    found, ids = np.unique(key, return_inverse=True)
    sums = np.stack(
        [np.bincount(ids, values[:, channel], len(found)) for channel in range(3)], axis=1
    )
    means = sums / np.bincount(ids, minlength=len(found))[:, None]
    materials = tuple(
        Material(f"reflectance {number}", (red, green, blue))
        for number, (red, green, blue) in enumerate(np.clip(means, 0, 1).tolist())
    )
    return replace(
        geometry, material_ids=ids.astype(np.int32), materials=materials or (Material(),)
    )
