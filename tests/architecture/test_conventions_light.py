"""Conventions of light: each test fails if its convention is turned round."""

import re
from dataclasses import replace

import numpy as np
import pytest

import andon
from andon.composite.model import Ambient
from andon.composite.reference import lamp_luminance, object_luminance, relit_linear
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.pictures import read_picture, write_picture
from andon.lamps import DirectionalLamp, HemisphereLamp, PointLamp, SkyLamp, SpotLamp
from andon.lamps.distributions import spot_attenuation
from andon.quantities import CameraFrame, photometric
from andon.responses import SRGB
from andon.transport.direct.reference import illuminance

from .settings import ORIGIN, VIEW, WHITE, X, Y, Z, close, grey, lamps_of, relit


def lux_of(lamp, position=ORIGIN, normal=Y):
    return illuminance(lamp, position, normal)


def test_weights():
    close([photometric(channel) for channel in np.eye(3)], [0.2126, 0.7152, 0.0722])


def test_neutral_light():
    (lamp,) = lamps_of({"kind": "point", "position": [0, 0, 0], "intensity_cd": 5})
    close(lamp.intensity_cd, [5, 5, 5])


@pytest.mark.parametrize(
    "colour", [{"temperature_k": 2700}, {"rgb": [1, 0, 0]}, {"chromaticity_xy": [0.2, 0.3]}]
)
def test_lamp_colour(colour):
    (lamp,) = lamps_of({"kind": "point", "position": [0, 0, 0], "intensity_cd": 5} | colour)
    close(photometric(lamp.intensity_cd), 5)
    assert np.ptp(lamp.intensity_cd) > 1


def test_one_candela():
    lamp = PointLamp("lamp", Y, WHITE)
    close(lux_of(lamp), WHITE)
    close(lux_of(replace(lamp, position_m=2 * Y)), WHITE / 4)
    close(lux_of(lamp, normal=-Y), 0)


def test_diffuse_luminance():
    surface = relit(grey()).surface
    white = replace(surface, reflectance=np.ones((*VIEW.shape, 3)))
    added = np.full((*VIEW.shape, 3), 100 * np.pi)
    dark = Ambient(np.full(3, 50.0), (0, 0, 0))
    close(object_luminance(white, dark, added), 100)


def test_flux():
    place = {"position": [0, 0, 0]}
    (point,) = lamps_of({"kind": "point", "flux_lm": 4 * np.pi} | place)
    close(point.intensity_cd, 1)
    cone = {"kind": "spot", "flux_lm": 100, "direction": [0, -1, 0], "outer_degrees": 40}
    (spot,) = lamps_of(cone | place)
    edges = np.linspace(np.cos(spot.outer_radians), 1, 20001)
    share = spot_attenuation(
        (edges[1:] + edges[:-1]) / 2,
        inner_radians=spot.inner_radians,
        outer_radians=spot.outer_radians,
    )
    close(2 * np.pi * share @ np.diff(edges) * spot.intensity_cd[0], 100, rtol=1e-6)


def test_spot():
    cone = {"inner_radians": np.radians(20), "outer_radians": np.radians(40)}
    lamp = SpotLamp("lamp", Y, WHITE, direction=-Y, **cone)
    close(lux_of(lamp), WHITE)  # on the axis: the intensity itself
    shares = spot_attenuation(np.cos(np.radians([19.9, 30, 40.1])), **cone)
    middle = (np.cos(np.radians(30)) - np.cos(cone["outer_radians"])) / np.ptp(
        np.cos(list(cone.values()))
    )
    close(shares, [1, middle**2, 0])


def test_directional():
    lamp = DirectionalLamp("sun", -Y, 1000 * WHITE)
    close(lux_of(lamp), 1000)  # light that travels down falls on what faces up
    close(lux_of(lamp, normal=-Y), 0)


def test_sky():
    sky = SkyLamp("sky", Y, 100 * WHITE)
    close([lux_of(sky, normal=n)[0] for n in (Y, X, -Y)], [100, 50, 0])
    dome = HemisphereLamp("dome", Y, 100 * WHITE, 40 * WHITE)
    close([lux_of(dome, normal=n)[0] for n in (Y, X, -Y)], [100, 70, 40])


def test_visible_lamps():
    lamp = PointLamp("lamp", -Z, 3 * WHITE, visible_radius_m=0.2)
    close(lamp_luminance(lamp, ORIGIN), 3 / (np.pi * 0.04))
    hidden, shown = (
        relit(grey(0), [replace(lamp, visible_radius_m=radius)]) for radius in (0.0, 0.2)
    )
    close(hidden.illuminance.lux, shown.illuminance.lux)
    assert hidden.luminance.cd_m2[1, 2].max() == 0
    close(shown.luminance.cd_m2[1, 2], 3 / (np.pi * 0.04))
    behind = replace(lamp, position_m=-3 * Z)
    assert relit(grey(0), [behind]).luminance.cd_m2.max() == 0


@pytest.mark.parametrize("word", ["absolute", "relative"])
def test_photometry(word):
    frame = relit(grey(), photometry=word)
    words = {frame.illuminance.photometry, frame.luminance.photometry, frame.report.photometry}
    assert words == {word}


def test_ambient_is_stated(tmp_path):
    write_picture(tmp_path / "a.png", grey())
    np.save(tmp_path / "d.npy", np.full(VIEW.shape, 2.0))
    tables = {
        "rig": {"camera": {"fx": 4.0}},
        "capture": {"source": "a.png"},
        "surface": {"depth": "d.npy"},
    }
    with pytest.raises(InputError, match="E0") as refused:
        prepare(andon.scene_from_dict(tables, folder=tmp_path))
    assert refused.value.field == "ambient"


def test_luminance_per_unit():
    frame = relit(grey(255), ambient_lux=100 * np.pi)
    close(frame.captured.luminance_per_unit, 100)
    close(frame.luminance.cd_m2, 100, rtol=1e-6)


def test_identity():
    photo = np.random.default_rng(0).integers(0, 256, (*VIEW.shape, 3), dtype=np.uint8)
    np.testing.assert_array_equal(relit(photo).image.rgb, photo)


def test_doubling():
    """As much light again as there was: twice the linear value."""
    lamp = HemisphereLamp("dome", Y, 100 * WHITE, 100 * WHITE)
    frame = relit(grey(), [lamp], ambient_lux=100)
    twice = SRGB.encode(2 * SRGB.decode(grey() / 255))
    close(frame.image.rgb, np.round(twice * 255), atol=0.5)


def test_light_in_holes():
    depth = np.full(VIEW.shape, 2.0)
    depth[0, 0] = np.nan
    lamp = HemisphereLamp("dome", Y, 100 * WHITE, 100 * WHITE)
    frame = relit(grey(), [lamp], depth=depth)
    assert frame.illuminance.lux[0, 0].max() == 0
    assert (frame.image.rgb[0, 0] == 128).all()
    assert (frame.image.rgb[1, 1] > 128).all()
    dimmed = relit(grey(), [lamp], depth=depth, dimming=0.5)
    close(dimmed.luminance.cd_m2[0, 0], frame.luminance.cd_m2[0, 0] / 2, rtol=1e-6)


def test_dimming_is_linear():
    linear = SRGB.decode(grey() / 255).astype(np.float32)
    frame = CameraFrame(linear, VIEW)
    none = np.zeros(linear.shape)
    ambient = Ambient(np.full(3, 100.0), (0.5, 0.25, 1.0))
    close(relit_linear(frame, ambient, none), linear * [0.5, 0.25, 1.0], rtol=1e-6)
    # It dims E0 and not ΔE.
    close(relit_linear(frame, ambient, none + 100), linear * [1.5, 1.25, 2.0], rtol=1e-6)
    paper = relit_linear(frame, replace(ambient, dimming_mode="paper"), none)
    close(SRGB.encode(paper), grey() / 255 * [0.5, 0.25, 1.0], rtol=1e-5)


def test_radiance():
    """1 cd is 1/179 W/sr in each channel of Radiance."""
    from andon.verify.truths.sources import POINT_RADIUS_M, PointSource, source_text

    text = source_text(PointSource(ORIGIN, np.array([1.0, 2, 3])), "lamp", "")
    radiance = [float(word) for word in re.search(r"0 0 3 (\S+) (\S+) (\S+)", text).groups()]
    close(radiance, np.array([1, 2, 3]) / (np.pi * POINT_RADIUS_M**2) / 179, rtol=1e-6)


def test_alpha(tmp_path):
    import OpenEXR

    plane = np.full((2, 2), 0.25, np.float32)
    channels = {"R": plane, "G": plane, "B": plane, "A": 2 * plane}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, channels).write(str(tmp_path / "a.exr"))
    close(read_picture(tmp_path / "a.exr").values, 0.25)
