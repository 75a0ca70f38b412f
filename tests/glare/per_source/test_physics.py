"""The veil of known sources against the model itself, and brute-force convolutions of shapes."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare import shapes
from andon.glare.model import Source
from andon.glare.per_source.convolution import disc_veil, outline_veil
from andon.glare.per_source.coordinates import chord
from andon.glare.per_source.model import PerSource
from andon.glare.per_source.reference import has_core, veil_of_sources
from andon.glare.per_source.tables import table_of
from andon.glare.pixels import pixel_radians
from andon.observer.spread.family import spread_function
from andon.observer.spread.paper import outline_bloom
from andon.spaces import View

from .views import KERNEL, PLACES, VIEWS, angles, pinhole, pixel_means, unit

DEGREE = np.pi / 180
POINT = shapes.circle(0.002 * DEGREE)
LUX = np.array([1.0, 2.0, 4.0])
OUTLINES = [
    shapes.circle(2 * DEGREE),
    shapes.ellipse(3 * DEGREE, 1 * DEGREE),
    shapes.cylinder(5 * DEGREE, 0.2 * DEGREE),
    shapes.hemisphere(2 * DEGREE),
    shapes.pear(2 * DEGREE, 0.6 * DEGREE, 3 * DEGREE),
]


def at(theta, phi):
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def brute_force(outline, point, core=True, count=700):
    """Mean of K over the shape, rasterised in equal steps of θ/θ0 and φ."""
    phi = (np.arange(count) + 0.5) / count * 2 * np.pi
    edge = outline.radius(phi)
    theta = (np.arange(count)[:, None] + 0.5) / count * edge
    weight = np.sin(theta) * edge
    value = KERNEL.per_sr(angles(at(theta, phi), point), core=core)
    return float(np.sum(value * weight) / np.sum(weight))


@pytest.mark.parametrize(("name", "towards"), PLACES)
def test_a_point_has_the_models_profile_and_is_round(name, towards):
    view = VIEWS[name]
    veil = veil_of_sources([Source(towards, LUX, POINT)], view, KERNEL)
    np.testing.assert_allclose(veil[..., 2], 4 * veil[..., 0])
    theta, looked_at = angles(view.directions(), towards), 0
    for degrees in (0.3, 1, 3, 10, 30):
        band = np.abs(theta - degrees * DEGREE) < max(0.02 * degrees * DEGREE, 2e-3)
        band &= theta > 6 * pixel_radians(view)
        if band.sum() < 6:
            continue
        expected = pixel_means(view, view.pixel_grid()[band], towards, has_core(view, KERNEL))
        ratio = veil[band][:, 0] / expected
        assert abs(np.mean(ratio) - 1) < 2e-3
        assert np.ptp(ratio) / 2 < 2e-3
        looked_at += 1
    assert looked_at >= 2


def test_a_tenth_of_a_degree_where_pixels_are_fine():
    view = pinhole(2)
    towards = unit(0.001, 0.002, 1)
    veil = veil_of_sources([Source(towards, np.ones(3), POINT)], view, KERNEL)[..., 0]
    theta = angles(view.directions(), towards)
    band = np.abs(theta - 0.1 * DEGREE) < 0.003 * DEGREE
    expected = pixel_means(view, view.pixel_grid()[band], towards, core=True)
    assert abs(np.mean(veil[band] / expected) - 1) < 0.01


@pytest.mark.parametrize(
    ("towards", "share"),
    [
        (unit(0.01, 0.1, 1), 5e-3),
        (unit(0.01, 0.1, -1), 5e-3),
        # Means are over a pixel's square, not over its wedge at the pole.
        (unit(0.02, -1, 0.05), 2e-2),
    ],
)
def test_energy_of_a_point_is_k(towards, share):
    view = View("latlong", 360, 180)
    veil = veil_of_sources([Source(towards, np.ones(3), POINT)], view, KERNEL)
    energy = np.einsum("ijc,ij->c", veil, view.solid_angles())
    np.testing.assert_allclose(energy, KERNEL.share, rtol=share)


@pytest.mark.parametrize("core", [True, False])
@pytest.mark.parametrize("outline", OUTLINES, ids=lambda o: o.name)
def test_convolutions_of_shapes(outline, core):
    phi = np.array([0.1, 0.9, 1.7, 3.5])
    theta = (
        outline.radius(phi) * np.array([0.4, 1.2, 2.0, 1.05]) + np.array([0, 0.1, 1, 0]) * DEGREE
    )
    points = at(theta, phi)
    expected = [brute_force(outline, point, core) for point in points]
    np.testing.assert_allclose(
        outline_veil(KERNEL, outline, points, core=core), expected, rtol=6e-3
    )
    if outline.name == "circle":
        radius = float(outline.radii_radians[0])
        np.testing.assert_allclose(disc_veil(KERNEL, radius, theta, core=core), expected, rtol=6e-3)


@pytest.mark.parametrize("outline", OUTLINES, ids=lambda o: o.name)
def test_tables_of_shapes(outline):
    generator = np.random.default_rng(3)
    phi = generator.uniform(0, 2 * np.pi, 300)
    beyond = 10 ** generator.uniform(-2, 1.7, 300) * DEGREE
    theta = np.where(
        np.arange(300) % 4 == 0, 0.7 * outline.radius(phi), outline.radius(phi) + beyond
    )
    table = table_of(KERNEL, outline, core=True)
    turned = phi - table.frame.axis_radians
    actual = table.at(chord(theta) * np.cos(turned), chord(theta) * np.sin(turned))
    expected = outline_veil(KERNEL, outline, at(theta, phi), core=True)
    np.testing.assert_allclose(actual, expected, rtol=0.02)
    assert np.sqrt(np.mean((actual / expected - 1) ** 2)) < 4e-3


def test_far_away_a_shape_is_a_point():
    outline = shapes.ellipse(0.6 * DEGREE, 0.2 * DEGREE)
    theta = 20 * DEGREE
    table = table_of(KERNEL, outline, core=True)
    actual = table.at(chord(theta) * np.ones(1), np.zeros(1))
    np.testing.assert_allclose(actual, KERNEL.per_sr(theta), rtol=3e-3)


def test_the_papers_form():
    view, towards = pinhole(20), unit(0, 0, 1)
    source = Source(towards, np.ones(3), shapes.circle(1 * DEGREE))
    veil = veil_of_sources([source], view, KERNEL, settings=PerSource(outline_bloom))[..., 0]
    theta = np.degrees(angles(view.directions(), towards))
    inside = theta < 0.8
    np.testing.assert_allclose(veil[inside], outline_bloom(0.0), rtol=1e-6)
    band = np.abs(theta - 3) < 0.1
    np.testing.assert_allclose(veil[band], outline_bloom(theta[band] - 1), rtol=3e-3)


@pytest.mark.parametrize(
    "outline", [POINT, OUTLINES[0], OUTLINES[1]], ids=["point", "disc", "ellipse"]
)
def test_halo_has_the_energy_of_a_points_ring(outline):
    view, spread = pinhole(40, 480, 480), spread_function("spencer")
    source = [Source(unit(0, 0, 1), LUX, outline)]
    ring = veil_of_sources(source, view, KERNEL, halo=spread, settings=PerSource(bloom_drawn=False))
    energy = np.einsum("ijc,ij->c", ring, view.solid_angles())
    np.testing.assert_allclose(energy, 0.016 * LUX, rtol=0.02)


def test_halo_is_at_its_angle_from_the_outline():
    view, spread = pinhole(30, 480, 480), spread_function("spencer")
    source = Source(unit(0, 0, 1), np.ones(3), shapes.circle(1 * DEGREE))
    ring = veil_of_sources(
        [source], view, KERNEL, halo=spread, settings=PerSource(bloom_drawn=False)
    )
    theta = np.degrees(angles(view.directions(), source.direction))
    for channel, wavelength in enumerate((611, 549, 467)):
        brightest = theta.ravel()[np.argmax(ring[..., channel])]
        assert abs(brightest - 1 - 3 * wavelength / 568) < 0.1


def test_reach_leaves_out_only_what_is_weaker():
    view = pinhole(60)
    source = [Source(unit(0, 0, 1), np.ones(3), POINT)]
    whole = veil_of_sources(source, view, KERNEL)
    cut = veil_of_sources(source, view, KERNEL, settings=PerSource(least_cd_m2=0.05))
    assert np.all(whole[cut == 0] < 0.05)
    np.testing.assert_array_equal(cut[cut > 0], whole[cut > 0])


def test_wrong_input():
    source = [Source(unit(0, 0, 1), np.ones(3), POINT)]
    with pytest.raises(InputError, match="one for each source"):
        veil_of_sources(source, VIEWS["20"], KERNEL, weights=[1, 1])
    spread = spread_function("cie135", halo=False)
    with pytest.raises(InputError, match="no halo"):
        veil_of_sources(source, VIEWS["20"], KERNEL, halo=spread)
    with pytest.raises(InputError, match="≥ 0"):
        PerSource(least_cd_m2=-1)
