"""Light that flickers: S(t) with a 1/f-like spectrum, for lamps and for gaps between leaves.

The intermittent map of Pomeau and Manneville, S ← (S + S^z) mod 1 with 1 < z < 2 (u = 1), creeps
away from 0 for a long while (*laminar*) and then jumps about, for spells of all lengths. That is
what makes candles and leaves in the wind look alive where white noise looks like a fault.

=================== ======================================= =====================================
choice              taken                                   instead of
=================== ======================================= =====================================
near 0              noise of 1e-12 joins at each iteration  a clamp, which ends in 24 values; or
                                                            nothing, where rounding makes periods
S^z                 table, lines between its values         `pow`, whose last bit differs between
                                                            machines: chaos makes another light
any time            blocks of iterations, each with its     one orbit since the beginning: a day
                    own start                               is 2.6 million iterations
start               drawn from the invariant density        spells of iterations thrown away
mean                of the invariant density, solved for    of a run: slow, as 1/f noise has it
between iterations  cubic B-spline, and the mean over the   lines: bright images of the spectrum
                    shutter's time
=================== ======================================= =====================================

The slope of the spectrum is that of z: about −0.5 at 1.6, −0.7 at 1.8, near white below 1.4
(`andon verify glare.flicker`: 2¹⁹ iterations, Welch with 2¹⁶, 1e-4…1e-2 per iteration). The
map is the specification's, after the paper's equation (9); the paper lets u > 0 be any.

Sources: Pomeau & Manneville 1980 (the map); Manneville 1980 (its spectrum); Steele, Lea & Flood
2014 (SplitMix64, the noise); Unser 1999 (B-splines).
"""

from __future__ import annotations

from andon.lamps.flicker.density import InvariantDensity, invariant_density
from andon.lamps.flicker.flicker import Flicker

__all__ = ["Flicker", "InvariantDensity", "invariant_density"]
