"""Colour of lamps: published chromaticities, the photometric value, the edge of the gamut."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.lamps.colour import (
    chromaticity_of_daylight,
    chromaticity_of_temperature,
    factors_from_chromaticity,
    factors_from_rgb,
    factors_from_temperature,
    rgb_factors,
)
from andon.lamps.observer_1931 import MATCHING
from andon.quantities import LUMINANCE_WEIGHTS

# IEC 61966-2-1, inverse of its matrix for XYZ → linear sRGB, four digits.
XYZ_FROM_RGB = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)


def chromaticity_of_rgb(factors):
    xyz = XYZ_FROM_RGB @ factors
    return xyz[:2] / xyz.sum()


def test_observer_sees_equal_energy_as_white():
    x, y, z = MATCHING.sum(axis=0)
    assert np.allclose([x / (x + y + z), y / (x + y + z)], 1 / 3, atol=5e-6)
    # ISO/CIE 11664-1: the area under ȳ is 106.857 in nm, and ȳ peaks with 1.0 at 555 nm.
    assert 5 * y == pytest.approx(106.857, abs=5e-3)
    assert MATCHING[35, 1] == 1.0


def test_illuminant_a():
    # Defined at 2848 K with c₂ = 1.4350e-2 m·K; with today's c₂ that spectrum is at 2855.54 K.
    published = (0.44757, 0.40745)  # CIE 15:2004, table T.3
    assert np.allclose(chromaticity_of_temperature(2855.54), published, rtol=0, atol=2e-5)
    assert np.allclose(chromaticity_of_temperature(2856.0), published, rtol=0, atol=6e-5)


def kim_locus(temperature_k):
    """Cubic fit of the Planckian locus, Kim et al. 2002 (US patent 7,024,034), 1667…25000 K."""
    t = 1e3 / temperature_k
    if temperature_k <= 4000:
        x = np.polyval([-0.2661239, -0.2343589, 0.8776956, 0.179910], t)
    else:
        x = np.polyval([-3.0258469, 2.1070379, 0.2226347, 0.240390], t)
    if temperature_k <= 2222:
        return x, np.polyval([-1.1063814, -1.34811020, 2.18555832, -0.20219683], x)
    if temperature_k <= 4000:
        return x, np.polyval([-0.9549476, -1.37418593, 2.09137015, -0.16748867], x)
    return x, np.polyval([3.0817580, -5.87338670, 3.75112997, -0.37001483], x)


@pytest.mark.parametrize("temperature_k", [1700, 2000, 2700, 3500, 5000, 6504, 10000, 25000])
def test_planckian_locus_beside_a_published_fit(temperature_k):
    ours = chromaticity_of_temperature(float(temperature_k))
    # The fit errs by 5.5e-4 at 2700 K.
    assert np.allclose(ours, kim_locus(temperature_k), rtol=0, atol=1e-3)


@pytest.mark.parametrize(
    ("temperature_k", "xy"),
    # CIE 15:2004, table T.3: D50, D55, D65, D75; their temperatures carry 1.4388/1.4380.
    # The formulas miss the published points, which come from the spectra, by up to 1.3e-4.
    [
        (5002.8, (0.34567, 0.35850)),
        (5503.1, (0.33242, 0.34743)),
        (6503.6, (0.31272, 0.32903)),
        (7504.2, (0.29902, 0.31485)),
    ],
)
def test_daylight_locus(temperature_k, xy):
    assert np.allclose(chromaticity_of_daylight(temperature_k), xy, rtol=0, atol=1.5e-4)


def test_daylight_is_on_the_green_side_of_planck():
    planck, daylight = chromaticity_of_temperature(6504.0), chromaticity_of_daylight(6504.0)
    assert daylight[1] - planck[1] == pytest.approx(0.0054, abs=2e-4)
    assert np.allclose(factors_from_temperature(6504, daylight=True), 1, atol=3e-3)


def test_d65_is_exactly_neutral():
    assert (factors_from_chromaticity((0.3127, 0.3290)) == 1).all()
    assert (rgb_factors() == 1).all()


def test_warm_is_red_and_cold_is_blue():
    warm, cold = factors_from_temperature(2700), factors_from_temperature(10000)
    assert warm[0] > warm[1] > warm[2] > 0
    assert cold[2] > cold[1] > cold[0] > 0


@given(st.floats(1000, 40000))
def test_photometric_value_is_kept_at_every_temperature(temperature_k):
    factors = factors_from_temperature(temperature_k)
    assert factors @ LUMINANCE_WEIGHTS == pytest.approx(1, abs=1e-14)
    assert (factors >= 0).all()


@given(st.tuples(*[st.floats(1e-3, 1)] * 3))
def test_chromaticity_comes_back_inside_the_gamut(rgb):
    xy = chromaticity_of_rgb(np.array(rgb))
    factors = factors_from_chromaticity((float(xy[0]), float(xy[1])))
    # The standard's matrix has four digits, ours is computed: they differ by 2e-4.
    assert np.allclose(factors, factors_from_rgb(np.array(rgb)), rtol=5e-3, atol=5e-3)


def test_outside_the_gamut_is_clipped_with_the_photometric_value_kept():
    factors = factors_from_chromaticity((0.7, 0.29))  # spectral red
    assert factors[1] == factors[2] == 0
    assert factors[0] == pytest.approx(1 / 0.2126)
    assert factors_from_temperature(1500)[2] == 0  # a candle is outside too


CHANNEL = st.just(0.0) | st.floats(1e-250, 1e290)  # times the gain, still a normal number


@given(st.tuples(CHANNEL, CHANNEL, CHANNEL).filter(any), st.floats(1e-3, 1e3))
def test_only_the_ratio_of_rgb_counts(rgb, gain):
    factors = factors_from_rgb(np.array(rgb))
    assert np.allclose(factors, factors_from_rgb(np.array(rgb) * gain), rtol=1e-12)
    assert factors @ LUMINANCE_WEIGHTS == pytest.approx(1)


@pytest.mark.parametrize("rgb", [(0, 0, 0), (-1, 0, 0), (np.nan, 1, 1), (np.inf, 1, 1)])
def test_light_without_colour_is_refused(rgb):
    with pytest.raises(InputError, match="rgb"):
        factors_from_rgb(np.array(rgb, float))


@pytest.mark.parametrize("xy", [(0.3, 0), (-0.1, 0.3), (0.7, 0.5), (np.nan, 0.3)])
def test_impossible_chromaticity_is_refused(xy):
    with pytest.raises(InputError, match="chromaticity_xy"):
        factors_from_chromaticity(xy)


@pytest.mark.parametrize("temperature_k", [999.9, 40001, -5, np.nan, np.inf])
def test_temperature_outside_the_range_is_refused(temperature_k):
    with pytest.raises(InputError, match="1000…40000 K"):
        chromaticity_of_temperature(temperature_k)
    with pytest.raises(InputError, match="4000…25000 K"):
        chromaticity_of_daylight(temperature_k)


def test_two_colours_are_refused():
    with pytest.raises(InputError, match="at most one"):
        rgb_factors(temperature_k=3000, rgb=(1, 1, 1))
