"""Small recordings of gaze as text, for tests of readers and of what is made of them."""

from __future__ import annotations

import numpy as np

from andon.files.gaze import OWN_COLUMNS
from andon.files.gaze.tables import PUPIL_COLUMNS

__all__ = ["EYELINK", "looking_at", "own_gaze", "pupil_gaze"]

EYES_M = np.array([[-0.0315, 0.0, 0.0], [0.0315, 0.0, 0.0]])

EYELINK = """** CONVERTED FROM a.edf
MSG\t90 DISPLAY_COORDS = 0 0 1279 1023
START\t100 \tLEFT\tRIGHT\tEVENTS
PUPIL\tAREA
100\t  655.6\t  599.9\t 1121.0\t  773.1\t  594.2\t  949.0\t.....
102\t  655.7\t  598.9\t 1122.0\t  773.8\t  593.9\t  951.0\t.....
SBLINK L 104
104\t   .\t   .\t    0.0\t   .\t   .\t    0.0\t.C.C.
106\t   .\t   .\t    0.0\t   .\t   .\t    0.0\t.C.C.
EBLINK L 104\t106\t4
108\t  655.7\t  598.9\t 1120.0\t  773.8\t  593.9\t  955.0\t.....
"""


def looking_at(points, eyes_m=EYES_M):
    """(n, 2, 3) unit directions of both eyes at (n, 3) points."""
    rays = np.asarray(points, float)[:, None] - eyes_m
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def _text(header, rows):
    cells = [",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in rows]
    return "\n".join([",".join(header), *cells]) + "\n"


def _rows(times, directions, confidence, unit):
    count = len(times)
    origins = np.broadcast_to(EYES_M / unit, (count, 2, 3))
    rays = np.stack([origins, directions], axis=2).reshape(count, 12)
    return np.column_stack([times, np.broadcast_to(confidence, count), rays])


def own_gaze(times=(0.0, 0.04, 0.08), directions=None, confidence=1.0):
    """Our own CSV with rays; everybody looks at 1 m by default."""
    if directions is None:
        directions = looking_at([(0.0, 0.0, 1.0)] * len(times))
    header = ("time_seconds", "confidence", *OWN_COLUMNS)
    return _text(header, _rows(times, directions, confidence, 1.0))


def pupil_gaze(times, directions, confidence=1.0):
    """A 3-D export of Pupil Labs Core: the same rays in millimetres."""
    header = ("gaze_timestamp", "confidence", *PUPIL_COLUMNS)
    return _text(header, _rows(times, directions, confidence, 1e-3))
