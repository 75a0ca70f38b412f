"""Sources of a picture: on the sphere, over seam and poles, merged and ranked."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare.sources.find import background_luminance, find_sources
from andon.quantities import photometric
from andon.spaces import View, pinhole_view

LATLONG = View("latlong", 360, 180)
FISHEYE = View("fisheye", 240, 240, 240 / np.pi, 240 / np.pi, 119.5, 119.5)


def direction_of(azimuth_degrees, elevation_degrees):
    a, e = np.radians([azimuth_degrees, elevation_degrees])
    return np.array([np.cos(e) * np.sin(a), -np.sin(e), np.cos(e) * np.cos(a)])


def with_disc(view, centre, radius_degrees, luminance, ambient=1.0):
    """A grey room with a bright disc around `centre`."""
    inside = view.directions() @ centre > np.cos(np.radians(radius_degrees))
    return np.where(inside[..., None], luminance, ambient) * np.ones(3)


@pytest.mark.parametrize(
    "centre",
    [(0, 0), (180, 0), (-179, 20), (77, 88), (10, 90), (0, -90)],
    ids=["ahead", "seam", "beside the seam", "by the pole", "zenith", "nadir"],
)
def test_a_disc_is_one_source_wherever_it_stands(centre):
    at = direction_of(*centre)
    found = find_sources(with_disc(LATLONG, at, 5, 1000), LATLONG)
    assert found.regions == 1
    (source,) = found.sources
    assert source.direction @ at > np.cos(np.radians(0.1))
    disc = 2 * np.pi * (1 - np.cos(np.radians(5)))
    assert found.solid_angle_sr[0] == pytest.approx(disc, rel=0.03)
    assert photometric(source.illuminance_lux) == pytest.approx(1000 * disc, rel=0.03)
    assert photometric(found.luminance_cd_m2[0]) == pytest.approx(1000)
    assert np.degrees(source.outline.radii_radians.mean()) == pytest.approx(5, rel=0.03)
    assert found.labels.max() == 1


def test_the_outline_of_an_ellipse_has_its_axes():
    view = pinhole_view(400, 300, 400)
    y, x = np.mgrid[:300, :400]
    turn = np.radians(30)
    along = (x - 200) * np.cos(turn) + (y - 150) * np.sin(turn)
    across = -(x - 200) * np.sin(turn) + (y - 150) * np.cos(turn)
    light = np.where((along / 24) ** 2 + (across / 8) ** 2 < 1, 500.0, 1.0)[..., None] * np.ones(3)
    (source,) = find_sources(light, view).sources
    radii = source.outline.radii_radians * 400
    assert radii.max() == pytest.approx(24, rel=0.03)
    assert radii.min() == pytest.approx(8, rel=0.05)
    right, _ = source.axes
    assert abs(right[:2] @ [np.cos(turn), np.sin(turn)]) == pytest.approx(1, abs=2e-3)


def test_strongest_first_and_the_rest_is_counted():
    light = np.ones((180, 360, 3))
    places = [(20 + 10 * i, 20 + 30 * i) for i in range(10)]
    for power, (row, column) in enumerate(places):
        light[row, column] = 100 * (power + 1)
    found = find_sources(light, LATLONG, most=4)
    assert found.regions == 10
    assert found.left_out == 6
    lux = [float(photometric(source.illuminance_lux)) for source in found.sources]
    assert lux == sorted(lux, reverse=True)
    solid = LATLONG.solid_angles()
    power = np.array([light[place][0] * solid[place] for place in places])
    assert lux == pytest.approx(np.sort(power)[:-5:-1])
    assert found.left_out_share == pytest.approx(1 - np.sum(lux) / power.sum())
    # The label of every kept pixel is the place of its source in the list.
    for number, source in enumerate(found.sources):
        (row, column), *more = np.argwhere(found.labels == number + 1)
        assert not more
        assert LATLONG.directions()[row, column] @ source.direction == pytest.approx(1)


def test_specks_near_a_stronger_one_are_part_of_it():
    view = pinhole_view(200, 200, 2000)
    light = np.ones((200, 200, 3))
    light[100, 100], light[100, 106], light[20, 20] = 1000, 500, 400
    apart = find_sources(light, view, merge_degrees=0.0)
    assert len(apart.sources) == 3
    merged = find_sources(light, view, merge_degrees=0.5)
    assert len(merged.sources) == 2
    assert merged.left_out == 0
    lux = [float(photometric(source.illuminance_lux)) for source in merged.sources]
    assert lux == pytest.approx([1500 / 2000**2, 400 / 2000**2], rel=1e-2)


def test_clipped_pixels_flag_their_source_alone():
    light = with_disc(FISHEYE, np.array([0, 0, 1.0]), 3, 1000)
    light[60, 60] = 900
    clipped = np.zeros(FISHEYE.shape, bool)
    clipped[119, 119] = True
    first, second = find_sources(light, FISHEYE, clipped=clipped).sources
    assert (first.clipped, second.clipped) == (True, False)


def test_a_sun_does_not_raise_the_ambient_luminance():
    light = with_disc(FISHEYE, np.array([0, 0, 1.0]), 1, 1e6, ambient=10)
    bright = photometric(light)
    assert np.average(bright, weights=FISHEYE.solid_angles()) > 20
    assert background_luminance(bright, FISHEYE.solid_angles()) == pytest.approx(10)


def test_an_even_or_black_picture_has_none():
    for value in (0.0, 7.0):
        found = find_sources(np.full((180, 360, 3), value), LATLONG)
        assert found.sources == ()
        assert found.left_out_share == 0
        assert found.luminance_cd_m2.shape == (0, 3)


def test_the_threshold_is_no_lower_than_stated():
    light = with_disc(FISHEYE, np.array([0, 0, 1.0]), 3, 100)
    assert len(find_sources(light, FISHEYE).sources) == 1
    assert not find_sources(light, FISHEYE, at_least_cd_m2=200).sources
    assert len(find_sources(light, FISHEYE, threshold_cd_m2=50, at_least_cd_m2=20).sources) == 1


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0])
def test_what_is_no_light_is_refused(bad):
    light = np.ones((180, 360, 3))
    light[3, 4, 1] = bad
    with pytest.raises(InputError, match="finite"):
        find_sources(light, LATLONG)
