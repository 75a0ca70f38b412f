"""The mixture of bumps, and how much of it the pyramid's levels have."""

import numpy as np
import pytest

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.ladder import Ladder
from andon.glare.whole_picture.mixture import Mixture, bump
from andon.glare.whole_picture.plan import plan_whole
from andon.glare.whole_picture.splines import filters, level_profile, sigma_cells, spline_weights
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye
from andon.spaces import pinhole_view
from comparison import assert_agree

MODELS = {
    "cie135": ("cie135", 25),
    "cie135, 70 years": ("cie135", 70),
    "cie146 general": ("cie146-general", 25),
    "cie146 small angle": ("cie146-small-angle", 25),
    "ijspeert": ("ijspeert", 25),
    "paper": ("paper", 25),
}
# Cells of level 1 of 0.1°.
VIEW = pinhole_view(320, 240, 1146.0)


def kernel(name):
    model, age = MODELS[name]
    return Kernel(spread_function(model, Eye(age_years=age), halo=False))


def test_a_bump_has_the_energy_and_the_spread_that_it_states():
    sigma = np.radians(0.5)
    radii = (np.arange(4000) + 0.5) * (7 * sigma / 4000)
    ring = bump(radii, np.array(sigma)) * 2 * np.pi * radii * (7 * sigma / 4000)
    assert ring.sum() == pytest.approx(1, abs=2e-4)
    assert (ring * radii**2).sum() / 2 == pytest.approx(sigma**2, rel=2e-3)


def test_the_profile_is_that_of_the_splines_and_the_filter():
    radius, generator = 2.3, np.random.default_rng(3)
    places = generator.random((4000, 2)) + 20
    azimuth = generator.random(4000) * 2 * np.pi
    reached = places + radius * np.stack([np.cos(azimuth), np.sin(azimuth)], -1)
    made = 1.0
    half = filters(3)[0]
    for axis in (0, 1):
        (start, given), (end, read) = (
            spline_weights(places[:, axis]),
            spline_weights(reached[:, axis]),
        )
        lattice = np.zeros((4000, 48))
        for k in range(3):
            np.add.at(lattice, (np.arange(4000), start + k), given[:, k])
        spread = half[0] * lattice
        for k, tap in enumerate(half[1:], 1):
            spread += tap * (np.roll(lattice, k, 1) + np.roll(lattice, -k, 1))
        made = made * sum(spread[np.arange(4000), end + k] * read[:, k] for k in range(3))
    assert np.mean(made) == pytest.approx(level_profile(np.array([radius]))[0], rel=0.02)


@pytest.mark.parametrize("name", MODELS)
def test_the_mixture_is_the_kernel(name):
    found = kernel(name)
    mixture = Mixture.of(found)
    theta = np.radians(np.geomspace(0.1, 40, 60))
    assert (mixture.share > 0).all()
    assert_agree(mixture.floor + mixture.per_sr(theta), found.per_sr(theta, core=True), rtol=1e-2)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("factor", [1.0, 1.19, 1.41, 1.68])
def test_the_rungs_are_the_mixture_from_five_cells_on(name, factor):
    found = kernel(name)
    cell = np.radians(0.1) * factor
    view = pinhole_view(320, 240, 2 / cell)
    # χ falls far from what is looked at.
    ladder = Ladder.of(view, found, Mixture.of(found), cell, (np.radians(50), np.radians(60)))
    theta = np.geomspace(5, 80, 200) * cell
    made = ladder.mixture.floor + ladder.per_sr(2 * np.sin(theta / 2), np.array(1.0))
    error = made / found.per_sr(theta, core=True) - 1
    assert np.sqrt(np.mean(error**2)) < 0.02
    assert np.abs(error[theta > 20 * cell]).max() < 0.01


def test_filters_sum_to_one_and_grow_by_the_root_of_two():
    for level in range(1, 6):
        for half in filters(level):
            assert half[0] + 2 * sum(half[1:]) == pytest.approx(1, abs=1e-12)
    assert sigma_cells(3, 1) / sigma_cells(3, 0) == pytest.approx(np.sqrt(2), rel=0.03)


def test_rungs_and_far_part_share_the_light():
    plan = plan_whole(VIEW, kernel("cie135"))
    assert (np.diff(plan.far.shares) < 0).all(), "where cells are smaller the far part has more"
    total = plan.resolved(np.array([1.0]))[0]
    beyond = Kernel(plan.kernel.spread, 2 * np.degrees(1 / VIEW.fx)).share
    whole = plan.kernel.share + plan.kernel.core_share
    assert beyond < total < whole + 1e-9, "what is scattered by less than a pixel stays in it"
