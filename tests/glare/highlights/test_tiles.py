"""Highlights as sources: by tiles as by pixels, steady in motion, the same on both engines."""

from dataclasses import replace

import numpy as np
import pytest

from andon.gbuffer import VIEW_RECORD, pack_view
from andon.glare.highlights.contrast import AmbientLevel
from andon.glare.highlights.tiles import (
    highlights_of_tiles,
    light_tiles,
    sources_of_tiles,
    survey_tiles,
    threshold_cd_m2,
)
from andon.glare.sources.moments import pixel_moments, sources_of
from andon.quantities import photometric
from andon.spaces import View, look_at, pinhole_view

POSE = look_at([0.3, 1, 2], [0.5, 0.2, -1])
VIEW = pinhole_view(150, 101, 120.0, POSE)
VIEWS = {
    "pinhole": VIEW,
    "fisheye": View("fisheye", 120, 90, 50.0, 50.0, 59.5, 44.5, (), POSE),
    "latlong": View("latlong", 160, 80, world_from_camera=POSE),
}
COLOUR = np.array([1.2, 1.0, 0.6])
AMBIENT = AmbientLevel(10.0, "picture")


def spot(view, column, row, sigma_px, peak):
    """A bell of `peak` cd/m² about a place of the picture."""
    columns, rows = np.moveaxis(view.pixel_grid(), -1, 0)
    square = (columns - column) ** 2 + (rows - row) ** 2
    return (peak * np.exp(-square / (2 * sigma_px**2)))[..., None] * COLOUR


def found(view, picture):
    survey = survey_tiles(view, picture + 10.0, picture)
    light = light_tiles(view, picture, threshold_cd_m2(AMBIENT, 40.0))
    return highlights_of_tiles(light, survey, AMBIENT, view, 40.0)


@pytest.mark.parametrize("name", VIEWS)
def test_tiles_find_what_pixels_are(name):
    view = VIEWS[name]
    picture = spot(view, 80.3, 47.8, 4.0, 4e4)
    (highlight,) = found(view, picture)
    lit = photometric(picture) > 0.5 * threshold_cd_m2(AMBIENT, 40.0)
    moments = pixel_moments(
        view.directions()[lit],
        picture[lit],
        view.solid_angles()[lit],
        np.zeros(np.count_nonzero(lit), int),
        1,
    )
    (expected,) = sources_of(moments)
    source = highlight.source
    assert source.illuminance_lux == pytest.approx(expected.illuminance_lux, rel=1e-3)
    assert np.linalg.norm(source.direction - expected.direction) < 1e-4
    for axis in (np.max, np.min):
        assert axis(source.outline.radii_radians) == pytest.approx(
            axis(expected.outline.radii_radians), rel=0.01
        )
    assert highlight.peak_cd_m2 == pytest.approx(photometric(picture).max())
    assert highlight.glares
    assert highlight.contrast == pytest.approx(highlight.peak_cd_m2 / 10)


def test_a_moving_highlight_is_steady():
    """Along a way over six tiles, by tenths of a pixel and more."""
    lux, directions = [], []
    for step in np.linspace(0, 1, 60):
        (highlight,) = found(VIEW, spot(VIEW, 40 + 50 * step, 30 + 17 * step, 2.0, 3e4))
        lux.append(highlight.source.illuminance_lux)
        directions.append(highlight.source.direction)
    # Towards the rim pixels are smaller: compare with a smooth curve.
    place = np.arange(60)
    smooth = np.stack(
        [np.polyval(np.polyfit(place, channel, 4), place) for channel in np.transpose(lux)], -1
    )
    assert np.abs(np.array(lux) / smooth - 1).max() < 0.01
    turns = np.linalg.norm(np.diff(directions, axis=0), axis=1)
    assert turns.max() < 1.2 * np.median(turns)


def test_two_highlights_are_two_and_the_weak_one_does_not_glare():
    picture = spot(VIEW, 30, 30, 2.0, 5e4) + spot(VIEW, 110, 70, 2.0, 200.0)
    strong, weak = found(VIEW, picture)
    assert strong.glares
    assert not weak.glares
    assert strong.source.illuminance_lux[0] > 100 * weak.source.illuminance_lux[0]
    survey = survey_tiles(VIEW, picture + 10.0, picture)
    light = light_tiles(VIEW, picture, threshold_cd_m2(AMBIENT, 40.0))
    (only,) = sources_of_tiles(light, survey, AMBIENT, VIEW, 40.0)
    assert only.illuminance_lux == pytest.approx(strong.source.illuminance_lux)


def test_at_the_seam_of_a_latlong_picture_it_is_one():
    view = VIEWS["latlong"]
    picture = spot(view, 0.0, 40.0, 3.0, 4e4) + spot(view, 160.0, 40.0, 3.0, 4e4)
    (highlight,) = found(view, picture)
    assert highlight.source.direction[2] < -0.999


def test_nothing_bright_is_nothing():
    assert found(VIEW, np.zeros((*VIEW.shape, 3))) == []


def test_the_survey_is_the_pictures_surround():
    picture = spot(VIEW, 60, 40, 2.0, 1e5)
    survey = survey_tiles(VIEW, picture + 10.0, picture)
    assert survey.ambient(None, 40.0).cd_m2 == pytest.approx(10.0)
    assert survey.peak_cd_m2.max() == pytest.approx(photometric(picture).max())
    assert survey.solid_angle_sr.sum() == pytest.approx(VIEW.solid_angles().sum())


@pytest.mark.parametrize("name", VIEWS)
def test_shaders_sum_the_same_tiles(gpu, name):
    from andon.glare.highlights.tile_stage import TileStage
    from andon.gpu.textures import make_texture, uniform_buffer, write_buffer

    view = VIEWS[name]
    picture = spot(view, 70.2, 33.6, 3.0, 4e4) + spot(view, 21.0, 66.0, 1.0, 9e3)
    alpha = np.ones((*view.shape, 1))
    highlights = make_texture(gpu, "rgba32float", view.width, view.height)
    highlights.write(np.concatenate([picture, alpha], -1))
    luminance = make_texture(gpu, "rgba32float", view.width, view.height)
    luminance.write(np.concatenate([(picture + 10) / 3, alpha], -1))
    buffer = uniform_buffer(gpu, VIEW_RECORD.dtype.itemsize)
    write_buffer(gpu, buffer, pack_view(view))
    stage = TileStage(gpu, view, highlights, luminance, buffer, 3.0)
    survey, expected = stage.survey(), survey_tiles(view, picture + 10.0, picture)
    np.testing.assert_allclose(survey.peak_cd_m2, expected.peak_cd_m2, rtol=1e-5, atol=1e-20)
    # A pixel's solid angle is that of its four sides: to a square of its angle.
    np.testing.assert_allclose(survey.solid_angle_sr, expected.solid_angle_sr, rtol=1e-3)
    # Differences of two lights: to float32 of the brighter.
    np.testing.assert_allclose(survey.surround, expected.surround, rtol=2e-3, atol=1e-4)
    ours, theirs = stage.light(40.0), light_tiles(view, picture, 40.0)
    scale = theirs.illuminance_lux.max()
    np.testing.assert_allclose(ours.illuminance_lux, theirs.illuminance_lux, atol=1e-3 * scale)
    for column in range(5):
        most = np.abs(theirs.sums[..., column]).max()
        np.testing.assert_allclose(
            ours.sums[..., column], theirs.sums[..., column], atol=2e-3 * most
        )
    found_there = highlights_of_tiles(ours, replace(survey), AMBIENT, view, 40.0)
    here = found(view, picture)
    assert len(found_there) == len(here)
    for one, other in zip(found_there, here, strict=True):
        assert one.source.illuminance_lux == pytest.approx(other.source.illuminance_lux, rel=2e-3)
