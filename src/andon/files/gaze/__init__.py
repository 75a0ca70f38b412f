"""Recordings of where somebody looks.

=================== ======== ==================================================================
reader              suffix   holds
=================== ======== ==================================================================
`read_gaze_table`   ``.csv`` eye rays (Pupil Labs Core's 3-D export, or ours) or distances
`read_eyelink`      ``.asc`` pupils, blinks, gaze on a screen: no rays
=================== ======== ==================================================================

The columns, their units and axes are in ``docs/gaze.md``. Times become seconds from the first
sample; a row that repeats or goes back in time is no sample, and is counted.
"""

from __future__ import annotations

from pathlib import Path

from andon.errors import InputError
from andon.files.gaze.eyelink import read_eyelink
from andon.files.gaze.model import DistanceRecording, GazeRecording, PupilRecording
from andon.files.gaze.tables import FARTHEST_EYE_M, OWN_COLUMNS, eye_rays, read_gaze_table
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.reader import Reader, choose_reader

__all__ = [
    "FARTHEST_EYE_M",
    "GAZE_READERS",
    "OWN_COLUMNS",
    "DistanceRecording",
    "GazeRecording",
    "PupilRecording",
    "eye_rays",
    "read_eyelink",
    "read_gaze",
    "read_gaze_table",
]

GAZE_READERS = (
    Reader("gaze.csv", (".csv",), read_gaze_table),
    Reader("gaze.eyelink", (".asc",), read_eyelink),
)


def read_gaze(
    path: str | Path, *, limits: Limits = DEFAULT_LIMITS
) -> GazeRecording | DistanceRecording:
    """The eye rays or distances of a recording, by its suffix and its columns.

    Raises
    ------
    InputError
        as the readers do, and if the recording tells neither rays nor a distance.
    """
    found = choose_reader(path, GAZE_READERS, "gaze recording").read(path, limits=limits)
    if isinstance(found, PupilRecording):
        raise InputError(
            "tells where on a screen each eye looks, not how far away",
            file=path,
            remedy="give a recording with two eye rays or a distance: docs/gaze.md",
        )
    return found
