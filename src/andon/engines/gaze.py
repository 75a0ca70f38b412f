"""What the eyes of a scene's observer are focused on, over time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from andon.errors import InputError
from andon.glass.focus import LayerVergences, focus_on
from andon.glass.model import Blur, Focus
from andon.observer.accommodation import accommodation_dioptres
from andon.observer.gaze import GazeTrack, LayerChoice, LslGaze, MouseGaze, Refocusing, load_track
from andon.observer.model import GazeState
from andon.scene import Scene
from andon.scene.eye import Gaze

__all__ = ["GazeSource", "SceneGaze", "gaze_of"]


class GazeSource(Protocol):
    """Says where somebody looks."""

    def at(self, time_seconds: float, /) -> tuple[float | None, GazeState]:
        """Vergence in dioptres, None where there is none, and how it is known."""
        ...


@dataclass(eq=False)
class SceneGaze:
    """Where the observer of a scene looks, as a focus.

    Attributes
    ----------
    table : [gaze].
    blur : of the layers.
    vergences : of the layers.
    limit_dioptres : the nearest that the eyes can focus on.
    source : what measures; None where the scene states what is looked at.
    """

    table: Gaze
    blur: Blur
    vergences: LayerVergences
    limit_dioptres: float
    source: GazeSource | None = None
    _choice: LayerChoice = field(init=False)
    _refocusing: Refocusing = field(init=False)

    def __post_init__(self) -> None:
        self._choice = LayerChoice(self.table.hysteresis)
        self._refocusing = Refocusing(self.table.response_seconds)

    def focus(self, time_seconds: float, /) -> Focus:
        """What is in focus at a time."""
        table = self.table
        if table.source in ("surface", "background"):
            return self._on(table.source)
        if table.distance_m is not None:
            return self._at(1 / table.distance_m, "seen")
        if self.source is None:
            return self._on("surface", "fallback")
        dioptres, state = self.source.at(time_seconds)
        if table.chooses == "distance" and dioptres is not None:
            return self._at(dioptres, state)
        layer = "surface" if dioptres is None else self._layer(time_seconds, dioptres)
        wanted = self._on(layer, state)
        return replace(wanted, dioptres=self._followed(time_seconds, wanted.dioptres))

    @property
    def pointer(self) -> MouseGaze | None:
        """What takes a pointer; None where something else says where the eyes look."""
        return self.source if isinstance(self.source, MouseGaze) else None

    def close(self) -> None:
        """Ends a thread that listens; after it there is no gaze."""
        if isinstance(self.source, LslGaze):
            self.source.close()
            self.source = None

    def _on(self, layer: str, state: GazeState = "seen") -> Focus:
        return focus_on(layer, self.vergences, self.blur, self.limit_dioptres, state)

    def _at(self, dioptres: float, state: GazeState) -> Focus:
        if self.blur == "paper":
            return Focus(dioptres, "distance", state)
        reached = float(np.clip(dioptres, 0, self.limit_dioptres))
        return Focus(reached, "distance", state, clamped=reached != dioptres)

    def _layer(self, time_seconds: float, dioptres: float) -> str:
        """By the distances that the layers really have: gaze is measured towards those."""
        if isinstance(self.source, GazeTrack):
            return self._recorded(self.source, time_seconds)
        straight = self.vergences.surface, self.vergences.background_straight
        return self._choice.update(dioptres, *straight)

    def _recorded(self, track: GazeTrack, time_seconds: float) -> str:
        """The same for any order of times: what the samples up to then have led to."""
        times = track.series.times_seconds
        index = int(np.searchsorted(times, time_seconds, side="right")) - 1
        return self._recorded_layers[max(index, 0)]

    def _followed(self, time_seconds: float, wanted: float) -> float:
        """Where the focus is on its way to what is wanted, in dioptres."""
        if isinstance(self.source, GazeTrack):
            return self._recorded_focus.at(time_seconds)
        self._refocusing.look(time_seconds, wanted)
        return self._refocusing.at(time_seconds)

    @cached_property
    def _recorded_focus(self) -> Refocusing:
        """Of the layers of the recording, with the surface where there is no gaze."""
        assert isinstance(self.source, GazeTrack)
        times = self.source.series.times_seconds.tolist()
        layers = zip(times, self._recorded_layers, strict=True)
        wanted = ((time, self._on(layer).dioptres) for time, layer in layers)
        return Refocusing(self.table.response_seconds, wanted)

    @cached_property
    def _recorded_layers(self) -> tuple[str, ...]:
        """The layer after each sample of the recording."""
        assert isinstance(self.source, GazeTrack)
        choice = LayerChoice(self.table.hysteresis)
        straight = self.vergences.surface, self.vergences.background_straight
        series = self.source.series
        return tuple(
            choice.update(self.source.at(float(time))[0], *straight)
            for time in series.times_seconds
        )


def gaze_of(scene: Scene, table: Gaze, blur: Blur, vergences: LayerVergences, /) -> SceneGaze:
    """Where the observer of `scene` looks. Raises `InputError` for what cannot be read."""
    return SceneGaze(
        table,
        blur,
        vergences,
        accommodation_dioptres(scene.observer.age),
        _source_of(scene, table),
    )


def _source_of(scene: Scene, table: Gaze) -> GazeSource | None:
    match table.source:
        case "file":
            assert table.file is not None  # the schema asks for it
            return load_track(scene.path(table.file, "gaze.file"), table)
        case "capture":
            recorded = scene.capture.gaze if scene.capture is not None else None
            if recorded is None:
                raise InputError(
                    "is missing: gaze.source is 'capture'",
                    file=scene.file,
                    field="capture.gaze",
                    remedy="name a recording there, or state gaze.source",
                )
            return load_track(scene.path(recorded, "capture.gaze"), table)
        case "lsl":
            return LslGaze(table)
        case "mouse":
            return MouseGaze(table)
        case "openxr":
            raise InputError(
                "'openxr' is in the schema but not built yet",
                file=scene.file,
                field="gaze.source",
                remedy="use file, lsl, mouse, fixed, surface or background",
            )
        case _:
            return None
