"""Lamps fitted to a photograph that was taken in their light.

What
    `fit_lamps` finds how much light of which colour each lamp of a scene gives, from a second
    photograph of the same view: the first without the lamps, the second, the reference, with them.
    It says how far the picture with the fitted lamps is from the reference, beside what trivial
    predictions miss it by.
Why in linear light
    Light adds, codes do not: the squares are those of linear values, weighted by the noise of
    codes, and the renderer is a black box whose pictures of single lamps are added up.
What is not fitted
    Places, forms and distributions of lamps, the depth, and where E0 comes from: what of the
    reference these cannot explain is left over, and is reported.

==================  =========================================================================
the reference has   is taken up by
==================  =========================================================================
another exposure    ``dimming="one"``: E0 and lamps both are then in the reference's exposure
white balance       ``dimming="channels"``
reflected light     ``bounce``: a hemisphere of light without shadows, a crude stand-in
moved things        robust weights
white pixels        a bound, not a value
a moved camera      alignment, or a refusal
==================  =========================================================================

Sources: `solve`, `motion`; the model of the photograph is that of `andon.composite`.
"""

from __future__ import annotations

from andon.calibrate.lamps.fit import fit_lamps
from andon.calibrate.lamps.measures import Measures
from andon.calibrate.lamps.model import FitSettings, FittedFill, FittedLight, LampFit

__all__ = ["FitSettings", "FittedFill", "FittedLight", "LampFit", "Measures", "fit_lamps"]
