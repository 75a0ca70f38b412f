"""The camera's white, as lit shades of a reference tell it."""

from types import SimpleNamespace

import numpy as np
import pytest

from andon.calibrate.lamps.shades import white_of_shades
from andon.quantities import CameraFrame, Luminance, Surface
from andon.responses import SRGB
from andon.spaces import View

VIEW = View("pinhole", 24, 18, 20.0, 20.0, 11.5, 8.5)
WHITE_CD_M2 = 80.0
ALL = np.ones(VIEW.shape, bool)


def frame(shell_cd_m2):
    """A grey picture with a shade of some light in its middle."""
    nothing = np.zeros((*VIEW.shape, 3))
    surface = Surface(
        nothing, nothing, ALL * 1.0, ALL, ~ALL, nothing, np.zeros(VIEW.shape, np.int32), nothing,
        VIEW, shell_cd_m2=shell_cd_m2,
    )  # fmt: skip
    captured = CameraFrame(np.full((*VIEW.shape, 3), 0.1, np.float32), VIEW, SRGB, WHITE_CD_M2)
    light = 0 if shell_cd_m2 is None else shell_cd_m2
    return SimpleNamespace(
        surface=surface, captured=captured, luminance=Luminance(0.1 * WHITE_CD_M2 + light)
    )


def shade(cd_m2=40.0):
    light = np.zeros((*VIEW.shape, 3))
    light[4:14, 6:18] = cd_m2 * np.linspace(0.5, 1.0, 12)[None, :, None]
    return light


@pytest.mark.parametrize("factor", [0.02, 0.3, 1.0, 2.5])
def test_the_white_that_the_reference_was_taken_with(factor):
    wanted = 0.1 + factor * shade() / WHITE_CD_M2
    found = white_of_shades(frame(shade()), wanted, ALL)
    assert found == pytest.approx(WHITE_CD_M2 / factor, rel=0.01)


def test_clipped_pixels_and_noise():
    random = np.random.default_rng(2)
    wanted = np.clip(0.1 + 2.2 * shade() / WHITE_CD_M2, 0, 1)
    assert (wanted == 1).mean() > 0.02
    noisy = np.clip(wanted + random.normal(0, 0.004, wanted.shape), 0, 1)
    assert white_of_shades(frame(shade()), noisy, ALL) == pytest.approx(WHITE_CD_M2 / 2.2, rel=0.02)


def test_nothing_is_told_without_a_shade():
    wanted = np.full((*VIEW.shape, 3), 0.1)
    assert white_of_shades(frame(None), wanted, ALL) is None
    assert white_of_shades(frame(0 * shade()), wanted, ALL) is None
    assert white_of_shades(frame(shade()), wanted, ~ALL) is None


def test_only_the_shade_counts():
    """A picture that is wrong beside the shade says nothing of the white."""
    wanted = 0.1 + 0.5 * shade() / WHITE_CD_M2
    wrong = np.where(shade() > 0, wanted, 0.9)
    both = [white_of_shades(frame(shade()), picture, ALL) for picture in (wanted, wrong)]
    assert both[0] == both[1]
