"""The glow's shader against the reference: within 1 % of the peak, energy within 0.5 %."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glow import reference
from andon.glow.model import Glow
from andon.glow.stage import BODY_LIMIT, GlowStage
from andon.gpu.textures import make_texture
from andon.spaces import View
from comparison import assert_agree

FOCAL_PX = 500.0
PEAK, ENERGY = 1e-2, 5e-3


def view(width=150, height=110, fy=FOCAL_PX):
    return View("pinhole", width, height, FOCAL_PX, fy, (width - 1) / 2, (height - 1) / 2)


def glow(sigma_px, fraction=1.0):
    return Glow(sigma_px / FOCAL_PX, fraction)


def half(picture):
    return np.asarray(picture).astype(np.float16).astype(np.float64)


def points(shape, seed=3):
    generator = np.random.default_rng(seed)
    picture = np.zeros((*shape, 3))
    for _ in range(4):
        row, column = generator.integers(0, shape)
        picture[row, column] = generator.uniform(5, 200, 3)
    return half(picture)


def lanterns(shape):
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    ball = np.hypot(rows - shape[0] * 0.4, columns - shape[1] * 0.3) < 9
    tube = (abs(rows - shape[0] * 0.7) < 3) & (abs(columns - shape[1] * 0.6) < 30)
    return half(ball[..., None] * [8, 5, 2] + tube[..., None] * [3, 4, 6])


def texture(gpu, picture, alpha=1.0):
    made = make_texture(gpu, "rgba16float", picture.shape[1], picture.shape[0])
    made.write(np.dstack([picture, np.full(picture.shape[:2], alpha)]))
    return made


def run(gpu, record):
    encoder = gpu.device.create_command_encoder()
    record(encoder)
    gpu.device.queue.submit([encoder.finish()])


def filtered_by_gpu(gpu, bodies, light, seen):
    source, target = texture(gpu, bodies), texture(gpu, np.full(bodies.shape, 7.0))
    stage = GlowStage(gpu, source, target, light, seen)
    run(gpu, lambda encoder: stage.encode_filtered(encoder, target))
    return target.read()[..., :3].astype(np.float64)


def glow_by_gpu(gpu, picture, bodies, light, seen, **options):
    target = texture(gpu, picture, alpha=0.25)
    stage = GlowStage(gpu, texture(gpu, bodies), target, light, seen)
    run(gpu, lambda encoder: stage.encode(encoder, **options))
    after = target.read()
    assert (after[..., 3] == 0.25).all()
    return after[..., :3].astype(np.float64)


@pytest.mark.parametrize("bodies", [points, lanterns])
@pytest.mark.parametrize("sigma", [0.01, 0.8, 3.0, 4.0, 5.9, 9.0, 20.0, 80.0, 1200.0])
def test_filtered_pictures_agree(gpu, sigma, bodies):
    seen = view()
    source = bodies(seen.shape)
    expected = reference.filtered(source, glow(sigma), seen)
    actual = filtered_by_gpu(gpu, source, glow(sigma), seen)
    assert_agree(actual, expected, atol=PEAK * expected.max())
    assert_agree(actual.sum(axis=(0, 1)), expected.sum(axis=(0, 1)), rtol=ENERGY)


@pytest.mark.parametrize(
    "seen",
    [
        view(64, 200),
        view(157, 1),
        view(1, 1),
        view(151, 113, fy=120.0),
        View("latlong", 128, 64),
        View("fisheye", 90, 70, 60.0, 40.0, 44.5, 34.5),
    ],
)
def test_other_pictures_agree(gpu, seen):
    source = points(seen.shape, seed=5)
    light = glow(9.0) if seen.projection == "pinhole" else Glow(np.radians(11))
    expected = reference.filtered(source, light, seen)
    actual = filtered_by_gpu(gpu, source, light, seen)
    assert_agree(actual, expected, atol=PEAK * expected.max())


@pytest.mark.parametrize("fraction", [0.3, 1.0])
@pytest.mark.parametrize("sigma", [2.0, 7.0, 30.0])
def test_pictures_with_glow_agree(gpu, sigma, fraction):
    seen = view()
    bodies = lanterns(seen.shape)
    picture = half(bodies + np.linspace(0, 1, 150)[None, :, None])
    expected = reference.add_glow(picture, bodies, glow(sigma, fraction), seen)
    actual = glow_by_gpu(gpu, picture, bodies, glow(sigma, fraction), seen)
    assert_agree(actual, expected, atol=PEAK * bodies.max())
    assert actual.sum() == pytest.approx(expected.sum(), rel=ENERGY)


def test_every_place_between_cells(gpu):
    """A point moved pixel by pixel over a cell takes its glow along; the peak does not flicker."""
    seen, peaks = view(150, 61), []
    for column in range(60, 71):
        source = np.zeros((61, 150, 3))
        source[30, column] = 100
        actual = filtered_by_gpu(gpu, source, glow(20.0), seen)
        expected = reference.filtered(source, glow(20.0), seen)
        assert_agree(actual, expected, atol=PEAK * expected.max())
        peaks.append(actual.max())
    assert max(peaks) / min(peaks) - 1 < PEAK


@pytest.mark.parametrize("sigma", [4.0, 15.0, 40.0])
def test_glows_are_smooth(gpu, sigma):
    """No blocks: along a row the slope never turns but once, and bends as the Gaussian does."""
    seen = view(301, 41)
    source = np.zeros((41, 301, 3))
    source[20, 150] = 30000
    profile = filtered_by_gpu(gpu, source, glow(sigma), seen)[20, :, 0]
    expected = reference.filtered(source, glow(sigma), seen)[20, :, 0]
    near = np.abs(np.arange(301) - 150) < 3 * sigma
    steps, true_steps = np.diff(profile), np.diff(expected)
    # Half floats: the height of a step is known to 2⁻¹⁰ of the value.
    rounding = 2.0**-10 * profile[1:]
    assert (steps[:150][near[:150]] >= -rounding[:150][near[:150]]).all()
    assert (steps[150:][near[151:]] <= rounding[150:][near[151:]]).all()
    assert_agree(steps, true_steps, atol=0.06 * np.abs(true_steps).max() + rounding.max())


@pytest.mark.parametrize("sigma", [2.0, 6.0, 25.0])
@pytest.mark.parametrize("corner", [(0, 0), (52, 17), (141, 101), (148, 60)])
def test_only_where_bodies_are(gpu, corner, sigma):
    """Told where bodies are, it gives the same bits for less."""
    seen, (column, row) = view(), corner
    bodies = np.zeros((*seen.shape, 3))
    bodies[row : row + 9, column : column + 9] = [8, 4, 2]
    picture = bodies + 0.5
    whole = glow_by_gpu(gpu, picture, bodies, glow(sigma), seen)
    part = glow_by_gpu(gpu, picture, bodies, glow(sigma), seen, within=(column, row, 9, 9))
    assert (whole == part).all()
    assert not (whole == picture).all()


@pytest.mark.parametrize("within", [(10, 10, 0, 5), (-9, 3, 9, 9), (150, 0, 4, 4)])
def test_nowhere(gpu, within):
    seen = view()
    picture = lanterns(seen.shape)
    after = glow_by_gpu(gpu, picture, picture, glow(9.0), seen, within=within)
    assert (after == picture).all()


def test_off_is_off(gpu):
    seen = view()
    picture = half(lanterns(seen.shape) + 0.3)
    assert (glow_by_gpu(gpu, picture, picture, glow(9.0, 0.0), seen) == picture).all()
    # So is a Gaussian narrower than a pixel: what it takes is what it gives.
    assert (glow_by_gpu(gpu, picture, picture, glow(0.01), seen) == picture).all()


@pytest.mark.parametrize("sigma", [2.0, 6.0, 25.0])
def test_a_body_that_moves_leaves_nothing_behind(gpu, sigma):
    """Frame after frame through one stage, told where the body is, as if each were the first."""
    seen, empty = view(), np.zeros((*view().shape, 3))
    source, target = texture(gpu, empty), texture(gpu, empty)
    stage = GlowStage(gpu, source, target, glow(sigma), seen)
    for column, row in ((3, 90), (40, 70), (60, 50), (135, 4), (20, 20)):
        bodies = empty.copy()
        bodies[row : row + 9, column : column + 9] = [800, 400, 200]
        for made in (source, target):
            made.write(np.dstack([bodies, np.ones(seen.shape)]))
        run(gpu, lambda encoder: stage.encode(encoder, (column, row, 9, 9)))  # noqa: B023
        actual = target.read()[..., :3].astype(np.float64)
        assert (actual == glow_by_gpu(gpu, bodies, bodies, glow(sigma), seen)).all()


def test_twice_is_the_same_as_once_each(gpu):
    """Nothing is left over from the frame before."""
    seen = view()
    source, target = texture(gpu, points(seen.shape)), texture(gpu, np.zeros((*seen.shape, 3)))
    stage = GlowStage(gpu, source, target, glow(7.0), seen)
    run(gpu, lambda encoder: stage.encode_filtered(encoder, target))
    bodies = lanterns(seen.shape)
    source.write(np.dstack([bodies, np.ones(seen.shape)]))
    run(gpu, lambda encoder: stage.encode_filtered(encoder, target))
    actual = target.read()[..., :3].astype(np.float64)
    assert (actual == filtered_by_gpu(gpu, bodies, glow(7.0), seen)).all()


@pytest.mark.parametrize("sigma", [2.0, 12.0])
def test_whatever_comes_stays_finite(gpu, sigma):
    """NaN and negative light are none, infinity is the limit, and the sum fits a half float."""
    seen = view()
    bodies = np.zeros((*seen.shape, 3))
    bodies[20:60, 30:90] = np.inf
    bodies[70:80] = np.nan
    bodies[90] = -5
    bodies[0, 0] = 65504
    usable = np.clip(np.nan_to_num(bodies, nan=0, posinf=BODY_LIMIT), 0, BODY_LIMIT)
    picture = np.full((*seen.shape, 3), BODY_LIMIT)
    expected = reference.add_glow(picture, usable, glow(sigma), seen)
    actual = glow_by_gpu(gpu, picture, bodies, glow(sigma), seen)
    # What half floats cannot hold is cut, and white on any display.
    assert_agree(actual, np.minimum(expected, BODY_LIMIT), atol=PEAK * BODY_LIMIT)
    alone = filtered_by_gpu(gpu, bodies, glow(sigma), seen)
    assert_agree(alone, reference.filtered(usable, glow(sigma), seen), atol=PEAK * BODY_LIMIT)


@pytest.mark.parametrize("wrong", ["bodies", "target"])
def test_pictures_have_the_views_size(gpu, wrong):
    seen = view()
    sizes = {"bodies": (150, 110), "target": (150, 110)} | {wrong: (110, 150)}
    pictures = [make_texture(gpu, "rgba16float", *sizes[name]) for name in ("bodies", "target")]
    with pytest.raises(InputError, match=rf"glow\.{wrong}: must be 150×110 px, got 110×150"):
        GlowStage(gpu, *pictures, glow(3.0), seen)
