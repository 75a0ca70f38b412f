"""[ambient] and [baked]: light that is already there."""

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
    exactly_one,
    refusal,
)
from andon.scene.camera import Camera
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
    harmonics: Reference | None = Field(
        default=None,
        description="E0 from an estimate of the light that arrives: JSON with coefficients_cd_m2, "
        "9 spherical-harmonic coefficients of luminance of three channels each, world axes "
        "(CONVENTIONS.md), or a LightProbe of three.js (andon probes export --format three); E0 is "
        "the irradiance at each pixel's normal.",
    )
    rest_lux: PositiveTriple | None = Field(
        default=None,
        description="E0 in lx without the sources, > 0: E0 of a pixel is this plus what every "
        "[[ambient.source]] gives it, shadows of the real surfaces included.",
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
        exactly_one(self, "illuminance_lux", "map", "probes", "harmonics", "rest_lux")
        if self.rest_lux is not None and not self.source:
            raise refusal(
                "is the light beside the known sources, and none is stated",
                key="rest_lux",
                remedy="add [[ambient.source]], or state illuminance_lux",
            )
        names = {source.name for source in self.source}
        for index, name in enumerate(self.removed):
            if name not in names:
                raise refusal(f"there is no source {name!r}", key=f"removed[{index}]")
        return self


class Baked(Table):
    """Illuminance maps that `andon bake` computes with Radiance, and frames add to what lamps give.

    A lamp of transport ``baked`` is in them with all its light, one of ``direct+bounce`` with what
    surfaces reflect of it.
    """

    folder: Reference = Field(description="Folder of the maps; `andon bake` makes it.")
    lamps: tuple[Name, ...] = Field(
        default=(),
        description="Names of the lamps that are in the maps.",
    )
    depth_tolerance_m: Positive = Field(
        default=0.02,
        description="A map is valid where its surface is less than this off the point's, metres.",
    )
    mode: Literal["blend", "first_valid"] = Field(
        default="blend",
        description="Where several maps see a point: blend them by angle and distance, or take the "
        "first one, in the order of the cameras (as in the paper).",
    )
    camera: tuple[Camera, ...] = Field(
        default=(),
        description="[[baked.camera]]: where maps are seen from, as [rig.camera], with width and "
        "height; default: cameras that together see the surface are found.",
    )
    coverage: Fraction = Field(
        default=0.99,
        description="Share of the visible surface that cameras that are found shall see, 0…1.",
    )
    most_cameras: Annotated[int, Field(ge=1, le=64)] = Field(
        default=12,
        description="No more cameras than this are found.",
    )
    map_size_px: Annotated[int, Field(ge=16, le=4096)] = Field(
        default=384,
        description="Pixels along the longer side of the maps of cameras that are found.",
    )
    quality: Literal["draft", "normal", "fine"] = Field(
        default="normal",
        description="How exactly Radiance computes; `andon bake --help` has errors and times.",
    )
    bounces: Annotated[int, Field(ge=0, le=16)] = Field(
        default=4,
        description="How often light is reflected (Radiance's -ab).",
    )
    frames_per_second: Positive | None = Field(
        default=None,
        description="Maps per second of a scene in which something moves; between them light is "
        "interpolated. Default: scene.frames_per_second.",
    )
    include: tuple[Reference, ...] = Field(
        default=(),
        description="Radiance files (.rad) of things that are in the bake alone; metres, +Y up. "
        "Files that they name come along. Those that emit light are refused: state a [[lamp]]. "
        "Lines that start programs (!) are refused unless `andon bake --trust`; then these run "
        "once, on the machine where the bake was started, and workers get what they print.",
    )

    @model_validator(mode="after")
    def _check_cameras(self) -> Baked:
        for index, camera in enumerate(self.camera):
            if camera.file is None and (camera.width is None or camera.height is None):
                raise refusal(
                    "a map has no picture whose size it could take",
                    key=f"camera[{index}]",
                    remedy="state width and height",
                )
        return self
