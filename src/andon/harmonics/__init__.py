"""Spherical harmonics, bands 0 to 4."""

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
