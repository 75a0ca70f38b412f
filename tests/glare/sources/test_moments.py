"""Blobs as ellipses: closed forms of uniform shapes, and sums that may be taken in parts."""

import numpy as np
import pytest

from andon.glare.sources.moments import Moments, pixel_moments, sources_of
from andon.spaces import pinhole_view

VIEW = pinhole_view(320, 240, 400.0)


def ellipse_picture(centre, a, b, turn):
    """Luminance 100 cd/m² within an ellipse of the tangent plane at `centre` (unit)."""
    directions = VIEW.directions()
    right = np.cross([0.0, 1, 0], centre)
    right /= np.linalg.norm(right)
    down = np.cross(centre, right)
    x, y = directions @ right, directions @ down
    u = np.cos(turn) * x + np.sin(turn) * y
    v = np.cos(turn) * y - np.sin(turn) * x
    return 100.0 * ((u / a) ** 2 + (v / b) ** 2 <= 1), right, down


def moments_of(picture, labels=None):
    flat = np.repeat(picture.reshape(-1, 1), 3, axis=1)
    labels = np.where(flat[:, 0] > 0, 0, -1) if labels is None else labels
    count = int(labels.max()) + 1
    omega = VIEW.solid_angles().ravel()
    return pixel_moments(VIEW.directions().reshape(-1, 3), flat, omega, labels, count)


@pytest.mark.parametrize("turn", [0.0, 0.5, 1.3])
def test_an_ellipse_is_found_again(turn):
    centre = np.array([0.1, -0.05, 1.0])
    centre /= np.linalg.norm(centre)
    picture, right, down = ellipse_picture(centre, 0.12, 0.04, turn)
    (source,) = sources_of(moments_of(picture))
    assert np.linalg.norm(source.direction - centre) < 1e-3
    major = np.cos(turn) * right + np.sin(turn) * down
    assert abs(source.axes[0] @ major) > 0.9995
    radii = source.outline.radii_radians
    assert radii.max() == pytest.approx(np.arcsin(0.12), rel=0.01)
    assert radii.min() == pytest.approx(np.arcsin(0.04), rel=0.01)
    assert source.luminance_cd_m2 == pytest.approx([100.0] * 3, rel=0.02)


def test_one_pixel_has_its_own_size():
    picture = np.zeros(VIEW.shape)
    picture[120, 160] = 5e4
    (source,) = sources_of(moments_of(picture))
    omega = VIEW.solid_angles()[120, 160]
    # A square's ellipse of the same moments is 4.7 % larger than the square.
    assert source.outline.solid_angle_sr == pytest.approx(omega, rel=0.05)
    assert source.illuminance_lux == pytest.approx([5e4 * omega] * 3)


def test_sums_may_be_taken_in_parts():
    picture, *_ = ellipse_picture(np.array([0.0, 0, 1]), 0.1, 0.05, 0.3)
    rows, columns = np.mgrid[0 : VIEW.height, 0 : VIEW.width]
    parts = np.where(picture > 0, rows // 16 * 20 + columns // 16, -1).ravel()
    whole, tiles = moments_of(picture), moments_of(picture, parts)
    together = tiles.merged(np.zeros(len(tiles), int), 1)
    for name in ("illuminance_lux", "first", "second", "peak_cd_m2"):
        assert getattr(together, name) == pytest.approx(getattr(whole, name), rel=1e-12)


def test_blobs_come_brightest_first_and_dark_ones_not():
    zero = np.zeros(3)
    light = np.array([[1.0, 1, 1], zero, [5.0, 5, 5]])
    d = np.array([0.0, 0, 1])
    moments = Moments(light, light[:, :1] * d, light[:, :1, None] * np.outer(d, d), light[:, 0])
    found = sources_of(moments, name="blob")
    assert [float(source.illuminance_lux[0]) for source in found] == [5.0, 1.0]
    assert found[0].name == "blob"
