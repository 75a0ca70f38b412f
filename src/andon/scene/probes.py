"""[probes]: light captured at places, for whatever moves between them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from andon.scene.base import (
    Fraction,
    Name,
    NonNegative,
    Positive,
    Reference,
    Table,
    Vector,
    refusal,
)

__all__ = ["Placement", "ProbePlace", "ProbeZone", "Probes"]

ProbeRole = Literal["general", "sky", "bounce", "bleeding"]


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
    role: ProbeRole = Field(
        default="general",
        description="What it is there for: light from the sky (high above), bounced light (near "
        "the ground), colour bleeding (near coloured things).",
    )
    range_m: Positive | None = Field(
        default=None,
        description="Farthest surface captured, metres; what lies beyond is as dark as nothing. "
        "Default: no limit.",
    )
    panorama: Reference | None = Field(
        default=None,
        description="A latlong picture, 2:1, that is captured here instead of the scene.",
    )
    heading_degrees: float = Field(
        default=0.0,
        description="Of a panorama: turns it around +Y, from −Z towards +X.",
    )
    luminance_per_unit: Positive = Field(
        default=1.0,
        description="Of a panorama: cd/m² of its linear value 1. A bake "
        "says where it is not stated.",
    )
    white: tuple[Positive, Positive, Positive] = Field(
        default=(1.0, 1.0, 1.0),
        description="Of a panorama: its linear values of a neutral surface; they are divided out.",
    )

    @model_validator(mode="after")
    def _check_panorama(self) -> ProbePlace:
        if self.panorama is None:
            for key in ("heading_degrees", "luminance_per_unit", "white"):
                if key in self.model_fields_set:
                    raise refusal("is of a panorama, and there is none", key=key)
        return self


class ProbeZone(Table):
    """A box of space whose light comes from the probes in it only; boxes of one name are one."""

    name: Name = Field(description="For probes.zones and messages.")
    low: Vector = Field(description="Corner with the smallest coordinates, metres, world.")
    high: Vector = Field(description="Corner with the largest coordinates, metres, world.")

    @model_validator(mode="after")
    def _check_box(self) -> ProbeZone:
        if not all(low < high for low, high in zip(self.low, self.high, strict=True)):
            raise refusal("must be above low in x, y and z", key="high")
        return self


class Placement(Table):
    """How probes are placed before a bake, beside those of [[probes.place]]."""

    kind: Literal["hand", "nodes", "vertices", "lattice", "random", "automatic"] = Field(
        default="hand",
        description="hand: [[probes.place]] alone; nodes: of a glTF file; vertices: of the "
        "surface; lattice and random: in a box; automatic: pruned lattice, not built yet.",
    )
    file: Reference | None = Field(
        default=None,
        description="Of kind nodes: the glTF file. Nodes whose names begin with `probe` are "
        "probes; `probe_sky…`, `probe_bounce…` and `probe_bleeding…` have that role.",
    )
    low: Vector | None = Field(
        default=None,
        description="Of the box, metres, world; default: the surface's bounds (vertices: none).",
    )
    high: Vector | None = Field(
        default=None,
        description="Of the box, metres, world; default: the surface's bounds (vertices: none).",
    )
    spacing_m: Positive | None = Field(
        default=None,
        description="Of a lattice, metres, about: it is made to fit the box.",
    )
    counts: (
        tuple[
            Annotated[int, Field(ge=1, le=1000)],
            Annotated[int, Field(ge=1, le=1000)],
            Annotated[int, Field(ge=1, le=1000)],
        ]
        | None
    ) = Field(
        default=None,
        description="Of a lattice: probes along x, y and z, instead of spacing_m.",
    )
    count: Annotated[int, Field(ge=1, le=100_000)] = Field(
        default=64,
        description="Of kind random: how many.",
    )
    min_distance_m: NonNegative = Field(
        default=0.0,
        description="Of kinds vertices and random: least distance between probes, metres.",
    )
    offset_m: NonNegative = Field(
        default=0.1,
        description="Of kind vertices: distance from the surface, along its normal, metres. "
        "Lattices and random places leave this much to the walls of their box and to surfaces: "
        "what is nearer is moved away or left out.",
    )
    role: ProbeRole = Field(
        default="general",
        description="Of generated probes.",
    )
    range_m: Positive | None = Field(
        default=None,
        description="Of generated probes: farthest surface captured, metres.",
    )
    error: Positive | None = Field(
        default=None,
        description="Of automatic placement, not built yet: largest relative irradiance error.",
    )

    @model_validator(mode="after")
    def _check_kind(self) -> Placement:
        needed = {
            "nodes": "file",
            "lattice": "spacing_m" if self.counts is None else "counts",
            "automatic": "spacing_m",
        }.get(self.kind)
        if needed is not None and getattr(self, needed) is None:
            raise refusal(f"kind {self.kind!r} needs {needed}", key=needed)
        if self.counts is not None and self.spacing_m is not None:
            raise refusal("counts excludes it", key="spacing_m", remedy="keep one of them")
        return self


class Probes(Table):
    """Light probes.

    They hold the light of the scene as it is when they are baked, E0 with its dimming. Of a
    photographed scene they see what the photograph shows; where no surface is they see surroundings
    of the luminance dimming·E0/π, which alone would give dimming·E0, unless a [[lamp]] is a sky or
    hemisphere. Of surfaces beside the picture they see its mean.
    """

    volume: Reference = Field(
        description="The probe volume, a .glb file: a bake writes it, a frame reads it."
    )
    zones: tuple[Name, ...] = Field(
        default=(),
        description="Zones that are used; default: all.",
    )
    state: Name | None = Field(
        default=None,
        description="State of the volume (day, night) that is baked, or seen; default: its "
        "first, and of a bake `default`. A second one comes from a second scene file with the same "
        "volume, places, zones and order, other lamps and another state (or `andon probes bake "
        "--state`).",
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
    zone: tuple[ProbeZone, ...] = Field(
        default=(),
        description="[[probes.zone]]: boxes that light does not cross. Default: one zone.",
    )
    cube_size_px: Annotated[int, Field(ge=8, le=256)] = Field(
        default=128,
        description="Side of the captured cube maps, 8…256 pixels.",
    )
    encoding: Literal["linear", "srgb8"] = Field(
        default="linear",
        description="Of the captured cube maps. linear: HDR; srgb8: the paper's 8 bits, with "
        "white at capture.luminance_per_unit.",
    )
    solid_angle: Literal["exact", "paper"] = Field(
        default="exact",
        description="Of their texels; paper: its approximation.",
    )
    order: Annotated[int, Field(ge=0, le=4)] = Field(
        default=2,
        description="Highest band of the spherical harmonics, 0…4.",
    )
    bounces: Annotated[int, Field(ge=0, le=16)] = Field(
        default=1,
        description="Times that light is reflected before it is captured; 0: only what emits.",
    )
    bounces_by: Literal["probes", "radiance"] = Field(
        default="probes",
        description="What computes the light of bounces: probes, where each bounce lights surfaces "
        "with the probes of the one before; or radiance, which follows all of them from surface to "
        "surface: slower, without the errors of nine coefficients between a few places.",
    )
    bounces_quality: Literal["draft", "normal", "fine"] = Field(
        default="draft",
        description="Of bounces_by radiance: how exactly it computes, as baked.quality; draft is "
        "about 1 % off what bounces add.",
    )
    visibility: bool = Field(
        default=True,
        description="Walls hide probes behind them.",
    )
    dering: bool = Field(
        default=True,
        description="Each probe is smoothed as little as keeps its irradiance from going negative.",
    )
    lookup: Literal["pixel", "object"] = Field(
        default="pixel",
        description="pixel: light is looked up where each pixel lies; object: once for each "
        "object, at its middle (the paper).",
    )

    @model_validator(mode="after")
    def _check_keys(self) -> Probes:
        if self.bounces_by == "probes" and "bounces_quality" in self.model_fields_set:
            raise refusal('is of bounces_by = "radiance"', key="bounces_quality")
        if self.blend_state is None and self.blend > 0:
            raise refusal("needs blend_state", key="blend")
        return self
