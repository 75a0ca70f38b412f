"""A camera that moved between photograph and reference, while a lamp was switched on."""

import numpy as np
import pytest

from andon.calibrate.lamps import FitSettings, fit_lamps
from andon.calibrate.lamps.motion import camera_motion
from andon.errors import InputError
from andon.responses import SRGB

from .lit_room import COOL, VIEW, WARM, codes_of, lit, room, texture

TRUTH = {WARM: 1.8, COOL: 0.6}


def moved(picture, dx, dy, turn=0.0):
    """The picture as a camera sees it that shifted by (dx, dy) pixels, and turned."""
    import cv2

    turned = cv2.getRotationMatrix2D((47.5, 35.5), turn, 1.0)
    turned[:, 2] += dx, dy
    border = cv2.BORDER_REFLECT
    return cv2.warpAffine(picture, turned, (96, 72), flags=cv2.INTER_CUBIC, borderMode=border)


def grain(shape=(240, 320), seed=4):
    """Grey values with structure of every size."""
    import cv2

    random = np.random.default_rng(seed)
    layers = [cv2.resize(random.random((n, n)), shape[::-1]) for n in (5, 20, 80, 200)]
    return np.clip(np.mean(layers, axis=0), 0, 1)


@pytest.mark.parametrize("shift", [(0, 0), (2.4, -1.3), (-6, 5)])
def test_a_shift_is_found_under_other_light(shift):
    import cv2

    rows, columns = np.indices((240, 320))
    lamp = 1 + 2 * np.exp(-((rows - 100) ** 2 + (columns - 120) ** 2) / 5000)
    photograph = 0.3 * grain()
    matrix = np.array([[1, 0, shift[0]], [0, 1, shift[1]]], float)
    reference = cv2.warpAffine(photograph * lamp, matrix, (320, 240), borderMode=cv2.BORDER_REFLECT)
    found = camera_motion(photograph, reference, np.ones((240, 320), bool))
    assert found.is_told
    assert found.corner_px == pytest.approx(np.hypot(*shift), abs=0.4)
    if shift == (0, 0):
        assert found.is_still
    else:
        assert found.matrix[:, 2] == pytest.approx(shift, abs=0.4)


def test_pictures_of_other_things_tell_nothing():
    found = camera_motion(grain(seed=4), grain(seed=9), np.ones((240, 320), bool))
    assert not found.is_told
    assert found.is_still


def test_a_reference_that_moved_is_brought_back():
    reference = moved(codes_of(lit(room(), TRUTH)), 1.2, -0.7)
    settings = FitSettings(engine="reference")
    found = fit_lamps(room(), reference, settings=settings)
    assert found.motion.corner_px == pytest.approx(np.hypot(1.2, 0.7), abs=0.3)
    assert any("was moved by up to 1." in line for line in found.notes)
    for light in found.lamps:
        assert light.factor == pytest.approx(np.full(3, TRUTH[light.name]), rel=0.02)
    left = fit_lamps(room(), reference, settings=FitSettings(engine="reference", align="none"))
    better, worse = (x.measures["whole_without_holes"]["fitted"] for x in (found, left))
    assert better.psnr_db > worse.psnr_db + 3
    assert not found.compared.all()
    assert np.isnan(left.motion.correlation)


def test_a_camera_that_moved_far_is_refused_with_the_number():
    reference = moved(codes_of(texture()), 6.0, 0.0)
    with pytest.raises(InputError, match=r"moved by 6\.\d px .* 1\.9 px can be brought back"):
        fit_lamps(room(), reference, settings=FitSettings(engine="reference"))


def test_white_stays_white_when_it_is_moved():
    """A pixel that takes part of its light from a clipped one is clipped."""
    from andon.calibrate.lamps.target import target_of

    reference = codes_of(lit(room(), {WARM: 9.0}))
    back = target_of(moved(reference, 0.9, 0.6), room().frames["mono"], VIEW, "auto")
    assert not back.motion.is_still
    assert back.white[back.seen].any()
    open_ = back.linear[back.seen][~back.white[back.seen]]
    assert open_.max() < SRGB.decode(np.array(254 / 255))
