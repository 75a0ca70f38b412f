"""Spherical harmonics as other programs hold them, to and from ours.

All have nine coefficients in the order L00, L1−1, L10, L11, L2−2, …; they differ in all else:

================= ========== ==================== ======= =============== ========================
program           holds      factors folded in    sign    axes            what its shader returns
================= ========== ==================== ======= =============== ========================
**Andon**         luminance  none                 +       right, +Y up    E
three.js, WebXR   luminance  none                 +       ours            E, × albedo/π afterwards
glTF's extension  irradiance A_l                  + or ∓  ours            Babylon.js: E/π
Unity             E/π        A_l, Y's, 1/π        (gone)  z turned round  E/π
Filament, shader  E/π        A_l, Y's, 1/π        (gone)  ours            E/π
cmgen, plain text luminance  none, or A_l         ∓       ours            (is no shader's)
================= ========== ==================== ======= =============== ========================

∓ is the Condon–Shortley sign: −1 where m is odd. Where the constants of the basis are folded in it
meets itself and is gone. *Luminance* stands for whatever unit of radiance the program works in: no
conversion changes the unit of light. Bands above 2 are cut on the way out.
"""

from __future__ import annotations

from andon.harmonics.conventions.filament import (
    cmgen_text,
    from_cmgen_text,
    from_filament,
    to_filament,
)
from andon.harmonics.conventions.gltf import from_gltf, to_gltf
from andon.harmonics.conventions.three import from_three, to_three
from andon.harmonics.conventions.unity import from_unity, to_unity

__all__ = [
    "cmgen_text",
    "from_cmgen_text",
    "from_filament",
    "from_gltf",
    "from_three",
    "from_unity",
    "to_filament",
    "to_gltf",
    "to_three",
    "to_unity",
]
