"""What all lamps of a scene file share: names, colour, motion, and the rules on them."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from andon.scene.base import (
    Name,
    NonNegative,
    Positive,
    Reference,
    Table,
    refusal,
    unknown_key,
)
from andon.scene.lamp_parts import Flicker, LampKey, Shell

__all__ = ["LampTable", "Shadowing", "Shelled", "of_other_kinds"]

_COLOUR_KEYS = ("chromaticity_xy", "temperature_k", "rgb")

# Two consecutive key directions closer to opposite than this have no defined way between them.
OPPOSITE_COSINE = -1 + 1e-9


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
    daylight: bool = Field(
        default=False,
        description="temperature_k is that of CIE daylight (D series), 4000…25000 K, instead of a "
        "Planckian radiator.",
    )
    rgb: tuple[NonNegative, NonNegative, NonNegative] | None = Field(
        default=None,
        description="Linear Rec.709 factors; only their ratio counts, the photometric value is "
        "the one stated.",
    )
    transport: Literal["direct", "baked", "direct+bounce"] = Field(
        default="direct",
        description="How its light gets to surfaces; never counted twice. direct: computed in each "
        "frame, without what surfaces reflect of it. baked: all of it is in the maps of [baked]. "
        "direct+bounce: computed in each frame, and what surfaces reflect of it is in the maps. "
        "Body, highlights and glare are those of a direct lamp; what sticks to glass takes no "
        "light of maps.",
    )
    in_probes: bool = Field(
        default=True,
        description="Light probes capture what surfaces reflect of it; and of kinds sky and "
        "hemisphere itself, which then lights no object that probes light.",
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
        owners = of_other_kinds(key)
        if owners:
            (mine,) = cls.model_fields["kind"].annotation.__args__  # pyright: ignore
            return refusal(f"kind {mine!r} has no key {key!r}", key=key, remedy=owners)
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
        if not given and self.light_required:
            raise refusal(f"{' or '.join(self.kinds_of_light)} is required")
        if len(given) > 1:
            one = "exactly one" if self.light_required else "at most one"
            choices = ", ".join(self.kinds_of_light)
            raise refusal(f"{one} of {choices} is allowed, got {' and '.join(given)}")

    def _check_colour(self) -> None:
        given = [key for key in _COLOUR_KEYS if getattr(self, key) is not None]
        if len(given) > 1:
            raise refusal(
                f"at most one of {', '.join(_COLOUR_KEYS)} is allowed, got {' and '.join(given)}"
            )
        kelvins = [key.temperature_k for key in self.key] + [self.temperature_k]
        if self.daylight and not all(4000 <= kelvin <= 25000 for kelvin in kelvins if kelvin):
            raise refusal("daylight needs 4000…25000 K", key="temperature_k")
        if self.daylight and self.temperature_k is None:
            raise refusal("daylight needs temperature_k", key="daylight", remedy="state it in K")
        if self.chromaticity_xy is not None and sum(self.chromaticity_xy) > 1:
            raise refusal(f"x + y must be ≤ 1, got {self.chromaticity_xy}", key="chromaticity_xy")
        if self.rgb is not None and not max(self.rgb) > 0:
            raise refusal("at least one channel must be > 0", key="rgb")

    def _check_keys(self) -> None:
        for index, (before, after) in enumerate(pairwise(self.key), start=1):
            if not after.time_seconds > before.time_seconds:
                raise refusal(
                    f"must be later than the key before, {before.time_seconds:g} s, got "
                    f"{after.time_seconds:g} s",
                    key=f"key[{index}].time_seconds",
                )
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


def of_other_kinds(key: str) -> str:
    """Which kinds of lamps have `key`, in words; empty where none has."""
    owners = [kind for kind, table in _kinds().items() if key in table.model_fields]
    if not owners:
        return ""
    what = "a shell" if key == "shell" else key
    *others, last = owners
    listed = f"{', '.join(others)} and {last}" if others else last
    return f"only {listed} {'have' if others else 'has'} {what}"


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
    shadow_filter: Literal["none", "linear", "exact"] = Field(
        default="linear",
        description="How the shadow map is read: none (hard), linear (blended over 2×2 texels), "
        "exact (the triangles' own edges, slower; directional lamps: linear).",
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

    @model_validator(mode="after")
    def _check_ball(self) -> Shelled:
        radius = self.shell.radius_m if self.shell is not None else None
        if radius is not None and self.visible_radius_m >= radius:
            raise refusal(
                f"must be < shell.radius_m, {radius:g} m, got {self.visible_radius_m:g}",
                key="visible_radius_m",
                remedy="the bulb is inside its shell; 0: it is not drawn",
            )
        return self
