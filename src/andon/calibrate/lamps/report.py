"""A fit as numbers for machines."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from andon.calibrate.lamps.model import FittedFill, FittedLight, LampFit

__all__ = ["fit_report", "stated_light"]


def fit_report(fit: LampFit, /) -> dict[str, Any]:
    """Fitted values and errors as plain numbers, units in the names; numbers that are none: None.

    >>> fit_report(fit)["errors"]["inside"]["fitted"]["psnr_db"]    # doctest: +SKIP
    31.4
    """
    response = fit.response
    return _plain(
        {
            "photometry": fit.photometry,
            "lamps": [_light(fit, light) for light in fit.lamps],
            "dimming": None if fit.dimming is None else _factor(fit.dimming),
            "bounce": None if fit.fill is None else _fill(fit.fill),
            "response": {
                "kind": response.kind,
                "gamma": response.gamma if response.kind == "gamma" else None,
                "tried_rmse_encoded": dict(fit.responses),
            },
            "motion": {
                "corner_px": fit.motion.corner_px,
                "correlation": fit.motion.correlation,
                "moved_back": not fit.motion.is_still,
            },
            "luminance_per_unit_cd_m2": fit.luminance_per_unit,
            "rejected_share": fit.rejected_share,
            "hole_pixels": int(fit.holes.sum()),
            "errors": {
                region: {name: asdict(measures) for name, measures in of.items()}
                for region, of in fit.measures.items()
            },
            "notes": list(fit.notes),
        }
    )


def stated_light(fit: LampFit, name: str, /) -> dict[str, Any]:
    """What the fitted scene states of a lamp's light: its key and value, and rgb; {} for arrays."""
    if fit.scene is None:
        return {}
    table = next(table for table in fit.scene.lamp if table.name == name)
    light = table.light or "intensity_cd"
    keys = (
        light,
        "rgb",
        "temperature_k",
        "chromaticity_xy",
        "ground_illuminance_lux",
        "ground_rgb",
    )
    stated: dict[str, Any] = {key: getattr(table, key, None) for key in keys}
    return {key: value for key, value in stated.items() if value is not None}


def _light(fit: LampFit, light: FittedLight) -> dict[str, Any]:
    return {"name": light.name, **_factor(light), **stated_light(fit, light.name)}


def _factor(light: FittedLight) -> dict[str, Any]:
    return {
        "factor": light.factor.tolist(),
        "factor_standard_error": light.error.tolist(),
        "share_of_added_light": light.share,
        "told_apart": light.told_apart,
    }


def _fill(fill: FittedFill) -> dict[str, Any]:
    return {
        "sky_lux": fill.sky_lux.tolist(),
        "sky_standard_error_lux": fill.sky_error_lux.tolist(),
        "ground_lux": fill.ground_lux.tolist(),
        "ground_standard_error_lux": fill.ground_error_lux.tolist(),
        "share_of_added_light": fill.share,
        "told_apart": fill.told_apart,
    }


def _plain(value: Any) -> Any:
    """JSON has neither NaN nor infinity."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}  # pyright: ignore
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]  # pyright: ignore
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value
