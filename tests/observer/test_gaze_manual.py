"""docs/gaze.md says what the readers do."""

import re
from pathlib import Path

import numpy as np
import pytest

from andon.files import read_gaze
from andon.files.gaze.table import MAX_SAMPLES
from andon.files.gaze.tables import OWN_COLUMNS
from andon.observer.gaze import FILTERS, REASONS, fixations
from andon.observer.gaze.lsl import CHANNELS, recording_of
from andon.scene.eye import Gaze

MANUAL = (Path(__file__).parents[2] / "docs" / "gaze.md").read_text(encoding="utf-8")


def test_it_names_every_column_and_reason():
    for name in (*OWN_COLUMNS, "time_seconds", "distance_m", "dioptres", "confidence"):
        assert f"`{name}`" in MANUAL
    for reason in REASONS:
        assert reason in MANUAL
    assert str(MAX_SAMPLES) in MANUAL


def test_it_names_every_filter_of_a_scene():
    for name in set(FILTERS) - {"mean"}:
        assert f"| `{name}` |" in MANUAL
        Gaze(filter=name)


def test_its_columns_are_a_recording(tmp_path):
    path = tmp_path / "a.csv"
    names = ["time_seconds", *re.findall(r"`((?:left|right)_\w+_[xyz](?:_m)?)`", MANUAL)]
    assert len(names) == 13
    path.write_text(",".join(names) + "\n" + ",".join("1" * 13) + "\n")
    assert np.isfinite(read_gaze(path).directions).all()


def test_its_sample_is_a_fixation():
    numbers = re.search(r"push_sample\((\[.*?\])\)", MANUAL)[1]
    values = np.array([float(word) for word in numbers.strip("[]").split(",")])
    assert len(values) == CHANNELS
    found = fixations(recording_of(np.zeros(1), values[None]))
    assert found.dioptres[0] == pytest.approx(1 / 1.05)
