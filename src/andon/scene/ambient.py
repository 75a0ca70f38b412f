"""[ambient], [baked] and [probes]: light that is already there."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from andon.scene.base import (
    Fraction,
    Name,
    NonNegativeTriple,
    Positive,
    PositiveTriple,
    Reference,
    Table,
    Vector,
    exactly_one,
    refusal,
)
from andon.scene.lamp import AnyLamp

__all__ = ["Ambient", "Baked", "Placement", "ProbePlace", "Probes"]


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


class ProbePlace(Table):
    """A probe placed by hand."""

    name: Name = Field(
        default="probe",
        description="For messages.",
    )
    position: Vector = Field(description="Where it counts, metres, world.")
    capture_position: Vector | None = Field(
        default=None,
        description="Where it is captured, metres; default: its position.",
    )
    role: Literal["general", "sky", "bounce", "bleeding"] = Field(
        default="general",
        description="What it is there for.",
    )
    range_m: Positive | None = Field(
        default=None,
        description="Farthest surface captured, metres.",
    )


class Placement(Table):
    """How probes are placed before a bake."""

    kind: Literal["hand", "nodes", "vertices", "lattice", "panoramas", "automatic"] = Field(
        default="hand",
        description="hand: [[probes.place]]; nodes: of a glTF file; automatic: pruned lattice.",
    )
    file: Reference | None = Field(
        default=None,
        description="glTF of the nodes, or list of panoramas.",
    )
    spacing_m: Positive | None = Field(
        default=None,
        description="Of a lattice, metres.",
    )
    error: Positive | None = Field(
        default=None,
        description="Of automatic placement: largest relative irradiance error.",
    )


class Probes(Table):
    """Light probes."""

    volume: Reference = Field(description="The probe volume: a bake writes it, a frame reads it.")
    zones: tuple[Name, ...] = Field(
        default=(),
        description="Zones that are used; default: all.",
    )
    state: Name | None = Field(
        default=None,
        description="State of the volume (day, night); default: its first.",
    )
    blend_state: Name | None = Field(
        default=None,
        description="A second state that is mixed in.",
    )
    blend: Fraction = Field(
        default=0.0,
        description="0: state … 1: blend_state.",
    )
    placement: Placement = Field(
        default=Placement(),
        description="Where probes go.",
    )
    place: tuple[ProbePlace, ...] = Field(
        default=(),
        description="[[probes.place]]: placed by hand.",
    )
    cube_size_px: Annotated[int, Field(ge=8, le=256)] = Field(
        default=128,
        description="Side of the captured cube maps, 8…256 pixels.",
    )
    order: Annotated[int, Field(ge=0, le=4)] = Field(
        default=2,
        description="Highest band of the spherical harmonics, 0…4.",
    )
    bounces: Annotated[int, Field(ge=0, le=16)] = Field(
        default=1,
        description="Times that light is reflected.",
    )
    visibility: bool = Field(
        default=True,
        description="Walls hide probes behind them.",
    )
