"""Tables inside [[lamp]]: keyframes, the shell of a luminous body, flicker."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from andon.scene.base import (
    Fraction,
    FractionTriple,
    NonNegative,
    Positive,
    Reference,
    Table,
    Vector,
    refusal,
)
from andon.scene.geometry import Direction

__all__ = ["Drum", "Flicker", "LampKey", "Shell"]


class LampKey(Table):
    """One keyframe of a lamp. Between keys, values run linearly; outside, they stay."""

    time_seconds: float = Field(description="Session time of the key in seconds.")
    position: Vector | None = Field(
        default=None,
        description="Position in metres, world.",
    )
    direction: Direction | None = Field(
        default=None,
        description="Direction, world; turns along the great circle between keys.",
    )
    intensity_cd: NonNegative | None = Field(
        default=None,
        description="Luminous intensity in cd.",
    )
    flux_lm: NonNegative | None = Field(
        default=None,
        description="Luminous flux in lm.",
    )
    luminance_cd_m2: NonNegative | None = Field(
        default=None,
        description="Luminance in cd/m².",
    )
    illuminance_lux: NonNegative | None = Field(
        default=None,
        description="Illuminance in lx.",
    )
    temperature_k: Annotated[float, Field(ge=1000, le=40000)] | None = Field(
        default=None,
        description="Colour temperature in K, 1000…40000.",
    )

    @property
    def animated(self) -> tuple[str, ...]:
        """Names of the quantities that this key sets."""
        names = (name for name in LampKey.model_fields if name != "time_seconds")
        return tuple(name for name in names if getattr(self, name) is not None)


class Drum(Table):
    """The common lampshade: a cylinder or a cone, open above and below, its axis upright."""

    radius_m: Positive = Field(
        description="Radius of the lower rim in metres.",
    )
    top_radius_m: Positive | None = Field(
        default=None,
        description="Radius of the upper rim in metres; default: the lower one's.",
    )
    height_m: Positive = Field(
        description="From rim to rim, upright, in metres.",
    )
    drop_m: Positive | None = Field(
        default=None,
        description="How far the lower rim is below the lamp, metres, less than height_m; "
        "default: half the height.",
    )

    @model_validator(mode="after")
    def _around_the_lamp(self) -> Drum:
        if self.drop_m is not None and not self.drop_m < self.height_m:
            raise refusal(
                f"must be < height_m, {self.height_m:g} m, got {self.drop_m:g}",
                key="drop_m",
                remedy="the lamp is inside its shade",
            )
        return self


class Shell(Table):
    """The translucent shell of a luminous body: lit from inside, it emits outside.

    It moves with its lamp. The lamp is inside it.
    """

    radius_m: Positive | None = Field(
        default=None,
        description="Radius in metres of a spherical shell around the lamp.",
    )
    mesh: Reference | None = Field(
        default=None,
        description="Mesh file of a shell of any other form: one layer of triangles; its origin "
        "is where the lamp is. What its rims leave free are openings.",
    )
    drum: Drum | None = Field(
        default=None,
        description="A drum or cone, open above and below, around the lamp.",
    )
    transmittance: FractionTriple = Field(
        default=(0.5, 0.5, 0.5),
        description="Net diffuse transmittance t in [0, 1]: share of the light that meets the "
        "shell and leaves through it, interreflection included; one number or three channels.",
    )
    absorptance: Fraction = Field(
        default=0.0,
        description="Share of that light that an open shell takes, [0, 1]; 1 − t at most. The "
        "rest leaves through the openings; a closed shell takes all that it does not let through.",
    )
    real: bool = Field(
        default=False,
        description="The shell is a real thing of the photograph, unlit there: its own light is "
        "added to its pixels instead of hiding them, and the real surface at its place hides no "
        "light of this lamp. It stands still.",
    )
    margin_m: Positive | None = Field(
        default=None,
        description="Of a real shell: what of the real surface is nearer to it than this is the "
        "shell; what is inside it or nearer than twice this hides no light of its lamp. Default: "
        "0.04 m, or the lift of shadows (twice the error of decimated and noisy geometry), if that "
        "is more.",
    )
    mode: Literal["exact", "paper"] = Field(
        default="exact",
        description="exact: area lamps and an energy balance; paper: a point lamp of t × the "
        "intensity shines through the shell, and what is left through its openings.",
    )

    @model_validator(mode="after")
    def _one_form(self) -> Shell:
        if sum(form is not None for form in (self.radius_m, self.mesh, self.drum)) != 1:
            raise refusal("exactly one of radius_m, mesh, drum is allowed")
        if self.margin_m is not None and not self.real:
            raise refusal(
                "belongs to real shells",
                key="margin_m",
                remedy="state real = true, or leave it out",
            )
        if self.absorptance + max(self.transmittance) > 1 + 1e-9:
            raise refusal("absorptance + transmittance must be ≤ 1", key="absorptance")
        return self


class Flicker(Table):
    """Irregular brightness S(t) of mean 1: candles, sun through leaves."""

    exponent: Annotated[float, Field(gt=1, lt=2)] = Field(
        default=1.8,
        description="z of the intermittent map S ← S + S^z mod 1, 1…2; 1/f-like above 1.5.",
    )
    steps_per_second: Positive = Field(
        default=30.0,
        description="Iterations of the map per second.",
    )
    amount: Fraction = Field(
        default=1.0,
        description="0 steady … 1 the full swing of S: long all but dark, up to 5 times the mean.",
    )
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = Field(
        default=None,
        description="Lamps of one seed flicker together; default: each by itself, after "
        "scene.seed and its name.",
    )
    gaps: Annotated[int, Field(ge=1, le=100_000)] = Field(
        default=1,
        description="Independent flickers whose mean is taken (gaps between leaves).",
    )
    mask: Reference | None = Field(
        default=None,
        description="Picture of the gaps, white is open: each flickers, with a weight that is its "
        "area.",
    )

    @model_validator(mode="after")
    def _check_gaps(self) -> Flicker:
        if self.mask is not None and self.gaps != 1:
            raise refusal("gaps and mask exclude each other", key="gaps")
        return self
