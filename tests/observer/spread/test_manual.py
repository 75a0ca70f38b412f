"""docs/glare.md says what the spread functions do."""

import re
from pathlib import Path

import numpy as np
import pytest

from andon.glare.kernel import Kernel
from andon.observer.presets import AGES, EYE_COLOURS, WORN
from andon.observer.spread.family import ALIASES, NAMES, spread_function
from andon.observer.spread.model import Eye

MANUAL = (Path(__file__).parents[3] / "docs" / "glare.md").read_text(encoding="utf-8")


def rows(heading):
    """{first cell: numbers} of the table under a row that begins with `heading`."""
    table = MANUAL.partition(f"\n| {heading} |")[2].partition("\n\n")[0]
    cells = [line.strip("| ").split(" | ") for line in table.splitlines()[2:]]
    return {cell[0].strip("`"): cell[1:] for cell in cells}


def test_it_names_everything():
    assert set(rows("name")) == set(NAMES)
    for name in (*NAMES, *ALIASES, *AGES, *EYE_COLOURS, *(set(WORN) - {"none"})):
        assert f"`{name}`" in MANUAL


def test_its_ranges():
    for name, (_, valid, _) in rows("name").items():
        least, most = spread_function(name).valid_degrees
        assert valid == f"{least:g}…{most:g}°"


def test_its_values():
    values = rows("θ")
    assert set(values) == set(NAMES)
    for name, told in values.items():
        ours = spread_function(name).bloom_per_sr([0.1, 0.3, 1, 3, 10, 30])
        # Four digits are told.
        np.testing.assert_allclose(ours, [float(value) for value in told], rtol=1e-3)


def test_its_shares_of_veil():
    shares = rows("model")
    assert set(shares) == set(NAMES)
    for name, told in shares.items():
        for age, share in zip((25, 70), told, strict=True):
            kernel = Kernel(spread_function(name, Eye(age)))
            assert kernel.share == pytest.approx(float(share), abs=0.0051)


def test_its_example():
    code = re.search(r"```python\n(.*?)```", MANUAL, re.DOTALL)[1]
    names = {}
    exec(compile(code, "glare.md", "exec"), names)
    told = re.findall(r"^(\S.*\))  # ([\d.]+)", code, re.MULTILINE)
    assert len(told) == 3
    for expression, value in told:
        assert eval(expression, names) == pytest.approx(float(value), abs=0.0006)
    increments = [65 * 0.4 * float(names[who].bloom_per_sr(3.0)) for who in ("young", "old")]
    text = " ".join(MANUAL.split())
    assert f"of {increments[0]:.0f} % for the young and {increments[1]:.0f} %" in text
