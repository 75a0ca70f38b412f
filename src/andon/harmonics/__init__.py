"""Spherical harmonics, bands 0 to 4: a light from all sides in a few numbers.

What
    A light L(d), in cd/m² per channel and by direction in world axes, becomes coefficients
    L_lm = ∫ L·Y_lm (`project_cube`, `project_latlong`), (..., k, 3) with k = (order + 1)². From
    them: illuminance on any surface (`irradiance`: the cosine dims band l by A_l), the same light
    turned (`rotated`), sums and mixes of lights (they are linear), and as little smoothing as keeps
    illuminance from going negative (`deringed`).
Why harmonics
    A diffuse surface averages over half the sphere; what is finer than band 2 hardly passes. Of
    eleven HDR panoramas two bands and the mean draw illuminance with 3.8 % of its mean as error,
    which is 1.5 % of the largest (Ramamoorthi & Hanrahan say 1 %); 0.9 % in the softest, 8 %
    where a low sun is all there is. Band 3 adds nothing, band 4 halves the error.
What it is not
    A mirror image. And no shadow: light that a body takes from itself must be taken before.

==================== ========= ===================== =======================================
way to store light   numbers   error of illuminance  why (not)
==================== ========= ===================== =======================================
ambient cube         18        by the direction      cannot be turned without loss
one direction + sky  9         by the light          cannot be added up or mixed
L1                   12        21 % of the mean      a lone lamp is 25 % too dark
**L2** (default)     27        3.8 %                 nᵀMn: one small matrix a channel
L4                   75        1.6 %                 2½ times the memory and the products
cube map of E        6·s²·3    by the size           memory, and a filter to read it
spherical Gaussians  by lobes  by lobes              fits of free lobes cannot be added up
==================== ========= ===================== =======================================

(Errors: means over the panoramas of ``andon verify probes.sh.l2`` and ``probes.sh.l4``.)

Settled
    Public, as `andon.harmonics`. Coefficients are (..., k, 3), leading axes are free; order L00,
    L1−1, L10, L11, L2−2, …; band 1 is +y, +z, +x: no Condon–Shortley sign. The roots are exact.
    Coefficients hold luminance; illuminance is made last (`convolved`), and π is divided out
    nowhere. Conversions for three.js, glTF, Unity and Filament are in `conventions`.

Sources: Ramamoorthi & Hanrahan 2001; Sloan 2008; Sloan 2017.
"""

from __future__ import annotations

from andon.harmonics.basis import (
    MAX_ORDER,
    added,
    basis,
    coefficient_count,
    order_of,
    to_order,
)
from andon.harmonics.cubes import SolidAngle, cube_directions, cube_solid_angles
from andon.harmonics.deringing import Target, deringed, heat_factors, smallest, smoothing
from andon.harmonics.irradiance import (
    convolved,
    cosine_factors,
    irradiance,
    irradiance_matrix,
    irradiance_polynomial,
)
from andon.harmonics.panoramas import (
    Clipped,
    NonNegative,
    clipped,
    cube_from_latlong,
    latlong_pixels,
    latlong_solid_angles,
    nonnegative,
)
from andon.harmonics.projection import project_cube, project_latlong
from andon.harmonics.rotation import rotated, rotation_matrix
from andon.harmonics.windows import Window, window_factors, windowed

__all__ = [
    "MAX_ORDER",
    "Clipped",
    "NonNegative",
    "SolidAngle",
    "Target",
    "Window",
    "added",
    "basis",
    "clipped",
    "coefficient_count",
    "convolved",
    "cosine_factors",
    "cube_directions",
    "cube_from_latlong",
    "cube_solid_angles",
    "deringed",
    "heat_factors",
    "irradiance",
    "irradiance_matrix",
    "irradiance_polynomial",
    "latlong_pixels",
    "latlong_solid_angles",
    "nonnegative",
    "order_of",
    "project_cube",
    "project_latlong",
    "rotated",
    "rotation_matrix",
    "smallest",
    "smoothing",
    "to_order",
    "window_factors",
    "windowed",
]
