"""Illuminance by area lamps in the reference: units, sides, pictures, energy."""

import numpy as np
import pytest

from andon.lamps import PointLamp
from andon.lamps.areas import AreaLamp, DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.transport.direct.reference import illuminance
from worlds import ball, unit

X, Y, Z = np.eye(3)
COLOUR = np.array([100.0, 50, 25])
SQUARE = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
ICO = ball(0.5, (0, 0, 0), 6)

LAMPS = {
    "sphere": SphereLamp("l", COLOUR, position_m=0 * X, radius_m=0.5),
    "disk": DiskLamp("l", COLOUR, position_m=0 * X, direction=Z, radius_m=0.5),
    "polygon": PolygonLamp("l", COLOUR, vertices_m=SQUARE),
    "tube": TubeLamp("l", COLOUR, ends_m=np.array([-0.5 * X, 0.5 * X]), radius_m=0.2),
    "mesh": MeshLamp("l", COLOUR, positions_m=ICO.positions, triangles=ICO.triangles),
}


@pytest.mark.parametrize("kind", LAMPS)
def test_batches_and_colour(kind):
    rng = np.random.default_rng(0)
    place = unit(rng.normal(size=(4, 5, 3))) * 2
    got = illuminance(LAMPS[kind], place, unit(-place + rng.normal(size=place.shape)))
    assert got.shape == (4, 5, 3)
    np.testing.assert_allclose(got[..., 0], 4 * got[..., 2])
    assert (got.max(axis=(0, 1)) > 0.05 * COLOUR).all()


@pytest.mark.parametrize(
    ("kind", "area", "tolerance"),
    [
        ("sphere", np.pi, 1e-3),
        ("disk", 0.25 * np.pi, 1e-3),
        ("polygon", 1.0, 1e-3),
        ("tube", 4 * np.pi * 0.04 + 2 * np.pi * 0.2, 1e-3),
        ("mesh", np.pi, 0.02),
    ],
)
def test_flux_is_pi_times_luminance_times_area(kind, area, tolerance):
    """∮ E dA over a sphere around the lamp, facing inwards (Gauss in height, equal azimuths)."""
    z, w = np.polynomial.legendre.leggauss(60)
    t = (np.arange(60) + 0.5) * 2 * np.pi / 60
    s = np.sqrt(1 - z**2)[:, None]
    place = np.stack([s * np.cos(t), s * np.sin(t), np.broadcast_to(z[:, None], (60, 60))], axis=-1)
    centre, radius = np.array([0.1, 0.2, 0.1]), 2.0
    got = illuminance(LAMPS[kind], centre + radius * place, -place)
    flux = (got * w[:, None, None]).sum(axis=(0, 1)) * 2 * np.pi / 60 * radius**2
    np.testing.assert_allclose(flux, np.pi * COLOUR * area, rtol=tolerance)


def test_a_ball_that_is_seen_whole_is_a_point():
    point = PointLamp("p", 0 * X, COLOUR * np.pi * 0.25)
    place, normal = np.array([0.0, 0, 2]), unit(np.array([0.4, 0, -1]))
    expected = illuminance(point, place, normal)
    np.testing.assert_allclose(illuminance(LAMPS["sphere"], place, normal), expected, rtol=1e-12)


@pytest.mark.parametrize("two_sided", [False, True])
@pytest.mark.parametrize("textured", [False, True])
def test_sides(two_sided, textured):
    texture = np.ones((4, 4, 3)) * [2.0, 1, 0] if textured else None
    factor = texture[0, 0] if textured else 1
    square = PolygonLamp("l", COLOUR, vertices_m=SQUARE, two_sided=two_sided, texture=texture)
    disk = DiskLamp(
        "l", COLOUR, position_m=0 * X, direction=Z, radius_m=np.pi**-0.5, two_sided=two_sided
    )
    for lamp, share in ((square, factor), (disk, 1)):
        front, back = illuminance(lamp, 9 * Z, -Z), illuminance(lamp, -9 * Z, Z)
        np.testing.assert_allclose(front, COLOUR * share / 81, rtol=1e-2)
        np.testing.assert_allclose(back, front * two_sided, rtol=1e-12)


def test_a_picture_from_behind_is_the_other_way_round():
    texture = np.zeros((2, 2, 3))
    texture[0, 0] = 4
    lamp = PolygonLamp("l", COLOUR, vertices_m=SQUARE, two_sided=True, texture=texture)
    place = np.array([[-0.25, 0.25, -0.1], [0.25, 0.25, -0.1]])
    left, right = illuminance(lamp, place, Z)[:, 0]
    assert left > 10 * right


def test_facets_have_luminances_of_their_own():
    height = ICO.positions[ICO.triangles].mean(axis=1)[:, 2:]
    light = np.where(height > 0, [[1.0, 0, 0]], [[0, 0, 1.0]])
    lamp = MeshLamp(
        "l",
        COLOUR,
        positions_m=ICO.positions,
        triangles=ICO.triangles,
        facet_luminance_cd_m2=light,
    )
    above, below = illuminance(lamp, 3 * Z, -Z), illuminance(lamp, -3 * Z, Z)
    assert above[0] > 0.05
    assert below[2] > 0.05
    assert above[1:].max() == below[:2].max() == 0


def test_an_area_of_no_kind_is_refused():
    with pytest.raises(TypeError, match="AreaLamp"):
        illuminance(AreaLamp("l", COLOUR), Z, Z)
