"""The squares of a fit: by hand, by brute force, and against what must not move them."""

from dataclasses import replace
from itertools import chain, combinations

import numpy as np
import pytest

from andon.calibrate.lamps.cells import cells_of
from andon.calibrate.lamps.nonnegative import nonnegative_least_squares
from andon.calibrate.lamps.solve import NOISE_AT_BLACK, NOISE_PER_LIGHT, Problem, solve
from andon.responses import srgb_decode


def best_of_all_subsets(gram, right):
    """The least x·G·x/2 − r·x with x ≥ 0, by trying which parameters are not 0."""
    size = len(right)
    best, found = 0.0, np.zeros(size)
    for chosen in chain.from_iterable(combinations(range(size), n) for n in range(1, size + 1)):
        own = list(chosen)
        x = np.zeros(size)
        x[own] = np.linalg.solve(gram[np.ix_(own, own)], right[own])
        value = x @ gram @ x / 2 - right @ x
        if (x >= 0).all() and value < best:
            best, found = value, x
    return found


@pytest.mark.parametrize("seed", range(20))
def test_nonnegative_squares_are_the_best_of_all_subsets(seed):
    random = np.random.default_rng(seed)
    rows = random.normal(size=(30, 6)) * 10.0 ** random.uniform(-3, 3, 6)
    gram, right = rows.T @ rows, rows.T @ random.normal(size=30)
    wanted = best_of_all_subsets(gram, right)
    found = nonnegative_least_squares(gram, right)
    assert found == pytest.approx(wanted, rel=1e-6, abs=1e-9 * wanted.max())


def test_a_parameter_without_equations_stays_zero():
    gram = np.diag([4.0, 0.0, 1.0])
    assert nonnegative_least_squares(gram, np.array([8.0, 0.0, -1.0])) == pytest.approx([2, 0, 0])


def problem(*, count=600, seed=5, noise=0.0):
    """Two lamps of known amounts on cells of many brightnesses."""
    random = np.random.default_rng(seed)
    photograph = random.uniform(0.02, 0.4, (count, 3))
    ratios = np.stack([random.uniform(0, 2, count), random.uniform(0, 1, count)])
    pictures = photograph * ratios[..., None]
    truth = np.array([[1.0, 0.8, 0.5], [0.3, 0.6, 1.1]])
    wanted = photograph + np.einsum("jnc,jc->nc", pictures, truth)
    wanted = wanted + noise * random.normal(size=wanted.shape)
    free = np.zeros((2, 3, 6))
    for index in range(6):
        free[index // 3, index % 3, index] = 1
    stated = Problem(
        pictures, photograph, wanted, photograph, np.ones((count, 3)), np.zeros(count, bool),
        np.arange(count) % 50, free, np.full(2, 1e-9),
    )  # fmt: skip
    return stated, truth


def test_exact_pictures_give_exact_amounts():
    stated, truth = problem()
    found = solve(stated)
    assert found.amounts == pytest.approx(truth, rel=1e-6)
    assert found.told_apart.all()
    assert found.rejected_share == 0


def test_a_third_of_cells_may_show_something_else():
    stated, truth = problem(noise=2e-3)
    spoiled = stated.wanted.copy()
    spoiled[::3] = 0.9
    assert solve(replace(stated, wanted=spoiled)).amounts == pytest.approx(truth, rel=0.02)


def test_few_lit_cells_are_no_outliers_among_many_unlit_ones():
    """Of 5000 cells 250 are lit, and all of these err by 10 % of their light: noise of a model."""
    stated, truth = problem(count=5000, noise=1e-4)
    random = np.random.default_rng(8)
    lit = (np.arange(5000) % 20 == 0)[:, None]
    pictures = stated.pictures * lit
    light = np.einsum("jnc,jc->nc", pictures, truth)
    off = light * random.normal(1, 0.1, light.shape)
    wanted = stated.photograph + off + 1e-4 * random.normal(size=off.shape)
    found = solve(replace(stated, pictures=pictures, wanted=wanted))
    assert found.amounts == pytest.approx(truth, rel=0.15)


def test_a_lamp_of_negative_light_gets_none():
    stated, truth = problem()
    darker = stated.photograph + stated.pictures[0] * truth[0] - 0.3 * stated.pictures[1]
    found = solve(replace(stated, wanted=darker))
    assert (found.amounts[1] == 0).all()


def test_the_noise_is_that_of_codes_and_a_half():
    """1.5 codes of 8 bits, by the slope of sRGB's decoding."""
    step = 1e-4
    for encoded in (0.001, 0.02, 0.05, 0.1, 0.2, 0.5, 0.98):
        slope = (srgb_decode(encoded + step) - srgb_decode(encoded - step)) / (2 * step)
        light = float(srgb_decode(encoded))
        wanted = (1.5 / 255 * slope) ** 2
        assert 1 / 1.9 < (NOISE_AT_BLACK + NOISE_PER_LIGHT * light) / wanted < 1.9


def test_cells_are_means_of_their_own_pixels():
    """5×3 pixels make 3×2 squares; what is white is apart, and what is neither is left out."""
    picture = np.arange(45, dtype=float).reshape(5, 3, 3)
    open_ = np.ones((5, 3, 3), bool)
    white = np.zeros_like(open_)
    open_[0, 0] = open_[0, 1] = False
    white[0, 1, 2] = True
    cells = cells_of(open_, white)
    assert cells.side_px == 2
    means = cells.of(picture)
    assert len(means) == 7
    assert cells.is_white.tolist() == [False] * 6 + [True]
    assert means[0] == pytest.approx(picture[1, :2].mean(axis=0))
    assert means[5] == pytest.approx(picture[4, 2])
    assert means[6] == pytest.approx([0, 0, picture[0, 1, 2]])
    assert cells.counts[6].tolist() == [0, 0, 1]
