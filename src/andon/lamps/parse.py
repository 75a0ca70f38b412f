"""One lamp in one line: ``kind=point,position=0.5,0.2,-1.5,flux_lm=800,temperature_k=2700``.

::

    option = pair *( "," pair )          pair = key "=" value
    value  = text | number *( sep number ) | "[" … "]"        sep = "," | ";" | space
    key    = name *( "." name )          shell.radius_m=0.1
    ends, vertices: points, [[0,1,-2],[1,1,-2]] or one after the other, [0,1,-2,1,1,-2]

A piece between commas without an equals sign continues the value before it. A preset
(``preset=candle,position=0,1,-2``) is written out.
"""

from __future__ import annotations

import re
from typing import Any, cast

from andon.errors import InputError, nearest_name

__all__ = ["parse_lamp_option"]

MAX_OPTION_CHARACTERS = 10_000
# A list in a list; a table in braces.
_INNER = re.compile(r"\[([^\[\]]*)\]")
_BRACES = re.compile(r"([\w.]+)\s*=\s*\{\s*([^{}]*=[^{}]*?)\s*(?:\}|$)")
_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_.]{0,99}")


def parse_lamp_option(text: str, /, *, field: str = "--lamp") -> dict[str, Any]:
    """The [[lamp]] table of a lamp option, ready for `scene_from_dict`.

    Keys and kinds are checked here, with the nearest known name; values by the scene. `field` is
    named in messages. Raises `InputError`.
    """
    if len(text) > MAX_OPTION_CHARACTERS:
        raise InputError(f"must have at most {MAX_OPTION_CHARACTERS} characters", field=field)
    _refuse_braces(text, field)
    table: dict[str, Any] = {}
    for key, value in _pairs(text, field):
        _put(table, key, _points(key, _parsed(value, f"{field}: {key}")), field)
    if "preset" in table:
        from andon.scene.presets import expand_preset

        table = expand_preset(table, f"{field}: preset")
    if "kind" not in table:
        remedy = "begin with kind=point,… or preset=bulb,…"
        raise InputError("kind is required", field=field, remedy=remedy)
    _check_keys(table, field)
    return table


def _refuse_braces(text: str, field: str) -> None:
    """Tables as TOML writes them, {key = value}, are written with dots here."""
    found = _BRACES.search(text)
    if found is None:
        return
    keys = (f"{found[1]}.{pair.strip()}" for pair in re.split(r",(?=\s*\w+\s*=)", found[2]))
    raise InputError(
        "takes no table in braces",
        field=f"{field}: {found[1][:60]}",
        remedy=f"write {','.join(keys)[:200]}",
    )


def _pairs(text: str, field: str) -> list[tuple[str, str]]:
    pairs: list[tuple[str, str]] = []
    for piece in text.split(","):
        key, equals, value = piece.partition("=")
        if equals and _KEY.fullmatch(key.strip()):
            pairs.append((key.strip(), value.strip()))
        elif pairs and not equals:
            key, value = pairs[-1]
            pairs[-1] = (key, f"{value},{piece.strip()}")
        else:
            raise InputError(
                f"must be key=value,key=value…, got {piece[:60]!r}",
                field=field,
                remedy="for example kind=point,position=0,1,-2,flux_lm=800",
            )
    return pairs


# Keys whose value is a list of points, written one after the other.
_POINT_LISTS = ("ends", "vertices")


def _points(key: str, value: Any) -> Any:
    """Nine numbers of `vertices` are three points; what is no such list stays as it is."""
    if key not in _POINT_LISTS or not isinstance(value, list):
        return value
    numbers = cast(list[Any], value)
    if len(numbers) % 3 or any(isinstance(number, str | list) for number in numbers):
        return numbers
    return [numbers[i : i + 3] for i in range(0, len(numbers), 3)]


def _put(table: dict[str, Any], key: str, value: Any, field: str) -> None:
    *parents, last = key.split(".")
    for parent in parents:
        entry: Any = table.setdefault(parent, {})
        if not isinstance(entry, dict):
            raise InputError(f"{parent} has a value already", field=f"{field}: {key}")
        table = cast(dict[str, Any], entry)
    if last in table:
        raise InputError("is given twice", field=f"{field}: {key}")
    table[last] = value


def _parsed(text: str, field: str) -> Any:
    """A number, true or false, a list of these, or the text itself."""
    if text == "":
        raise InputError("has no value", field=field[:80])
    bracketed = text.startswith("[") and text.endswith("]")
    if bracketed and _INNER.search(text, 1):
        return [_parsed(f"[{inner}]", field) for inner in _INNER.findall(text)]
    parts = [part for part in re.split(r"[,;\s]+", text.strip("[]").strip()) if part]
    values = [_scalar(part) for part in parts]
    if bracketed:
        return values
    if len(values) == 1:
        return values[0]
    # A text with spaces or commas (a name, a file) is a text; a list has numbers only.
    return text if any(isinstance(value, str) for value in values) else values


def _scalar(text: str) -> Any:
    if text in ("true", "false"):
        return text == "true"
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    return text


def _check_keys(table: dict[str, Any], field: str) -> None:
    from andon.scene.lamp import LAMP_KINDS
    from andon.scene.lamp_base import of_other_kinds
    from andon.scene.presets import PRESETS

    kind = str(table["kind"])
    if kind in PRESETS:
        raise InputError(
            f"{kind} is a preset", field=f"{field}: kind", remedy=f"write preset={kind}"
        )
    if kind not in LAMP_KINDS:
        near = nearest_name(kind, list(LAMP_KINDS))
        raise InputError(
            f"must be one of {', '.join(LAMP_KINDS)}, got {kind[:60]!r}",
            field=f"{field}: kind",
            remedy=f"did you mean {near!r}?" if near else None,
        )
    known = list(LAMP_KINDS[kind].model_fields)
    for key in table:
        if key in known:
            continue
        owners = of_other_kinds(key)
        if owners:
            raise InputError(f"kind {kind!r} has no key {key!r}", field=field, remedy=owners)
        near = nearest_name(key, known)
        raise InputError(
            f"unknown key {key[:60]!r} for kind {kind!r}",
            field=field,
            remedy=f"did you mean {near!r}?" if near else f"known keys: {', '.join(known)}",
        )
