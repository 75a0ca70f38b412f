"""What all lamps of a scene file share: names, colour, shells, keyframes, photometric rules."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from andon.scene.base import (
    Fraction,
    FractionTriple,
    Name,
    NonNegative,
    Positive,
    Reference,
    Table,
    Vector,
    refusal,
    unknown_key,
)
from andon.scene.geometry import Direction

__all__ = ["PHOTOMETRIC_KEYS", "Flicker", "LampKey", "LampTable", "Shell"]

PHOTOMETRIC_KEYS = ("intensity_cd", "flux_lm", "luminance_cd_m2", "illuminance_lux")
_COLOUR_KEYS = ("chromaticity_xy", "temperature_k", "rgb")

# Two consecutive key directions closer to opposite than this have no defined way between them.
OPPOSITE_COSINE = -1 + 1e-9


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


class Shell(Table):
    """The translucent shell of a luminous body: lit from inside, it emits outside."""

    radius_m: Positive | None = Field(
        default=None,
        description="Radius of a spherical shell in metres.",
    )
    mesh: Reference | None = Field(
        default=None,
        description="Mesh file of a shell of any other form.",
    )
    transmittance: FractionTriple = Field(
        default=(0.5, 0.5, 0.5),
        description="Net diffuse transmittance t in [0, 1], interreflection included; one number "
        "or three channels.",
    )
    absorptance: Fraction = Field(
        default=0.0,
        description="Share of the light that an open shell takes, [0, 1]; 1 − t at most.",
    )

    @model_validator(mode="after")
    def _one_form(self) -> Shell:
        if (self.radius_m is None) == (self.mesh is None):
            raise refusal("exactly one of radius_m, mesh is allowed")
        if self.absorptance + max(self.transmittance) > 1 + 1e-9:
            raise refusal("absorptance + transmittance must be ≤ 1", key="absorptance")
        return self


class Flicker(Table):
    """Irregular brightness S(t) of mean 1: candles, sun through leaves."""

    exponent: Annotated[float, Field(gt=1, le=3)] = Field(
        default=1.8,
        description="z of the intermittent map S ← S + u·S^z mod 1; 1/f-like above 1.5.",
    )
    steps_per_second: Positive = Field(
        default=30.0,
        description="Iterations of the map per second.",
    )
    amount: Fraction = Field(
        default=1.0,
        description="0 steady … 1 the full swing of S.",
    )
    gaps: Annotated[int, Field(ge=1, le=100_000)] = Field(
        default=1,
        description="Independent flickers whose mean is taken (gaps between leaves).",
    )
    mask: Reference | None = Field(
        default=None,
        description="Picture of the gaps, white is open.",
    )


class LampTable(Table):
    """Keys of every lamp."""

    kinds_of_light: ClassVar[tuple[str, ...]] = ("intensity_cd", "flux_lm")
    light_required: ClassVar[bool] = True

    name: Name = Field(
        default="",
        description="Unique name; default: the kind and a number.",
    )
    chromaticity_xy: tuple[Positive, Positive] | None = Field(
        default=None,
        description="CIE 1931 chromaticity (x, y), x + y ≤ 1.",
    )
    temperature_k: Annotated[float, Field(ge=1000, le=40000)] | None = Field(
        default=None,
        description="Colour temperature in K, 1000…40000.",
    )
    rgb: tuple[NonNegative, NonNegative, NonNegative] | None = Field(
        default=None,
        description="Linear Rec.709 factors; only their ratio counts, the photometric value is "
        "the one stated.",
    )
    transport: Literal["direct", "baked", "direct+bounce"] = Field(
        default="direct",
        description="How its light gets to surfaces; never counted twice.",
    )
    in_probes: bool = Field(
        default=False,
        description="Captured by light probes; false for a lamp that lights objects directly.",
    )
    flicker: Flicker | None = Field(
        default=None,
        description="Irregular brightness over time.",
    )
    path: Reference | None = Field(
        default=None,
        description="File of positions over time: CSV time_seconds, x_m, y_m, z_m, or TUM.",
    )
    key: tuple[LampKey, ...] = Field(
        default=(),
        description="Keyframes, in the order of their times; they override the lamp's own values.",
    )

    @classmethod
    def _unknown(cls, key: str) -> PydanticCustomError:
        owners = [kind for kind, table in _kinds().items() if key in table.model_fields]
        if owners:
            (mine,) = cls.model_fields["kind"].annotation.__args__  # pyright: ignore
            return refusal(
                f"kind {mine!r} has no key {key!r}",
                key=key,
                remedy=f"it belongs to {', '.join(owners)}",
            )
        return unknown_key(key, list(cls.model_fields))

    @model_validator(mode="after")
    def _check_lamp(self) -> LampTable:
        self._check_light()
        self._check_colour()
        self._check_keys()
        if self.path is not None and self.key:
            raise refusal("path and key exclude each other", key="path")
        return self

    @property
    def light(self) -> str | None:
        """The photometric key that this lamp states; None only where none is needed."""
        return next((key for key in self.kinds_of_light if getattr(self, key) is not None), None)

    def _check_light(self) -> None:
        given = [key for key in self.kinds_of_light if getattr(self, key) is not None]
        if len(given) > 1 or (self.light_required and not given):
            many = "exactly one" if self.light_required else "at most one"
            came = " and ".join(given) or "none"
            raise refusal(f"{many} of {', '.join(self.kinds_of_light)} is allowed, got {came}")

    def _check_colour(self) -> None:
        given = [key for key in _COLOUR_KEYS if getattr(self, key) is not None]
        if len(given) > 1:
            raise refusal(
                f"at most one of {', '.join(_COLOUR_KEYS)} is allowed, got {' and '.join(given)}"
            )
        if self.chromaticity_xy is not None and sum(self.chromaticity_xy) > 1:
            raise refusal(f"x + y must be ≤ 1, got {self.chromaticity_xy}", key="chromaticity_xy")
        if self.rgb is not None and not max(self.rgb) > 0:
            raise refusal("at least one channel must be > 0", key="rgb")

    def _check_keys(self) -> None:
        for index, key in enumerate(self.key):
            for name in key.animated:
                if getattr(self, name, None) is None:
                    raise refusal(
                        f"this lamp does not state {name}",
                        key=f"key[{index}].{name}",
                        remedy="a key animates what the lamp itself states",
                    )
            if not key.animated:
                raise refusal("the key sets nothing", key=f"key[{index}]")
        for index, (before, after) in enumerate(pairwise(self.key), start=1):
            if not after.time_seconds > before.time_seconds:
                raise refusal(
                    f"must be later than the key before, {before.time_seconds:g} s, got "
                    f"{after.time_seconds:g} s",
                    key=f"key[{index}].time_seconds",
                )
        self._check_turns()

    def _check_turns(self) -> None:
        turns = [(i, key.direction) for i, key in enumerate(self.key) if key.direction is not None]
        for (_, before), (index, after) in pairwise(turns):
            cosine = np.dot(before, after) / np.linalg.norm(before) / np.linalg.norm(after)
            if cosine < OPPOSITE_COSINE:
                raise refusal(
                    "is opposite to the key before: the way between is not defined",
                    key=f"key[{index}].direction",
                    remedy="add a key between them",
                )


def _kinds() -> dict[str, type[LampTable]]:
    from andon.scene.lamp import LAMP_KINDS

    return LAMP_KINDS


ShadowMapSize = Annotated[int, Field(ge=16, le=8192)]


class Shadowing(Table):
    """Keys of lamps that cast shadows."""

    shadow: bool = Field(
        default=True,
        description="The lamp casts shadows.",
    )
    shadow_map_size: ShadowMapSize = Field(
        default=1024,
        description="Texels along a side of the shadow map, 16…8192.",
    )
    shadow_filter: Literal["none", "linear", "pcf"] = Field(
        default="pcf",
        description="How the shadow map is read: none (hard), linear (2×2), pcf (wider average).",
    )


class Shelled(Table):
    """Keys of point-like lamps."""

    visible_radius_m: NonNegative = Field(
        default=0.0,
        description="Radius of the ball that is drawn in the picture, metres; 0: not drawn.",
    )
    shell: Shell | None = Field(
        default=None,
        description="Translucent shell around the lamp.",
    )
