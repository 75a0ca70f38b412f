"""The sun through gaps: how much light, from where, when; and what an eye makes of it."""

import cv2
import numpy as np
import pytest
from sunlit import VIEW, komorebi

from andon.errors import InputError
from andon.glare.komorebi import Komorebi, Sun
from andon.glare.komorebi.seen import Seen
from andon.lamps.flicker import Flicker
from andon.observer.spread.model import Eye
from andon.quantities import photometric


def lux(sources):
    return np.array([photometric(source.illuminance_lux) for source in sources])


def test_equation_11_for_gaps_of_one_size():
    """I_p = (1/n)·Σ I·S_i, with ⟨S⟩ made 1."""
    shown = komorebi(transmitted=0.01)
    for time in (0.0, 1.7, 40.0):
        shares = shown.flicker.open_share(time)
        weights = shown.canopy.solid_angles_sr / shown.canopy.solid_angles_sr.mean()
        expected = 1000.0 / 12 * weights * shares / shown.flicker.mean
        assert np.allclose(lux(shown.sources(time)), expected, rtol=1e-6)


def test_the_mean_over_time_is_what_comes_through():
    shown = komorebi(transmitted=0.01, z=1.4)  # of 1.8 the mean of hours still wanders
    mean = np.mean([lux(shown.sources(t)).sum() for t in np.arange(0, 600, 2.0)])
    assert abs(mean / 1000 - 1) < 0.05


def test_no_gap_is_brighter_than_the_sun():
    sun = 100_000 / Sun().solid_angle_sr
    bright = komorebi(size=1, count=2, transmitted=1.0)
    assert np.isclose(photometric(bright.luminance_cd_m2), sun)
    most = sum(lux(bright.sources(t)).max() for t in np.arange(0, 20, 0.5)) / 40
    assert most <= sun * bright.canopy.solid_angles_sr.max() * 1.0001
    assert photometric(komorebi(transmitted=1e-3).luminance_cd_m2) < sun


def test_the_area_scales_with_the_light_and_the_luminance_stays():
    shown = komorebi(size=4)
    first, other = shown.sources(0.4), shown.sources(3.1)
    for a, b in zip(first, other, strict=True):
        ratio = photometric(a.illuminance_lux) / photometric(b.illuminance_lux)
        assert np.isclose(a.outline.solid_angle_sr / b.outline.solid_angle_sr, ratio, rtol=1e-3)
        assert np.allclose(a.luminance_cd_m2, shown.luminance_cd_m2, rtol=1e-3)


def test_the_picture_has_the_light_of_the_sources():
    shown = komorebi(size=5)
    seen = shown.picture(2.2) - shown.canopy.leaves_cd_m2
    added = photometric((seen * VIEW.solid_angles()[..., None]).sum(axis=(0, 1)))
    hidden = photometric(shown.canopy.leaves_cd_m2).max() / photometric(shown.luminance_cd_m2)
    assert np.isclose(added, lux(shown.sources(2.2)).sum(), rtol=2 * hidden)


def test_sources_lie_in_their_gaps():
    shown = komorebi()
    for source, direction in zip(shown.sources(0.0), shown.canopy.directions, strict=True):
        assert np.array_equal(source.direction, direction)


def test_frames_of_one_seed_are_one_film():
    first, again, other = (komorebi(seed=s).picture(1.3) for s in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_light_between_frames_changes_little_by_little():
    """At 30 frames a second and 6 iterations a gap takes 5 frames from closed to open."""
    shown = komorebi(exposure=1 / 30)
    shares = np.stack([shown.open_shares(n / 30) for n in range(150)])
    assert np.abs(np.diff(shares, axis=0)).max() < 0.2
    assert shares.max() > 0.8


def test_bloom_and_needles_take_no_light_that_is_not_there():
    """On a picture of 40° most of what is scattered stays on it, and nothing is won."""
    shown = komorebi(transmitted=0.002)
    seen = Seen(shown, Eye(pupil_mm=3.0))
    before, after = shown.picture(1.0), seen.picture(1.0)
    solid = VIEW.solid_angles()[..., None]
    held = photometric((after * solid).sum((0, 1))) / photometric((before * solid).sum((0, 1)))
    assert 0.9 < held <= 1.0
    assert (after > 0).all()


def test_leaves_beside_a_bright_gap_are_veiled_as_the_model_says():
    shown = komorebi(count=1, size=1, transmitted=0.01)
    seen = Seen(shown)
    time = next(t for t in np.arange(0, 40, 0.25) if shown.open_shares(t)[0] > 0.5)
    bloom = seen.picture(time) - Seen(komorebi(count=1, size=1, transmitted=0.0)).picture(time)
    from andon.observer.spread.family import spread_function

    gap = shown.sources(time)[0]
    kept = 1 - seen.parts(time)[1][0].share  # needles have the rest
    for x, y in ((60, 14), (12, 60), (110, 70)):
        angle = np.degrees(np.arccos(VIEW.directions()[y, x] @ gap.direction))
        veil = (
            kept * spread_function("cie135").bloom_per_sr(angle) * photometric(gap.illuminance_lux)
        )
        assert np.isclose(photometric(bloom[y, x]), veil, rtol=0.04)


def test_an_old_eye_sees_more_of_a_veil():
    shown = komorebi()
    young, old = (Seen(shown, Eye(age_years=age)).picture(1.0) for age in (20, 75))
    leaves = photometric(shown.canopy.leaves_cd_m2)
    dark = leaves < np.percentile(leaves, 30)  # bright ones lose more than they get
    # Beside a gap all eyes scatter alike: age tells from some degrees on.
    gaps = np.zeros(dark.shape, np.uint8)
    gaps.ravel()[shown.canopy.pixels] = 1
    dark &= cv2.dilate(gaps, np.ones((9, 9), np.uint8)) == 0
    assert dark.sum() > 500
    assert (photometric(old)[dark] > 1.2 * photometric(young)[dark]).all()


@pytest.mark.parametrize(
    "wrong", [{"illuminance_lux": -1}, {"transmitted": 1.5}, {"diameter_degrees": 0}]
)
def test_impossible_suns_are_refused(wrong):
    with pytest.raises(InputError, match=r"sun\."):
        Sun(**wrong)


def test_a_stream_for_each_gap():
    with pytest.raises(InputError, match="stream for each of 12 gaps"):
        Komorebi(komorebi().canopy, flicker=Flicker(0, 1.8, 6.0, 3))
