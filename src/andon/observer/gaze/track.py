"""A recording as the gaze of a session: what was known at each moment."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from andon.files.gaze import read_gaze
from andon.observer.gaze.filters import filter_of
from andon.observer.gaze.fixation import fixations
from andon.observer.gaze.smoother import Smoothed, smoothed
from andon.observer.model import DistanceRecording, Fixation, GazeRecording, GazeState
from andon.scene.eye import Gaze

__all__ = ["GazeTrack", "load_track"]


@dataclass(frozen=True, eq=False)
class GazeTrack:
    """Playback of a recording: causal, so that the picture is what a live one would have been.

    The recording's first sample is the session's second 0. It is neither clamped nor repeated:
    after its end the last fixation is held, then there is none.

    Attributes
    ----------
    fixation : of each sample, with counts of what was rejected.
    series : the same, smoothed.
    """

    fixation: Fixation
    series: Smoothed

    @classmethod
    def of(cls, recording: GazeRecording | DistanceRecording, gaze: Gaze, /) -> GazeTrack:
        """The track of a recording with the limits and the filter of [gaze]."""
        found = fixations(
            recording,
            minimum_confidence=gaze.minimum_confidence,
            maximum_gap_degrees=gaze.maximum_gap_degrees,
        )
        series = smoothed(
            found.times_seconds, found.dioptres, filter_of(gaze), hold_seconds=gaze.hold_seconds
        )
        return cls(found, series)

    def at(self, time_seconds: float, /) -> tuple[float | None, GazeState]:
        """Vergence in dioptres and its state, of the samples up to `time_seconds`; None where the
        state is ``fallback``.
        """
        return self.series.at(time_seconds)


def load_track(path: str | Path, gaze: Gaze, /) -> GazeTrack:
    """The track of a recorded file (`andon.files.read_gaze`). Raises `InputError`."""
    return GazeTrack.of(read_gaze(path), gaze)
