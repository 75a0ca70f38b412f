"""The rows of baked light's presets: better ones err less, and none more than it states."""

import numpy as np
import pytest

from andon.transport.baked.radiance.quality import QUALITIES
from andon.verify.rows import baked_quality
from requirements import required

required("pyradiance")


def test_presets_are_ordered():
    """What is stated: more time, less error."""
    draft, normal, fine = QUALITIES.values()
    assert [draft.name, normal.name, fine.name] == list(QUALITIES)
    assert draft.median_error > normal.median_error > fine.median_error
    assert draft.p95_error > normal.p95_error >= fine.p95_error
    assert (
        draft.seconds_per_100k_points
        < normal.seconds_per_100k_points
        < fine.seconds_per_100k_points
    )


@pytest.mark.parametrize("name", ["draft", "normal"])
def test_a_preset_errs_no_more_than_it_states(name):
    rows = {row.name: row for row in baked_quality.ROWS}
    for figure in ("median", "p95"):
        row = rows[f"baked.quality.{name}.{figure}"]
        assert row.holds(row.measure())


def test_the_map_sees_its_room():
    """Its points are on the walls or the block, and look at the camera."""
    place, facing = baked_quality._seen()
    assert (np.abs(place[:, 1] - 1.3) <= 1.3 + 1e-6).all()
    assert (np.sum((np.array([-1.8, 2.0, 1.8]) - place) * facing, axis=1) > 0).all()
    assert (np.abs(place - [0.9, 0.351, -0.6]) < [0.51, 0.36, 0.51]).all(axis=1).mean() > 0.03
