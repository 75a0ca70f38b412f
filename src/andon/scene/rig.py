"""[scene] and [rig]: the session, and who looks."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from andon.scene.base import Count, NonNegative, Positive, Reference, Table, refusal
from andon.scene.camera import Camera

__all__ = ["About", "Rig", "Trajectory"]

METRES_PER_UNIT = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}


class About(Table):
    """The session as a whole."""

    name: str = Field(
        default="scene",
        description="Title for reports.",
    )
    photometry: Literal["absolute", "relative"] = Field(
        default="absolute",
        description="Whether lux and cd/m² are absolute, or relative to the light of the "
        "photograph; every number that leaves the program carries this word.",
    )
    unit: Literal["m", "cm", "mm", "in", "ft"] = Field(
        default="m",
        description="Unit of mesh files that do not say (OBJ); the scene file is in metres.",
    )
    up: Literal["y", "z"] = Field(
        default="y",
        description="Up axis of mesh files that do not say (OBJ).",
    )
    seed: Count = Field(
        default=0,
        description="Seed from which every random stream is derived.",
    )
    duration_seconds: NonNegative = Field(
        default=0.0,
        description="Length in seconds; 0 is a still.",
    )
    frames_per_second: Positive = Field(
        default=30.0,
        description="Frames per second of a sequence.",
    )

    @property
    def metres_per_unit(self) -> float:
        """Metres in one `unit`."""
        return METRES_PER_UNIT[self.unit]


class Trajectory(Table):
    """Poses of the rig over time."""

    file: Reference = Field(description="Trajectory file.")
    format: Literal["tum"] = Field(
        default="tum",
        description="tum: lines of time_seconds tx ty tz qx qy qz qw, world_from_rig.",
    )
    time_offset_seconds: float = Field(
        default=0.0,
        description="Added to the file's times to get session time, seconds.",
    )


class Rig(Table):
    """One camera or two eyes."""

    kind: Literal["mono", "stereo"] = Field(
        default="mono",
        description="One view or two.",
    )
    camera: Camera | None = Field(
        default=None,
        description="The camera of a mono rig. Of a stereo rig: the point between both eyes, which "
        "look in parallel, observer.interpupillary_mm apart; instead of left and right.",
    )
    left: Camera | None = Field(
        default=None,
        description="The left eye of a stereo rig.",
    )
    right: Camera | None = Field(
        default=None,
        description="The right eye of a stereo rig.",
    )
    trajectory: Trajectory | None = Field(
        default=None,
        description="Poses over time.",
    )

    @model_validator(mode="after")
    def _check_eyes(self) -> Rig:
        if self.kind == "mono" or self.camera is not None:
            for key in ("left", "right"):
                if getattr(self, key) is not None:
                    raise _refused_eye(self.kind, key)
        else:
            for key in ("left", "right"):
                if getattr(self, key) is None:
                    raise refusal(
                        "a stereo rig needs both eyes", key=key, remedy=f"add [rig.{key}]"
                    )
        return self

    @property
    def cameras(self) -> tuple[tuple[str, Camera], ...]:
        """(name of the view, camera): mono, or left and right; empty where none is stated.

        Both eyes of a stereo rig that states one camera have it; `andon.engines.reading.view_of`
        puts them apart.
        """
        if self.kind == "stereo" and self.camera is not None:
            return (("left", self.camera), ("right", self.camera))
        named = (("mono", self.camera), ("left", self.left), ("right", self.right))
        return tuple((name, camera) for name, camera in named if camera is not None)


def _refused_eye(kind: str, key: str) -> Exception:
    if kind == "mono":
        return refusal(f"a mono rig has no {key}", key=key, remedy="change rig.kind")
    remedy = "state [rig.camera], or [rig.left] and [rig.right]"
    return refusal(f"{key} and camera exclude each other", key=key, remedy=remedy)
