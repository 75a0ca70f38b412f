"""Rows of glass, thinned: bodies against Mitsuba's rays, blur by pupils, disparity, the exit."""

import numpy as np
import pytest

from andon.verify import traced_frame
from andon.verify.glass_rays import seen_through
from andon.verify.glass_setting import BACKDROP, BODIES, EYE_M, body, drinking_glass, goblet
from andon.verify.registry import NotShown, rows
from andon.verify.rows import glass, glass_blur, glass_frame
from andon.verify.run import chosen, measured
from requirements import missing, required


@pytest.fixture
def measured_engine(engine):
    required("mitsuba")
    return engine


def test_snells_row_holds(engine):
    assert glass.snell_error(engine) < (1e-12 if engine == "reference" else 1e-5)


def test_a_wrong_flag_is_no_figure(monkeypatch):
    right = glass.refracted

    def never_total(*arguments):
        directions, flags = right(*arguments)
        return directions, flags & False

    monkeypatch.setattr(glass, "refracted", never_total)
    assert glass.snell_error("reference") == float("inf")


@pytest.mark.parametrize("name", ["ball", "slab", "lens", "nested"])
def test_bodies_refract_as_mitsubas_do(measured_engine, name):
    errors = glass.errors_px(measured_engine, name, 64)
    assert len(errors) > 20
    assert np.median(errors) < 0.01
    assert (errors < 0.1).mean() > 0.98


def test_a_mesh_refracts_as_mitsubas_does(measured_engine):
    assert glass.share_near(measured_engine, "goblet", 48) > 0.95


def test_a_real_glass_refracts_as_mitsubas_does(measured_engine):
    try:
        drinking_glass()
    except NotShown as error:
        missing(str(error))
    assert glass.share_near(measured_engine, "real", 48) > 0.9


def test_the_goblet_is_closed_and_outward():
    mesh = goblet()
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    a, b, c = mesh.positions[mesh.triangles].transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0


def test_beside_the_glass_the_backdrop_is_where_it_is(engine):
    directions = np.array([[0.3, 0.1, -0.6], [0.35, 0.0, -0.6], [1.0, 0, 0], [0, 0, 1.0]])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    found = seen_through(engine, body("ball"), EYE_M, directions)
    assert not found.glass.any()
    np.testing.assert_allclose(found.points[0], [0.3, 0.1, -0.2], atol=1e-6)
    away = np.linalg.norm(found.points[0] - EYE_M)
    np.testing.assert_allclose(found.vergence[0], np.eye(2) / away, atol=1e-5)
    assert np.isnan(found.points[2:]).all()
    assert np.abs(found.points[1, 0]) < BACKDROP.right_m[0]


def test_blur_and_disparity_hold(measured_engine, monkeypatch):
    monkeypatch.setattr(glass_blur, "POINTS", glass_blur.POINTS[::2])
    monkeypatch.setattr(glass_blur, "FOCI_M", glass_blur.FOCI_M[1::2])
    assert glass_blur.blur_error(measured_engine, 60) < 0.05
    assert glass_blur.disparity_error_px(measured_engine, 96) < 0.05
    assert np.isfinite(glass_blur.disparities_px(None, 96)[:, 0]).sum() > 20


def test_pupils_of_both_tracers_agree(monkeypatch):
    required("mitsuba")
    monkeypatch.setattr(glass_blur, "POINTS", glass_blur.POINTS[1:2])
    assert glass_blur.oracle_error(40) < 1e-3


def test_the_exit_is_worth_nine_dioptres():
    # Two interfaces give +6.65 D on the axis, one −2.28 D, by the paraxial formulas of a ball.
    shift, dioptres = glass_blur.one_interface()
    assert dioptres == pytest.approx(6.65 + 2.28, abs=0.01)
    assert shift > 50


@pytest.mark.slow
@pytest.mark.parametrize("entry", chosen(["glass"], rows()), ids=lambda entry: entry.name)
def test_every_row_holds(entry):
    result = measured(entry)
    if "not_shown" in result:
        missing(result["not_shown"])
    assert result["holds"] is not False, result


def test_every_body_is_named():
    assert set(glass.TRUTHS) == set(BODIES)


def test_whole_pictures_agree_with_the_path_tracer(monkeypatch):
    """The reference's own: what is mirrored inside the ball is the difference, some %."""
    required("mitsuba")
    monkeypatch.setattr(traced_frame, "WIDTH", 320)
    monkeypatch.setattr(traced_frame, "HEIGHT", 180)
    monkeypatch.setattr(traced_frame, "FOCAL_PX", traced_frame.FOCAL_PX / 4)
    monkeypatch.setattr(traced_frame, "SMALLER", 4)
    off = glass_frame.off_traced("reference", 64)
    assert -6 < off < 0
