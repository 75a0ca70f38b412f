"""Spot cones: glTF's falloff, and a flux that is the integral of it."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.lamps.distributions import (
    POINT_SOLID_ANGLE_SR,
    flux_lm_from_intensity,
    intensity_cd_from_flux,
    spot_attenuation,
    spot_coefficients,
    spot_solid_angle_sr,
)

CONES = [(0, 45), (30, 45), (0, 90), (89.9, 90), (44.9999999, 45), (0, 0.1), (0, 1), (10, 10.5)]


def integral(function, low, high, order=40):
    """∫ function(c) dc over [low, high] by Gauss-Legendre."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    middle, half = (high + low) / 2, (high - low) / 2
    return half * (weights @ function(middle + half * nodes))


@pytest.mark.parametrize(("inner", "outer"), CONES)
def test_flux_is_the_integral_over_the_sphere(inner, outer):
    inner, outer = np.radians(inner), np.radians(outer)

    def attenuation(cosine):
        return spot_attenuation(cosine, inner_radians=inner, outer_radians=outer)

    pieces = [-1, np.cos(outer), np.cos(inner), 1]  # smooth between the edges of the cone
    numerical = sum(integral(attenuation, *pair) for pair in pairwise(pieces))
    # For the narrowest cone 1 − cos θ itself has a relative rounding of 1e-10.
    assert spot_solid_angle_sr(inner, outer) == pytest.approx(2 * np.pi * numerical, rel=1e-9)


def test_flux_agrees_with_a_grid_over_the_sphere():
    rows, columns = 2000, 16  # equal steps in cos θ are equal solid angles
    cosine = 1 - (np.arange(rows) + 0.5) / rows * 2
    values = spot_attenuation(
        np.repeat(cosine, columns), inner_radians=0.2, outer_radians=np.radians(60)
    )
    total = values.mean() * POINT_SOLID_ANGLE_SR
    assert spot_solid_angle_sr(0.2, np.radians(60)) == pytest.approx(total, rel=1e-5)


def test_known_values():
    # A half-space with a ramp from the axis: ∫₀¹ c² dc = 1/3.
    assert spot_solid_angle_sr(0, np.pi / 2) == pytest.approx(2 * np.pi / 3, rel=1e-15)
    # A hard cone is a spherical cap.
    assert spot_solid_angle_sr(np.pi / 3 - 1e-10, np.pi / 3) == pytest.approx(np.pi, rel=1e-8)
    assert flux_lm_from_intensity(100, POINT_SOLID_ANGLE_SR) == pytest.approx(1256.637061)


def test_falloff_is_the_square_of_a_ramp_in_the_cosine():
    inner, outer = np.radians(20), np.radians(40)
    middle = (np.cos(inner) + np.cos(outer)) / 2
    edges = np.array([1, np.cos(inner), middle, np.cos(outer), np.cos(outer) - 1e-9, 0, -1])
    values = spot_attenuation(edges, inner_radians=inner, outer_radians=outer)
    assert np.allclose(values, [1, 1, 0.25, 0, 0, 0, 0], atol=1e-14)


@given(st.floats(0.1, 90), st.floats(0, 0.999999))
def test_axis_has_full_intensity_and_the_outside_none(outer, share):
    inner, outer = np.radians(outer * share), np.radians(outer)
    values = spot_attenuation(
        np.array([1.0, np.cos(outer + 0.01), -1.0]), inner_radians=inner, outer_radians=outer
    )
    assert np.allclose(values, [1, 0, 0], atol=1e-6)


def test_coefficients_are_what_the_shader_computes():
    scale, offset = spot_coefficients(0.3, 0.9)
    cosine = np.linspace(-1, 1, 11)
    ramp = np.clip(cosine * scale + offset, 0, 1)
    assert np.array_equal(ramp**2, spot_attenuation(cosine, inner_radians=0.3, outer_radians=0.9))


@given(st.floats(0, 1e6), st.floats(0.1, 90))
def test_flux_and_intensity_are_inverse(intensity, outer):
    solid_angle = spot_solid_angle_sr(0, np.radians(outer))
    flux = flux_lm_from_intensity(intensity, solid_angle)
    assert intensity_cd_from_flux(flux, solid_angle) == pytest.approx(intensity, rel=1e-12)


@pytest.mark.parametrize("cone", [(0.5, 0.5), (0.6, 0.5), (-0.1, 0.5), (0, 1.6), (0, 0), (0, 1e-4)])
def test_impossible_cones_are_refused(cone):
    with pytest.raises(InputError, match="inner < outer"):
        spot_solid_angle_sr(*cone)
    with pytest.raises(InputError, match="inner < outer"):
        spot_coefficients(cone[0], float("nan"))
