"""Light that halo and needles take."""

import numpy as np
import pytest

from andon.glare.around import around, needles_within
from andon.glare.kernel import Kernel
from andon.glare.model import Source
from andon.glare.needles import NeedleModel
from andon.glare.picture import glare_of_picture
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye
from andon.spaces import pinhole_view

# Hardly anything passes this mist unscattered.
MISTY = Eye(mist=6.6, pupil_mm=6.0)
KERNEL = Kernel(spread_function("cie135", MISTY))


def test_needles_take_what_is_left():
    model = NeedleModel()
    assert needles_within(Kernel(spread_function("cie135")), model) is model
    star = Source(np.array([0.0, 0, 1]), np.full(3, 1e4))
    seen = around(
        [star], np.array([1e9]), 0.0, MISTY, KERNEL,
        needles=needles_within(KERNEL, model), contrast=40.0,
    )  # fmt: skip
    veil = KERNEL.share + KERNEL.core_share
    assert veil > 0.9
    assert (veil + seen.taken).max() <= 1 + 1e-3
    without_cap = around([star], np.array([1e9]), 0.0, MISTY, KERNEL, needles=model, contrast=40.0)
    assert (veil + without_cap.taken).max() > 1.01


@pytest.mark.parametrize("renderer", ["per-source", "whole-picture"])
def test_no_pixel_is_darker_than_black(renderer):
    view = pinhole_view(60, 40, 2000.0)
    light = np.full((*view.shape, 3), 1e-3)
    light[20, 30] = 1e8
    result = glare_of_picture(light, view, MISTY, renderer=renderer, engine="reference")
    assert result.stars[1]
    assert result.picture.min() >= 0
