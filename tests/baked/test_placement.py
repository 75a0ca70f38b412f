"""Cameras that together see the surface."""

import numpy as np
import pytest

from andon.transport.baked.placement import suggested_views
from worlds import block

MOST = {"coverage": 0.99, "most_cameras": 12, "map_size_px": 384}


def test_an_empty_room_is_seen_by_few_cameras():
    found = suggested_views(block((5, 2.5, 4), (0, 1.25, 0), inwards=True), **MOST)
    assert found.ended == "reached"
    assert found.coverage >= 0.99
    assert len(found.views) <= 6
    assert found.reachable_area_m2 == pytest.approx(2 * (5 * 2.5 + 5 * 4 + 2.5 * 4), rel=1e-3)
    np.testing.assert_allclose(found.coverage_so_far[-1], found.coverage)
