"""Spencer's, IJspeert's and the paper's models: integrals, terms, values worked out by hand."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.observer.spread import ijspeert, paper, spencer
from andon.observer.spread.angles import integral
from andon.observer.spread.cie135 import cie135
from andon.observer.spread.cie146 import small_angle
from comparison import assert_agree

# ── Spencer ─────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("term", [spencer.core, spencer.narrow_skirt, spencer.wide_skirt])
def test_terms_of_spencer_have_all_the_light(term):
    assert integral(term) == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("wavelength_nm", [*spencer.HALO_NM, 568.0, 400.0, 700.0])
def test_rings_have_all_the_light(wavelength_nm):
    """Of both models, at every wavelength."""
    for halo in (spencer.halo, paper.halo):
        ring = integral(lambda theta, halo=halo: halo(theta, (wavelength_nm,))[..., 0])
        assert ring == pytest.approx(1, abs=1e-3)


def test_weights_of_spencer():
    for adaptation, weights in spencer.WEIGHTS.items():
        assert sum(weights) == pytest.approx(1)
        whole = integral(lambda theta, of=adaptation: spencer.spencer(theta, of))
        assert whole == pytest.approx(1 - weights[3], abs=1e-3)


def test_values_of_spencer():
    """At 1° f0 is nothing, f1 = 20.91/1.02³, f2 = 72.37/1.02²."""
    assert spencer.core(1.0) < 1e-300
    assert spencer.spencer(1.0, "photopic") == pytest.approx(
        0.478 * 19.7037 + 0.138 * 69.5598, rel=1e-5
    )
    assert spencer.halo(3.0, (568.0,)) == pytest.approx(436.9)


# ── IJspeert ────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("age", [0, 25, 70, 120])
@pytest.mark.parametrize("pigment", [0, 0.5, 1.2])
@pytest.mark.parametrize("pupil_mm", [1, 2, 5, 8, 10])
def test_ijspeert_has_all_the_light(age, pigment, pupil_mm):
    terms = ijspeert.terms_of(age, pigment, pupil_mm)
    assert sum(terms.shares) == pytest.approx(1)
    assert min(*terms.shares, *terms.widths) > 0
    whole = integral(lambda theta: ijspeert.ijspeert(theta, age, pigment, pupil_mm))
    assert whole == pytest.approx(1, abs=1e-3)


def test_terms_of_ijspeert():
    """Age 0, m = 0.106, a pupil of 3.2 mm: AF = 1, c_sa = 1 − m, b = 8064, 1/(bP) = 3.875248e-5."""
    terms = ijspeert.terms_of(0, 0.5, 3.2)
    middle = 0.106 / ((1 + 25 * 0.106) * 2)
    assert_agree(terms.shares, [0.447, 0.447, middle, 0.106 - middle], rtol=1e-12)
    widths = [7.750496e-5, 2 * (5e-4 - 3.875248e-5), 1 / 11.36, 1]
    assert_agree(terms.widths, widths, rtol=1e-6)


def test_pigmentation():
    values = [ijspeert.pigmentation(p) for p in (0, 0.25, 0.5, 1.0, 1.2)]
    assert_agree(values, [0.056, 0.081, 0.106, 0.16, 0.16])


def test_small_pupils_scatter_less_near_the_point():
    """Daylight's pupil leaves out the lens's rim: at 0.1° there is less light around the point."""
    near = [float(ijspeert.ijspeert(0.1, pupil_mm=pupil)) for pupil in (2, 4, 7)]
    assert near == sorted(near)
    assert near[2] > 1.7 * near[0]
    far = [float(ijspeert.ijspeert(10.0, pupil_mm=pupil)) for pupil in (2, 4, 7)]
    assert max(far) < 1.02 * min(far)


# ── the paper ───────────────────────────────────────────────────────────────────────────────────


def test_values_of_equation_1():
    assert paper.point_bloom(0.87) == pytest.approx(29)
    assert paper.point_bloom(1.87) == pytest.approx(29 / 2**2.8)
    assert paper.point_bloom(0.87, age=62.5) == pytest.approx(29 * 2 / 1.0256)


def test_equation_1_beside_the_cie():
    """Within 21 % from 0.5 to 8°, and not beyond: at 0.1° it has a sixth."""
    theta = np.geomspace(0.5, 8, 200)
    ratio = paper.point_bloom(theta) / cie135(theta)
    assert 1.15 < ratio.max() <= 1.215
    assert 0.785 <= ratio.min() < 0.9
    assert paper.point_bloom(0.1) / cie135(0.1) < 0.2


def test_the_ring_is_as_wide_as_spencer_s():
    theta = np.array([3.0, 3.225])
    at, beside = spencer.halo(theta, (568.0,))[:, 0]
    first, second = paper.halo(theta - 0.05, (568.0,))[:, 0]
    assert at / beside == pytest.approx(first / second, rel=1e-3)
    assert second == pytest.approx(first / np.e)


@pytest.mark.parametrize("age", [0, 25, 70])
def test_outlines_of_points_are_the_cie_s(age):
    """Beyond an outline of no size, shifted by θ1 = 0.1°, it is the small-angle equation."""
    theta = np.geomspace(0.1, 30, 50)
    assert_agree(paper.outline_bloom(theta - 0.1, age), small_angle(theta, age), rtol=1e-12)


def test_inside_an_outline():
    values = paper.outline_bloom([-180, -1, 0, 0.1])
    assert values[0] == values[1] == values[2] > values[3]
    assert values[2] == pytest.approx(10 / 0.1**3 + 5 * 1.0256 / 0.1**2)
    for wrong in (181, -181, np.nan):
        with pytest.raises(InputError, match="beyond_degrees"):
            paper.outline_bloom(wrong)


def test_mist_raises_the_wide_part_of_an_outline():
    near, far = paper.outline_bloom([0, 20], wide=2) / paper.outline_bloom([0, 20])
    assert near < 1.06
    assert far > 1.8
