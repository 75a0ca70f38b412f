"""[ambient] and [baked]: light that is already there."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from andon.scene.base import (
    Name,
    NonNegativeTriple,
    Positive,
    PositiveTriple,
    Reference,
    Table,
    exactly_one,
    refusal,
)
from andon.scene.lamp import AnyLamp

__all__ = ["Ambient", "Baked"]


class Ambient(Table):
    """E0, the light in which the pictures were taken."""

    illuminance_lux: PositiveTriple | None = Field(
        default=None,
        description="E0 in lx, the same everywhere: a number or three channels, > 0.",
    )
    map: Reference | None = Field(
        default=None,
        description="EXR of E0 in lx for each pixel of the view.",
    )
    probes: bool = Field(
        default=False,
        description="E0 from the light probes of [probes].",
    )
    dimming: NonNegativeTriple = Field(
        default=(1.0, 1.0, 1.0),
        description="Factor on E0 in the result, number or three; 1: unchanged.",
    )
    dimming_mode: Literal["linear", "paper"] = Field(
        default="linear",
        description="linear: dimming scales light; paper: it scales encoded RGB (not physical).",
    )
    source: tuple[AnyLamp, ...] = Field(
        default=(),
        description="[[ambient.source]]: real lamps and windows that are part of E0, as [[lamp]]: "
        "virtual things take away what they hide of it. Where there are such, each costs two of "
        "the 64 lamps.",
    )
    removed: tuple[Name, ...] = Field(
        default=(),
        description="Names of sources that are switched off in the result: their light is taken "
        "out of E0, with its shadows among the real things. Such a source costs one lamp.",
    )

    @model_validator(mode="after")
    def _check_ambient(self) -> Ambient:
        exactly_one(self, "illuminance_lux", "map", "probes")
        names = {source.name for source in self.source}
        for index, name in enumerate(self.removed):
            if name not in names:
                raise refusal(f"there is no source {name!r}", key=f"removed[{index}]")
        return self


class Baked(Table):
    """Precomputed illuminance maps."""

    folder: Reference = Field(description="Folder of the maps.")
    lamps: tuple[Name, ...] = Field(
        default=(),
        description="Names of the lamps that are in the maps.",
    )
    depth_tolerance_m: Positive = Field(
        default=0.02,
        description="A map is valid where its depth differs by less than this, metres.",
    )
