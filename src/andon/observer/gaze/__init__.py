"""Gaze: from the rays of two eyes to what is in focus.

::

    recording ┐
    LSL       ├─▶ meeting of the rays ─▶ rejected? ─▶ filter, in dioptres ─▶ held? ─▶ layer
    pointer ──┘   fixation.py                         filters.py     smoother.py    choice.py

Why the crossing of both rays, and not what a single ray hits: glass has its images one behind the
other along the *same* ray; only vergence tells them apart. It is the worst-conditioned number of an
eye tracker: with eyes 63 mm apart, 0.5° of noise is 0.14 D, whatever the distance, so at 2 m it
spans 1.56…2.77 m, and beyond 7 m half of it is "behind infinity". So everything here is in
dioptres, and a layer is chosen with hysteresis rather than a distance believed.

============================ ========================== ===========================================
alternative                  cost                       why not
============================ ========================== ===========================================
the paper: mean of 20 in m   lags 0.317 s at 30 Hz,     skewed: the mean lies too far away, and one
                             too far by noise           sample near infinity moves it for 20; kept
                                                        as ``paper``
Kalman filter                a model of eye movements   two parameters more than a 1 € filter, which
                                                        nobody who tunes it can see
ray against the scene        needs the scene's geometry cannot tell a surface from what is seen
                                                        through it
============================ ========================== ===========================================

Every source answers ``at(time_seconds) -> (dioptres | None, state)`` from its past alone; `state`
is ``seen``, ``held`` or ``fallback``, and there is never a NaN.

Sources: the paper on glass by gaze, section 4.2; Casiez et al. 2012; Campbell & Westheimer 1960.
"""

from __future__ import annotations

from andon.observer.gaze.blinks import blink_intervals
from andon.observer.gaze.choice import LayerChoice
from andon.observer.gaze.filters import FILTERS, Filter, FilterName, filter_of, make_filter
from andon.observer.gaze.fixation import REASONS, fixations, meeting
from andon.observer.gaze.lsl import LslGaze
from andon.observer.gaze.mouse import MouseGaze
from andon.observer.gaze.refocusing import Refocusing
from andon.observer.gaze.smoother import Smoothed, Smoother, smoothed
from andon.observer.gaze.track import GazeTrack, load_track

__all__ = [
    "FILTERS",
    "REASONS",
    "Filter",
    "FilterName",
    "GazeTrack",
    "LayerChoice",
    "LslGaze",
    "MouseGaze",
    "Refocusing",
    "Smoothed",
    "Smoother",
    "blink_intervals",
    "filter_of",
    "fixations",
    "load_track",
    "make_filter",
    "meeting",
    "smoothed",
]
