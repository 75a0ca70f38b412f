"""Logarithmic axes and dashes of the diagrams."""

import numpy as np
import pytest

from andon.display.dashes import dash_mask
from andon.display.time_series import (
    BOTTOM_PX,
    LEFT_PX,
    RIGHT_PX,
    TOP_PX,
    WIDTH_PX,
    Curve,
    Panel,
    decade_lines,
    drawn,
)

RED = (220, 20, 30)


def test_lines_of_decades():
    lines = decade_lines(0.02, 300)
    assert [value for value, _ in lines[:3]] == [0.02, 0.03, 0.04]
    assert lines[-1] == (300, "")
    assert [text for _, text in lines if text] == ["0.1", "1", "10", "100"]
    assert [text for _, text in decade_lines(0.1, 10) if text] == [
        "0.1", "0.2", "0.5", "1", "2", "5", "10"
    ]  # fmt: skip


def rows_of(picture, column):
    return np.flatnonzero((np.abs(picture[:, column].astype(int) - RED) < 60).all(axis=1))


@pytest.mark.parametrize(
    ("logarithmic", "y_at"),
    [
        ("xy", lambda share: share),
        ("x", lambda share: (10 ** (4 * share) - 1) / 9999),
        ("y", lambda share: np.log10(1 + 9999 * share) / 4),
        ("", lambda share: share),
    ],
)
def test_where_a_line_runs(logarithmic, y_at):
    """y = x from 0.01 to 100: straight where both axes are alike."""
    x = np.geomspace(0.01, 100, 4001)
    curve = Curve("", RED, x, x, 3.0)
    ends = 0.01, 100.0
    panel = Panel("t", "x", "y", ends, ends, [curve], logarithmic=logarithmic, height_px=400)
    picture = drawn([panel])
    assert picture.shape == (400, WIDTH_PX, 3)
    inner = 400 - TOP_PX - BOTTOM_PX
    for share in (0.1, 0.25, 0.5, 0.75, 0.9):
        column = round(LEFT_PX + share * (WIDTH_PX - LEFT_PX - RIGHT_PX))
        row = TOP_PX + inner * (1 - y_at(share))
        assert abs(rows_of(picture, column).mean() - row) < 2.5


def test_dashes_are_as_long_on_the_paper_whatever_the_steps():
    for step in (0.5, 0.25):
        points = np.stack([np.arange(0, 100, step), np.zeros(round(100 / step))], axis=-1)
        ink = dash_mask(points, 10.0)
        assert ink.mean() == pytest.approx(0.6, abs=0.02)
        assert np.abs(np.diff(ink.astype(int))).sum() == 9


def test_a_dashed_curve_has_gaps():
    x = np.linspace(0, 1, 2000)
    curves = [
        Curve("solid", RED, x, np.full(2000, 0.3)),
        Curve("dashed", RED, x, np.full(2000, 0.7), dash_px=9.0),
    ]
    picture = drawn([Panel("t", "x", "y", (0, 1), (0, 1), curves, legend="none")])
    red = (np.abs(picture[TOP_PX:-BOTTOM_PX].astype(int) - RED) < 60).all(axis=2).sum(axis=1)
    solid, dashed = red[len(red) // 2 :].max(), red[: len(red) // 2].max()
    assert solid > 1000
    assert 0.5 < dashed / solid < 0.7


def test_a_legend_inside_is_in_the_corner():
    x = np.linspace(0, 1, 10)
    curves = [Curve("curve", RED, x, x), Curve("", RED, x, x / 2)]
    inside, none = (
        drawn([Panel("t", "x", "y", (0, 1), (0, 1), curves, legend=legend)])
        for legend in ("inside", "none")
    )
    rows, columns = np.nonzero((inside != none).any(axis=2))
    assert TOP_PX < rows.min() < rows.max() < TOP_PX + 40
    assert columns.min() > WIDTH_PX - 150
