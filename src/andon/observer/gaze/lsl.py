"""Gaze over the network: a stream of the Lab Streaming Layer (LSL), 15 channels.

======== ============================================== =========================
channels what                                           unit
======== ============================================== =========================
0…2      centre of the left eye, x y z                  m
3…5      direction of the left ray                      any length but 0
6…8      centre of the right eye                        m
9…11     direction of the right ray                     any length but 0
12       confidence                                     0…1
13, 14   diameter of the left and the right pupil       mm
======== ============================================== =========================

Both eyes are in one right-handed frame. NaN in an eye's channels says that it is missing; NaN in
the pupils, that they are not measured. The stream has the type ``Gaze``, numbers as its format, and
any rate; its labels, if it has any, are not read.

A thread waits for the network, so that asking for the gaze never does. A stream that goes away is
held, then there is no fixation; the next one that fits is taken up.

LSL listens to the local network and trusts it: whoever is on it can offer a stream of that type.
"""

from __future__ import annotations

import threading
from collections import deque
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.files.gaze import FARTHEST_EYE_M, eye_rays
from andon.observer.gaze.filters import filter_of
from andon.observer.gaze.fixation import fixations
from andon.observer.gaze.smoother import Smoother
from andon.observer.model import GazeRecording, GazeState
from andon.scene.eye import Gaze

__all__ = ["CHANNELS", "STREAM_TYPE", "LslGaze", "recording_of"]

Float = NDArray[np.float64]

CHANNELS = 15
STREAM_TYPE = "Gaze"
RAYS = slice(0, 12)
CONFIDENCE = 12
# How long the thread waits for a sample or a stream before it asks whether it should end.
WAIT_SECONDS = 0.05
# A stream that has not announced itself for as long is gone (LSL asks every half second).
FORGET_STREAM_SECONDS = 3.0
# 8 s at 1000 Hz: what nobody asked for in that time is of no use.
WAITING_SAMPLES = 8192


def recording_of(times_seconds: Float, channels: Float, /) -> GazeRecording:
    """The rays of (n, 15) channels at (n,) rising times; impossible numbers are missing eyes."""
    numbers = np.where(np.abs(channels) <= 1e6, channels, np.nan)
    origins, directions = eye_rays(numbers[:, RAYS])
    far = (np.abs(origins) > FARTHEST_EYE_M).any(axis=-1)
    origins[far], directions[far] = np.nan, np.nan
    confidence = np.clip(np.nan_to_num(numbers[:, CONFIDENCE], nan=0.0), 0.0, 1.0)
    return GazeRecording(times_seconds, origins, directions, confidence)


class LslGaze:
    """The gaze of a stream, from now on: the moment of its making is the session's second 0.

    Attributes
    ----------
    rejected : reason → samples that were no fixation, so far.
    connections, losses : streams taken up, and gone.
    problem : why a stream is not or no longer taken; "" while one is.

    Raises
    ------
    MachineError
        if pylsl or the library that it needs is not there.
    """

    def __init__(self, gaze: Gaze, /) -> None:
        self._lsl = _pylsl()
        self._gaze = gaze
        self._smoother = Smoother(filter_of(gaze), gaze.hold_seconds)
        self._waiting: deque[tuple[float, list[float]]] = deque(maxlen=WAITING_SAMPLES)
        self._start: float = self._lsl.local_clock()
        self.rejected: dict[str, int] = {}
        self.connections = self.losses = 0
        self.problem = ""
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="andon-gaze", daemon=True)
        self._thread.start()

    def __enter__(self) -> LslGaze:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the thread and lets go of the stream."""
        self._stop.set()
        self._thread.join()

    def seconds(self) -> float:
        """Session time now."""
        return float(self._lsl.local_clock()) - self._start

    def at(self, time_seconds: float, /) -> tuple[float | None, GazeState]:
        """Vergence in dioptres and its state, of all that has come in; None: ``fallback``.

        `time_seconds` is session time, as a rule `seconds()`. Never waits.
        """
        samples = [self._waiting.popleft() for _ in range(len(self._waiting))]
        if samples:
            # A clock ahead of ours would make a stream that has gone look alive.
            times = np.minimum([stamp for stamp, _ in samples], self.seconds())
            found = fixations(
                recording_of(times, np.array([values for _, values in samples], np.float64)),
                minimum_confidence=self._gaze.minimum_confidence,
                maximum_gap_degrees=self._gaze.maximum_gap_degrees,
            )
            for time, value in zip(times.tolist(), found.dioptres.tolist(), strict=True):
                self._smoother.push(time, value)
            for reason, count in found.rejected.items():
                self.rejected[reason] = self.rejected.get(reason, 0) + count
        return self._smoother.at(time_seconds)

    # ── the thread ──────────────────────────────────────────────────────────────────────────────

    def _run(self) -> None:
        key, value = ("name", self._gaze.stream) if self._gaze.stream else ("type", STREAM_TYPE)
        resolver = self._lsl.ContinuousResolver(key, value, forget_after=FORGET_STREAM_SECONDS)
        gone: set[str] = set()
        while not self._stop.is_set():
            info = self._fitting(resolver.results(), gone)
            if info is None:
                self._stop.wait(WAIT_SECONDS)
                continue
            try:
                self._listen(info)
            except RuntimeError as error:  # the base of pylsl's LostError and TimeoutError
                gone.add(info.uid())
                self.losses += 1
                self.problem = f"stream {info.name()!r}: {error}"

    def _fitting(self, found: list[Any], gone: set[str]) -> Any | None:
        for info in sorted(found, key=lambda info: (info.name(), info.uid())):
            if info.uid() in gone:
                continue
            if info.channel_count() == CHANNELS and info.channel_format() in (
                self._lsl.cf_float32,
                self._lsl.cf_double64,
            ):
                self.problem = ""
                return info
            self.problem = (
                f"stream {info.name()!r} must have {CHANNELS} channels of float32 or double64, has "
                f"{info.channel_count()}; docs/gaze.md lists them"
            )
        return None

    def _listen(self, info: Any) -> None:
        """Takes samples until the stream is lost (`LostError`) or this is closed."""
        inlet = self._lsl.StreamInlet(
            info, max_buflen=8, recover=False, processing_flags=self._lsl.proc_clocksync
        )
        try:
            inlet.open_stream(timeout=2.0)
            self.connections += 1
            while not self._stop.is_set():
                # A chunk alone would wait for its end; one sample is there at once.
                values, stamp = inlet.pull_sample(timeout=WAIT_SECONDS)
                if stamp is None:
                    continue
                rest, stamps = inlet.pull_chunk(timeout=0.0)
                for row, time in zip([values, *rest], [stamp, *stamps], strict=True):
                    self._waiting.append((float(time) - self._start, row))
        finally:
            inlet.close_stream()


def _pylsl() -> Any:
    try:
        import pylsl
    except (ImportError, RuntimeError) as error:  # the latter: its library is not found
        raise MachineError(
            f"gaze over LSL needs pylsl: {str(error).splitlines()[0]}",
            remedy="pip install andon[gaze]",
        ) from error
    return pylsl
