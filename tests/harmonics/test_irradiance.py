"""Irradiance in its four forms, against closed forms and integrals."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.harmonics import (
    basis,
    convolved,
    cosine_factors,
    irradiance,
    irradiance_matrix,
    irradiance_polynomial,
)

from .quadrature import gauss_fourier, units


def light_of(shape, seed=1):
    return np.random.default_rng(seed).normal(size=(*shape, 3))


def test_factors_are_integrals_of_the_cosine():
    """A_l = 2π ∫ P_l(t) t dt over 0…1."""
    t, share = np.polynomial.legendre.leggauss(8)
    t, share = (t + 1) / 2, share / 2
    for band in range(5):
        expected = 2 * np.pi * (np.polynomial.legendre.Legendre.basis(band)(t) * t) @ share
        factors = cosine_factors(4)[band**2 : (band + 1) ** 2]
        np.testing.assert_allclose(factors, expected, atol=1e-14)


@pytest.mark.parametrize("order", range(5))
def test_constant_light(order):
    light = np.zeros(((order + 1) ** 2, 3))
    light[0] = 5 * np.sqrt(4 * np.pi)
    np.testing.assert_allclose(irradiance(light, units(9, 2)), 5 * np.pi, rtol=1e-13)


@pytest.mark.parametrize("order", range(5))
def test_linear_light_is_integrated(order):
    """Against ∫ L·max(0, n·d): the half sphere over n, by Gauss–Fourier on that half."""
    light = light_of(((order + 1) ** 2,))
    directions, weights = half_sphere()
    for normal in units(4, 3):
        turned = directions @ frame_of(normal).T
        expected = (weights * directions[:, 2]) @ (basis(turned, order) @ light)
        np.testing.assert_allclose(irradiance(light, normal), expected, atol=1e-12)


def half_sphere():
    cosine, share = np.polynomial.legendre.leggauss(8)
    cosine, share = (cosine + 1) / 2, share / 2
    azimuth = np.arange(9) * 2 * np.pi / 9
    sine = np.sqrt(1 - cosine**2)[:, None]
    parts = (sine * np.cos(azimuth), sine * np.sin(azimuth), cosine[:, None] + 0 * azimuth)
    weights = np.repeat(share[:, None], 9, axis=1) * 2 * np.pi / 9
    return np.stack(parts, axis=-1).reshape(-1, 3), weights.ravel()


def frame_of(normal):
    """(3, 3) whose third column is `normal`."""
    first = np.cross(normal, [0.31, 0.22, 0.87])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first), normal], axis=1)


def test_four_forms_are_one():
    light, normals = light_of((7, 9)), units(7, 4)
    direct = irradiance(light, normals)
    extended = np.concatenate([normals, np.ones((7, 1))], axis=1)
    matrix = irradiance_matrix(light)
    assert matrix.shape == (7, 3, 4, 4)
    np.testing.assert_array_equal(matrix, np.swapaxes(matrix, -1, -2))
    by_matrix = np.einsum("ni,ncij,nj->nc", extended, matrix, extended)
    series = np.einsum("nk,nkc->nc", basis(normals, 2), convolved(light))
    for other in (by_matrix, series, irradiance_polynomial(light, normals)):
        np.testing.assert_allclose(other, direct, atol=1e-12)


def test_rounded_constants_of_the_literature():
    """Ramamoorthi & Hanrahan 2001, equation 12."""
    c1, c2, c3, c4, c5 = 0.429043, 0.511664, 0.743125, 0.886227, 0.247708
    light = light_of((9,))
    l00, l1m, l10, l11, l2m2, l2m1, l20, l21, l22 = light[:, 0]
    expected = [
        [c1 * l22, c1 * l2m2, c1 * l21, c2 * l11],
        [c1 * l2m2, -c1 * l22, c1 * l2m1, c2 * l1m],
        [c1 * l21, c1 * l2m1, c3 * l20, c2 * l10],
        [c2 * l11, c2 * l1m, c2 * l10, c4 * l00 - c5 * l20],
    ]
    np.testing.assert_allclose(irradiance_matrix(light)[0], expected, atol=3e-6)


@pytest.mark.parametrize("order", [0, 1])
def test_few_bands(order):
    light, normals = light_of(((order + 1) ** 2,)), units(5, 5)
    extended = np.concatenate([normals, np.ones((5, 1))], axis=1)
    by_matrix = np.einsum("ni,cij,nj->nc", extended, irradiance_matrix(light), extended)
    np.testing.assert_allclose(by_matrix, irradiance(light, normals), atol=1e-12)


def test_shapes_broadcast():
    normals = units(6, 6).reshape(2, 3, 3)
    assert irradiance(light_of((9,)), normals).shape == (2, 3, 3)
    assert irradiance(light_of((3, 9)), normals).shape == (2, 3, 3)
    assert irradiance(light_of((2, 1, 9)), normals[0]).shape == (2, 3, 3)
    one = irradiance(light_of((3, 9)), normals)[1, 2]
    np.testing.assert_allclose(irradiance(light_of((3, 9))[2], normals[1, 2]), one, rtol=1e-12)


def test_flux_over_the_sphere():
    """∫ E dn = π ∫ L dω: what a small sphere takes."""
    light = light_of((25,))
    directions, weights = gauss_fourier(8)
    total = weights @ irradiance(light, directions)
    np.testing.assert_allclose(total, np.pi * np.sqrt(4 * np.pi) * light[0], rtol=1e-12)


def test_not_three_channels():
    with pytest.raises(InputError, match=r"must be \(\.\.\., k, 3\)"):
        irradiance_matrix(np.ones((9, 4)))
    with pytest.raises(InputError, match="number of coefficients"):
        irradiance(np.ones((8, 3)), np.eye(3))
