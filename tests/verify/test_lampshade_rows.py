"""A lampshade against Radiance: what paper does per hit, the truth's energy, thinned rows."""

import numpy as np
import pytest

from andon.quantities import Geometry
from andon.verify.registry import rows
from andon.verify.rows import lampshade
from andon.verify.run import chosen, measured
from andon.verify.solids import icosphere
from andon.verify.truths.lampshade import lampshade_lux, per_hit, walk
from requirements import required


def test_a_closed_ball_keeps_all_and_an_open_drum_what_its_openings_leave():
    ball = icosphere(0.2, 8)
    closed = walk(Geometry(ball.positions, ball.triangles))
    assert closed.met == pytest.approx(1, abs=1e-4)
    assert closed.stays[10] == pytest.approx(1, abs=1e-3)
    # The openings are two caps of the sphere of directions: 1 − cos of their half-angle.
    half = np.arctan(lampshade.RADIUS_M / (lampshade.HEIGHT_M / 2))
    assert walk(lampshade.drum()).met == pytest.approx(np.cos(half), abs=0.005)


def test_what_a_hit_does_adds_up_to_the_net_shares():
    rays = walk(lampshade.drum())
    paper = per_hit(rays, t=0.5, a=0.1)
    received = rays.stays @ paper.reflects ** np.arange(len(rays.stays))
    assert paper.passes * received == pytest.approx(0.5, abs=1e-6)
    assert (1 - paper.reflects - paper.passes) * received == pytest.approx(0.1, abs=1e-6)
    dark = per_hit(rays, t=0.3, a=0.7)
    assert (dark.passes, dark.reflects) == pytest.approx((0.3, 0))


def test_radiances_paper_sends_t_of_what_meets_it_to_the_walls(monkeypatch):
    required("pyradiance")
    monkeypatch.setattr(lampshade, "RAYS", 64)
    lampshade._truth.cache_clear()
    assert lampshade.truth_flux_error("dark") < 0.02
    median, p95 = lampshade.against_radiance("dark", "exact")
    lampshade._truth.cache_clear()
    lampshade.against_radiance.cache_clear()
    assert median < 0.03
    assert p95 < 0.12


def test_the_bulb_shines_through_the_openings_only():
    required("pyradiance")
    points = np.array([[0.0, -1.3, 0], [2.0, 0, 0]])
    normals = np.array([[0.0, 1, 0], [-1.0, 0, 0]])
    paper = per_hit(walk(lampshade.drum()), t=0.5, a=0.5)
    bulb, lit = lampshade_lux(lampshade.drum(), paper, 60.0, points, normals, rays=400)
    np.testing.assert_allclose(bulb, [60 / 1.3**2, 0], rtol=1e-3)
    # From the side the drum is π·t·E_inside/π over what is seen of it, within its own size.
    assert 60 / 4 * 0.4 < lit[1] < 60 / 4 * 0.6


@pytest.mark.parametrize("case", lampshade.CASES)
def test_lumens_add_up(case):
    assert lampshade.flux_error(case, "exact") < 0.01


@pytest.mark.slow
def test_the_dark_shade_holds():
    for entry in chosen(["relight.lampshade.dark.exact"], rows()):
        assert measured(entry)["holds"] is not False, measured(entry)
