"""What all spread functions have in common: energy, age, angle, ring, glasses and mist."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.observer.spread.angles import integral
from andon.observer.spread.family import (
    NAMES,
    lenticular_halo,
    scattered_share,
    spread_function,
)
from andon.observer.spread.model import Eye
from andon.observer.spread.wide import wide_factor
from comparison import assert_agree

ANGLES = np.geomspace(0.1, 100, 301)
AGES = (0, 20, 45, 70, 90)
# Spencer's model has no age.
AGED = [name for name in NAMES if name != "spencer"]


def bloom(name, theta=ANGLES, **eye):
    return spread_function(name, Eye(**eye)).bloom_per_sr(theta)


@pytest.mark.parametrize("name", NAMES)
def test_falls_with_the_angle(name):
    spread = spread_function(name)
    values = spread.bloom_per_sr(ANGLES)
    assert (values > 0).all()
    assert (np.diff(values) <= 0).all()
    least, most = spread.valid_degrees
    assert 0 <= least < most <= 100


@pytest.mark.parametrize("name", AGED)
def test_the_old_see_more_veil(name):
    """Beyond 0.5°; nearer there is less light of the older, since more of it is scattered."""
    veils = [bloom(name, ANGLES[ANGLES > 0.5], age_years=age) for age in AGES]
    assert (np.diff(veils, axis=0) > 0).all()
    shares = [scattered_share(spread_function(name, Eye(age_years=age)), 0.5) for age in AGES]
    assert (np.diff(shares) > 0).all()


@pytest.mark.parametrize("name", ["cie135", "cie146-general", "ijspeert"])
def test_light_irises_let_light_in(name):
    """Through the iris's rim: it is seen at large angles."""
    assert (np.diff([bloom(name, 60.0, pigment=p) for p in (0, 0.5, 1.0)]) > 0).all()


def test_a_pupil_matters_to_ijspeert_alone():
    for name in NAMES:
        same = np.array_equal(bloom(name, pupil_mm=2), bloom(name, pupil_mm=7))
        assert same == (name != "ijspeert")


@pytest.mark.parametrize("name", NAMES)
def test_shapes_and_colours(name):
    spread = spread_function(name, Eye(adaptation="scotopic"))
    theta = np.array([[0.5, 2.9], [3.1, 40.0]])
    assert spread.bloom_per_sr(theta).shape == (2, 2)
    assert spread.bloom_per_sr(3).shape == ()
    assert spread.halo_per_sr(theta).shape == (2, 2, 3)
    assert_agree(
        spread.per_sr(theta), spread.bloom_per_sr(theta)[..., None] + spread.halo_per_sr(theta)
    )


@pytest.mark.parametrize(
    ("adaptation", "share"), [("photopic", None), ("mesopic", 0.016), ("scotopic", 0.033)]
)
@pytest.mark.parametrize("name", NAMES)
def test_the_ring_of_the_lens(name, adaptation, share):
    """Its light in each channel; red is outside, blue inside."""
    halo = spread_function(name, Eye(adaptation=adaptation)).halo_per_sr
    assert spread_function(name, Eye(adaptation=adaptation), halo=False).halo_per_sr is None
    if share is None:
        assert halo is None
        assert lenticular_halo(Eye(adaptation=adaptation)) is None
        return
    for channel in range(3):
        energy = integral(lambda theta, c=channel: halo(theta)[..., c])
        assert energy == pytest.approx(share, rel=1e-3)
    theta = np.linspace(1, 5, 4001)
    radius = theta[halo(theta).argmax(axis=0)]
    first = 2.95 if name == "paper" else 3.0
    assert_agree(radius, first * np.array([611, 549, 467]) / 568, atol=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_glasses_and_mist_by_default_do_nothing(name):
    plain = bloom(name)
    for eye in ({"glasses": "spectacles"}, {"glasses_dioptres": -8.0}, {"mist": 0.0}):
        assert np.array_equal(bloom(name, **eye), plain)


@pytest.mark.parametrize("name", NAMES)
def test_glasses_and_mist_add_light(name):
    plain = bloom(name)
    for eye in ({"glasses": "contact-lenses", "glasses_dioptres": -6.0}, {"mist": 1.0}):
        factor = bloom(name, **eye) / plain
        assert (factor >= 1).all()
        assert factor.max() <= wide_factor(Eye(**eye)) * (1 + 1e-12)
        # Beyond 30° what is wide is nearly all there is.
        far = (factor[ANGLES > 30] - 1) / (wide_factor(Eye(**eye)) - 1)
        assert (far > 0.9).all()


def test_what_short_sight_adds():
    """0.006 log units a dioptre: 8.6 % at −6 D."""
    worn = Eye(glasses="spectacles", glasses_dioptres=-6.0)
    assert wide_factor(worn) == pytest.approx(10**0.036)
    assert wide_factor(Eye(glasses="spectacles", glasses_dioptres=6.0)) == 1
    assert wide_factor(Eye(mist=0.5)) == 1.5


@pytest.mark.parametrize("name", NAMES)
def test_no_more_light_than_there_is(name):
    with pytest.raises(InputError, match=rf"model {name}: scatters .* more than there is"):
        spread_function(name, Eye(mist=20.0))


@pytest.mark.parametrize("name", ["cie136", "", "CIE135", "glow"])
def test_models_that_are_none(name):
    with pytest.raises(InputError, match=r"must be one of cie135, .*paper, got"):
        spread_function(name)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("age_years", -1), ("age_years", 120.1), ("age_years", np.nan), ("pigment", 1.3),
        ("pigment", -0.1), ("pupil_mm", 0), ("pupil_mm", 11), ("mist", -0.1), ("mist", np.inf),
        ("glasses_dioptres", -31),
    ],
)  # fmt: skip
def test_eyes_that_are_none(key, value):
    with pytest.raises(InputError, match=rf"eye\.{key}: must be"):
        Eye(**{key: value})


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("theta", [-0.1, 180.1, np.nan, np.inf, [1, -1]])
def test_angles_that_are_none(name, theta):
    spread = spread_function(name)
    for function in (spread.bloom_per_sr, spread.halo_per_sr):
        with pytest.raises(InputError, match="theta_degrees: must be 0…180°"):
            function(theta)


@pytest.mark.parametrize("name", NAMES)
def test_the_point_itself(name):
    """Finite, or infinite for the models that begin farther out; never NaN."""
    at_zero = spread_function(name).bloom_per_sr([0.0, 180.0])
    assert np.isinf(at_zero[0]) == name.startswith("cie146")
    assert np.isfinite(at_zero[1])


def test_shares_add_up():
    spread = spread_function("cie135")
    parts = [scattered_share(spread, a, b) for a, b in ((0, 0.1), (0.1, 3), (3, 90))]
    assert sum(parts) == pytest.approx(scattered_share(spread, 0), rel=1e-6)
    assert scattered_share(spread, 90) == 0
    assert scattered_share(spread, 100, 95) == 0
