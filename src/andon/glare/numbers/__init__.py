"""Numbers of glare: the veil in cd/m², threshold increment, UGR and DGP.

========== ============================================== ===================================
number     says                                           source
========== ============================================== ===================================
veil       luminance that lies over what is looked at     the spread function
TI         how much more contrast is needed because of it CIE 31:1976
UGR        discomfort from lamps indoors                  CIE 117:1995
DGP        share of people disturbed by daylight          Wienold & Christoffersen 2006
========== ============================================== ===================================

`evalglare` of Radiance gives the last two and a veil of its own, as a cross-check.
"""

from __future__ import annotations

from andon.glare.numbers.indices import (
    daylight_glare_probability,
    position_index,
    threshold_increment_percent,
    unified_glare_rating,
)
from andon.glare.numbers.veil import veil_towards, vertical_illuminance

__all__ = [
    "daylight_glare_probability",
    "position_index",
    "threshold_increment_percent",
    "unified_glare_rating",
    "veil_towards",
    "vertical_illuminance",
]
