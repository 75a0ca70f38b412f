"""Frames of a komorebi on the GPU against the reference."""

import numpy as np
from sunlit import komorebi

from andon.glare.komorebi.seen import Seen
from andon.glare.komorebi.stage import SeenStage
from andon.observer.spread.model import Eye


def test_frames_agree(gpu):
    seen = Seen(komorebi(transmitted=0.005), Eye(age_years=60.0), seed=2)
    stage = SeenStage(gpu, seen)
    for time in (0.0, 1.9):
        expected, found = seen.picture(time), stage.picture(time)
        # One step of half floats at the sun's luminance; and what is seen is seen alike.
        assert np.allclose(found, expected, rtol=0.02, atol=4 * stage.cd_m2_per_unit * 2**-14)
        # Half of the light is ten pixels of sun, of which the GPU keeps 0.22 % too little: what
        # stays in a pixel, and what blocks spread of it, are half floats.
        assert abs(found.sum() / expected.sum() - 1) < 3e-3


def test_a_frame_does_not_depend_on_those_before(gpu):
    seen = Seen(komorebi())
    stage = SeenStage(gpu, seen)
    first = stage.picture(0.3)
    stage.picture(2.0)
    assert np.array_equal(stage.picture(0.3), first)
