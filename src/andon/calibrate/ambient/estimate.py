"""From a photograph and its surface to E0 of each pixel, but for its scale."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.ambient.fit import Fitted, fit, mean_of
from andon.calibrate.ambient.model import AmbientEstimate, AmbientSettings
from andon.calibrate.ambient.observed import Observed, observe
from andon.calibrate.ambient.pairs import pairs_of
from andon.quantities import CameraFrame, Surface

__all__ = ["estimate_ambient"]

Float = NDArray[np.float64]

DEFAULT_SETTINGS = AmbientSettings()
# Standard deviation of log light that the field does not know of: light with edges, and materials
# that are of one chromaticity but not of one reflectance. That of the rooms of `verify`.
MODEL_ERROR = 0.2
# Blocks of pixels, 8 × 8, in which the stated error is the same.
ERROR_STEP = 8


def estimate_ambient(
    frame: CameraFrame,
    seen: Surface,
    /,
    *,
    sources_lux: Sequence[Float] = (),
    settings: AmbientSettings = DEFAULT_SETTINGS,
) -> AmbientEstimate:
    """E0 of the pixels of `frame`, whose real surface is `seen`.

    Parameters
    ----------
    frame : linear light; clipped pixels are left out.
    seen : without virtual objects.
    sources_lux : of each known source (H, W, 3), what it gives directly, shadows included.

    Raises `InputError` where hardly a pixel has light and a surface.
    """
    observed = observe(frame, seen, sources_lux, settings.longest_px)
    pairs = pairs_of(observed.number, settings.near_pairs, settings.far_pairs, settings.seed)
    fitted, strengths = fit(observed, pairs, settings)
    valid = seen.valid
    rest = np.exp(
        fitted.log_illuminance(observed.where.of(seen.position[valid]), seen.normal[valid])
    )
    # The patterns' means are those of what was fitted.
    own = [
        strength * np.nan_to_num(source[valid]) / mean_of(small)
        for strength, source, small in zip(strengths, sources_lux, observed.sources, strict=True)
    ]
    light = rest * (1 + sum(own, np.zeros(1)))
    relative = np.ones((*seen.view.shape, 3))
    relative[valid] = light / light.mean(axis=0)
    shares = tuple(float((rest * part).sum() / light.sum()) for part in own)
    return AmbientEstimate(relative, _errors(fitted, observed, seen), observed.used_share, shares)


def _errors(fitted: Fitted, observed: Observed, seen: Surface) -> Float:
    """(H, W) standard deviation of log light, in blocks; NaN in holes."""
    rows, columns = np.indices(seen.view.shape)
    asked = seen.valid & (rows % ERROR_STEP == 0) & (columns % ERROR_STEP == 0)
    coarse = np.full(seen.view.shape, np.nan)
    place = observed.where.of(seen.position[asked]), seen.normal[asked]
    coarse[asked] = np.hypot(fitted.log_error(*place), MODEL_ERROR)
    coarse = coarse[::ERROR_STEP, ::ERROR_STEP]
    coarse = np.where(np.isnan(coarse), np.nanmedian(coarse), coarse)
    whole = coarse.repeat(ERROR_STEP, axis=0).repeat(ERROR_STEP, axis=1)
    height, width = seen.view.shape
    return np.where(seen.valid, whole[:height, :width], np.nan)
