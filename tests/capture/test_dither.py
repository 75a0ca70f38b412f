"""Values elsewhere in their step: bytes that stay, bands that go, and nothing else that changes."""

import numpy as np
import pytest

from andon.capture.dither import TILE_PX, blue_noise, dithered, within_steps
from andon.capture.still import frame_from_picture
from andon.display.model import Exposure
from andon.display.reference import encode, shown_codes
from andon.files.pictures import Picture
from andon.responses import LINEAR, SRGB, Response
from andon.spaces import View
from worlds import ALL_CODES

KNOTS = np.linspace(0, 1, 33)[:, None]
RESPONSES = {
    "linear": LINEAR,
    "srgb": SRGB,
    "gamma 3": Response("gamma", gamma=3.0),
    "curve": Response("curve", linear=KNOTS ** [1.5, 2.2, 3.0], encoded=KNOTS * np.ones(3)),
}
GAIN = 16
HEIGHT, WIDTH = 128, 512
# Of the photograph: plateaus of 12 to 24 columns, of which every one becomes a band.
SLOPES = {"slow": (3.0, 24.0), "slower": (5.0, 15.0)}


def frame_of(codes, response=SRGB, **more):
    height, width = codes.shape[:2]
    view = View("pinhole", width, height, width, width, width / 2, height / 2, **more)
    return frame_from_picture(Picture(codes, "srgb"), view, response, luminance_per_unit=1.0)


def bright(linear):
    """Codes in [0, 255], not rounded, of 16 times the light."""
    return shown_codes(GAIN * np.asarray(linear, np.float64), Exposure(), SRGB, 1.0)


# ── the pattern ───────────────────────────────────────────────────────────────────────────────


def test_the_pattern_has_every_value_once():
    noise = blue_noise()
    assert noise.shape == (TILE_PX, TILE_PX)
    steps = np.sort(noise.ravel())
    np.testing.assert_allclose(steps, (np.arange(TILE_PX**2) + 0.5) / TILE_PX**2 - 0.5, atol=1e-12)


def low_share(noise, below=1 / 8):
    """Mean power below a frequency in cycles/px, as a share of the mean power."""
    power = np.abs(np.fft.fft2(noise - noise.mean())) ** 2
    radius = np.hypot(*np.meshgrid(*[np.fft.fftfreq(n) for n in noise.shape], indexing="ij"))
    return power[(radius < below) & (radius > 0)].mean() / power.mean()


def test_the_pattern_is_blue_and_has_no_seam():
    """The tile is a torus: the transform of one takes it for endless."""
    white = np.random.default_rng(1).random((TILE_PX, TILE_PX))
    assert low_share(white) > 0.5
    assert low_share(blue_noise()) < 0.001
    rows, columns = np.mgrid[:256, :256]
    gradient_noise = (52.9829189 * ((0.06711056 * columns + 0.00583715 * rows) % 1)) % 1
    assert low_share(gradient_noise) > 0.02


def test_the_channels_have_noise_of_their_own():
    flat = dithered(frame_of(np.full((TILE_PX, TILE_PX, 3), 9, np.uint8))).linear
    correlation = np.corrcoef(flat.reshape(-1, 3).T) - np.eye(3)
    assert np.abs(correlation).max() < 0.05


# ── what does not change ──────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", RESPONSES)
def test_unchanged_light_keeps_its_bytes(name):
    """In gradients and in texture, through the half floats of the GPU as well."""
    ramps = np.arange(256).repeat(9).reshape(1, -1, 1) * np.ones((32, 1, 3))
    for codes in (ALL_CODES, ramps.astype(np.uint8)):
        drawn = dithered(frame_of(codes, RESPONSES[name])).linear
        for held in (drawn, drawn.astype(np.float16)):
            shown = encode(held.astype(np.float64), Exposure(), RESPONSES[name], 1.0)
            assert (shown == codes).all()
    assert (drawn != frame_of(codes, RESPONSES[name]).linear).mean() > 0.5


def test_a_lens_that_was_taken_out_keeps_its_bytes():
    """Values between codes, which undistortion makes, round as before."""
    ramp = np.linspace(2, 40, 160)[None, :, None] * np.ones((120, 1, 3))
    lens = (0.15, -0.05, 0.0, 0.0)
    frame = frame_of(ramp.astype(np.uint8), distortion=lens)
    exact = frame.response.encode(frame.linear.astype(np.float64)) * 255
    assert (np.abs(exact - np.round(exact)) > 0.1).mean() > 0.05
    shown = encode(dithered(frame).linear.astype(np.float64), Exposure(), SRGB, 1.0)
    assert (shown == encode(frame.linear.astype(np.float64), Exposure(), SRGB, 1.0)).all()


def test_black_and_clipped_white_stay():
    codes = np.full((40, 40, 3), 255, np.uint8)
    codes[:20] = 0
    frame = frame_of(codes)
    assert (dithered(frame).linear == frame.linear).all()


def test_floats_have_no_steps():
    view = View("pinhole", 8, 8, 8, 8, 4, 4)
    light = np.random.default_rng(0).random((8, 8, 3)).astype(np.float32)
    frame = frame_from_picture(Picture(light, "linear"), view, SRGB, luminance_per_unit=1.0)
    assert frame.code_step == 0
    assert dithered(frame) is frame


def test_steps_of_16_bits_are_257_times_finer():
    frames = [frame_of(np.full((64, 64, 3), 5, kind), LINEAR) for kind in (np.uint8, np.uint16)]
    spreads = [dithered(frame).linear.std() for frame in frames]
    assert spreads[0] / spreads[1] == pytest.approx(257, rel=0.03)


def test_texture_is_left_alone():
    codes = np.random.default_rng(3).integers(3, 30, (48, 48, 3)).astype(np.uint8)
    frame = frame_of(codes)
    np.testing.assert_array_equal(dithered(frame).linear, frame.linear)


# ── what does ─────────────────────────────────────────────────────────────────────────────────


def ramp(name):
    """Codes of a slow gradient that nothing rounded, and the frame of it in 8 bits."""
    exact = np.linspace(*SLOPES[name], WIDTH)[None, :, None] * np.ones((HEIGHT, 1, 3))
    return exact, frame_of(np.round(exact).astype(np.uint8))


def longest_run(codes):
    """The most columns in a row with one code, of the first channel of a row."""
    changes = np.flatnonzero(np.diff(codes[0, :, 0]))
    return int(np.diff(np.concatenate([[-1], changes, [codes.shape[1] - 1]])).max())


@pytest.mark.parametrize("name", SLOPES)
def test_bands_vanish(name):
    """In what 16 times the light makes of a gradient: runs, and the error that the eye sees."""
    exact, frame = ramp(name)
    truth = bright(SRGB.decode(exact / 255))
    plain, noisy = (np.round(bright(f.linear)) for f in (frame, dithered(frame)))
    assert longest_run(plain) >= 20
    assert longest_run(noisy) <= 10
    # Columns' means, ends left out, whose surroundings are reflected: what remains of the steps.
    bands, left = ((x - truth).mean(axis=0)[20:-20, 0] for x in (plain, noisy))
    assert left.std() < 0.45 * bands.std()
    lines, rest = (np.abs(np.fft.rfft(x * np.hanning(len(x)))).max() for x in (bands, left))
    assert rest < 0.5 * lines
    # The grain costs no accuracy: what smoothing gains is what noise takes.
    assert (noisy - truth).std() < 1.05 * (plain - truth).std()


@pytest.mark.parametrize("name", SLOPES)
def test_the_noise_has_no_mean(name):
    """Within 0.1 codes of what is dithered, over each tile: light in linear units, shown."""
    _, frame = ramp(name)
    inner, _ = within_steps(frame)
    light = SRGB.decode(inner * frame.code_step)
    noisy = dithered(frame).linear
    for rows in (slice(0, 64), slice(64, 128)):
        tiles = [x[rows].reshape(64, -1, 64, 3).mean(axis=(0, 2)) for x in (light, noisy)]
        assert np.abs(bright(tiles[0]) - bright(tiles[1])).max() < 0.1


def test_the_noise_is_as_wide_as_the_step_has_become():
    """A flat code 6 at 16 times the light: even over its step, less 0.01 to either side."""
    frame = frame_of(np.full((TILE_PX, TILE_PX, 3), 6, np.uint8))
    shown = bright(dithered(frame).linear)
    places = 6 + 0.98 * ((np.arange(4096) + 0.5) / 4096 - 0.5)
    expected = bright(SRGB.decode(places / 255))
    assert shown.std() == pytest.approx(expected.std(), rel=0.02)
    slope = (bright(SRGB.decode(6.01 / 255)) - bright(SRGB.decode(5.99 / 255))) / 0.02
    assert shown.std() == pytest.approx(0.98 * slope / np.sqrt(12), rel=0.03)


def test_a_real_gradient_gets_nearer_to_what_it_was(data_dir):
    """A panorama with a clear sky, six stops under in 8 bits, against its floats."""
    from andon.files.pictures import read_picture

    sky = read_picture(data_dir / "openexr_photos" / "KernerEnvLatLong.exr").values[40:200, 300:700]
    exact = SRGB.encode(np.clip(sky.astype(np.float64) / 64, 0, 1)) * 255
    frame = frame_of(np.round(exact).astype(np.uint8))
    inner, room = within_steps(frame)
    before, after = (np.round(exact) - exact).std(), (inner - exact).std()
    assert before == pytest.approx(1 / np.sqrt(12), rel=0.05)
    assert after < 0.75 * before
    assert room.mean() > 0.2
