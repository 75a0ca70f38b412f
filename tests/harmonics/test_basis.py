"""The basis and the sums over cubes and panoramas, against exact integrals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.harmonics import added, basis, coefficient_count, order_of, to_order

from .quadrature import gauss_fourier, units


def test_orthonormal():
    directions, weights = gauss_fourier(8)
    values = basis(directions, 4)
    np.testing.assert_allclose((values.T * weights) @ values, np.eye(25), atol=1e-14)


def test_signs_of_band_1():
    x, y, z = np.eye(3)
    root = np.sqrt(3 / (4 * np.pi))
    assert basis(y, 1)[1] == pytest.approx(root)
    assert basis(z, 1)[2] == pytest.approx(root)
    assert basis(x, 1)[3] == pytest.approx(root)


def test_rounded_constants_of_the_literature():
    """Ramamoorthi & Hanrahan 2001, equation 3, at a direction with x, y, z all different."""
    n = np.array([2.0, 3.0, 6.0]) / 7
    x, y, z = n
    expected = [
        0.282095,
        *(0.488603 * np.array([y, z, x])),
        1.092548 * x * y,
        1.092548 * y * z,
        0.315392 * (3 * z * z - 1),
        1.092548 * x * z,
        0.546274 * (x * x - y * y),
    ]
    np.testing.assert_allclose(basis(n), expected, atol=1e-6)


def legendre(band, degree, cosine):
    """P_l^m without (−1)^m, by the polynomial's derivative."""
    polynomial = np.polynomial.legendre.Legendre.basis(band).deriv(degree)
    return (1 - cosine**2) ** (degree / 2) * polynomial(cosine)


def test_against_legendre():
    """Y_lm = K·P_l^|m|(cos θ)·{√2 sin |m|φ, 1, √2 cos mφ} for all of bands 0 to 4."""
    from math import factorial

    n = units(50, 1)
    azimuth = np.arctan2(n[:, 1], n[:, 0])
    for band in range(5):
        for degree in range(-band, band + 1):
            m = abs(degree)
            k = np.sqrt((2 * band + 1) / (4 * np.pi) * factorial(band - m) / factorial(band + m))
            wave = np.sin(m * azimuth) if degree < 0 else np.cos(m * azimuth)
            value = k * legendre(band, m, n[:, 2]) * wave * (np.sqrt(2) if m else 1)
            np.testing.assert_allclose(
                basis(n, 4)[:, band * band + band + degree], value, atol=1e-13
            )


@given(st.integers(0, 4), st.integers(0, 4), st.integers(0, 10**6))
def test_addition_theorem(order, lead, seed):
    """Σ Y_lm² is the same in all directions: (order + 1)²/4π; whatever the leading shape."""
    n = units(2**lead, seed).reshape(*([2] * lead), 3)
    square = (basis(n, order) ** 2).sum(axis=-1)
    assert square.shape == (2,) * lead
    np.testing.assert_allclose(square, (order + 1) ** 2 / (4 * np.pi), rtol=1e-12)


@pytest.mark.parametrize("order", range(5))
def test_counts(order):
    assert order_of(coefficient_count(order)) == order


@pytest.mark.parametrize("count", [-1, 0, 2, 8, 10, 36])
def test_counts_that_are_none(count):
    with pytest.raises(InputError, match=f"must be 1, 4, 9, 16 or 25, got {count}"):
        order_of(count)


@pytest.mark.parametrize("order", [-1, 5])
def test_orders_that_are_none(order):
    with pytest.raises(InputError, match=f"order: must be 0…4, got {order}"):
        basis(np.eye(3), order)


def test_addition_of_different_orders():
    one, two = np.full((5, 4, 3), 1.0), np.full((5, 9, 3), 2.0)
    total = added(one, two)
    assert total.shape == (5, 9, 3)
    assert (total[:, :4] == 3).all()
    assert (total[:, 4:] == 2).all()
    np.testing.assert_array_equal(to_order(total, 1), total[:, :4])
    with pytest.raises(InputError, match="at least one"):
        added()
