"""The rows of spherical harmonics: they hold, and they see what is wrong."""

import numpy as np
import pytest

import andon.verify.rows.harmonics as rows
from andon.harmonics import project_cube
from andon.verify.registry import NotShown
from andon.verify.truths.three_light_probe import recorded

ROWS = {row.name: row for row in rows.ROWS}
OF_DATA = ("probes.sh.others.three", "probes.sh.l2", "probes.sh.l4")


@pytest.mark.parametrize("name", [n for n in ROWS if not n.startswith(OF_DATA)])
def test_rows_that_need_no_data(name):
    row = ROWS[name]
    figure = row.measure()
    assert np.isfinite(figure)
    assert row.holds(figure) in (True, None)


def test_a_wrong_factor_is_seen(monkeypatch):
    monkeypatch.setattr(rows, "convolved", lambda light: light * np.pi)
    assert not ROWS["probes.sh.matrix"].holds(ROWS["probes.sh.matrix"].measure())


def test_a_turned_axis_is_seen(monkeypatch):
    monkeypatch.setattr(rows, "rotated", lambda light, turns: light)
    assert not ROWS["probes.sh.rotation"].holds(ROWS["probes.sh.rotation"].measure())


def test_three_js_saw_other_texels_is_not_shown(monkeypatch):
    other = recorded()[0].__class__(
        recorded()[0].panorama, "187", np.zeros((6, 3)), np.ones((9, 3)), np.ones((9, 3))
    )
    monkeypatch.setattr(rows, "panorama", lambda name: np.ones((16, 32, 3), np.float32))
    with pytest.raises(NotShown, match=r"another cube map than three\.js was shown"):
        rows._faces(other)


def test_three_js(data_dir, monkeypatch):
    """The first panorama, coefficient by coefficient."""
    monkeypatch.setenv("ANDON_DATA", str(data_dir))
    entry = recorded()[0]
    ours = project_cube(rows._faces(entry), 2, "paper")
    np.testing.assert_allclose(ours, entry.target, atol=3e-6 * entry.target[0].max())
    assert entry.revision == "187"


def test_without_data_rows_are_not_shown(monkeypatch):
    monkeypatch.delenv("ANDON_DATA", raising=False)
    with pytest.raises(NotShown, match="ANDON_DATA is not set"):
        rows.panorama.__wrapped__("hdri_blender_cc0/city.exr")
    monkeypatch.setenv("ANDON_DATA", "/nowhere")
    with pytest.raises(NotShown, match="is missing"):
        rows.panorama.__wrapped__("hdri_blender_cc0/city.exr")
