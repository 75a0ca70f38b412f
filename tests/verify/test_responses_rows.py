"""Rows of responses that are quick: known surfaces, and the real ball."""

import numpy as np
import pytest

from andon.verify.gray_sphere import ball_normals
from andon.verify.registry import rows
from andon.verify.run import chosen, measured


@pytest.mark.parametrize("surface", ["linear", "gamma", "s"])
def test_known_surfaces_come_back(surface):
    (entry,) = chosen([f"relight.response.surface.{surface}"], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.slow
@pytest.mark.parametrize("camera", ["srgb", "pleasing"])
def test_known_cameras_come_back(camera):
    (entry,) = chosen([f"relight.response.known.{camera}_7x1ev"], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.usefixtures("data_dir")
def test_a_real_matte_ball_is_straight_but_for_its_offset():
    entries = chosen(["relight.response.sphere"], rows())
    found = {entry.name.rsplit(".", 1)[1]: measured(entry)["figure"] for entry in entries}
    assert found["straight_with_offset"] < 0.02
    assert found["offset"] > 0.02  # light that comes from no lamp
    assert found["rms"] < 0.06


def test_normals_of_a_ball():
    y, x = np.mgrid[-20:21, -24:25]
    normals = ball_normals(np.hypot(x, y) <= 18)
    np.testing.assert_allclose(normals[20, 24], [0, 0, 1], atol=1e-12)
    assert normals[20, 34, 0] == pytest.approx(10 / 18, abs=0.01)  # right
    assert normals[10, 24, 1] == pytest.approx(10 / 18, abs=0.01)  # up
    known = np.isfinite(normals[..., 0])
    np.testing.assert_allclose(np.linalg.norm(normals[known], axis=1), 1)
    assert not known[20, 24 + 18]
