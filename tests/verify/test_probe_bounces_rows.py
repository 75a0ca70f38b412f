"""What the rows of bounces of probes rest on, and longer runs of them."""

import numpy as np
import pytest

from andon.harmonics import cube_directions
from andon.rays import RayScene
from andon.surface.still import still_geometry
from andon.verify.probe_bounces import (
    bounce_errors,
    box_scene,
    furnace_error,
    true_irradiance,
)
from andon.verify.rows.probe_bounces import ROWS


def test_the_box_is_closed_and_shows_its_inside(tmp_path):
    geometry = still_geometry(box_scene(tmp_path))
    assert len(geometry.triangles) == 24
    directions = cube_directions(16).reshape(-1, 3)
    hits = RayScene(geometry).first_hits(
        np.broadcast_to([0.41, 0.23, 0.29], directions.shape), directions
    )
    assert np.isfinite(hits.distance).all()
    corners = geometry.positions[geometry.triangles[hits.triangle]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((normals * directions).sum(axis=1) < 0).all()


def test_the_truth_of_a_furnace_is_its_closed_form(tmp_path):
    """E = π·ε·(1 + ρ), asked in free air."""
    scene = box_scene(tmp_path, furnace=True)
    lux = true_irradiance(scene, np.array([[0.2, 0.1, -0.3]]), np.eye(3), 1)
    np.testing.assert_allclose(lux, np.pi * 2.0 * 1.6, rtol=0.02)


def test_probes_are_exact_in_a_furnace():
    assert furnace_error("probes", 3, engine="reference") < 1e-6


def test_the_rows_have_bars_where_radiance_is_asked():
    assert {row.name for row in ROWS if row.bar is not None} == {
        "probes.bounces.furnace.radiance", "probes.bounces.radiance",
        "probes.bounces.radiance.added",
    }  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("bounces", [2, 3, 4])
def test_radiance_is_within_three_percent_after_any_bounce(bounces):
    errors = bounce_errors("radiance", bounces, engine="reference")
    assert errors.rms < 0.03
    assert abs(errors.bias) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("bounces", [2, 3, 4])
def test_denser_lattices_converge(bounces):
    """What is wrong is the lookup between the probes, and more probes mend it."""
    sparse, dense, denser = (
        bounce_errors("probes", bounces, engine="reference", side=side, reach=reach)
        for side, reach in ((2, 0.8), (4, 0.95), (6, 0.97))
    )
    assert denser.added_rms < dense.added_rms < sparse.added_rms
    assert denser.rms < 0.04


@pytest.mark.slow
@pytest.mark.parametrize("quality", ["draft", "normal", "fine"])
def test_radiance_is_within_five_percent_of_a_furnace(quality):
    assert furnace_error("radiance", 4, quality, "reference") < 0.05
