"""What picture files say of their angles and their light."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.pictures import read_picture, write_exr, write_hdr
from andon.files.pictures.model import Picture
from andon.files.pictures.radiance_view import from_hemispherical, line_of_view, radiance_view
from andon.glare.calibration import calibrated, projected
from andon.spaces import View, pinhole_view


def picture(width=64, height=48, **facts):
    return Picture(np.ones((height, width, 3), np.float32), "linear", **facts)


def corner(view):
    """Direction through the middle of the right edge, degrees from straight ahead."""
    edge = view.directions_at(np.array([view.width - 0.5, view.cy]))
    return float(np.degrees(np.arctan2(edge[0], edge[2])))


@pytest.mark.parametrize(
    ("line", "projection", "half_degrees"),
    [
        ("-vtv -vp 1 2 3 -vd 0 1 0 -vu 0 0 1 -vh 60 -vv 45", "pinhole", 30),
        ("-vh 80 -vv 60", "pinhole", 40),
        ("-vta -vh 180 -vv 180", "fisheye", 90),
        ("rvu -vtv -vh 60 -vv 45 -vta -vh 200 -vv 200", "fisheye", 100),
        ("", "pinhole", 22.5),
    ],
)
def test_view_lines(line, projection, half_degrees):
    view = radiance_view(line, 64, 48).view
    assert view.projection == projection
    assert corner(view) == pytest.approx(half_degrees)


def test_a_shifted_view_looks_past_its_middle():
    # rpict's manual: -vs moves the picture by its width to the right: the axis is left of it.
    view = radiance_view("-vtv -vh 90 -vv 90 -vs 0.5 -vl 0.25", 100, 100).view
    assert view.directions_at(np.array([-0.5, 74.5])) == pytest.approx([0, 0, 1])
    assert view.directions_at(np.array([99.5, 74.5])) == pytest.approx(
        np.array([2, 0, 1]) / np.sqrt(5)
    )


def test_hemispherical_views_are_resampled():
    read = radiance_view("-vth -vh 180 -vv 180", 200, 200)
    assert read.hemispherical
    assert read.view.projection == "fisheye"
    # -vth: r = sin θ. Light at 30° stands at half the radius, as equidistant at a third.
    stored = np.zeros((200, 200, 3), np.float32)
    stored[98:102, 148:152] = 1
    seen = from_hemispherical(stored, read.view)
    x = np.average(np.arange(200), weights=seen[..., 0].sum(axis=0))
    assert x == pytest.approx(99.5 + 100 / 3, abs=0.3)
    assert seen.shape == (200, 200, 3)
    assert (seen[0, 0] == 0).all()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("-vtl -vh 10 -vv 10", "no angular scale"),
        ("-vtc -vh 360 -vv 90", "pinterp"),
        ("-vts -vh 90 -vv 90", "pinterp"),
        ("-vtx -vh 90 -vv 90", "type v, a or h"),
        ("-vtv -vh 180 -vv 60", "-vh"),
        ("-vtv -vh 60 -vv -3", "-vv"),
        ("-vtv -vh nan -vv 60", "must be a number"),
        ("-vtv -vv 60 -vh", "must be a number"),
    ],
)
def test_views_without_angles_are_refused(line, said):
    with pytest.raises(InputError, match=said):
        radiance_view(line, 64, 48)


@pytest.mark.parametrize(
    "view",
    [
        pinhole_view(64, 48, 40.0),
        View("pinhole", 64, 48, 50, 45, 20, 30),
        View("fisheye", 64, 64, 20, 20, 31.5, 31.5),
    ],
    ids=["pinhole", "shifted", "fisheye"],
)
def test_a_written_view_is_read_back(tmp_path, view):
    path = tmp_path / "seen.hdr"
    light = np.linspace(0.1, 9, view.height * view.width * 3).reshape(*view.shape, 3)
    write_hdr(path, light.astype(np.float32), view_line=line_of_view(view))
    read = read_picture(path)
    assert read.values == pytest.approx(light, rel=0.01)
    again = radiance_view(read.view_line, *view.shape[::-1]).view
    for key in ("fx", "fy", "cx", "cy"):
        assert getattr(again, key) == pytest.approx(getattr(view, key))


def test_angles_come_from_the_first_that_states_them():
    stated = pinhole_view(64, 48, 100.0)
    everything = picture(view_line="-vta -vh 120 -vv 90", hfov_degrees=40.0)
    assert calibrated(everything, view=stated).view is not None
    assert calibrated(everything, view=stated).view.fx == 100
    assert calibrated(everything).view.projection == "fisheye"
    exif = calibrated(picture(hfov_degrees=40.0))
    assert corner(exif.view) == pytest.approx(20)
    assert calibrated(picture(128, 64)).view.projection == "latlong"
    marked = picture(attributes={"envmap": "latlong"}, hfov_degrees=40.0)
    assert calibrated(marked).view.projection == "latlong"
    nothing = calibrated(picture())
    assert corner(nothing.view) == pytest.approx(30)
    assert any("60°" in line for line in nothing.warnings)
    assert not any("60°" in line for line in exif.warnings)


def test_light_comes_from_the_first_that_states_it():
    radiance = picture(view_line="-vtv -vh 60 -vv 45")
    white = picture(attributes={"whiteLuminance": 621.0})
    ours = picture(attributes={"andon:unit": "cd/m2", "whiteLuminance": 5.0})
    relative = picture(attributes={"andon:unit": "cd/m2", "andon:photometry": "relative"})
    for given, scale, photometry in (
        (radiance, 179, "absolute"),
        (white, 621, "absolute"),
        (ours, 1, "absolute"),
        (relative, 1, "relative"),
        (picture(), 1, "relative"),
        (picture(attributes={"whiteLuminance": 0.0}), 1, "relative"),
    ):
        found = calibrated(given)
        assert (found.cd_m2_per_unit, found.photometry) == (scale, photometry)
        assert found.luminance_cd_m2.max() == pytest.approx(scale)
        assert any("relative" in line for line in found.warnings) == (photometry == "relative")
    assert calibrated(white, cd_m2_per_unit=3.0).cd_m2_per_unit == 3
    for bad in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="> 0"):
            calibrated(white, cd_m2_per_unit=bad)


def test_white_of_8_bits_is_clipped():
    codes = np.full((48, 64, 3), 100, np.uint8)
    codes[3, 4, 1] = 255
    found = calibrated(Picture(codes, "srgb"), cd_m2_per_unit=200.0)
    assert found.clipped is not None
    assert np.argwhere(found.clipped).tolist() == [[3, 4]]
    assert found.luminance_cd_m2[3, 4, 1] == pytest.approx(200)
    assert any("1 pixels are at the white" in line for line in found.warnings)


def test_only_wide_fish_eyes_are_circles():
    wide = calibrated(picture(100, 100), view=projected("fisheye", 182.0, 100, 100))
    assert wide.shows is not None
    assert wide.shows.mean() == pytest.approx(np.pi / 4, abs=0.01)
    assert not wide.shows[0, 0]
    narrow = calibrated(picture(100, 100), view=projected("fisheye", 120.0, 100, 100))
    assert narrow.shows is None


def test_a_lens_is_taken_out():
    bent = View("pinhole", 64, 48, 50, 50, 31.5, 23.5, (-0.2, 0.0, 0.0, 0.0))
    found = calibrated(picture(), view=bent)
    assert found.view.distortion == ()
    assert found.luminance_cd_m2[24, 32] == pytest.approx(1)


def test_stated_projections():
    assert projected(None, None, 64, 48) is None
    assert projected("pinhole", None, 64, 48) is None
    assert corner(projected("fisheye", None, 64, 64)) == pytest.approx(90)
    assert corner(projected(None, 50.0, 64, 64)) == pytest.approx(25)
    assert projected("latlong", None, 64, 32).projection == "latlong"
    for wrong in (("pinhole", 180.0), ("fisheye", 361.0), ("latlong", 90.0), (None, np.nan)):
        with pytest.raises(InputError):
            projected(*wrong, 64, 48)


def test_headers_of_real_files(data_dir):
    tree = calibrated(read_picture(data_dir / "openexr_photos" / "Tree.exr"))
    assert (tree.cd_m2_per_unit, tree.photometry) == (621, "absolute")
    kerner = calibrated(read_picture(data_dir / "openexr_photos" / "KernerEnvLatLong.exr"))
    assert kerner.angles_from == "envmap of the header"
    sunset = calibrated(read_picture(data_dir / "radiance_tests" / "px" / "ref" / "test.hdr"))
    assert sunset.view.projection == "fisheye"
    bottles = calibrated(read_picture(data_dir / "brackets_piccante" / "bottles.hdr"))
    assert bottles.photometry == "relative"


def test_additive_light_has_alpha_0(tmp_path):
    path = tmp_path / "glare.exr"
    light = np.full((4, 5, 3), 0.25, np.float32)
    write_exr(path, light, unit="cd/m2", alpha=np.zeros((4, 5)))
    read = read_picture(path)
    assert (read.values == light).all()
    assert read.alpha is not None
    assert (read.alpha == 0).all()
