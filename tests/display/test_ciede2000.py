"""CIEDE2000 against the pairs that its authors published, which try each of its cases."""

import numpy as np
import pytest

from andon.display.ciede2000 import delta_e_2000, lab_of_linear

# Sharma, Wu & Dalal 2005, table 1: L*a*b* of two colours, and their difference.
PAIRS = [
    ((50, 2.6772, -79.7751), (50, 0, -82.7485), 2.0425),
    ((50, 3.1571, -77.2803), (50, 0, -82.7485), 2.8615),
    ((50, 2.8361, -74.0200), (50, 0, -82.7485), 3.4412),
    ((50, -1.3802, -84.2814), (50, 0, -82.7485), 1.0000),
    ((50, 0, 0), (50, -1, 2), 2.3669),
    ((50, 2.4900, -0.0010), (50, -2.4900, 0.0009), 7.1792),
    ((50, 2.4900, -0.0010), (50, -2.4900, 0.0011), 7.2195),
    ((50, -0.0010, 2.4900), (50, 0.0009, -2.4900), 4.8045),
    ((50, 2.5000, 0.0000), (50, 0.0000, -2.5000), 4.3065),
    ((50, 2.5, 0), (73, 25, -18), 27.1492),
    ((50, 2.5, 0), (61, -5, 29), 22.8977),
    ((50, 2.5, 0), (56, -27, -3), 31.9030),
    ((50, 2.5, 0), (58, 24, 15), 19.4535),
    ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
]


@pytest.mark.parametrize(("one", "other", "difference"), PAIRS)
def test_published_pairs(one, other, difference):
    for first, second in ((one, other), (other, one)):
        got = delta_e_2000(np.array(first, float), np.array(second, float))
        assert got == pytest.approx(difference, abs=5e-5)


def test_white_and_grey():
    lab = lab_of_linear(np.array([[1.0, 1, 1], [0.18, 0.18, 0.18], [0, 0, 0]]))
    assert np.allclose(lab[:, 1:], 0, atol=1e-9)
    assert np.allclose(lab[:, 0], [100, 49.496, 0], atol=1e-3)
