"""The accuracy rows: what is claimed, how it is measured, what it is held against."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Literal

__all__ = ["STAGES", "NotShown", "Row", "rows"]

Stage = Literal["relight", "probes", "glass", "glare", "baked", "live", "web"]
STAGES: tuple[Stage, ...] = ("relight", "probes", "glass", "glare", "baked", "live", "web")


class NotShown(Exception):
    """What a row needs is not on this machine; the message says what, and what installs it."""


@dataclass(frozen=True)
class Row:
    """One claim.

    Attributes
    ----------
    name : ``stage.what.engine``, unique.
    stage : part of the frame.
    bar : the figure must be at most this (or at least, where `at_least`); None is published only.
    unit : of figure and bar.
    against : the truth that it is held against.
    measure : returns the figure; raises `NotShown` where something is missing.
    """

    name: str
    stage: Stage
    bar: float | None
    unit: str
    against: str
    measure: Callable[[], float]
    at_least: bool = False

    def holds(self, figure: float) -> bool | None:
        """Whether `figure` meets the bar; None where there is no bar."""
        if self.bar is None:
            return None
        return figure >= self.bar if self.at_least else figure <= self.bar


# Modules of `andon.verify.rows`, stage by stage.
IN_ORDER = (
    "relight",
    "areas",
    "area_scene",
    "penumbra",
    "synthetic",
    "confidence",
    "lamp_on",
    "photographs",
    "lampshade",
    "photometry",
    "responses",
    "ambient",
    "probe_capture",
    "probe_bounces",
    "harmonics",
    "probe_light",
    "probe_space",
    "baked",
    "baked_projection",
    "baked_quality",
    "gaze",
    "glass",
    "glass_blur",
    "glass_frame",
    "caustic",
    "glare_flicker",
    "glare_frame",
    "glare_picture",
    "glare_whole",
    "glare_sources",
    "glare_highlights",
    "glare_models",
    "glare_needles",
    "glare_numbers",
)


def rows() -> tuple[Row, ...]:
    """All rows, stage by stage."""
    modules = (import_module(f"andon.verify.rows.{name}") for name in IN_ORDER)
    return tuple(row for module in modules for row in module.ROWS)
