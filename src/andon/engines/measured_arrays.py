"""What is measured of the real surface, from arrays in memory instead of files."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient, MeasuredSurface
from andon.composite.per_lux import map_scale
from andon.engines.array_checks import described, numbers
from andon.engines.measured import checked_reflectance
from andon.errors import InputError
from andon.quantities import CameraFrame
from andon.responses import SurfaceCurve

__all__ = ["measured_arrays"]


def measured_arrays(
    reflectance_map: Any, curves: Any, frame: CameraFrame, ambient: Ambient, /
) -> MeasuredSurface | None:
    """See `andon.relight`; None where nothing is measured."""
    pairs = _pairs(curves, frame.view.shape)
    if reflectance_map is None and not pairs:
        return None
    rho = None if reflectance_map is None else _reflectance(reflectance_map, frame, ambient)
    if not pairs:
        return MeasuredSurface(rho)
    curve_of = np.full(frame.view.shape, -1, np.int16)
    for number, (_, own) in enumerate(pairs):
        curve_of[own] = number
    return MeasuredSurface(rho, tuple(curve for curve, _ in pairs), curve_of)


def _reflectance(reflectance_map: Any, frame: CameraFrame, ambient: Ambient) -> NDArray[np.float64]:
    height, width = frame.view.shape
    wanted = f"an array ({height}, {width}, 3) of linear ρ"
    rho = numbers(reflectance_map, "reflectance_map", wanted)
    if rho.shape != (height, width, 3):
        raise InputError(f"must be {wanted}, got {rho.shape}", field="reflectance_map")
    rho = checked_reflectance(rho, "reflectance_map")
    return map_scale(rho, frame, ambient) * rho


def _pairs(curves: Any, shape: tuple[int, int]) -> list[tuple[SurfaceCurve, NDArray[np.bool_]]]:
    """Each curve with its pixels."""
    if isinstance(curves, SurfaceCurve):
        return [(curves, np.ones(shape, bool))]
    wanted = "an andon.SurfaceCurve, or a list of pairs (curve, mask)"
    if not isinstance(curves, list | tuple):
        raise InputError(f"must be {wanted}, got {described(curves)}", field="curves")
    return [
        _pair(pair, f"curves[{index}]", shape)
        for index, pair in enumerate(cast("list[Any]", curves))
    ]


def _pair(pair: Any, field: str, shape: tuple[int, int]) -> tuple[SurfaceCurve, NDArray[np.bool_]]:
    if not (isinstance(pair, list | tuple) and len(cast("list[Any]", pair)) == 2):
        raise InputError(f"must be a pair (curve, mask), got {described(pair)}", field=field)
    curve, mask = cast("tuple[Any, Any]", pair)
    if not isinstance(curve, SurfaceCurve):
        raise InputError(
            f"must be an andon.SurfaceCurve, got {described(curve)}",
            field=field,
            remedy="e.g. andon.SurfaceCurve(illuminance_lux, linear)",
        )
    own = np.asarray(mask)
    if own.shape != shape or own.dtype != np.bool_:
        raise InputError(
            f"the mask must be {shape} bool, got {described(mask)}",
            field=field,
            remedy="e.g. picture > 127",
        )
    if not own.any():
        raise InputError("the mask selects no pixel", field=field)
    return curve, own
