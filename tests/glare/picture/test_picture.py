"""Glare of whole pictures: energy, engines, what is no light, the report."""

import json

import numpy as np
import pytest

import andon
from andon.errors import InputError
from andon.glare.picture import glare_of_picture
from andon.observer.spread.model import Eye
from andon.quantities import photometric
from andon.spaces import View, pinhole_view

SPHERE = View("latlong", 128, 64)
ROAD = pinhole_view(160, 90, 160.0)
# The keys that the specification of the report names.
SPECIFIED = {
    "photometry", "view", "observer", "model", "sources", "veil_cd_m2", "ti_percent", "ugr", "dgp",
    "validity",
}  # fmt: skip


def night(view, lamps=((0.4, 0.3, 4e4), (0.7, 0.5, 9e3))):
    """A dim room with lamps of one pixel at places of the picture."""
    light = np.full((*view.shape, 3), 0.5) * [1.0, 0.8, 0.6]
    for x, y, luminance in lamps:
        light[int(y * view.height), int(x * view.width)] = luminance
    return light


def flux(light, view):
    return (light * view.solid_angles()[..., None]).sum(axis=(0, 1))


@pytest.fixture(scope="module")
def seen():
    return glare_of_picture(night(SPHERE), SPHERE, Eye(70), engine="reference")


def test_all_light_of_a_sphere_is_still_there(seen):
    assert flux(seen.picture, SPHERE) == pytest.approx(flux(night(SPHERE), SPHERE), rel=5e-3)


def test_picture_is_what_stays_and_the_glare():
    plain = glare_of_picture(night(ROAD), ROAD, engine="reference", with_stars=False)
    expected = (1 - plain.share) * night(ROAD) + plain.glare
    assert plain.picture == pytest.approx(expected, rel=1e-3, abs=1e-9)
    assert (plain.veil == plain.glare).all()
    assert plain.stars == (0, 0)


def test_halo_and_needles_are_taken_from_their_sources():
    eye = Eye(30, adaptation="scotopic")
    plain = glare_of_picture(night(ROAD), ROAD, eye, engine="reference", with_stars=False)
    full = glare_of_picture(night(ROAD), ROAD, eye, engine="reference")
    assert full.stars == (2, 2)
    added = flux(full.glare - plain.glare, ROAD)
    assert (added > 0.01 * flux(night(ROAD), ROAD)).all()
    # Rings and needles that end in the picture give back what was taken.
    assert flux(full.picture, ROAD) == pytest.approx(flux(plain.picture, ROAD), rel=0.02)
    far = ROAD.directions() @ full.found.sources[0].direction < np.cos(np.radians(25))
    far &= ROAD.directions() @ full.found.sources[1].direction < np.cos(np.radians(25))
    assert full.picture[far] == pytest.approx(plain.picture[far], rel=1e-6)


def test_the_veil_at_the_gaze_is_that_of_the_map():
    for row, column in ((45, 80), (27, 70), (60, 120)):
        gaze = ROAD.directions()[row, column]
        one = glare_of_picture(night(ROAD), ROAD, Eye(50), gaze=gaze, engine="reference")
        mapped = photometric(one.veil[row, column])
        assert one.numbers.veil_cd_m2 == pytest.approx(mapped, rel=0.03)


def test_both_renderers_agree_beside_the_sources():
    lamps = night(ROAD) - night(ROAD, ())
    whole = glare_of_picture(lamps, ROAD, engine="reference", with_stars=False)
    each = glare_of_picture(
        lamps, ROAD, renderer="per-source", engine="reference", with_stars=False
    )
    assert each.renderer == "per-source"
    away = np.ones(ROAD.shape, bool)
    for source in whole.found.sources:
        away &= ROAD.directions() @ source.direction < np.cos(np.radians(2.5))
    error = each.glare[away] / whole.glare[away] - 1
    assert np.sqrt(np.mean(error**2)) < 0.03


@pytest.mark.parametrize("renderer", ["whole-picture", "per-source"])
def test_both_engines_agree(gpu, renderer):
    assert gpu is not None
    results = [
        glare_of_picture(night(ROAD), ROAD, renderer=renderer, engine=engine)
        for engine in ("gpu", "reference")
    ]
    assert [result.engine for result in results] == ["gpu", "reference"]
    first, second = (result.picture for result in results)
    assert first == pytest.approx(second, rel=0.01)


def test_older_eyes_have_more_veil():
    veils = [
        glare_of_picture(night(ROAD), ROAD, Eye(age), engine="reference").numbers.veil_cd_m2
        for age in (20, 45, 70)
    ]
    # CIE 135: 70 to 25 years is 1.3 at 1° and 2.1 at 10°.
    assert veils[0] < veils[1] < veils[2]
    assert 1.3 < veils[2] / veils[0] < 2.2


def test_what_is_no_light_counts_as_dark():
    clean, dirty = night(ROAD), night(ROAD)
    for place, bad in (((1, 1), np.nan), ((2, 2), np.inf), ((3, 3), -5.0), ((4, 4), -np.inf)):
        dirty[(*place, 1)] = bad
        clean[(*place, 1)] = 0
    first, second = (glare_of_picture(light, ROAD, engine="reference") for light in (dirty, clean))
    assert np.isfinite(first.picture).all()
    assert (first.picture == second.picture).all()
    told = first.report()["pixels"]
    assert (told["nan"], told["infinite"], told["negative"]) == (1, 2, 2)
    assert sum("count as 0" in line for line in first.report()["warnings"]) == 3


def test_nothing_is_drawn_outside_the_circle():
    view = View("fisheye", 64, 64, 64 / np.pi, 64 / np.pi, 31.5, 31.5)
    x, y = np.moveaxis(view.pixel_grid() - 31.5, -1, 0)
    shows = np.hypot(x, y) <= 32
    light = np.ones((64, 64, 3))
    light[~shows] = 1e6
    result = glare_of_picture(light, view, shows=shows, engine="reference")
    assert (result.picture[~shows] == 0).all()
    assert result.picture[shows].max() < 1.5
    assert result.report()["pixels"]["outside"] == np.count_nonzero(~shows)


@pytest.mark.parametrize("shape", [(90, 160), (90, 160, 4), (160, 90, 3), (0, 160, 3)])
def test_pictures_of_other_shapes_are_refused(shape):
    with pytest.raises(InputError):
        glare_of_picture(np.ones(shape), ROAD)


def test_too_many_pixels_are_refused_with_the_limit():
    huge = View("latlong", 16384, 8192)
    light = np.broadcast_to(np.float32(1), (8192, 16384, 3))
    with pytest.raises(InputError, match="33554432"):
        glare_of_picture(light, huge)


def test_unknown_names_and_a_gaze_that_is_none():
    with pytest.raises(InputError, match="cie135"):
        glare_of_picture(night(ROAD), ROAD, model="nobody")
    with pytest.raises(InputError, match="gaze"):
        glare_of_picture(night(ROAD), ROAD, gaze=np.zeros(3))
    with pytest.raises(InputError, match=r"renderer: must be one of .*per-source"):
        glare_of_picture(night(ROAD), ROAD, renderer="fast")
    with pytest.raises(InputError, match=r"engine: must be one of .*reference"):
        glare_of_picture(night(ROAD), ROAD, engine="cuda")


def test_a_black_picture_stays_black():
    result = glare_of_picture(np.zeros((90, 160, 3)), ROAD, engine="reference")
    assert (result.picture == 0).all()
    assert json.dumps(result.report())


def test_the_report_says_it_all(seen):
    told = json.loads(json.dumps(seen.report(map_file="veil.exr", warnings=("mind the step",))))
    assert told.keys() >= SPECIFIED
    assert told["veil_cd_m2"]["map_file"] == "veil.exr"
    assert told["veil_cd_m2"]["gaze"] == pytest.approx(seen.numbers.veil_cd_m2, rel=1e-5)
    assert told["warnings"][0] == "mind the step"
    assert told["observer"]["age_years"] == 70
    first, second = told["sources"]
    keys = {"direction", "solid_angle_sr", "luminance_cd_m2", "illuminance_lux"}
    assert first.keys() >= keys
    assert first["illuminance_lux"] > second["illuminance_lux"]
    product = first["solid_angle_sr"] * first["luminance_cd_m2"]
    assert first["illuminance_lux"] == pytest.approx(product, rel=1e-4)
    assert np.linalg.norm(first["direction"]) == pytest.approx(1, abs=1e-5)
    for name in ("veil_cd_m2", "ti_percent", "ugr", "dgp"):
        assert told["validity"][name].keys() == {"unit", "range", "holds", "why"}


def test_a_relative_picture_says_so():
    result = glare_of_picture(night(ROAD), ROAD, photometry="relative", engine="reference")
    told = result.report()
    assert told["photometry"] == "relative"
    assert not any(value["holds"] for value in told["validity"].values())
    assert "relative" in told["validity"]["ugr"]["why"]


def test_clipped_sources_are_reported():
    clipped = night(ROAD).max(axis=-1) > 1e4
    result = glare_of_picture(night(ROAD), ROAD, clipped=clipped, engine="reference")
    assert [source["clipped"] for source in result.report()["sources"]] == [True, False]
    assert any("1 of 2 sources are clipped" in line for line in result.report()["warnings"])


def test_it_is_public():
    assert andon.glare_of_picture is glare_of_picture


@pytest.mark.parametrize("hfov_degrees", [20.0, 60.0])
def test_both_renderers_keep_as_much_light(hfov_degrees):
    """With pixels finer than 0.1°, whose core is veil, and with coarser ones."""
    focal = 160 / np.tan(np.radians(hfov_degrees / 2))
    view = pinhole_view(320, 240, float(focal))
    theta = np.degrees(np.arccos(np.clip(view.directions()[..., 2], -1, 1)))
    light = np.where(theta < 0.5, 1e4, 0.0)[..., None] * np.ones(3)
    solid = view.solid_angles()[..., None]
    kept = [
        float((seen.picture * solid).sum() / (light * solid).sum())
        for seen in (
            glare_of_picture(light, view, with_stars=False, engine="reference", renderer=renderer)
            for renderer in ("whole-picture", "per-source")
        )
    ]
    assert kept[0] < 1
    assert kept[1] == pytest.approx(kept[0], abs=0.005)
