"""E0 of each pixel, estimated from one photograph and its geometry.

What
    `estimate_ambient` takes linear light and the surface of every pixel, and gives illuminance in
    three channels that is smooth in place and normal, with its own stated error; `placed` gives it
    the scale and colour that somebody knows. Pictures, pairs and the field behind it are arrays:
    nothing is trained.
How
    A pixel is log I = log ρ + log E. E is the light of a room: smooth along surfaces, and by the
    normal no finer than nine spherical harmonics. So log E is drawn from a Gaussian field whose
    covariance is a product of a Gaussian of the distance and bands 0 to 2 of the angle between
    normals (`field`). What is seen are *differences* of log I between two pixels, near ones and far
    ones; where the two show the same material they are differences of log E. Whether they do is not
    known: pairs of different chromaticity do not count, and of the others those whose difference
    smooth light does not explain count less and less (Geman & McClure's loss, from wide to narrow).
    Known sources of E0 come in as patterns, with their shadows, whose share is searched for.
Why so
    It falls back to one E0 everywhere where the photograph says nothing, and says so by its error.

==========================  ====================================================================
other way                   why not
==========================  ====================================================================
E0 the same everywhere      1.4 to 8 times the error (``andon verify relight.ambient``)
log I itself, smoothed      a dark floor becomes a dark light: reflectance is imprinted
Retinex without geometry    a crease looks like an edge of reflectance
nine harmonics of normals   no place: 3 to 4 times the error of this field, fitted to the truth
intrinsic images, learned   weights and data that nobody here can check
==========================  ====================================================================

Limits
    No sharp shadow of a lamp that is not named. Two surfaces without a common chromaticity have an
    offset to each other that only the field's smoothness knows. The mean colour of the light and of
    what it falls on cannot be told apart: neutral, unless stated. Nor can their scale, by a named
    source either: how much of the light is its own is not known well enough.

Sources: Land & McCann 1971; Barron & Malik 2015 (log ρ + log E with priors on both); Rasmussen &
Williams 2006 (the field, its inducing points and its error); Geman & McClure 1987; Ramamoorthi &
Hanrahan 2001.
"""

from __future__ import annotations

from andon.calibrate.ambient.estimate import estimate_ambient
from andon.calibrate.ambient.model import AmbientEstimate, AmbientSettings
from andon.calibrate.ambient.scale import Placed, placed

__all__ = ["AmbientEstimate", "AmbientSettings", "Placed", "estimate_ambient", "placed"]
