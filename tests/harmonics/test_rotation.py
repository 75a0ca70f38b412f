"""Rotation: the turned light seen in turned directions is the light."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.harmonics import basis, irradiance, rotated, rotation_matrix
from andon.harmonics.deringing import smallest

from .quadrature import units

X, Y, Z = np.eye(3)


def turn(axis, angle):
    """Rodrigues' formula."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.cross(axis, np.eye(3)).T
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def light_of(*shape, seed=1):
    return np.random.default_rng(seed).normal(size=(*shape, 3))


@given(st.integers(0, 10**6), st.floats(-7, 7), st.integers(0, 4))
def test_turned_light_in_turned_directions(seed, angle, order):
    rotation = turn(units(1, seed)[0], angle)
    light, directions = light_of((order + 1) ** 2, seed=seed), units(5, seed + 1)
    before = basis(directions, order) @ light
    after = basis(directions @ rotation.T, order) @ rotated(light, rotation)
    np.testing.assert_allclose(after, before, atol=1e-12)
    np.testing.assert_allclose(
        irradiance(rotated(light, rotation), directions @ rotation.T),
        irradiance(light, directions),
        atol=1e-12,
    )


@given(st.integers(0, 10**6))
def test_a_group(seed):
    """D(R₂)·D(R₁) = D(R₂·R₁), D(Rᵀ) = Dᵀ = D⁻¹."""
    one, two = turn(units(1, seed)[0], 0.7), turn(units(1, seed + 1)[0], 2.9)
    d1, d2 = rotation_matrix(one, 4), rotation_matrix(two, 4)
    np.testing.assert_allclose(d2 @ d1, rotation_matrix(two @ one, 4), atol=1e-13)
    np.testing.assert_allclose(rotation_matrix(one.T, 4), d1.T, atol=1e-14)
    np.testing.assert_allclose(d1 @ d1.T, np.eye(25), atol=1e-13)


def test_bands_do_not_mix():
    matrix = rotation_matrix(turn(X + Y, 1.0), 4)
    bands = np.repeat(np.arange(5), 2 * np.arange(5) + 1)
    assert (matrix[bands[:, None] != bands] == 0).all()


def test_a_quarter_turn_about_up():
    """Light from −Z arrives from −X after 90° about +Y (right-handed)."""
    light = basis(-Z, 2)[:, None] * np.ones(3)
    np.testing.assert_allclose(rotated(light, turn(Y, np.pi / 2))[:, 0], basis(-X), atol=1e-14)


def test_many_at_once():
    rotations = np.stack([turn(axis, 1.1) for axis in units(4, 5)])
    lights = light_of(4, 9)
    together = rotated(lights, rotations)
    for light, rotation, result in zip(lights, rotations, together, strict=True):
        np.testing.assert_allclose(rotated(light, rotation), result, atol=1e-14)
    assert rotated(lights, rotations[0]).shape == (4, 9, 3)
    assert rotated(lights[0], rotations).shape == (4, 9, 3)


def test_the_minimum_turns_along():
    light = light_of(6, 9)
    for axis in units(3, 6):
        np.testing.assert_allclose(
            smallest(rotated(light, turn(axis, 0.8))), smallest(light), atol=1e-11
        )


@pytest.mark.parametrize("wrong", [2 * np.eye(3), np.diag([1, 1, -1.0]), np.full((3, 3), np.nan)])
def test_no_rotation(wrong):
    with pytest.raises(InputError, match="rotation: must be orthonormal"):
        rotated(np.ones((9, 3)), wrong)


def test_no_matrix():
    with pytest.raises(InputError, match=r"rotation: must be \(\.\.\., 3, 3\), got \(4, 4\)"):
        rotation_matrix(np.eye(4))
