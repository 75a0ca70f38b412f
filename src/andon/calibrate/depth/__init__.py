"""Scale and shift of relative depth, from what somebody knows of the scene.

Estimators of depth from one photograph know neither the unit nor the zero of their numbers r:

======== =============== ========================================= ==============================
kind     model           examples                                  a plane under a wrong shift
======== =============== ========================================= ==============================
inverse  1/z = a·r + b   MiDaS (Ranftl et al. 2022), Depth         stays a plane, but leans
                         Anything (Yang et al. 2024)               otherwise
depth    z = a·r + b     Marigold (Ke et al. 2024)                 is bent, if it is slanted
======== =============== ========================================= ==============================

That planes stay planes under inverse depth is projective geometry: adding b to 1/z maps a point P
to P/(1 + b·z), a collineation. So flatness says nothing of *its* shift; directions do: a floor that
is level, two walls that stand at right angles.

================================ ==================== ====================
known                            gives the scale      gives the shift
================================ ==================== ====================
a length, the depth of a pixel   yes                  two of them together
flat pixels                      no                   kind depth, slanted
a level floor, a right angle     no                   yes
the camera's height over it      yes                  with the floor
metric depth of many pixels      yes                  yes
================================ ==================== ====================

All is put into one problem of two unknowns, log a and s = b/a, which makes every relative error of
a length linear in the scale. Groups of pixels are summarised once (`planes`, `known`), robustly;
what remains is a handful of residuals, solved by Levenberg–Marquardt from the best of many starts.
Estimators err smoothly over a picture, so a group never counts as more than `INDEPENDENT` samples.

Nothing is guessed silently: where the shift is undetermined it is taken as 0 and said so, and where
the scale is, the fit is refused.
"""

from __future__ import annotations

from andon.calibrate.depth.fit import fit_depth
from andon.calibrate.depth.model import (
    At,
    DepthFit,
    Floor,
    Kind,
    Knowledge,
    Length,
    Plane,
    RelativeDepth,
    Row,
    relative_depth,
)

__all__ = [
    "At",
    "DepthFit",
    "Floor",
    "Kind",
    "Knowledge",
    "Length",
    "Plane",
    "RelativeDepth",
    "Row",
    "fit_depth",
    "relative_depth",
]
