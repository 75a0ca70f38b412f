"""Form factors, solid angles and beams against closed forms."""

import numpy as np
import pytest

from andon.lamps.shells.beams import Beam, beam_flux, beam_of, solid_angles
from andon.lamps.shells.factors import enclosure_factors, point_factors
from andon.lamps.shells.radiosity import balance
from andon.lamps.solids import icosphere, quarters
from lamps.shell_worlds import box, lamp

UP = np.array([[0.0, 0, 1]])
ORIGIN = np.zeros((1, 3))


def corners(mesh):
    return mesh.positions[mesh.triangles]


def square(half, height):
    """Two triangles above the origin that shine down."""
    a, b, c, d = half * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) + [0, 0, height]
    return np.array([[a, c, b], [a, d, c]])


def test_a_square_overhead():
    # Four rectangles from the foot of the normal (Lambert 1760): a = b = half/height.
    x = 1 / np.sqrt(2)
    quarter = (2 * x * np.arctan(x)) / (2 * np.pi)
    found = point_factors(ORIGIN, UP, square(1.0, 1.0))
    assert found.sum() == pytest.approx(4 * quarter, rel=1e-12)
    behind = point_factors(ORIGIN, UP, square(1.0, 1.0)[:, ::-1])
    np.testing.assert_allclose(behind, -found, rtol=1e-12)


def test_horizon():
    # Half of a great wall stands above the ground: a wall that fills half the sky gives ½.
    wall = np.array(
        [
            [[1, -1e5, -1e5], [1, -1e5, 1e5], [1, 1e5, 1e5]],
            [[1, -1e5, -1e5], [1, 1e5, 1e5], [1, 1e5, -1e5]],
        ]
    )
    assert abs(point_factors(ORIGIN, UP, wall).sum()) == pytest.approx(0.5, abs=1e-4)
    assert point_factors(ORIGIN, UP, square(1.0, -1.0)).sum() == 0
    assert np.isfinite(point_factors(ORIGIN, UP, square(1.0, 0.0))).all()


def test_a_hemisphere_around_gives_one():
    ball = corners(icosphere(3))[:, ::-1]
    random = np.random.default_rng(0)
    points = random.uniform(-0.4, 0.4, (20, 3))
    normals = random.normal(size=(20, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    found = point_factors(points, normals, ball)
    np.testing.assert_allclose(found.sum(axis=1), 1, rtol=1e-9)
    assert found.min() > -1e-12


def test_a_cube():
    # Known to many digits: opposite squares 0.19982, neighbours 0.20004.
    inside = corners(box((1, 1, 1)))[:, ::-1]
    inside = quarters(quarters(inside))
    shares = enclosure_factors(inside, closed=True)
    np.testing.assert_allclose(shares.sum(axis=1), 1, rtol=1e-12)
    face = np.argmax(np.abs(inside.mean(axis=1)), axis=1) * 2
    face += inside.mean(axis=1)[np.arange(len(inside)), face // 2] > 0
    between = [
        [shares[face == i][:, face == j].sum(axis=1).mean() for j in range(6)] for i in range(6)
    ]
    assert between[0][0] == pytest.approx(0, abs=1e-12)
    assert between[0][1] == pytest.approx(0.19982, abs=2e-3)
    assert between[0][2] == pytest.approx(0.20004, abs=2e-3)


def test_reciprocity():
    inside = corners(box((1, 2, 3)))[:, ::-1]
    size = np.linalg.norm(
        np.cross(inside[:, 1] - inside[:, 0], inside[:, 2] - inside[:, 0]), axis=1
    )
    exchange = size[:, None] * enclosure_factors(quarters(inside), closed=True).reshape(
        12, 4, 12, 4
    ).mean(axis=1).sum(axis=2)
    np.testing.assert_allclose(exchange, exchange.T, rtol=1e-6, atol=1e-12)


def test_without_its_lids_rows_lose_light():
    inside = corners(box((1, 1, 1), sides="xz"))[:, ::-1]
    rows = enclosure_factors(inside, closed=False).sum(axis=1)
    np.testing.assert_allclose(rows, 0.6, atol=0.03)


def test_solid_angles():
    ball = corners(icosphere(2))
    assert solid_angles(ball).sum() == pytest.approx(4 * np.pi, rel=1e-12)
    assert solid_angles(ball - [2, 0, 0]).sum() == pytest.approx(0, abs=1e-12)
    octant = np.eye(3)[None]
    assert solid_angles(octant)[0] == pytest.approx(np.pi / 2)
    np.testing.assert_allclose(beam_flux(ball, beam_of(lamp())), solid_angles(ball))


@pytest.mark.parametrize("outer", [90, 45, 10, 1, 0.1])
@pytest.mark.parametrize("soft", [0.0, 0.5, 0.99])
def test_all_of_a_beam_meets_a_closed_shell(outer, soft):
    direction = np.array([1, 2, -3]) / np.sqrt(14)
    beam = Beam(tuple(direction), soft * np.radians(outer), np.radians(outer))
    assert beam_flux(corners(icosphere(1)), beam).sum() == pytest.approx(beam.flux_lm, rel=0.02)
    assert beam_flux(corners(box((1, 2, 3))), beam).sum() == pytest.approx(beam.flux_lm, rel=0.02)


def test_unknown_distributions_are_not_taken_for_points():
    class Odd(type(lamp())):
        pass

    with pytest.raises(TypeError, match="Odd"):
        beam_of(Odd("odd", np.zeros(3), np.ones(3)))


@pytest.mark.parametrize("t", [0.0, 0.1, 0.6])
@pytest.mark.parametrize("a", [0.0, 0.3])
def test_balance(t, a):
    random = np.random.default_rng(3)
    shares = random.uniform(size=(7, 8))
    shares /= shares.sum(axis=1, keepdims=True)
    incident = random.dirichlet(np.ones(7))
    found = balance(incident, shares[:, :7], t=t, a=a)
    # What arrives is what came from the lamp and what was reflected.
    again = incident + found.reflects * found.received @ shares[:, :7]
    np.testing.assert_allclose(found.received, again, rtol=1e-6)
    assert found.passes * found.received.sum() == pytest.approx(t, abs=1e-9)
    leaves = found.reflects * found.received @ shares[:, 7]
    assert leaves == pytest.approx(1 - t - a, abs=1e-6)


def test_balance_of_the_dark():
    found = balance(np.zeros(3), np.zeros((3, 3)), t=0.5, a=0.1)
    assert not found.received.any()


def test_more_reflection_is_more_even():
    inside = corners(icosphere(1))[:, ::-1]
    shares = enclosure_factors(inside, closed=True) * 0.8
    spot = np.zeros(len(inside))
    spot[0] = 1
    spread = [
        np.std(b.received / b.received.sum())
        for b in (balance(spot, shares, t=t, a=0) for t in (0.9, 0.5, 0.1))
    ]
    assert spread[0] > spread[1] > spread[2]
