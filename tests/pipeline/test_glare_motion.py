"""Four of the sixty frames of ``andon verify glare.frame.motion``."""

import numpy as np

from andon.verify.glare_motion import glare_steps


def test_a_turning_camera_does_not_make_glare_flicker(engine):
    assert np.sqrt(np.mean(glare_steps(4, engine) ** 2)) < 0.01
