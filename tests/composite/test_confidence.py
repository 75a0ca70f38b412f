"""Expected errors against many noisy photographs of one scene, and causes one by one."""

import numpy as np
import pytest

from andon.capture.noise import noise_codes
from andon.capture.still import frame_from_picture
from andon.composite.confidence import BAR_CODES, Cause, confidence_of
from andon.display.model import Exposure
from andon.display.reference import shown_codes
from andon.files.pictures import Picture
from andon.responses import LINEAR, SRGB, Response
from andon.spaces import View

HEIGHT, WIDTH = 40, 48
VIEW = View("pinhole", WIDTH, HEIGHT, WIDTH, WIDTH, WIDTH / 2, HEIGHT / 2)
TRIALS = 500  # σ of a σ: 1/√1000, 3 %
STEP = 1 / 255


def frame_of(linear, response=SRGB):
    codes = response.encode(np.clip(linear, 0, 1)) * 255 + 0.5
    picture = Picture(np.asarray(np.clip(codes, 0, 255), np.uint8), "srgb")
    return frame_from_picture(picture, VIEW, response, luminance_per_unit=1.0)


def shown(response, tone="none"):
    return lambda linear: shown_codes(linear, Exposure(tone=tone), response, 1.0)


def scene():
    """Linear light of the photograph, darker to the left; what it is multiplied by, to the top."""
    random = np.random.default_rng(4)
    light = np.geomspace(0.02, 0.5, WIDTH)[None, :, None] * random.uniform(
        0.7, 1, (HEIGHT, WIDTH, 3)
    )
    gain = np.geomspace(12, 0.3, HEIGHT)[:, None, None] * np.array([1.0, 0.8, 0.5])
    return light, np.broadcast_to(gain, light.shape)


def trusted(frame, gain, sigma, causes=None, tone="none"):
    return confidence_of(
        frame, lambda light: light * gain, shown(frame.response, tone), causes or {}, sigma
    )


@pytest.mark.parametrize(("response", "tone"), [
    (SRGB, "none"), (SRGB, "reinhard"), (LINEAR, "none"), (Response("gamma", gamma=2.2), "hue"),
])  # fmt: skip
@pytest.mark.parametrize("noise", [0.002, 0.004])
def test_expected_errors_are_those_of_many_photographs(response, tone, noise):
    """Noise of up to a third of the light and 8 bits, relit by 0.2 to 12 times: σ within 10 %."""
    random = np.random.default_rng(5)
    light, gain = scene()
    show = shown(response, tone)
    mean, square = np.zeros(light.shape), np.zeros(light.shape)
    for _ in range(TRIALS):
        noisy = light + random.normal(0, noise, light.shape)
        codes = np.clip(np.floor(response.encode(np.clip(noisy, 0, 1)) * 255 + 0.5), 0, 255)
        out = show(response.decode(codes / 255) * gain)
        mean += out / TRIALS
        square += out**2 / TRIALS
    measured = np.sqrt(np.maximum(square - mean**2, 0).mean(axis=-1))
    slope = (response.encode(light + 1e-5) - response.encode(light - 1e-5)) / 2e-5
    # Rounding adds a spread of its own only where noise carries values over the steps.
    carried = (noise * slope > 0.35 * STEP).all(axis=-1)
    sigma = np.hypot(noise * slope, STEP / np.sqrt(12))
    expected = trusted(frame_of(light, response), gain, sigma, tone=tone).expected_error_codes
    # White has no spread to compare, and at its rim half of one.
    inside = carried & (show(light * gain * 1.15) < 254).all(axis=-1) & (measured > 0)
    assert inside.mean() > 0.2
    ratio = expected[inside] / measured[inside]
    assert np.median(ratio) == pytest.approx(1, abs=0.03)
    assert np.percentile(ratio, [5, 95]) == pytest.approx([1, 1], abs=0.1)


def test_the_luminance_errs_by_its_share():
    """Three channels of 2, 3 and 4 % that err on their own, each by its share of light."""
    light = np.broadcast_to([0.3, 0.2, 0.1], (HEIGHT, WIDTH, 3))
    sigma = light * [0.02, 0.03, 0.04]
    found = trusted(frame_of(light, LINEAR), np.full(light.shape, 2.0), sigma).relative_error
    weights = np.array([0.2126, 0.7152, 0.0722]) * [0.3, 0.2, 0.1]
    expected = np.linalg.norm(weights * [0.02, 0.03, 0.04]) / weights.sum()
    assert found == pytest.approx(expected, rel=0.02)


def test_what_the_photograph_knows_well_is_trusted_and_half_at_the_bar():
    """A linear response: noise of s codes times the gain is the error; ½ at 38 dB, 3.2 codes."""
    light = np.full((HEIGHT, WIDTH, 3), 0.1)
    gains = np.linspace(0.5, 4, WIDTH)[None, :, None] * np.ones((HEIGHT, 1, 3))
    found = trusted(frame_of(light, LINEAR), gains, np.full(light.shape, STEP))
    np.testing.assert_allclose(found.expected_error_codes, gains[..., 0], rtol=1e-6)
    np.testing.assert_allclose(found.confidence, 1 / (1 + (gains[..., 0] / 3.21) ** 2), rtol=1e-3)
    assert pytest.approx(3.21, abs=0.01) == BAR_CODES
    assert (found.cause == np.where(gains[..., 0] > BAR_CODES, 1, 0)).all()
    assert found.share(Cause.AMPLIFIED) == pytest.approx((gains[0, :, 0] > BAR_CODES).mean())


def test_clipped_light_that_is_darkened_has_a_bound():
    """White at 0.25 of its light shows 64 codes of a linear display: anything up to 255."""
    light = np.full((HEIGHT, WIDTH, 3), 0.2)
    light[:, :10] = 1.0
    found = trusted(frame_of(light, LINEAR), np.full(light.shape, 0.25), np.full(light.shape, STEP))
    clipped = found.cause == Cause.CLIPPED
    assert clipped[:, :10].all()
    assert not clipped[:, 10:].any()
    expected = (255 - 63.75) / np.sqrt(3)
    np.testing.assert_allclose(found.expected_error_codes[clipped], expected, rtol=1e-6)
    assert np.isnan(found.relative_error[clipped]).all()
    assert (found.confidence[clipped] < 0.01).all()


@pytest.mark.parametrize("gain", [1.0, 3.0])
def test_clipped_light_that_stays_white_is_right(gain):
    light = np.ones((HEIGHT, WIDTH, 3))
    found = trusted(frame_of(light), np.full(light.shape, gain), np.full(light.shape, STEP))
    assert (found.cause == Cause.SOUND).all()
    assert (found.expected_error_codes < 1).all()


def test_black_is_not_certain():
    """Code 0 stands for up to half a step: 8 times the light, and it may be 4 codes."""
    light = np.zeros((HEIGHT, WIDTH, 3))
    sigma = np.full(light.shape, STEP / np.sqrt(12))
    found = trusted(frame_of(light, LINEAR), np.full(light.shape, 8.0), sigma)
    np.testing.assert_allclose(found.expected_error_codes, 8 / np.sqrt(12), rtol=1e-6)


def test_what_is_not_told_has_no_error_and_no_confidence():
    light, gain = scene()
    names = (Cause.BEYOND, Cause.HOLE, Cause.UNCOVERED, Cause.GLASS)
    masks = {name: np.zeros((HEIGHT, WIDTH), bool) for name in (*names, Cause.VIRTUAL)}
    for number, mask in enumerate(masks.values()):
        mask[number] = True
    found = trusted(frame_of(light), gain, np.full(light.shape, STEP), masks)
    for number, name in enumerate(masks):
        assert (found.cause[number] == name).all()
    assert np.isnan(found.expected_error_codes[:4]).all()
    assert (found.confidence[:4] == 0).all()
    assert (found.expected_error_codes[4] == 0).all()
    assert (found.confidence[4] == 1).all()
    assert (found.cause[5:] <= Cause.CLIPPED).all()


def test_of_several_causes_the_last_counts():
    light = np.full((HEIGHT, WIDTH, 3), 1.0)
    everywhere = np.ones((HEIGHT, WIDTH), bool)
    causes = {Cause.UNCOVERED: everywhere, Cause.HOLE: everywhere}
    found = trusted(frame_of(light), np.full(light.shape, 0.2), np.full(light.shape, STEP), causes)
    assert (found.cause == Cause.UNCOVERED).all()


def test_a_photograph_tells_its_noise_itself():
    """Without knowing σ: the RMS of what is expected is that of what is wrong."""
    random = np.random.default_rng(6)
    down, right = np.mgrid[:240, :320] / 320
    light = np.stack([0.03 + 0.3 * right, 0.2 + 0 * right, 0.05 + 0.2 * down], axis=-1)
    view = View("pinhole", 320, 240, 320, 320, 160, 120)
    noisy = np.clip(light + random.normal(0, 0.004, light.shape), 0, 1)
    picture = Picture(np.asarray(SRGB.encode(noisy) * 255 + 0.5, np.uint8), "srgb")
    frame = frame_from_picture(picture, view, SRGB, luminance_per_unit=1.0)
    gain = 3 - 2 * right[..., None]
    found = trusted(frame, gain, noise_codes(frame))
    actual = shown(SRGB)(frame.linear * gain) - shown(SRGB)(light * gain)
    expected = found.expected_error_codes
    ratio = np.sqrt((expected**2).mean() / (actual**2).mean())
    assert ratio == pytest.approx(1, abs=0.07)
