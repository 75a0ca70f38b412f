"""Conventions of what is measured: each test fails if its own is turned round."""

import json

import numpy as np

from andon.files.harmonics import read_harmonics
from andon.files.responses import read_surface_response
from andon.harmonics import irradiance
from andon.lamps.shells.drum import drum_mesh
from andon.lamps.shells.model import Drum
from andon.responses import SRGB

from .settings import X, Y, close, grey, relit


def test_surface_curves(tmp_path):
    """Lux to *linear* camera values, through which the captured light goes back and forth."""
    file = tmp_path / "wall.csv"
    file.write_text("illuminance_lux,linear_r,linear_g,linear_b\n0,0.1,0.1,0.1\n200,0.5,0.5,0.5\n")
    curve = read_surface_response(file)
    close(curve.linear_of(np.full(3, 100.0)), 0.3)
    photo = grey(round(255 * SRGB.encode(0.3)))
    np.testing.assert_array_equal(relit(photo, curves=curve).image.rgb, photo)
    dimmed = relit(photo, curves=curve, dimming=0.5)
    # f(100 lx · ½), and not 0.3 · ½: what the camera adds by itself stays.
    close(SRGB.decode(dimmed.image.rgb / 255), 0.2, atol=0.005)


def test_drum():
    """About the upright through the lamp; the lower rim is `drop_m` below it."""
    mesh = drum_mesh(Drum(0.2, 0.1, 0.3, 0.12), 16, 1)
    points = mesh.positions
    low, high = points[:, 1] < 0, points[:, 1] > 0
    close(points[low, 1], -0.12)
    close(points[high, 1], 0.18)
    close(np.hypot(points[low, 0], points[low, 2]), 0.2)
    close(np.hypot(points[high, 0], points[high, 2]), 0.1)


def test_harmonics_of_e0(tmp_path):
    """Luminance in world axes, the order of `spherical_harmonics`; row 1 is light from above."""
    rows = [[0.0] * 3 for _ in range(9)]
    rows[0], rows[1] = [200.0] * 3, [50.0] * 3
    file = tmp_path / "light.json"
    file.write_text(json.dumps({"coefficients_cd_m2": rows}))
    light = read_harmonics(file)
    up, down, side = (irradiance(light, n) for n in (Y, -Y, X))
    assert (up > side).all()
    assert (side > down).all()
    # An even luminance L gives π·L; L00 is L times √(4π).
    close(side, np.pi * 200 / np.sqrt(4 * np.pi))
