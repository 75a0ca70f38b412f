"""What glasses and mist add: factors of a spread function's wide part.

========================= ======================================= ==================================
worn, in the air          factor                                  source
========================= ======================================= ==================================
nothing, clear air        1
glasses, contact lenses   10^(0.006·|D|) for short sight          Gaurisankar et al. 2019, measured:
                                                                  0.006 log units a dioptre, alike
                                                                  for glasses and contact lenses
mist                      1 + mist                                none: reconstructed from the
                                                                  paper, which only says that mist
                                                                  adds bloom
========================= ======================================= ==================================

Lenses for long sight were not measured and add nothing here. Clean spectacles without power add
less than a tenth of what the eye scatters, with fingerprints as much as it (de Wit & Coppens 2003):
that is left out. That short-sighted lenses add *needles* is not this function's.
"""

from __future__ import annotations

from andon.observer.spread.model import Eye

__all__ = ["wide_factor"]

LOG_UNITS_PER_DIOPTRE = 0.006


def wide_factor(eye: Eye, /) -> float:
    """≥ 1; by default exactly 1."""
    short_sight = 0.0 if eye.glasses == "none" else max(-eye.glasses_dioptres, 0.0)
    return 10 ** (LOG_UNITS_PER_DIOPTRE * short_sight) * (1 + eye.mist)
