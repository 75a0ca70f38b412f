"""What every table of a scene file shares: strictness, number types, and refusals in our words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, cast

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from andon.errors import nearest_name

__all__ = [
    "Affine",
    "Count",
    "Fraction",
    "FractionTriple",
    "Name",
    "NonNegative",
    "NonNegativeTriple",
    "Pixels",
    "Positive",
    "PositiveTriple",
    "Reference",
    "Size",
    "Table",
    "Vector",
    "exactly_one",
    "refusal",
    "shown",
    "unknown_key",
]

# Values from a stranger's file are quoted in messages: cut here, so that one line stays one line.
SHOWN_CHARACTERS = 60


def shown(value: object) -> str:
    """`value` as a message quotes it: on one line, at most `SHOWN_CHARACTERS` long."""
    text = repr(value)
    return text if len(text) <= SHOWN_CHARACTERS else text[: SHOWN_CHARACTERS - 1] + "…"


def refusal(rule: str, *, key: str = "", remedy: str = "") -> PydanticCustomError:
    """An error for a validator to raise; `key` is relative to the table that is validated."""
    return PydanticCustomError("andon", "{rule}", {"rule": rule, "key": key, "remedy": remedy})


def unknown_key(key: str, known: list[str]) -> PydanticCustomError:
    """The refusal of a key that the table does not have, with the nearest one that it has."""
    near = nearest_name(key, known)
    remedy = f"did you mean {near!r}?" if near else f"known keys: {', '.join(known)}"
    return refusal(f"unknown key {shown(key)}", key=key, remedy=remedy)


class Table(BaseModel):
    """One table of the scene file: frozen, strict, and without unknown keys.

    Strict means that "5" is not a number, nor is ``true``; an integer is one. Infinity and NaN
    are refused unless a field says otherwise.
    """

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, value: Any) -> Any:
        if isinstance(value, Mapping):
            for key in cast(Mapping[str, Any], value):
                if key not in cls.model_fields:
                    raise cls._unknown(key)
        return cast(Any, value)

    @classmethod
    def _unknown(cls, key: str) -> PydanticCustomError:
        return unknown_key(key, list(cls.model_fields))


def exactly_one(table: Table, *keys: str) -> None:
    """Raise a refusal unless exactly one of `keys` is set (neither None nor false)."""
    given = [key for key in keys if getattr(table, key) not in (None, False)]
    if len(given) == 1:
        return
    came = "none" if not given else " and ".join(given)
    raise refusal(f"exactly one of {', '.join(keys)} is allowed, got {came}")


def _broadcast(value: Any) -> Any:
    """A single number stands for three equal channels."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return (value, value, value)
    return value


Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=0)]
Pixels = Annotated[int, Field(ge=1, le=65536)]

Vector = tuple[float, float, float]
Size = tuple[Positive, Positive, Positive]
Affine = tuple[
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
]

PositiveTriple = Annotated[
    tuple[Positive, Positive, Positive],
    BeforeValidator(
        _broadcast, json_schema_input_type=Positive | tuple[Positive, Positive, Positive]
    ),
]
NonNegativeTriple = Annotated[
    tuple[NonNegative, NonNegative, NonNegative],
    BeforeValidator(
        _broadcast,
        json_schema_input_type=NonNegative | tuple[NonNegative, NonNegative, NonNegative],
    ),
]
FractionTriple = Annotated[
    tuple[Fraction, Fraction, Fraction],
    BeforeValidator(
        _broadcast, json_schema_input_type=Fraction | tuple[Fraction, Fraction, Fraction]
    ),
]

Name = Annotated[str, Field(min_length=1, max_length=200)]
# A path relative to the scene's folder; resolved and confined by `Scene.path`, not at parse time.
Reference = Annotated[str, Field(min_length=1, max_length=4096)]
