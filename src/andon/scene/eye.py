"""[observer], [gaze], [atmosphere], [glare] and [display]: the eye and the screen."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from andon.scene.base import Count, Fraction, NonNegative, Positive, Reference, Table, refusal

__all__ = ["Atmosphere", "Display", "Gaze", "Glare", "Observer"]

# A veil begins near its source: light that is scattered fades out from 90° on.
MinimumAngle = Annotated[float, Field(gt=0, le=10)]


class Observer(Table):
    """Whose eyes."""

    age: Annotated[float, Field(ge=0, le=120)] = Field(
        default=25.0,
        description="Years, 0…120.",
    )
    pigment: Annotated[float, Field(ge=0, le=1.2)] = Field(
        default=0.5,
        description="CIE pigmentation: 0 black, 0.5 brown, 1.0 light, 1.2 very light eyes.",
    )
    pupil_mm: Annotated[float, Field(ge=1, le=10)] | None = Field(
        default=None,
        description="Fixed pupil diameter in mm (2…8 in life).",
    )
    pupil_model: Literal["moon-spencer", "watson-yellott"] | None = Field(
        default=None,
        description="Pupil from the adaptation luminance; default: watson-yellott.",
    )
    glasses: Literal["none", "spectacles", "contact-lenses"] = Field(
        default="none",
        description="What is worn; short-sighted lenses add needles to glare.",
    )
    glasses_dioptres: Annotated[float, Field(ge=-30, le=30)] = Field(
        default=0.0,
        description="Power of what is worn, dioptres; negative for short sight.",
    )
    interpupillary_mm: Annotated[float, Field(gt=0, le=100)] = Field(
        default=63.0,
        description="Distance of the pupils in mm.",
    )

    @model_validator(mode="after")
    def _check_pupil(self) -> Observer:
        if self.pupil_mm is not None and self.pupil_model is not None:
            raise refusal("pupil_mm and pupil_model exclude each other", key="pupil_model")
        return self


class Gaze(Table):
    """Where the observer looks."""

    source: Literal[
        "capture", "file", "lsl", "mouse", "openxr", "fixed", "surface", "background"
    ] = Field(
        default="capture",
        description="capture: capture.gaze; fixed: distance_m; surface, background: a layer of "
        "the glass.",
    )
    file: Reference | None = Field(
        default=None,
        description="Recording (CSV) of source file.",
    )
    stream: str | None = Field(
        default=None,
        description="Name of the LSL stream; default: the first gaze.",
    )
    distance_m: Positive | None = Field(
        default=None,
        description="Fixation distance of source fixed, metres.",
    )
    filter: Literal["none", "paper", "one-euro"] = Field(
        default="one-euro",
        description="Smoothing, in dioptres; paper: mean of `samples` in metres.",
    )
    samples: Annotated[int, Field(ge=1, le=1000)] = Field(
        default=20,
        description="Of the mean.",
    )
    minimum_cutoff_hz: Positive = Field(
        default=1.0,
        description="Of one-euro: cutoff at rest, Hz.",
    )
    speed_coefficient: NonNegative = Field(
        default=0.5,
        description="Of one-euro: Hz per dioptre/s.",
    )
    minimum_confidence: Fraction = Field(
        default=0.6,
        description="Samples below this are dropped.",
    )
    maximum_gap_degrees: Positive = Field(
        default=3.0,
        description="Samples whose two rays miss each other by more, seen from the eyes, are "
        "dropped, degrees.",
    )
    hold_seconds: NonNegative = Field(
        default=0.5,
        description="Without a good sample the last fixation is held this long, then the surface "
        "is looked at.",
    )
    chooses: Literal["layer", "distance"] = Field(
        default="layer",
        description="layer: a measured fixation chooses the surface or the background of the "
        "glass, whichever is nearer in dioptres by its straight distance, as if the glass did not "
        "bend light; distance: it is focused on as it is.",
    )
    hysteresis: Fraction = Field(
        default=0.3,
        description="Of the choice: share of the way between both layers that has to be crossed "
        "beyond the middle.",
    )
    response_seconds: NonNegative = Field(
        default=0.25,
        description="Time constant with which the eyes refocus when they look at the other layer; "
        "0: at once.",
    )
    blur: Literal["optical", "gaussian", "paper", "off"] = Field(
        default="optical",
        description="Of the layers that are not looked at. optical: a uniform disc, as in a "
        "defocused eye; gaussian: of the same second moment; paper: the paper's Gaussian on the "
        "background; off: none.",
    )
    defocus: Literal["glass", "frame"] = Field(
        default="glass",
        description="What is out of focus. glass: the layers of glass, where a real eye does the "
        "rest; frame: what is seen beside it too, by its depth.",
    )

    @model_validator(mode="after")
    def _check_source(self) -> Gaze:
        for key in ("file", "distance_m"):
            wanted = {"file": "file", "distance_m": "fixed"}[key]
            if (getattr(self, key) is not None) != (self.source == wanted):
                raise refusal(f"source {wanted!r} needs {key}, others do not take it", key=key)
        return self


class Atmosphere(Table):
    """What is in the air."""

    mist: NonNegative = Field(
        default=0.0,
        description="Relative mist; 0: clear air.",
    )


class Glare(Table):
    """Light scattered in the observer's eye; without this table there is none."""

    model: Literal[
        "cie135",
        "cie146-general",
        "cie146-small-angle",
        "cie146-stiles-holladay",
        "spencer",
        "ijspeert",
        "paper",
        "glow",
    ] = Field(
        default="cie135",
        description="Point-spread function; paper: the paper's own; glow: a Gaussian around "
        "luminous bodies, no eye.",
    )
    renderer: Literal["auto", "per-source", "whole-picture"] = Field(
        default="auto",
        description="per-source: the light of the sources that are found, around each; "
        "whole-picture: all light. auto: whole-picture.",
    )
    highlights: bool = Field(
        default=True,
        description="Highlights of lamps on virtual metal and water have halo and needles, too; "
        "their veil they always have, unless the renderer is per-source.",
    )
    highlight_contrast: Positive = Field(
        default=40.0,
        description="Halo and needles from this luminance ratio to the surround on.",
    )
    halo: bool = Field(
        default=True,
        description="The coloured ring.",
    )
    needles: bool = Field(
        default=True,
        description="Flare needles.",
    )
    adaptation: Literal["auto", "photopic", "mesopic", "scotopic"] = Field(
        default="auto",
        description="Of the eye: whether it sees the ring, and the weights of the model spencer; "
        "auto: by the mean luminance of the photograph.",
    )
    minimum_angle_degrees: MinimumAngle = Field(
        default=0.1,
        description="Light scattered by less than this stays where it is, degrees.",
    )
    glow_sigma_degrees: Positive | None = Field(
        default=None,
        description="Of the model glow: σ in degrees; default: as much as cie135 within 1°.",
    )
    glow_fraction: Fraction | None = Field(
        default=None,
        description="Of the model glow: share of the bodies' light that is scattered, 1 as in the "
        "paper; default: what cie135 scatters by more than minimum_angle_degrees (0.32 at 25 "
        "years).",
    )
    seed: Count | None = Field(
        default=None,
        description="Pattern of needles; default: from scene.seed.",
    )

    @model_validator(mode="after")
    def _check_glow(self) -> Glare:
        for key in ("glow_sigma_degrees", "glow_fraction"):
            if getattr(self, key) is not None and self.model != "glow":
                raise refusal("belongs to model 'glow'", key=key, remedy="remove it")
        return self


class Display(Table):
    """From luminance to the screen."""

    mode: Literal["vst", "ost"] = Field(
        default="vst",
        description="vst: video see-through; ost: optical, adds light to what is seen.",
    )
    exposure: Positive | None = Field(
        default=None,
        description="Linear screen value per cd/m². Default: 1/capture.luminance_per_unit, which "
        "gives light that was not changed its own bytes back.",
    )
    tone: Literal["none", "hue", "reinhard", "fusion"] = Field(
        default="none",
        description="none: clips each channel, as a camera does; hue: what is brighter than white "
        "fades to white and keeps its hue (lamps); reinhard: compresses; fusion: Mertens exposure "
        "fusion of what five neutral filters from 100 to 6.25 % would show.",
    )
    peak_luminance_cd_m2: Positive | None = Field(
        default=None,
        description="cd/m² of screen value 1; needed where mode is ost.",
    )
    transmittance: Fraction = Field(
        default=1.0,
        description="τ of an optical see-through display: share of real light that passes.",
    )
    compensation: bool = Field(
        default=True,
        description="Of mode ost. true: takes the real light into account that passes; false: "
        "shows what is virtual as it is, so that the room shines through it.",
    )
    dither: bool = Field(
        default=False,
        description="Against banding, where light was added to the darks of 8-bit pictures: each "
        "captured value lies elsewhere in its step, by its surroundings and by noise. What was not "
        "changed keeps its bytes.",
    )

    @model_validator(mode="after")
    def _check_peak(self) -> Display:
        if self.mode == "ost" and self.peak_luminance_cd_m2 is None:
            raise refusal(
                "mode 'ost' needs it",
                key="peak_luminance_cd_m2",
                remedy="state the luminance of the display's white in cd/m²",
            )
        return self
