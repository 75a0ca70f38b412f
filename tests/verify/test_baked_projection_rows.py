"""The rows of projected maps hold."""

import pytest

from andon.verify.rows.baked_projection import ROWS


@pytest.mark.parametrize("row", [row for row in ROWS if row.bar], ids=lambda row: row.name)
def test_row(row, gpu):
    assert row.holds(row.measure())
