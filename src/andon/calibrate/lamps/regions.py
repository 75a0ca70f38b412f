"""Errors of a fit and of trivial predictions, where the fit looked and where it did not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.measures import Measures, best_gain, best_gains, measured
from andon.calibrate.lamps.target import Target
from andon.responses import Response

__all__ = ["errors_by_region"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]


def errors_by_region(
    photograph: Float,
    predicted: Float,
    target: Target,
    mask: Mask | None,
    holes: Mask,
    response: Response,
    /,
) -> dict[str, dict[str, Measures]]:
    """Errors of the predictions of `andon.calibrate.lamps.measures`, by region.

    Regions are ``whole``, with a mask also ``inside`` and ``outside``, and of each the part
    ``…_without_holes``; a region without a pixel is left out. Gains are the best of the pixels
    that the fit may look at, everywhere.
    """
    looked = target.seen if mask is None else target.seen & mask
    pair = photograph[looked], target.linear[looked]
    gains = {"gain_one": best_gain(*pair, response), "gain_channels": best_gains(*pair, response)}
    regions = {"whole": target.seen}
    if mask is not None:
        regions = {"inside": looked, "outside": target.seen & ~mask, **regions}
    regions |= {f"{name}_without_holes": region & ~holes for name, region in regions.items()}
    white = 1.0 if target.is_encoded else np.inf

    def errors(region: Mask) -> dict[str, Measures]:
        def off(picture: Float, gain: Float | None = None) -> Measures:
            return measured(picture, target.linear[region], response, gain, white=white)

        own = photograph[region]
        trivial = {name: off(gain * own, gain) for name, gain in gains.items()}
        return {"fitted": off(predicted[region]), "unchanged": off(own), **trivial}

    return {name: errors(region) for name, region in regions.items() if region.any()}
