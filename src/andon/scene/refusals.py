"""Every way in which a scene can be wrong, as one line: file, field, rule and remedy."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from andon.errors import InputError, nearest_name
from andon.scene.base import shown
from andon.scene.lamp import LAMP_KINDS
from andon.scene.presets import PRESETS

__all__ = ["input_error"]

# Ends of key names and the unit that messages give for them, longest first.
_UNITS = {
    "_cd_m2": "cd/m²",
    "_cd": "cd",
    "_lm": "lm",
    "_lux": "lx",
    "_degrees": "°",
    "_seconds": "s",
    "_mm": "mm",
    "_px": "px",
    "_hz": "Hz",
    "_m": "m",
    "_k": "K",
}
_COMPARISONS = {
    "greater_than": (">", "gt"),
    "greater_than_equal": ("≥", "ge"),
    "less_than": ("<", "lt"),
    "less_than_equal": ("≤", "le"),
}
_EXPECTED = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "an integer",
    "int_from_float": "an integer",
    "string_type": "a text",
    "bool_type": "true or false",
    "tuple_type": "a list",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
    "finite_number": "finite",
}


def input_error(error: ValidationError, file: str) -> InputError:
    """The `InputError` of a failed validation: the most telling fault, and how many more."""
    faults = sorted(_distinct(error.errors(include_url=False)), key=_telling)
    field, rule, remedy = _translate(faults[0])
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    return InputError(
        rule + ("" if remedy else more),
        file=file,
        field=field or None,
        remedy=remedy and remedy + more,
    )


def _distinct(faults: list[ErrorDetails]) -> list[ErrorDetails]:
    """The faults, where one number that stands for three channels counts once and has no index."""
    groups: dict[tuple[object, int], list[ErrorDetails]] = {}
    for fault in faults:
        groups.setdefault((fault["loc"][:-1], id(fault["input"])), []).append(fault)
    distinct: list[ErrorDetails] = []
    for same in groups.values():
        if len(same) == 3 and isinstance(same[0]["loc"][-1], int):
            same[0]["loc"] = same[0]["loc"][:-1]
            same = same[:1]
        distinct += same
    return distinct


def _telling(fault: ErrorDetails) -> int:
    # A misspelt key explains why the right one is missing, not the other way round.
    return {"missing": 2}.get(fault["type"], 1)


def _translate(fault: ErrorDetails) -> tuple[str, str, str | None]:
    field, context = dotted(fault["loc"]), fault.get("ctx", {})
    kind, came = fault["type"], fault["input"]
    if kind == "andon":
        # A list entry's key begins with its index: "source" + "[0]".
        return _join(field, context["key"]), context["rule"], context["remedy"] or None
    if kind == "missing":
        return _missing(fault["loc"])
    if kind == "literal_error":
        return field, *_choice(context["expected"], came)
    if kind.startswith("union_tag"):
        if not isinstance(came, dict):
            return field, f"must be a table with a kind, got {shown(came)}", None
        given = came.get("kind", "")  # pyright: ignore
        if given == "":
            return f"{field}.kind", "is required", f"one of {', '.join(LAMP_KINDS)}"
        if isinstance(given, str) and given in PRESETS:
            return f"{field}.kind", f"{given} is a preset", f'write preset = "{given}"'
        choices = ", ".join(repr(name) for name in LAMP_KINDS)
        return f"{field}.kind", *_choice(choices, given)  # pyright: ignore
    if kind in _COMPARISONS:
        sign, key = _COMPARISONS[kind]
        unit = _unit(field)
        return field, f"must be {sign} {context[key]:g}{unit}, got {shown(came)}", None
    if kind == "tuple_type" and isinstance(came, dict):
        return field, "must be a list of tables", f"write [[{field}]], not [{field}]"
    if kind in _EXPECTED:
        return field, f"must be {_EXPECTED[kind]}, got {shown(came)}", None
    if kind in ("too_long", "too_short", "string_too_long", "string_too_short"):
        limit = context.get("max_length", context.get("min_length"))
        most = "at most" if kind.endswith("long") else "at least"
        what = "characters" if kind.startswith("string") else "entries"
        return field, f"must have {most} {limit} {what}, got {shown(came)}", None
    return field, f"{fault['msg']}, got {shown(came)}", None


def _missing(loc: Sequence[int | str]) -> tuple[str, str, str | None]:
    if isinstance(loc[-1], int):  # a tuple that is too short lacks the entry of that index
        return dotted(loc[:-1]), f"has too few entries: number {loc[-1] + 1} is missing", None
    table = dotted(loc[:-1])
    return dotted(loc), "is required", f"add '{loc[-1]} = …'" + (f" to {table}" if table else "")


def _choice(expected: str, came: object) -> tuple[str, str | None]:
    names = re.findall(r"'([^']*)'", expected)
    near = nearest_name(came[:100], names) if isinstance(came, str) else None
    rule = f"must be one of {', '.join(map(repr, names))}, got {shown(came)}"
    return rule, f"did you mean {near!r}?" if near else None


def _unit(field: str) -> str:
    name = re.sub(r"\[\d+\]$", "", field)
    return next((f" {unit}" for end, unit in _UNITS.items() if name.endswith(end)), "")


def _join(field: str, key: str) -> str:
    key = key if key.isprintable() and len(key) <= 100 else shown(key)
    return f"{field}.{key}" if field and key else field or key


def dotted(loc: Sequence[int | str]) -> str:
    """A field's path as the file writes it, ``lamp[1].intensity_cd``; union tags are left out."""
    path = ""
    for part in loc:
        if isinstance(part, int):
            path += f"[{part}]"
        elif not (part.startswith("<") and part.endswith(">")):
            path = _join(path, part)
    return path
