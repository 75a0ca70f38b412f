"""The speed rows: what is printed, what is refused, and that ours is timed at all."""

import json
import time

import pytest

from andon.bench import run as bench
from andon.bench.registry import BenchRow, Duel, rows
from andon.verify.registry import NotShown


def row(duel, **bar):
    def prepare():
        if isinstance(duel, Exception):
            raise duel
        return duel

    return BenchRow("relight.test", "relight", "a sloth", 1_000_000, prepare, **bar)


def duel(agreement=1.0, **more):
    return Duel(
        lambda: time.sleep(0.002), lambda: time.sleep(0.008), agreement, 0.95, "an adapter", **more
    )


def test_names_are_unique_and_begin_with_their_stage():
    names = [entry.name for entry in rows()]
    assert len(set(names)) == len(names)
    assert all(entry.name.startswith(f"{entry.stage}.") for entry in rows())


def test_the_ratio_is_peer_over_ours():
    result = bench.measured(row(duel(), bar=2.0), quick=True)
    assert 1.5 < result["ratio"] < 8
    assert result["ratio"] == pytest.approx(result["peer_seconds"] / result["ours_seconds"])
    assert result["holds"] is True
    assert result["mpix_per_second"] == pytest.approx(1 / result["ours_seconds"])
    for key in ("name", "stage", "peer", "agreement", "pixels", "adapter"):
        assert key in result


def test_bars_are_ratios_rates_or_milliseconds():
    assert row(duel(), bar=3.0).holds(1.0, 4.0) is True
    assert row(duel(), bar=30.0, bar_is_rate=True).holds(0.02, 9.0) is True
    assert row(duel(), bar=30.0, bar_is_rate=True).holds(0.04, 9.0) is False
    assert row(duel(), bar=30.0, bar_is_milliseconds=True).holds(0.02, 9.0) is True
    assert row(duel()).holds(1.0, 1.0) is None


def test_no_time_is_given_for_two_that_disagree():
    result = bench.measured(row(duel(0.5)), quick=True)
    assert result["holds"] is False
    assert "ours_seconds" not in result


def test_a_missing_peer_is_not_shown():
    result = bench.measured(row(NotShown("pygfx is missing")), quick=True)
    assert result["not_shown"] == "pygfx is missing"
    assert result["holds"] is False


def test_what_was_opened_is_closed_even_when_they_disagree():
    closed = []
    bench.measured(row(duel(0.1, close=lambda: closed.append(1))), quick=True)
    assert closed == [1]


def test_what_the_peer_does_besides_is_taken_off():
    result = bench.measured(
        row(duel(peer_less=lambda: time.sleep(0.006), peer_parts=2)), quick=True
    )
    assert result["peer_seconds"] < 0.004


@pytest.mark.usefixtures("gpu")
def test_the_frame_beside_the_reference(tmp_path):
    path = tmp_path / "bench.json"
    assert bench.run(("relight.frame.1_lamps.reference",), quick=True, json_path=path) == 0
    (entry,) = json.loads(path.read_text())
    assert entry["agreement"] > 0.95
    assert entry["ratio"] > 0
