"""EyeLink's text export (``.asc``): pupils, gaze on the screen, and the blinks that it found.

::

    7270003   648.9   607.5   151.0   775.1   594.2   236.0  .....   both eyes: x y pupil, twice
    7270005      .       .      0.0   107.1  1440.7   232.0  .C...   the left eye is closed
    7270005   648.9   607.5   151.0  ...                             one eye
    SBLINK L 7270005                                                 a blink begins
    EBLINK L 7270005  7270047  44                                    … and ends: first, last, ms

Times are milliseconds of the tracker's clock, gaze is in pixels of a screen whose distance the file
does not tell: there are no rays, so no fixation. Lines of other kinds are passed over.

Source: SR Research, EyeLink 1000 User Manual 1.5, 4.9 "ASC file format".
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

import numpy as np

from andon.errors import InputError
from andon.files.gaze.model import PupilRecording
from andon.files.gaze.table import MAX_SAMPLES, rising, to_cell
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.paths import open_bounded

__all__ = ["read_eyelink"]

# Warnings of the tracker behind the numbers: one eye, both, and the same with a target on the head.
FLAGS = re.compile(r"[.A-Z]{3}|[.A-Z]{5}|[.A-Z]{13}|[.A-Z]{17}")
ONE_EYE, BOTH_EYES = 4, 7
SECONDS = 1e-3
Eye = Literal["left", "right"]
_EYES: dict[str, Eye] = {"L": "left", "R": "right"}
_UNITS: dict[str, Literal["area", "diameter"]] = {"AREA": "area", "DIAMETER": "diameter"}


def read_eyelink(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> PupilRecording:
    """The samples and blinks of an EyeLink ASC file, or of its samples or events alone.

    Raises
    ------
    InputError
        if a sample or a blink is cut short or no number, eyes come and go, or there is neither
        sample nor blink.
    """
    data = open_bounded(path, limits, max_bytes=limits.max_mesh_text_bytes)
    reading = _Reading(path)
    for number, line in enumerate(data.decode("latin-1").splitlines(), start=1):
        reading.take(line, f"line {number}")
    return reading.recording()


class _Reading:
    """What was read so far."""

    def __init__(self, path: str | Path) -> None:
        self.path = path
        self.samples: list[list[float]] = []
        self.blinks: list[tuple[Eye, float, float]] = []
        self.starts: list[float] = []
        self.unit: Literal["area", "diameter", ""] = ""
        self.eye: Eye = "left"

    def take(self, line: str, place: str) -> None:
        """One line."""
        if line[:1].isdigit():
            self._sample(line.split(), place)
            return
        words = line.split()
        match words[:2]:
            case ["EBLINK", ("L" | "R") as eye]:
                if len(words) != 5:
                    raise self._error("a blink must have a start, an end and a duration", place)
                start, end = (to_cell(word, self.path, place) for word in words[2:4])
                if not start <= end:
                    raise self._error(f"a blink must end after it starts, got {line!r:.60}", place)
                self.blinks.append((_EYES[eye], start, end))
            case ["EBLINK", _] | ["EBLINK"]:
                raise self._error("a blink must name the eye, L or R", place)
            case ["PUPIL", unit] if unit in _UNITS:
                self.unit = _UNITS[unit]
            case ["START", time]:
                self.starts.append(to_cell(time, self.path, place))
                if "LEFT" not in words and "RIGHT" in words:
                    self.eye = "right"
            case _:
                pass

    def _sample(self, words: list[str], place: str) -> None:
        if not words[-1][-1:].isdigit() and FLAGS.fullmatch(words[-1]):
            words = words[:-1]
        width = len(self.samples[0]) if self.samples else len(words)
        if width not in (ONE_EYE, BOTH_EYES) or len(words) != width:
            raise self._error(
                "a sample must have a time and x, y, pupil of one eye or of both, all alike; has "
                f"{len(words)} words",
                place,
            )
        check_at_most(len(self.samples) + 1, MAX_SAMPLES, "samples", self.path)
        self.samples.append([to_cell(word, self.path, place) for word in words])

    def _error(self, rule: str, place: str) -> InputError:
        return InputError(rule, file=self.path, field=place)

    def recording(self) -> PupilRecording:
        """All of it, in seconds from the first sample or blink."""
        width = len(self.samples[0]) if self.samples else ONE_EYE
        table = np.array(self.samples, np.float64).reshape(len(self.samples), width)
        keep, dropped = rising(table[:, 0])
        kept = table[keep]
        if not len(kept) and not self.blinks:
            raise InputError("must have at least one sample or blink", file=self.path)
        # The events of a recording are often in a file of their own: both begin with its START.
        stamps = [*self.starts[:1], *kept[:1, 0].tolist(), *(start for _, start, _ in self.blinks)]
        zero = min(stamp for stamp in stamps if stamp == stamp)
        eyes = np.full((len(kept), 2, 3), np.nan)
        if width == BOTH_EYES:
            eyes[:] = kept[:, 1:].reshape(-1, 2, 3)
        else:
            eyes[:, int(self.eye == "right")] = kept[:, 1:]
        if (eyes[..., 2] < 0).any():
            raise InputError("must be ≥ 0", file=self.path, field="pupil")
        blinks: list[tuple[Eye, float, float]] = [
            (eye, (start - zero) * SECONDS, (end - zero) * SECONDS)
            for eye, start, end in self.blinks
        ]
        times = (kept[:, 0] - zero) * SECONDS
        return PupilRecording(times, eyes[..., :2], eyes[..., 2], self.unit, tuple(blinks), dropped)
