"""The focus follows what is looked at."""

import numpy as np
import pytest

from andon.observer.gaze import Refocusing


def test_it_nears_its_target_exponentially():
    focus = Refocusing(0.25, [(0.0, 3.0), (1.0, 6.0)])
    assert focus.at(0.5) == 3.0
    assert focus.at(1.0) == 3.0
    assert focus.at(1.25) == pytest.approx(6 - 3 * np.exp(-1))
    assert focus.at(9.0) == pytest.approx(6.0)


def test_a_change_on_the_way_starts_where_the_focus_is():
    focus = Refocusing(0.25, [(0.0, 3.0), (1.0, 6.0), (1.1, 3.0)])
    there = 6 - 3 * np.exp(-0.4)
    assert focus.at(1.1) == pytest.approx(there)
    assert focus.at(1.35) == pytest.approx(3 + (there - 3) * np.exp(-1))


def test_any_order_of_times_gives_the_same():
    focus = Refocusing(0.2, [(0.1 * k, 3.0 + (k // 7 % 2)) for k in range(60)])
    times = np.linspace(0, 6, 50)
    forwards = [focus.at(time) for time in times]
    assert forwards == [focus.at(time) for time in times[::-1]][::-1]
    assert min(forwards) >= 3.0
    assert max(forwards) <= 4.0


def test_at_once():
    focus = Refocusing(0.0, [(0.0, 3.0), (1.0, 6.0)])
    assert focus.at(1.0) == 6.0


def test_before_the_first_target_it_is_there():
    assert Refocusing(0.25, [(2.0, 4.0)]).at(-1.0) == 4.0
