"""A fit at a glance: photograph, reference, prediction, and where the prediction is off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.measures import encoded
from andon.calibrate.lamps.model import LampFit
from andon.display.false_colour import GAP_PX, contact_sheet
from andon.display.signed_colour import outlined, signed_colour
from andon.quantities import photometric

__all__ = ["fit_figure"]

Rgb = NDArray[np.uint8]

# Ends of the error's scale, percent of the range of codes: the first that most errors keep within.
TOPS, WITHIN = (2.0, 5.0, 10.0, 20.0, 50.0), 98


def fit_figure(fit: LampFit, /) -> Rgb:
    """(H', W', 3) uint8: four labelled pictures; the mask is outlined in green.

    The error is that of the photometric mean of encoded values, prediction less reference, in
    percent of their range; what the reference does not show is grey.
    """
    codes = [encoded(x, fit.response) for x in (fit.photograph, fit.reference, fit.predicted)]
    off = 100 * (photometric(codes[2]) - photometric(codes[1]))
    size = float(np.percentile(np.abs(off[fit.compared]), WITHIN)) if fit.compared.any() else 0.0
    top = next((value for value in TOPS if value >= size), TOPS[-1])
    photograph, reference, predicted = (np.round(255 * c).astype(np.uint8) for c in codes)
    error = signed_colour(off, "%", top=top, known=fit.compared)
    if fit.mask is not None:
        reference, predicted = (outlined(x, fit.mask) for x in (reference, predicted))
        width = fit.mask.shape[1]
        error[:, :width] = outlined(error[:, :width], fit.mask)
    return contact_sheet(
        [
            ("photograph", photograph),
            ("reference", reference),
            (f"prediction, {_quality(fit)}", predicted),
            ("prediction less reference, % of the range of codes", error),
        ],
        columns=2,
        gap_px=GAP_PX,
    )


def _quality(fit: LampFit) -> str:
    region = "inside" if fit.mask is not None else "whole"
    of = fit.measures[region]
    where = " in the mask" if fit.mask is not None else ""
    return (
        f"{of['fitted'].psnr_db:.1f} dB{where} (unchanged {of['unchanged'].psnr_db:.1f}, "
        f"best gain {of['gain_one'].psnr_db:.1f})"
    )
