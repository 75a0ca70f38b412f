"""The oracle: energy, constants, rotations, and a convolution on the plane."""

import numpy as np
import pytest
from scipy.ndimage import map_coordinates
from scipy.signal import fftconvolve

from andon.errors import InputError
from andon.glare.kernel import Kernel
from andon.glare.whole_picture.exact import convolved
from andon.observer.spread.family import spread_function
from andon.spaces import View, pinhole_view
from comparison import assert_agree

KERNEL = Kernel(spread_function("cie135"))
PANORAMA = View("latlong", 64, 32)


def share(core):
    return KERNEL.share + KERNEL.core_share * core


def grey(values):
    return values[..., None] * np.ones(3)


@pytest.mark.parametrize("core", [False, True])
def test_energy_of_every_pixel_and_a_constant_stay(core):
    """1.2e-3 at the wedges of the poles, 1e-4 elsewhere."""
    bright = convolved(np.ones((32, 64, 3)), PANORAMA, KERNEL, core=core)
    assert_agree(bright[1:-1], np.full((30, 64, 3), share(core)), rtol=2e-4)
    assert_agree(bright, np.full((32, 64, 3), share(core)), rtol=1.5e-3)
    omega = PANORAMA.solid_angles()
    for row in (0, 1, 7, 16):
        point = np.zeros((32, 64, 3))
        point[row, 9] = [1, 2, 3]
        sent = (convolved(point, PANORAMA, KERNEL, core=core) * omega[..., None]).sum(axis=(0, 1))
        assert_agree(sent, share(core) * omega[row, 9] * np.array([1, 2, 3]), rtol=1.5e-3)


@pytest.mark.parametrize("degrees", [12, 40])
def test_what_leaves_a_fisheye_is_lost(degrees):
    """A point in the middle of a picture: the shares of the kernel within its inscribed circle."""
    size = 41
    focal = (size / 2) / np.radians(degrees)
    view = View("fisheye", size, size, focal, focal, (size - 1) / 2, (size - 1) / 2)
    point = np.zeros((size, size, 3))
    point[20, 20] = 1
    veil = (
        convolved(point, view, KERNEL)[..., 0] * view.solid_angles() / view.solid_angles()[20, 20]
    )
    theta = np.linspace(np.radians(0.1), np.radians(degrees), 200_001)
    ring = KERNEL.per_sr(theta, core=True) * np.sin(theta) * 2 * np.pi
    within = ((ring[1:] + ring[:-1]) / 2).sum() * (theta[1] - theta[0])
    angle = np.arccos(np.clip(view.directions()[..., 2], -1, 1))
    assert veil[angle < np.radians(degrees)].sum() == pytest.approx(within, rel=2e-3)


def test_a_blob_has_the_same_veil_wherever_it_is():
    """Turned from the pole to 37° and to the horizon, the veil turns with it."""
    view = View("latlong", 96, 48)
    directions = view.directions()
    veils = {}
    for elevation in (90, 37, 0):
        high = np.radians(elevation)
        axis = np.array([0, -np.sin(high), np.cos(high)])
        angle = np.arccos(np.clip(directions @ axis, -1, 1))
        veils[elevation] = convolved(grey(np.exp(-((angle / 0.45) ** 2))), view, KERNEL)[..., 0]
    for elevation in (37, 0):
        down = np.radians(90 - elevation)
        turned = directions @ np.array(
            [
                [1, 0, 0],
                [0, np.cos(down), -np.sin(down)],
                [0, np.sin(down), np.cos(down)],
            ]
        )
        at = np.moveaxis(view.project(turned), -1, 0)[::-1]
        actual = map_coordinates(veils[elevation], at, order=3, mode="grid-wrap")
        inside = (at[0] > 2) & (at[0] < 45) & (directions[..., 1] < 0.2)
        assert inside.mean() > 0.4
        assert_agree(actual[inside], veils[90][inside], rtol=0.015)


@pytest.mark.parametrize("degrees", [5, 20])
def test_narrow_pictures_are_convolved_as_on_the_plane(degrees):
    """Against SciPy, with a kernel that is averaged over both pixels by brute force."""
    width, height, parts = 28, 20, 40
    focal = (width / 2) / np.tan(np.radians(degrees / 2))
    view = pinhole_view(width, height, focal)
    picture = np.random.default_rng(2).gamma(0.2, 1, (height, width))
    offsets = np.arange(-width, width + 1)
    # Differences of two pixels are spread like a tent.
    fine = (np.arange(-parts, parts) + 0.5) / parts
    tent = (1 - abs(fine)) / parts
    kernel = np.zeros((2 * width + 1, 2 * width + 1))
    for i, row in enumerate(offsets):
        across = np.hypot(row + fine[:, None, None], offsets[:, None] + fine)
        values = KERNEL.per_sr(across / focal, core=True)
        kernel[i] = np.einsum("a,b,acb->c", tent, tent, values) / focal**2
    expected = fftconvolve(picture, kernel)[width:-width, width:-width]
    actual = convolved(grey(picture), view, KERNEL, core=True)[..., 0]
    assert np.sqrt(np.mean((actual / expected - 1) ** 2)) < 0.01
    assert actual.sum() == pytest.approx(expected.sum(), rel=0.01)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -1.0])
def test_light_is_light(wrong):
    with pytest.raises(InputError, match="finite and ≥ 0"):
        convolved(np.full((32, 64, 3), wrong), PANORAMA, KERNEL)


def test_pictures_have_the_views_shape():
    with pytest.raises(InputError, match=r"must be \(32, 64, 3\)"):
        convolved(np.zeros((64, 32, 3)), PANORAMA, KERNEL)
