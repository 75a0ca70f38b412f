"""Blurred layers against closed forms: moments, energy, constants, sharpness, rims."""

import dataclasses

import numpy as np
import pytest

from andon.errors import InputError
from andon.glass.defocus.kernels import Kernel
from andon.glass.defocus.reference import blurred, extended, gathered
from comparison import assert_agree
from defocus.pictures import disc_of_glass, natural, sheet, spread

SIZE = 141
MIDDLE = SIZE // 2
BALL = disc_of_glass(110, 130, 40)
DIAMETERS = [2.0, 2.7, 3.0, 5.5, 8.0, 13.3, 30.0, 47.9, 64.0]


def point_image(diameter, kind="optical"):
    picture = np.zeros((SIZE, SIZE, 1))
    picture[MIDDLE, MIDDLE] = 1
    return gathered(picture, np.full((SIZE, SIZE), diameter), Kernel(kind))[..., 0]


# ── the kernel ──────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("kind", ["optical", "gaussian"])
@pytest.mark.parametrize("diameter", DIAMETERS)
def test_a_point_spreads_by_a_sixteenth_of_the_square(diameter, kind):
    total, centre, (yy, xx, xy) = spread(point_image(diameter, kind))
    assert total == pytest.approx(1, abs=1e-12)
    assert centre == pytest.approx((MIDDLE, MIDDLE), abs=1e-9)
    assert [yy, xx] == pytest.approx([diameter**2 / 16] * 2, rel=1e-3)
    assert xy == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("diameter", [1.0, 1.2, 1.6])
def test_small_discs_too(diameter):
    _, _, (yy, xx, _) = spread(point_image(diameter))
    assert [yy, xx] == pytest.approx([diameter**2 / 16] * 2, rel=5e-3)


@pytest.mark.parametrize("kind", ["optical", "gaussian", "paper"])
def test_less_than_a_pixel_is_sharp(kind):
    picture = natural(20, 30)
    assert (gathered(picture, np.full((20, 30), 0.999), Kernel(kind)) == picture).all()


@pytest.mark.parametrize("diameter", [8.0, 21.5, 60.0])
def test_a_disc_is_a_disc(diameter):
    """Flat within, nothing without, one pixel of rim, and as round as the grid allows."""
    image = point_image(diameter)
    rows, columns = np.mgrid[:SIZE, :SIZE] - MIDDLE
    away = np.hypot(rows, columns)
    flat = image[away < diameter / 2 - 1.1]
    assert np.ptp(flat) < 1e-15
    assert flat[0] == pytest.approx(4 / np.pi / diameter**2, rel=0.03)
    assert (image[away > diameter / 2 + 1.1] == 0).all()
    assert (np.abs(image - image.T) < 1e-15).all()
    fourth = (image * (rows**4 + columns**4)).sum() / 2
    crossed = (image * rows**2 * columns**2).sum()
    assert fourth / crossed == pytest.approx(3, rel=0.4 / diameter)


def test_a_gaussian_is_one():
    image = point_image(24.0, "gaussian")[MIDDLE]
    away = np.abs(np.arange(SIZE) - MIDDLE)
    near = away < 14
    # Cut at 3σ and widened to keep its second moment: σ of 6 px within 2 %.
    expected = np.exp(-(away[near] ** 2) / 2 / 6.1**2)
    assert_agree(image[near] / image[MIDDLE], expected, atol=0.02)


def test_the_papers_gaussian_is_as_printed():
    """exp(−r²/K) within ±K/2, weights that sum to 1."""
    blur_px = 8.0
    image = point_image(blur_px, "paper")
    rows, columns = np.mgrid[:SIZE, :SIZE] - MIDDLE
    window = (abs(rows) <= 4) & (abs(columns) <= 4)
    expected = np.exp(-(rows**2 + columns**2) / blur_px) * window
    assert_agree(image, expected / expected.sum(), atol=1e-15)
    # σ² = K/2; what the window cuts off is little.
    assert spread(image)[2][1] == pytest.approx(blur_px / 2, rel=0.15)


def test_every_pixel_has_its_own_disc():
    picture = natural(50, 60)
    diameters = np.linspace(0.5, 20, 3000).reshape(50, 60)
    together = gathered(picture, diameters, Kernel("optical"))
    for place in ((0, 0), (7, 33), (25, 5), (49, 59)):
        alone = gathered(picture, np.full((50, 60), diameters[place]), Kernel("optical"))
        assert_agree(together[place], alone[place], atol=1e-14)


def test_a_border_goes_on_outside():
    step = np.zeros((40, 40, 1))
    step[:, 20:] = 1
    after = gathered(step, np.full((40, 40), 12.0), Kernel("optical"))
    assert_agree(after[0], after[20], atol=1e-12)
    constant = gathered(np.full((9, 7, 2), 0.3), np.full((9, 7), 40.0), Kernel("optical"))
    assert_agree(constant, np.full((9, 7, 2), 0.3), rtol=1e-12)


# ── layers ──────────────────────────────────────────────────────────────────────────────────────


def full_layers(seed=1, **diameters):
    shape = BALL.shape
    alpha = 0.2 * (natural(*shape, seed=seed)[..., 0] > 0.5)
    return sheet(
        BALL,
        refracted=natural(*shape, seed=seed + 1),
        surface=alpha[..., None] * natural(*shape, seed=seed + 2),
        surface_alpha=alpha,
        reflected=0.1 * natural(*shape, seed=seed + 3),
        **diameters,
    )


@pytest.mark.parametrize("kind", ["off", "optical", "gaussian", "paper"])
def test_in_focus_nothing_changes(kind):
    layers = full_layers(refracted_px=0.4, surface_px=0.0, reflected_px=0.9)
    behind = natural(*BALL.shape, seed=9)
    sharp = layers.over(behind)
    assert_agree(blurred(layers, kind).over(behind), sharp, atol=1e-15)
    assert (sharp[BALL == 0] == behind[BALL == 0]).all()


def test_off_is_off_however_far():
    layers = full_layers(refracted_px=40.0, surface_px=30.0)
    assert blurred(layers, "off") is layers


@pytest.mark.parametrize("kind", ["optical", "gaussian"])
def test_a_constant_stays_constant_up_to_the_rim(kind):
    layers = sheet(
        BALL, refracted=0.7, reflected=0.1, refracted_px=17.0, surface_px=9.0, reflected_px=30.0
    )
    after = blurred(layers, kind)
    cover = after.coverage[..., None]
    assert_agree(after.refracted, 0.7 * np.broadcast_to(cover, (*BALL.shape, 3)), atol=1e-12)
    assert_agree(after.reflected, 0.1 * np.broadcast_to(cover, (*BALL.shape, 3)), atol=1e-12)
    # In front of the same constant the rim cannot be seen.
    plain = dataclasses.replace(after, reflected=np.zeros_like(after.reflected))
    assert_agree(
        plain.over(np.full((*BALL.shape, 3), 0.7)), np.full((*BALL.shape, 3), 0.7), atol=1e-12
    )


def test_the_rim_is_blurred_with_the_surface_alone():
    layers = sheet(BALL, refracted=1.0, refracted_px=40.0, surface_px=12.0, reflected_px=5.0)
    after = blurred(layers)
    rim = gathered(BALL[..., None], np.full(BALL.shape, 12.0), Kernel("optical"))[..., 0]
    assert_agree(after.coverage, rim, atol=1e-12)
    assert 0.4 < after.coverage[54, 65 + 40] < 0.6
    assert after.coverage.sum() == pytest.approx(BALL.sum(), rel=1e-6)


def test_a_point_deep_inside_keeps_its_light():
    light = np.zeros((*BALL.shape, 3))
    light[55, 66] = [5.0, 3.0, 1.0]
    layers = sheet(BALL, refracted=light, refracted_px=20.0, surface=light, surface_px=11.0)
    after = blurred(layers)
    near = slice(40, 71), slice(50, 83)
    for image, diameter in ((after.refracted[near], 20), (after.surface[near], 11)):
        assert_agree(image.sum(axis=(0, 1)), [5.0, 3.0, 1.0], rtol=1e-9)
        assert spread(image[..., 0])[2][:2] == pytest.approx([diameter**2 / 16] * 2, rel=1e-3)


def test_in_the_papers_mode_the_refracted_image_stays():
    layers = full_layers(refracted_px=30.0, surface_px=0.0, reflected_px=6.0)
    after = blurred(layers, "paper")
    assert_agree(after.refracted, layers.refracted, atol=1e-15)
    assert not (after.reflected == layers.reflected).all()


def test_a_sharp_image_reaches_as_far_as_the_blurred_rim():
    """Focused on what is seen through it: outside, the nearest glass is gone on with."""
    ramp = np.linspace(0.2, 0.8, 130)[None, :, None] * np.ones((110, 1, 3))
    after = blurred(sheet(BALL, refracted=ramp, surface_px=20.0))
    ring = (BALL == 0) & (after.coverage > 0.02)
    seen = after.refracted[ring] / after.coverage[ring][:, None]
    # Not a slope, but what the ramp was at most two discs away.
    assert np.abs(seen - ramp[ring]).max() < 20 * 0.6 / 129
    inside = BALL > 0
    assert_agree(
        after.refracted[inside], ramp[inside] * after.coverage[inside][:, None], atol=1e-12
    )


def test_extending_keeps_what_is_known():
    values = natural(33, 47)
    cover = disc_of_glass(33, 47, 9)
    whole = extended(values * cover[..., None], cover)
    assert (whole[cover > 0] == values[cover > 0]).all()
    assert whole.min() >= values[cover > 0].min()
    assert whole.max() <= values[cover > 0].max()
    assert (extended(values, np.zeros((33, 47))) == 0).all()
    assert extended(values, np.ones((33, 47))) is values
    # A single covered pixel answers everywhere.
    one = np.zeros((33, 47))
    one[20, 5] = 1
    assert_agree(extended(values, one), np.broadcast_to(values[20, 5], values.shape), rtol=1e-12)


def test_no_glass_is_nothing():
    layers = sheet(np.zeros((20, 30)), refracted=1.0, refracted_px=9.0, surface_px=9.0)
    behind = natural(20, 30)
    assert (blurred(layers).over(behind) == behind).all()


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"surface_px": np.full(BALL.shape, -1.0)}, "surface_px"),
        ({"refracted_px": np.full(BALL.shape, np.nan)}, "refracted_px"),
        ({"coverage": np.full(BALL.shape, np.inf)}, "coverage"),
        ({"reflected": np.zeros((3, 4, 3))}, "reflected"),
        ({"surface_alpha": np.zeros((3, 4))}, "surface_alpha"),
    ],
)
def test_what_cannot_be_is_refused(wrong, field):
    with pytest.raises(InputError, match=f"layers.{field}: must be"):
        blurred(dataclasses.replace(full_layers(), **wrong))
