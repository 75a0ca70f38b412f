"""Komorebi: the sun through leaves that move, as sources of glare that come and go.

::

    mask ─────┐
    picture ──┼▶ Canopy: leaves, gaps ─┬─ picture(t) ─▶ luminance of leaves and open gaps ─▶ bloom
    list ─────┘                        └─ sources(t) ─▶ Source of each gap ─▶ needles

What
    n gaps, each with a 1/f flicker S_i(t) of its own (`andon.lamps.flicker`): the share of its area
    that is open. Through what is open the sun shines, so S_i scales area and light alike and the
    luminance stays: ``E_i = w_i·I·S_i/⟨S⟩``, with w_i the gap's share of all area. For gaps of one
    size that is the paper's ``I_p = (1/n)·Σ I·S_i``, with the mean of S made 1.
How bright
    I is the part of the sun's light that the leaves let through. No gap is brighter than the sun
    itself, E/Ω of a disc of 0.53°: one that is smaller shows a part of it, and where all gaps
    together are, their light is less than stated.
Shape
    A gap closes from its outline inwards, pixel by pixel, and the pixel that is half covered has
    half of the light: the area on the picture is S_i to within nothing, and grows smoothly.
Instead of what
    A video of leaves has one eye, one exposure and no light beyond white. Leaves that move as
    geometry need a model of the tree and of the wind, and end at the same statistics.

Sources: the glare paper, equations 9 to 11; Pomeau & Manneville 1980; Otsu 1979 (threshold);
Monsi & Saeki 1953 (light through leaves).
"""

from __future__ import annotations

from andon.glare.komorebi.canopy import (
    Canopy,
    canopy_of_list,
    canopy_of_mask,
    canopy_of_picture,
)
from andon.glare.komorebi.model import SUN_LUX, Komorebi, Sun

__all__ = [
    "SUN_LUX",
    "Canopy",
    "Komorebi",
    "Sun",
    "canopy_of_list",
    "canopy_of_mask",
    "canopy_of_picture",
]
