"""Lamps fitted to photographs whose light is known."""

import numpy as np
import pytest

from andon.calibrate.lamps import FitSettings, fit_lamps
from andon.calibrate.lamps.measures import encoded
from andon.display.ciede2000 import delta_e_2000, lab_of_linear
from andon.errors import InputError
from andon.responses import SRGB, Response

from .lit_room import COOL, VIEW, WARM, codes_of, lit, photographed, room, texture

TRUTH = {WARM: np.array([1.8, 1.0, 0.4]), COOL: np.array([0.5, 0.8, 1.4])}


def fit(prepared, reference, mask=None, **settings):
    return fit_lamps(
        prepared, reference, mask=mask, settings=FitSettings(engine="reference", **settings)
    )


def assert_factors(found, truth, scale=1.0, rtol=0.02):
    for light in found.lamps:
        assert light.factor == pytest.approx(
            scale * np.broadcast_to(truth[light.name], 3), rel=rtol
        )


def test_flux_and_colour_are_found_in_noise_codes_and_another_exposure():
    prepared, reference = photographed(TRUTH, exposure=0.7)
    found = fit(prepared, reference, dimming="one")
    assert_factors(found, TRUTH, 0.7)
    assert found.dimming.factor == pytest.approx(np.full(3, 0.7), rel=0.01)
    inside = found.measures["whole_without_holes"]
    assert inside["fitted"].psnr_db > inside["gain_channels"].psnr_db + 6
    assert found.notes == ()


def test_an_exposure_that_is_not_asked_for_is_not_taken_for_light():
    """Then factors are wrong by about as much as the exposure, and the error says so."""
    prepared, reference = photographed(TRUTH, exposure=0.7)
    asked, blind = fit(prepared, reference, dimming="one"), fit(prepared, reference)
    assert blind.dimming is None
    assert blind.measures["whole"]["fitted"].psnr_db < asked.measures["whole"]["fitted"].psnr_db - 5


def test_dimming_is_fitted_by_itself_where_the_reference_is_darker():
    """Light that is added darkens nothing: a darker place tells of another exposure."""
    prepared, darker = photographed(TRUTH, exposure=0.7)
    assert fit(prepared, darker, dimming="auto").dimming.factor == pytest.approx(0.7, rel=0.01)
    prepared, same = photographed(TRUTH)
    assert fit(prepared, same, dimming="auto").dimming is None


def test_a_white_balance_is_taken_up_by_three_channels():
    balance = np.array([0.8, 1.0, 1.3])
    prepared, reference = photographed(TRUTH, exposure=balance)
    found = fit(prepared, reference, dimming="channels")
    assert found.dimming.factor == pytest.approx(balance, rel=0.02)
    assert_factors(found, {name: balance * value for name, value in TRUTH.items()}, rtol=0.03)


def test_flux_alone_keeps_the_colour():
    prepared, reference = photographed({WARM: 1.7, COOL: 0.6})
    found = fit(prepared, reference, colour=False)
    assert_factors(found, {WARM: 1.7, COOL: 0.6})
    for light in found.lamps:
        assert (light.factor == light.factor[0]).all()


def test_lamps_that_are_not_chosen_stay_as_they_are():
    prepared, reference = photographed({WARM: 1.7, COOL: 1.0})
    found = fit(prepared, reference, lamps=(WARM,))
    assert [light.name for light in found.lamps] == [WARM]
    assert_factors(found, {WARM: 1.7})


def test_a_lamp_that_was_stated_a_million_times_too_dim_is_found(engine):
    """Half floats would round its picture away."""
    truth = {WARM: np.array([1.8, 1.0, 0.4]) * 1e6}
    from dataclasses import replace

    from andon import PointLamp

    clean = room(lamps=(PointLamp(WARM, np.array([-0.7, 0.3, -1.6]), np.full(3, 5e-5)),))
    reference = codes_of(lit(clean, truth))
    settings = FitSettings(engine=engine)
    found = fit_lamps(replace(clean), reference, settings=settings)
    assert_factors(found, truth)


def test_white_pixels_bound_and_do_not_pull():
    """A lamp that burns out a quarter of the reference is found from the rest."""
    truth = {WARM: 7.0, COOL: 2.0}
    prepared, reference = photographed(truth)
    assert (reference >= 254).any(axis=-1).mean() > 0.2
    found = fit(prepared, reference)
    assert_factors(found, truth)


def test_white_pixels_count_while_the_prediction_is_darker():
    """Where all that a lamp lights is white, the fit still knows that it must be bright."""
    prepared = room()
    reference = np.full((*VIEW.shape, 3), 255, np.uint8)
    found = fit(prepared, reference, lamps=(WARM,), align="none")
    predicted = np.minimum(found.predicted, 1)[~found.holes]
    assert np.median(predicted) > 0.95


def test_things_that_moved_count_for_nothing():
    prepared, reference = photographed(TRUTH)
    reference[10:40, 20:45] = [30, 200, 40]  # a tenth of the picture, in the lamp's light
    found = fit(prepared, reference, align="none")
    assert_factors(found, TRUTH)
    assert found.rejected_share > 0.08


def test_the_fit_looks_only_into_the_mask():
    prepared, reference = photographed(TRUTH)
    mask = np.zeros(VIEW.shape, bool)
    mask[20:, :60] = True
    reference[~mask] = 128
    found = fit(prepared, reference, mask, align="none")
    assert_factors(found, TRUTH)
    assert set(found.measures) == {
        f"{region}{holes}"
        for region in ("inside", "outside", "whole")
        for holes in ("", "_without_holes")
    }
    assert found.measures["inside"]["fitted"].pixels == mask.sum()
    assert found.measures["outside"]["fitted"].pixels == (~mask).sum()
    assert found.measures["inside"]["fitted"].psnr_db > 35
    assert found.measures["outside"]["fitted"].psnr_db < 25


def test_bounce_is_found_apart_from_lamps():
    from andon import HemisphereLamp

    sky, ground = np.array([12.0, 9.0, 6.0]), np.array([3.0, 4.0, 8.0])
    lamps = room().lamps(0.0)
    fill = HemisphereLamp("fill", np.array([0.0, 1.0, 0.0]), sky, ground)
    reference = codes_of(lit(room(lamps=(*lamps, fill)), TRUTH), noise=2)
    found = fit(room(), reference, bounce=True)
    assert_factors(found, TRUTH, rtol=0.03)
    assert found.fill.sky_lux == pytest.approx(sky, rel=0.1, abs=0.6)
    assert found.fill.ground_lux == pytest.approx(ground, rel=0.1, abs=0.6)
    alone = fit(room(), reference)
    assert found.measures["whole"]["fitted"].psnr_db > alone.measures["whole"]["fitted"].psnr_db + 1
    shares = [light.share for light in found.lamps] + [found.fill.share]
    assert sum(shares) == pytest.approx(1)
    assert 0.05 < found.fill.share < 0.3


def test_lamps_at_one_place_are_said_not_to_be_told_apart():
    from andon import PointLamp

    place = np.array([-0.7, 0.3, -1.6])
    twins = [PointLamp(name, place, np.full(3, 50.0)) for name in ("one", "other")]
    apart = PointLamp(COOL, np.array([0.8, -0.2, -1.9]), np.full(3, 50.0))
    prepared = room(lamps=(*twins, apart))
    reference = codes_of(lit(prepared, {"one": 1.0, "other": 0.5, COOL: 0.8}), noise=2)
    found = fit(prepared, reference)
    one, other, cool = found.lamps
    assert (one.told_apart, other.told_apart, cool.told_apart) == (False, False, True)
    assert one.factor + other.factor == pytest.approx(np.full(3, 1.5), rel=0.02)
    assert cool.factor == pytest.approx(np.full(3, 0.8), rel=0.02)
    assert any("no pixel tells one from other" in line for line in found.notes)


def test_standard_errors_are_as_large_as_what_noise_does():
    """Over twelve noises the factors spread as the fit says, within a factor of two."""
    clean = room()
    light, found = lit(clean, {WARM: 1.2}), []
    for seed in range(12):
        photograph = codes_of(texture(), noise=100 + seed)
        reference = codes_of(light, noise=200 + seed)
        found.append(fit(room(photograph), reference, lamps=(WARM,), align="none").lamps[0])
    spread = np.std([x.factor for x in found], axis=0)
    stated = np.mean([x.error for x in found], axis=0)
    assert (stated > spread / 2).all()
    assert (stated < 2 * spread).all()


def test_the_photograph_as_its_own_reference_has_nothing_to_fit():
    photograph = codes_of(texture())
    found = fit(room(photograph), photograph)
    for light in found.lamps:
        assert light.factor == pytest.approx(np.zeros(3), abs=1e-6)
    assert any("nothing to fit" in line for line in found.notes)
    assert found.measures["whole"]["fitted"].rmse_encoded < 1e-6


def test_a_linear_reference_is_light(tmp_path):
    from andon.files.pictures import write_exr

    prepared = room()
    light = lit(prepared, TRUTH)
    path = tmp_path / "reference.exr"
    write_exr(path, light.astype(np.float32), unit="1", photometry="relative")
    found = fit(prepared, path)
    assert_factors(found, TRUTH, rtol=2e-3)


@pytest.mark.parametrize("name", ["gamma:1.8", "srgb"])
def test_the_response_is_told_by_how_light_adds(name):
    kind, _, gamma = name.partition(":")
    truth = Response("gamma", gamma=float(gamma)) if gamma else SRGB
    clean = room(response=truth)
    bright = {WARM: 3.0, COOL: 2.0}
    reference = codes_of(lit(clean, bright), truth, noise=2)
    wrong = room(codes_of(texture(), truth, noise=1))  # says sRGB
    found = fit(wrong, reference, response=True)
    assert min(found.responses, key=found.responses.get) == name
    assert found.response.kind == kind
    assert_factors(found, bright, rtol=0.03)
    again = fit(wrong, reference)
    assert found.measures["whole"]["fitted"].rmse_encoded <= (
        again.measures["whole"]["fitted"].rmse_encoded + 1e-9
    )


def test_the_drawn_frame_is_the_prediction_that_is_measured():
    prepared, reference = photographed(TRUTH)
    found = fit(prepared, reference)
    codes = found.frame.image.rgb / 255
    assert np.abs(codes - encoded(found.predicted, SRGB)).max() < 0.51 / 255
    wanted = encoded(found.reference, SRGB)
    rmse = np.sqrt(np.mean((encoded(found.predicted, SRGB) - wanted) ** 2))
    whole = found.measures["whole"]["fitted"]
    assert whole.rmse_encoded == pytest.approx(rmse)
    assert whole.psnr_db == pytest.approx(-20 * np.log10(rmse))
    shown = [lab_of_linear(np.clip(x, 0, 1)) for x in (found.predicted, found.reference)]
    assert whole.delta_e_mean == pytest.approx(delta_e_2000(*shown).mean(), abs=0.01)


@pytest.mark.parametrize(
    ("reference", "words"),
    [
        (np.zeros((10, 96, 3), np.uint8), "is 96×10 px but the photograph is 96×72"),
        (np.zeros((72, 96), np.uint8), "must be a path or"),
        (np.full((72, 96, 3), np.nan), "NaN or infinite"),
    ],
)
def test_references_that_do_not_fit_are_refused(reference, words):
    with pytest.raises(InputError, match=words):
        fit(room(), reference)


@pytest.mark.parametrize(
    ("mask", "words"),
    [
        (np.zeros(VIEW.shape, bool), "selects nothing"),
        (np.ones((5, 5), bool), "is 5×5 px"),
        (np.ones(VIEW.shape, np.uint8), "must be a path or"),
    ],
)
def test_masks_that_do_not_fit_are_refused(mask, words):
    with pytest.raises(InputError, match=words):
        fit(room(), codes_of(texture()), mask)


def test_a_mask_of_holes_alone_is_refused():
    mask = np.zeros(VIEW.shape, bool)
    mask[5:11, 81:91] = True
    with pytest.raises(InputError, match="no pixel to fit"):
        fit(room(), codes_of(texture()), mask)


def test_a_lamp_that_shines_nowhere_is_refused():
    from andon import PointLamp

    lamps = (*room().lamps(0.0), PointLamp("behind", np.array([0.0, 0.0, -9.0]), np.full(3, 50.0)))
    with pytest.raises(InputError, match="'behind' adds no light"):
        fit(room(lamps=lamps), codes_of(texture()))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"lamps": ("wram",)}, "there is no lamp 'wram'"),
        ({"lamps": ()}, "nothing to fit"),
        ({"dimming": "two"}, "must be one of auto, off, one, channels"),
        ({"align": "yes"}, "must be one of auto, none"),
        ({"view": "left"}, "there is no view 'left'"),
    ],
)
def test_settings_that_do_not_fit_are_refused(settings, words):
    with pytest.raises(InputError, match=words):
        fit(room(), codes_of(texture()), **settings)


def test_where_e0_is_even_a_fill_from_all_sides_is_called_dimming():
    prepared, reference = photographed(TRUTH, exposure=0.7)
    found = fit(prepared, reference, dimming="one", bounce=True)
    assert found.dimming.factor == pytest.approx(np.full(3, 0.7), rel=0.02)
    assert found.fill.share < 0.01
    assert not found.dimming.told_apart
    assert any("no pixel tells dimming from bounce" in line for line in found.notes)
    assert_factors(found, TRUTH, 0.7)
