"""Errors and the trivial predictions beside them, by hand."""

import numpy as np
import pytest

from andon.calibrate.lamps.measures import best_gain, best_gains, encoded, measured
from andon.calibrate.lamps.motion import NOT_ASKED
from andon.calibrate.lamps.regions import errors_by_region
from andon.calibrate.lamps.target import Target
from andon.responses import LINEAR, SRGB, Response


def test_errors_of_two_pixels_by_hand():
    wanted = np.array([[0.25, 0.25, 0.25], [0.5, 0.5, 0.5]])
    found = measured(np.add(wanted, [[0.1, 0, 0], [0, 0, 0.2]]), wanted, LINEAR)
    rmse = np.sqrt((0.01 + 0.04) / 6)
    assert found.rmse_linear == pytest.approx(rmse)
    assert found.rmse_encoded == pytest.approx(rmse)
    assert found.psnr_db == pytest.approx(10 * np.log10(6 / 0.05))
    assert found.pixels == 2
    assert found.gain is None
    assert found.delta_e_mean > 1


def test_what_the_camera_clips_is_no_error():
    wanted = np.ones((1, 3))
    found = measured(np.full((1, 3), 7.0), wanted, SRGB)
    assert (found.rmse_linear, found.rmse_encoded, found.psnr_db) == (0, 0, np.inf)
    light = measured(np.full((1, 3), 7.0), wanted, SRGB, white=np.inf)
    assert light.rmse_linear == pytest.approx(6)


@pytest.mark.parametrize("response", [SRGB, LINEAR, Response("gamma", gamma=1.8)])
def test_gains_that_are_exact_are_found(response):
    photograph = np.random.default_rng(1).uniform(0.01, 0.3, (500, 3))
    assert best_gain(photograph, 2.5 * photograph, response) == pytest.approx(
        np.full(3, 2.5), rel=1e-4
    )
    gains = np.array([0.02, 1.0, 3.1])
    assert best_gains(photograph, gains * photograph, response) == pytest.approx(gains, rel=1e-4)


def test_no_gain_on_a_fine_grid_is_better():
    """A lamp in half of the picture: no gain is right, the one that is reported errs least."""
    random = np.random.default_rng(2)
    photograph = random.uniform(0.02, 0.6, (400, 3))
    wanted = photograph * np.where(np.arange(400) % 2, 1.0, 4.0)[:, None]

    def error(gain):
        return np.mean((encoded(gain * photograph, SRGB) - encoded(wanted, SRGB)) ** 2)

    found = error(best_gain(photograph, wanted, SRGB))
    assert found <= min(error(gain) for gain in np.geomspace(0.01, 100, 4001)) * (1 + 1e-6)
    assert error(best_gains(photograph, wanted, SRGB)) <= found


def test_regions_and_their_gains():
    """The gain is the best inside the mask, and the same outside."""
    photograph = np.full((4, 6, 3), 0.2)
    wanted = photograph.copy()
    wanted[:, :3] *= 2
    wanted[:, 3:] *= 3
    mask = np.zeros((4, 6), bool)
    mask[:, :3] = True
    holes = np.zeros((4, 6), bool)
    holes[0] = True
    seen = np.ones((4, 6), bool)
    seen[3] = False
    target = Target(wanted, np.zeros_like(wanted, bool), seen, NOT_ASKED, True)
    found = errors_by_region(photograph, wanted, target, mask, holes, SRGB)
    pixels = {name: of["fitted"].pixels for name, of in found.items()}
    assert pixels == {
        "inside": 9, "outside": 9, "whole": 18,
        "inside_without_holes": 6, "outside_without_holes": 6, "whole_without_holes": 12,
    }  # fmt: skip
    assert found["inside"]["gain_one"].rmse_encoded == pytest.approx(0, abs=1e-5)
    off = encoded(np.array([0.4]), SRGB) - encoded(np.array([0.6]), SRGB)
    assert found["outside"]["gain_one"].rmse_encoded == pytest.approx(abs(off[0]), rel=1e-3)
    assert found["outside"]["gain_one"].gain == pytest.approx((2, 2, 2), rel=1e-3)
    assert found["whole"]["fitted"].psnr_db == np.inf
    assert found["outside"]["unchanged"].rmse_linear == pytest.approx(0.4)
