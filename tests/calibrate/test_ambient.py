"""E0 from one photograph: what it finds, what it must not imprint, and what it states of itself."""

from dataclasses import replace

import numpy as np
import pytest

from andon.calibrate.ambient import AmbientEstimate, AmbientSettings, estimate_ambient, placed
from andon.calibrate.ambient.field import CHROMA, LUMINANCE, Field, spread_points
from andon.calibrate.ambient.observed import observe
from andon.calibrate.ambient.of_scene import as_captured
from andon.errors import InputError
from andon.lenses import undistort
from andon.quantities import CameraFrame, photometric
from andon.spaces import View
from andon.surface import reference as surface
from andon.surface.load import surface_of_mesh
from worlds import block, points_on, unit

FEW = AmbientSettings(inducing=50, near_pairs=4000, far_pairs=3000)
WIDTH, HEIGHT = 72, 54
VIEW = View("pinhole", WIDTH, HEIGHT, 50.0, 50.0, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
PAINT = np.array([0.5, 0.45, 0.4])


@pytest.fixture(scope="module")
def corner():
    """The inside of a box, seen from its middle: floor, ceiling, three walls."""
    room = block((3.0, 2.4, 4.0), (0.0, 0.1, -0.5), inwards=True)
    return surface.see(surface_of_mesh(room, np.zeros(3)), VIEW)


def lamp_lux(seen, at=(0.9, 0.6, -1.4), rest=20.0, colour=(1.0, 1.0, 1.0)):
    """E of a point lamp of 100 cd, and the same rest everywhere."""
    reach = np.array(at) - seen.position
    square = (reach**2).sum(axis=-1)
    cosine = np.maximum((reach * seen.normal).sum(axis=-1), 0)
    return rest + (100 * cosine / square**1.5)[..., None] * np.array(colour)


def photographed(seen, lux, reflectance, *, clipped=None):
    linear = (reflectance * lux / np.max(reflectance * lux)).astype(np.float32)
    return CameraFrame(linear, seen.view, clipped=clipped)


def median_error(found, lux):
    """Of |E0/true − 1| after the best scale of each channel."""
    ratio = (found / lux).reshape(-1, 3)
    return float(np.median(np.abs(ratio / np.median(ratio, axis=0) - 1)))


def checked(seen):
    """Reflectance of checks in two shades of one paint, other ones on floor and walls."""
    step = np.floor(seen.position * 4 + 0.5).sum(axis=-1) % 2
    floor = np.abs(seen.normal[..., 1:2]) > 0.5
    return PAINT * np.where(step[..., None] == 1, 1.0, 0.45) * np.where(floor, [0.6, 1, 0.5], 1.0)


# ── what is found ─────────────────────────────────────────────────────────────────────────────


def test_in_one_paint_the_light_is_found(corner):
    lux = lamp_lux(corner)
    found = estimate_ambient(photographed(corner, lux, PAINT), corner, settings=FEW)
    assert median_error(found.relative, lux) < 0.03
    assert median_error(np.ones_like(lux), lux) > 0.25
    np.testing.assert_allclose(found.relative.mean(axis=(0, 1)), 1)


def test_checks_are_no_light(corner):
    lux = lamp_lux(corner)
    found = estimate_ambient(photographed(corner, lux, checked(corner)), corner, settings=FEW)
    assert median_error(found.relative, lux) < 0.12


def test_mixed_light_has_its_colours_where_they_are(corner):
    lux = lamp_lux(corner, colour=(1.6, 1.0, 0.4))
    found = estimate_ambient(photographed(corner, lux, PAINT), corner, settings=FEW).relative
    warmth, truth = (np.log(e[..., 0] / e[..., 2]).ravel() for e in (found, lux))
    assert np.corrcoef(warmth, truth)[0, 1] > 0.9
    assert 0.5 < np.polyfit(truth, warmth, 1)[0] < 1.2


def test_paints_are_not_imprinted_on_even_light(corner):
    left = (corner.position[..., :1] < 0.2).astype(float)
    reflectance = left * [0.7, 0.1, 0.08] + (1 - left) * [0.15, 0.2, 0.6]
    lux = np.full((HEIGHT, WIDTH, 3), 80.0)
    frame = photographed(corner, lux, reflectance)
    found = estimate_ambient(frame, corner, settings=FEW).relative
    assert np.quantile(np.abs(found - 1), 0.95) < 0.06


def test_where_no_two_pixels_are_alike_it_falls_back_to_one_e0(corner):
    noise = np.random.default_rng(2).uniform(0.1, 0.9, (HEIGHT, WIDTH, 3))
    lux = np.full((HEIGHT, WIDTH, 3), 80.0)
    found = estimate_ambient(photographed(corner, lux, noise), corner, settings=FEW).relative
    # Pairs that agree by chance are left: less than a fifth of the noise's own spread comes in.
    assert np.log(found).std() < 0.2 * np.log(noise).std()


def test_exposure_and_white_balance_do_not_matter(corner):
    lux = lamp_lux(corner)
    frame = photographed(corner, lux, checked(corner))
    warmer = replace(frame, linear=frame.linear * np.float32([0.5, 0.3, 0.2]))
    first, second = (estimate_ambient(f, corner, settings=FEW).relative for f in (frame, warmer))
    np.testing.assert_allclose(first, second, rtol=1e-3)


def test_clipped_and_black_pixels_are_left_out(corner):
    lux = lamp_lux(corner)
    frame = photographed(corner, lux, PAINT)
    clipped = np.zeros((HEIGHT, WIDTH), bool)
    clipped[:20, 40:] = True
    linear = np.where(clipped[..., None], 1.0, frame.linear).astype(np.float32)
    linear[40:, :20] = 0
    broken = estimate_ambient(replace(frame, linear=linear, clipped=clipped), corner, settings=FEW)
    assert broken.used_share == pytest.approx(1 - (20 * 32 + 14 * 20) / (WIDTH * HEIGHT), abs=0.01)
    assert median_error(broken.relative, lux) < 0.06


def test_normals_alone_give_light_by_normals(corner):
    x, y = np.meshgrid(np.linspace(-1, 1, WIDTH), np.linspace(-1, 1, HEIGHT))
    normal = unit(np.stack([x, -y, np.ones_like(x)], axis=-1))
    seen = surface.from_normals(normal, VIEW)
    lux = (60 + 50 * normal @ unit([0.5, 0.8, 0.4]))[..., None] * np.ones(3)
    found = estimate_ambient(photographed(seen, lux, PAINT), seen, settings=FEW)
    assert median_error(found.relative, lux) < 0.03


# ── known sources ─────────────────────────────────────────────────────────────────────────────


def test_a_named_lamp_brings_its_shadow_and_its_share(corner):
    direct = lamp_lux(corner, rest=0.0)
    direct[20:40, 10:30] = 0  # what hides it is not in the geometry's smoothness
    lux = 20 + direct
    frame = photographed(corner, lux, checked(corner))
    plain = estimate_ambient(frame, corner, settings=FEW)
    named = estimate_ambient(frame, corner, sources_lux=[direct], settings=FEW)
    shadow = np.s_[22:38, 12:28]
    errors = [
        np.median(np.abs(e.relative / lux * np.median(lux / e.relative) - 1)[shadow])
        for e in (plain, named)
    ]
    assert errors[1] < 0.5 * errors[0]
    assert named.source_shares[0] == pytest.approx(direct.mean() / lux.mean(), abs=0.15)


def test_a_lamp_that_is_off_is_not_found(corner):
    lux = lamp_lux(corner)
    elsewhere = lamp_lux(corner, at=(-1.0, -0.4, -0.9), rest=0.0)
    frame = photographed(corner, lux, PAINT)
    found = estimate_ambient(frame, corner, sources_lux=[elsewhere], settings=FEW)
    assert found.source_shares[0] < 0.1


# ── scale ─────────────────────────────────────────────────────────────────────────────────────


def test_scale_and_colour_are_as_stated(corner):
    frame = replace(photographed(corner, lamp_lux(corner), PAINT), luminance_per_unit=30.0)
    found = estimate_ambient(frame, corner, settings=FEW)
    relative = placed(found, frame, corner)
    assert (relative.photometry, relative.by) == ("relative", "nothing")
    assert photometric(relative.lux).mean() == pytest.approx(1)
    stated = placed(found, frame, corner, mean_lux=150.0, colour=np.array([2.0, 1.0, 0.5]))
    assert photometric(stated.lux).mean() == pytest.approx(150)
    mean = stated.lux.mean(axis=(0, 1))
    np.testing.assert_allclose(mean / mean[1], [2, 1, 0.5])
    reflecting = placed(found, frame, corner, mean_reflectance=0.4)
    reflectance = np.pi * 30.0 * frame.linear / reflecting.lux
    assert photometric(reflectance).mean() == pytest.approx(0.4, rel=1e-6)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"mean_lux": -5.0}, "lux: must be > 0 lx, got -5"),
        ({"mean_lux": np.nan}, "must be > 0 lx"),
        ({"mean_reflectance": 1.5}, "reflectance: must be in"),
        ({"mean_lux": 5.0, "mean_reflectance": 0.5}, "one of lux and reflectance"),
        ({"colour": np.array([1.0, 0.0, 1.0])}, "colour: must be > 0"),
    ],
)
def test_scales_out_of_range_are_refused(corner, keys, message):
    frame = photographed(corner, lamp_lux(corner), PAINT)
    found = AmbientEstimate(np.ones((HEIGHT, WIDTH, 3)), np.ones((HEIGHT, WIDTH)), 1.0)
    with pytest.raises(InputError, match=message):
        placed(found, frame, corner, **keys)


# ── parts ─────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("terms", [LUMINANCE, CHROMA])
def test_features_have_the_covariance_of_the_field(terms):
    position, normal = points_on(block((1, 1, 1), (0, 0, 0)), 60)
    field = Field(terms, position, normal)
    features = field.features(position, normal)
    expected = np.zeros((60, 60))
    cosine = normal @ normal.T
    square = ((position[:, None] - position) ** 2).sum(axis=-1)
    for term in terms:
        legendre = np.polynomial.legendre.legval(cosine, term.bands)
        expected += term.variance * np.exp(-square / (2 * term.length**2)) * legendre
    np.testing.assert_allclose(features @ features.T, expected, atol=1e-4)
    assert np.linalg.eigvalsh(expected).min() > -1e-9
    weights = np.random.default_rng(1).normal(size=(60, 2))
    values = field.values(weights, position, normal)  # in float32
    np.testing.assert_allclose(values, features @ weights, atol=1e-3)


def test_spread_points_leave_no_gap():
    position, normal = points_on(block((1, 1, 1), (0, 0, 0)), 400)
    chosen = spread_points(position, normal, 40)
    assert len(set(chosen.tolist())) == 40
    gap = np.linalg.norm(position[:, None] - position[chosen], axis=-1).min(axis=1).max()
    assert gap < 0.6
    same = spread_points(np.zeros((5, 3)), np.zeros((5, 3)), 3)
    assert same.tolist() == [0]


def test_blocks_are_means_and_those_across_an_edge_are_left_out(corner):
    lux = lamp_lux(corner)
    frame = photographed(corner, lux, PAINT)
    found = observe(frame, corner, [lux], WIDTH // 4)
    assert found.number.shape == (-(-HEIGHT // 4), WIDTH // 4)
    assert 0.5 < found.used_share <= 1
    row, column = np.argwhere(found.number >= 0)[7]
    own = np.s_[4 * row : 4 * row + 4, 4 * column : 4 * column + 4]
    at = found.number[row, column]
    np.testing.assert_allclose(np.exp(found.log_light[at]), frame.linear[own].mean(axis=(0, 1)))
    np.testing.assert_allclose(found.sources[0][at], lux[own].mean(axis=(0, 1)))
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=1), 1)


def test_too_little_to_see_is_refused(corner):
    frame = photographed(corner, lamp_lux(corner), PAINT)
    all_clipped = replace(frame, clipped=np.ones((HEIGHT, WIDTH), bool))
    nothing = replace(corner, valid=np.zeros((HEIGHT, WIDTH), bool))
    for shown, seen in ((all_clipped, corner), (frame, nothing)):
        with pytest.raises(InputError, match="at least 64 are needed"):
            estimate_ambient(shown, seen, settings=FEW)


@pytest.mark.parametrize(
    ("projection", "distortion"),
    [("pinhole", (0.12, -0.05, 0.001, -0.002)), ("fisheye", (0.03, -0.01, 0.0, 0.0))],
)
def test_e0_is_written_as_the_lens_saw_it(projection, distortion):
    view = replace(VIEW, projection=projection, distortion=distortion)
    x, y = np.meshgrid(np.linspace(1, 2, WIDTH), np.linspace(1, 3, HEIGHT))
    lux = np.stack([x * y, x + y, y], axis=-1)
    back = undistort(as_captured(lux, view), view)
    inside = np.isfinite(back).all(axis=-1)
    inside[[0, 1, -2, -1]] = inside[:, [0, 1, -2, -1]] = False
    np.testing.assert_allclose(back[inside], lux[inside], rtol=5e-3)


def test_the_stated_error_is_larger_where_nothing_hangs_together(corner):
    lux = lamp_lux(corner)
    whole = estimate_ambient(photographed(corner, lux, PAINT), corner, settings=FEW)
    noise = np.random.default_rng(2).uniform(0.05, 0.95, (HEIGHT, WIDTH, 3))
    torn = estimate_ambient(photographed(corner, lux, noise), corner, settings=FEW)
    assert torn.stated_error > 1.5 * whole.stated_error
    assert np.isfinite(whole.log_error).all()
