"""The picture beside the glass, blurred by depth: what spreads over what."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glass.defocus.frame import frame_blurred
from andon.glass.defocus.kernels import Kernel
from andon.glass.defocus.reference import gathered
from comparison import assert_agree
from defocus.pictures import natural

HEIGHT, WIDTH = 40, 60
PICTURE = natural(HEIGHT, WIDTH)
LEFT = np.arange(WIDTH)[None, :] * np.ones((HEIGHT, 1)) < 30
# White to the left of black.
EDGE = LEFT[..., None] * np.ones(3)


def depths(left, right):
    return np.where(LEFT, left, right)


def test_in_focus_it_is_itself():
    none = np.zeros((HEIGHT, WIDTH))
    assert_agree(frame_blurred(PICTURE, none, none), PICTURE, atol=1e-15)


def test_one_distance_is_one_disc():
    wide, far = np.full((HEIGHT, WIDTH), 9.0), np.ones((HEIGHT, WIDTH))
    expected = gathered(PICTURE, wide, Kernel("optical"))
    assert_agree(frame_blurred(PICTURE, wide, far), expected, atol=1e-12)


def test_a_sharp_thing_in_front_keeps_its_edge():
    after = frame_blurred(EDGE, depths(0.0, 16.0), depths(2.0, 0.5))
    assert_agree(after[LEFT], EDGE[LEFT], atol=1e-12)


def test_a_blurred_thing_in_front_spreads_over_what_is_sharp_behind():
    after = frame_blurred(EDGE, depths(16.0, 0.0), depths(2.0, 0.5))[20, :, 0]
    assert after[35] > 0.01
    assert after[25] < 0.99
    assert (np.diff(after) <= 1e-12).all()


def test_what_is_behind_does_not_spread_over_what_is_sharp():
    """The same edge, the white half behind and out of focus: the black half stays black."""
    after = frame_blurred(EDGE, depths(16.0, 0.0), depths(0.5, 2.0))
    assert_agree(after[~LEFT], EDGE[~LEFT], atol=1e-12)


def test_a_constant_stays_constant():
    generator = np.random.default_rng(2)
    blur, near = generator.uniform(0, 12, (2, HEIGHT, WIDTH))
    flat = np.full((HEIGHT, WIDTH, 3), 0.4)
    assert_agree(frame_blurred(flat, blur, near), flat, rtol=1e-12)


@pytest.mark.parametrize(
    ("blur", "near", "field"),
    [
        (np.full((HEIGHT, WIDTH), -1.0), np.ones((HEIGHT, WIDTH)), "diameter_px"),
        (np.full((HEIGHT, WIDTH), np.nan), np.ones((HEIGHT, WIDTH)), "diameter_px"),
        (np.ones((3, 3)), np.ones((HEIGHT, WIDTH)), "diameter_px"),
        (np.ones((HEIGHT, WIDTH)), np.ones((3, 3)), "vergence"),
    ],
)
def test_what_cannot_be_is_refused(blur, near, field):
    with pytest.raises(InputError, match=f"frame.{field}: must be"):
        frame_blurred(PICTURE, blur, near)
