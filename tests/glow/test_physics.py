"""The glow against closed forms: what a Gaussian of unit sum does to points, discs and borders."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glow.automatic import glow_from_table, standard_share
from andon.glow.model import Glow, pixels_per_radian
from andon.glow.plan import plan_axis
from andon.glow.reference import add_glow, filtered, gaussian_taps
from andon.observer.spread.cie135 import cie135
from andon.observer.spread.model import Eye
from andon.scene.eye import Glare, Observer
from andon.spaces import View
from comparison import assert_agree

WIDTH, HEIGHT, FOCAL_PX = 120, 90, 1000.0
VIEW = View("pinhole", WIDTH, HEIGHT, FOCAL_PX, FOCAL_PX, 59.5, 44.5)
WARM = np.array([3.0, 2.0, 0.5])


def glow(sigma_px, fraction=1.0):
    return Glow(sigma_px / FOCAL_PX, fraction)


def point(row, column, light=WARM):
    picture = np.zeros((HEIGHT, WIDTH, 3))
    picture[row, column] = light
    return picture


def gaussian(row, column, across, down):
    """k·exp(−x²/2σ²) of a pixel in the whole plane, which sums to 1."""
    rows, columns = np.arange(HEIGHT)[:, None] - row, np.arange(WIDTH)[None, :] - column
    far = np.arange(-4000, 4001)
    k = [1 / np.exp(-((far / sigma) ** 2) / 2).sum() for sigma in (across, down)]
    return np.exp(-((columns / across) ** 2 + (rows / down) ** 2) / 2) * k[0] * k[1]


# ── the filter ──────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("sigma_px", [0.4, 1.0, 6.0, 40.0])
def test_a_point_becomes_the_gaussian(sigma_px):
    expected = gaussian(30, 77, sigma_px, sigma_px)[..., None] * WARM
    assert_agree(filtered(point(30, 77), glow(sigma_px), VIEW), expected, atol=1e-13)


def test_pixels_that_are_not_square_have_two_sigmas():
    view = View("pinhole", WIDTH, HEIGHT, 1000.0, 500.0, 59.5, 44.5)
    expected = gaussian(40, 60, 8.0, 4.0)[..., None] * WARM
    assert_agree(filtered(point(40, 60), glow(8.0), view), expected, atol=1e-13)


def test_energy_is_kept_and_spreads_by_sigma():
    spread = filtered(point(45, 60, np.ones(3)), glow(6.0), VIEW)[..., 1]
    assert spread.sum() == pytest.approx(1, abs=1e-6)
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    assert (spread * (columns - 60) ** 2).sum() == pytest.approx(36, rel=1e-6)
    assert (spread * (rows - 45) ** 2).sum() == pytest.approx(36, rel=1e-6)
    assert (spread * (rows - 45) * (columns - 60)).sum() == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("fraction", [0.3, 1.0])
def test_the_picture_keeps_its_energy(fraction):
    bodies = point(45, 60)
    picture = bodies + 0.7
    after = add_glow(picture, bodies, glow(6.0, fraction), VIEW)
    assert_agree(after.sum(axis=(0, 1)), picture.sum(axis=(0, 1)), rtol=1e-9)
    kept = 1 - fraction * (1 - gaussian(45, 60, 6.0, 6.0)[45, 60])
    assert_agree(after[45, 60], 0.7 + kept * WARM, rtol=1e-12)


def test_light_that_leaves_the_picture_is_lost():
    """Of a point on the border half is left, and its own column once; in a corner a quarter."""
    own = gaussian_taps(5.0, WIDTH)[len(gaussian_taps(5.0, WIDTH)) // 2]
    half = (1 + own) / 2
    on_the_border = filtered(point(45, 0, np.ones(3)), glow(5.0), VIEW)
    assert on_the_border[..., 0].sum() == pytest.approx(half, abs=1e-9)
    in_a_corner = filtered(point(HEIGHT - 1, WIDTH - 1, np.ones(3)), glow(5.0), VIEW)
    assert in_a_corner[..., 0].sum() == pytest.approx(half**2, abs=1e-9)
    # A mirror would have made the border brighter than the point's own row elsewhere.
    assert_agree(on_the_border[45, 0], filtered(point(45, 60, np.ones(3)), glow(5.0), VIEW)[45, 60],
                 rtol=1e-9)  # fmt: skip


@pytest.mark.parametrize("radius", [6.0, 12.0, 25.0])
def test_the_middle_of_a_disc(radius):
    """1 − exp(−R²/2σ²), the integral of the Gaussian over a disc; pixels cost a part in 50."""
    view = View("pinhole", 121, 91, FOCAL_PX, FOCAL_PX, 60.0, 45.0)
    rows, columns = np.mgrid[:91, :121]
    disc = (np.hypot(rows - 45, columns - 60) <= radius)[..., None] * np.ones(3)
    middle = filtered(disc, glow(10.0), view)[45, 60, 0]
    assert middle == pytest.approx(1 - np.exp(-(radius**2) / 200), rel=0.02)


def test_two_bodies_glow_as_each_alone():
    one, other = point(20, 30), point(60, 100, np.array([0.1, 7.0, 2.0]))
    apart = filtered(one, glow(9.0), VIEW) + filtered(other, glow(9.0), VIEW)
    assert_agree(filtered(one + other, glow(9.0), VIEW), apart, atol=1e-13)


def test_a_body_takes_its_glow_along():
    here = filtered(point(40, 50), glow(3.0), VIEW)
    there = filtered(point(47, 63), glow(3.0), VIEW)
    assert_agree(there[7:, 13:], here[:-7, :-13], atol=1e-13)


def test_glows_of_glows():
    """Gaussians in a row add their variances."""
    twice = filtered(filtered(point(45, 60), glow(3.0), VIEW), glow(4.0), VIEW)
    assert_agree(twice, filtered(point(45, 60), glow(5.0), VIEW), atol=1e-9)


def test_without_a_width_nothing_moves():
    bodies = np.random.default_rng(1).uniform(0, 9, (HEIGHT, WIDTH, 3))
    assert_agree(add_glow(bodies + 1, bodies, glow(1e-3), VIEW), bodies + 1, atol=1e-13)


def test_without_a_fraction_every_byte_stays():
    picture = np.random.default_rng(2).uniform(0, 9, (HEIGHT, WIDTH, 3)).astype(np.float32)
    after = add_glow(picture, picture * np.float32(0.5), glow(9.0, 0.0), VIEW)
    assert after.dtype == picture.dtype
    assert after.tobytes() == picture.tobytes()


def test_darkness_stays_dark():
    assert (filtered(np.zeros((HEIGHT, WIDTH, 3)), glow(9.0), VIEW) == 0).all()


def test_glows_wider_than_the_picture():
    lit = filtered(np.ones((HEIGHT, WIDTH, 3)), glow(3000.0), VIEW)
    expected = WIDTH * HEIGHT / (2 * np.pi * 3000.0**2)
    assert_agree(lit, np.full_like(lit, expected), rtol=1e-3)


# ── the angle ───────────────────────────────────────────────────────────────────────────────────


def test_pixels_of_an_angle():
    assert pixels_per_radian(VIEW) == (FOCAL_PX, FOCAL_PX)
    latlong = View("latlong", 64, 32)
    # The mean pixel of a sphere: 4π over their number.
    mean = 1 / np.sqrt(4 * np.pi / (64 * 32))
    assert pixels_per_radian(latlong) == pytest.approx((mean, mean), rel=1e-12)
    fisheye = View("fisheye", 65, 65, 400.0, 300.0, 32.0, 32.0)  # narrow: the axis is the mean
    assert pixels_per_radian(fisheye) == pytest.approx((400, 300), rel=3e-3)


@pytest.mark.parametrize("projection", ["pinhole", "fisheye"])
def test_sigma_is_the_angle_to_the_axis(projection):
    view = View(projection, 121, 91, 2000.0, 1500.0, 60.0, 45.0)
    across, down = Glow(0.004).sigma_pixels(view)
    directions = view.directions()
    for row, column in ((45, 60 + round(across)), (45 + round(down), 60)):
        angle = np.arccos(directions[row, column] @ directions[45, 60])
        assert angle == pytest.approx(0.004, rel=5e-3)


# ── the cells between (plan.py) ─────────────────────────────────────────────────────────────────


def spread_by(plan, column):
    """Where the plan puts the light of one column, by its own definition in NumPy."""
    box = np.ones(plan.reduction) / plan.reduction
    spline = np.convolve(np.convolve(box, box), box) * plan.reduction
    first, end = plan.cells
    cells = np.zeros((end - first, plan.length))
    for index in range(end - first):
        for k, weight in enumerate(spline):
            pixel = (first + index) * plan.reduction - plan.reduction + 1 + k
            if 0 <= pixel < plan.length:
                cells[index, pixel] = weight
    taps = np.concatenate([plan.taps[:0:-1], plan.taps])
    middle = [np.convolve(cell, taps)[plan.radius : plan.radius + end - first] for cell in cells.T]
    return (np.array(middle) @ cells / plan.reduction)[column]


@pytest.mark.parametrize("sigma", [0.2, 1.5, 3.9, 4.0, 6.0, 11.4, 20.0])
def test_cells_keep_energy_place_and_variance(sigma):
    plan = plan_axis(241, sigma)
    for column in range(110, 110 + plan.reduction):
        spread = spread_by(plan, column)
        offsets = np.arange(241) - column
        assert spread.sum() == pytest.approx(1, abs=1e-12)
        assert (spread * offsets).sum() == pytest.approx(0, abs=1e-9)
        expected = np.exp(-((offsets / sigma) ** 2) / 2)
        expected /= expected.sum()
        variance = (expected * offsets**2).sum()
        assert (spread * offsets**2).sum() == pytest.approx(variance, rel=0.02)
        assert np.abs(spread - expected).max() < 0.006 * expected.max()


@pytest.mark.parametrize("sigma", [1e-3, 0.7, 5.0, 90.0, 1e4, 1e9])
@pytest.mark.parametrize("length", [1, 2, 7, 240])
def test_every_plan_is_bounded(length, sigma):
    plan = plan_axis(length, sigma)
    assert 1 <= plan.reduction <= length
    assert 1 <= plan.radius <= 30
    assert plan.texels <= length + 2 * plan.radius + 6
    for pixels in ((0, length), (length - 1, length), (0, 1)):
        spans = plan.spans(pixels)
        assert 0 <= spans.reduced[0] < spans.filtered[0] < spans.filtered[1] < spans.reduced[1]
        assert spans.reduced[1] <= plan.texels
        assert 0 <= spans.reached[0] <= pixels[0] < pixels[1] <= spans.reached[1] <= length
        assert 0 <= spans.source[0] <= pixels[0] < pixels[1] <= spans.source[1] <= length


# ── the eye ─────────────────────────────────────────────────────────────────────────────────────


def test_shares_of_the_scattered_light():
    assert standard_share(Eye(), 0.0) == pytest.approx(1)
    assert standard_share(Eye(), 90.0) == 0
    shares = [standard_share(Eye(), angle) for angle in (0.01, 0.1, 1, 10, 60)]
    assert (np.diff(shares) < 0).all()
    # Against a quadrature in θ instead of log θ, from where the function is smooth enough for it.
    theta = np.linspace(1, 90, 400_001)
    ring = cie135(theta) * np.sin(np.radians(theta)) * 2 * np.pi
    step = np.radians(theta[1] - theta[0])
    beyond = ((ring[1:] + ring[:-1]) / 2).sum() * step
    assert shares[2] == pytest.approx(beyond / 1.0102, rel=1e-3)


@pytest.mark.parametrize("observer", [None, Observer(age=70, pigment=1.2)])
@pytest.mark.parametrize("keys", [{}, {"glow_fraction": 1.0}, {"minimum_angle_degrees": 0.3}])
def test_as_much_within_a_degree_as_the_eye_scatters(observer, keys):
    """Counted in a picture with 100 px per degree."""
    light = glow_from_table(Glare(model="glow", **keys), observer)
    view = View("pinhole", 601, 601, 18000 / np.pi, 18000 / np.pi, 300.0, 300.0)
    body = np.zeros((601, 601, 3))
    body[300, 300] = 1
    picture = add_glow(body, body, light, view)[..., 0]
    rows, columns = np.mgrid[:601, :601]
    within = picture[np.hypot(rows - 300, columns - 300) <= 100].sum()
    age, pigment = (25, 0.5) if observer is None else (70, 1.2)
    assert within == pytest.approx(1 - standard_share(Eye(age, pigment), 1.0), abs=1e-3)


def test_the_defaults_that_the_docs_state():
    light = glow_from_table(Glare(model="glow"))
    assert light.fraction == pytest.approx(0.32, abs=0.005)
    assert np.degrees(light.sigma_radians) == pytest.approx(0.59, abs=0.005)
    whole = glow_from_table(Glare(model="glow", glow_fraction=1.0))
    assert np.degrees(whole.sigma_radians) == pytest.approx(0.44, abs=0.005)


def test_what_is_stated_is_taken():
    table = Glare(model="glow", glow_sigma_degrees=2.0, glow_fraction=0.05)
    assert glow_from_table(table) == Glow(np.radians(2.0), 0.05)


@pytest.mark.parametrize("table", [None, Glare(), Glare(model="glow", glow_fraction=0.0)])
def test_no_glow(table):
    assert glow_from_table(table) is None


# ── refusals ────────────────────────────────────────────────────────────────────────────────────


def test_a_fraction_that_no_gaussian_can_have():
    with pytest.raises(InputError, match=r"glare\.glow_fraction: .* 0\.0747 .*state glow_sigma"):
        glow_from_table(Glare(model="glow", glow_fraction=0.05))


@pytest.mark.parametrize("sigma", [0.0, -1.0, 4.0, np.nan, np.inf])
def test_sigma_is_an_angle(sigma):
    with pytest.raises(InputError, match="sigma_radians"):
        Glow(sigma)


@pytest.mark.parametrize("fraction", [-0.1, 1.1, np.nan])
def test_fraction_is_a_share(fraction):
    with pytest.raises(InputError, match="fraction"):
        Glow(0.01, fraction)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -1.0])
def test_bodies_are_light(wrong):
    with pytest.raises(InputError, match="finite and ≥ 0"):
        filtered(point(3, 3, wrong), glow(2.0), VIEW)


@pytest.mark.parametrize("shape", [(HEIGHT, WIDTH), (WIDTH, HEIGHT, 3), (HEIGHT, WIDTH, 4)])
def test_bodies_have_the_views_shape(shape):
    with pytest.raises(InputError, match=r"must be \(90, 120, 3\)"):
        filtered(np.zeros(shape), glow(2.0), VIEW)


@pytest.mark.parametrize("key", ["glow_sigma_degrees", "glow_fraction"])
def test_keys_belong_to_their_model(key):
    with pytest.raises(ValueError, match="belongs to model 'glow'"):
        Glare(**{key: 0.5})
