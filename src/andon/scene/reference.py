"""The reference manual of the scene file, written from the models so that it cannot go stale."""

from __future__ import annotations

import json
from collections.abc import Iterator
from inspect import getdoc
from typing import Any, cast, get_args, get_origin

from pydantic.fields import FieldInfo

from andon.scene.base import Table
from andon.scene.lamp import LAMP_KINDS
from andon.scene.lamp_base import LampTable
from andon.scene.model import Scene
from andon.scene.presets import PRESETS

__all__ = ["EXAMPLE", "EXAMPLES", "scene_reference_markdown"]

EXAMPLE = """\
[scene]
name = "desk at night"

[rig.camera]
hfov_degrees = 60.0

[capture]
source = "photo.png"

[surface]
depth = "depth.npy"

[ambient]
illuminance_lux = 120.0
dimming = 0.3

[[lamp]]
kind = "point"
name = "bulb"
position = [0.5, 0.2, -1.5]
flux_lm = 800.0
temperature_k = 2700.0

[[lamp.key]]
time_seconds = 0.0
position = [0.5, 0.2, -1.5]

[[lamp.key]]
time_seconds = 2.0
position = [-0.5, 0.2, -1.5]
"""

_INTRODUCTION = """\
# The scene file

One TOML file (UTF-8, 1 MiB at most) describes everything that a frame needs. This page is written
from the program's own models; `scene.schema.json` is the same for editors.

- Every table is optional, except for what the command needs. A table that is absent switches its
  stage off.
- Unknown keys are errors, and the message names the nearest known key.
- Units are in the names; lengths are in metres, the world is right-handed with +Y up.
- Paths are relative to the file's folder and stay inside it.
- Where a key takes *number or 3 numbers*, one number stands for three equal channels.
- Attribute paths in Python are those of the file: `scene.lamp[0].flux_lm`.

```toml
{example}```
"""


EXAMPLES = {
    "rig": """\
Two eyes, each with its picture:

```toml
[rig]
kind = "stereo"

[rig.left]
hfov_degrees = 60.0
position = [-0.0315, 0.0, 0.0]
look_at = [-0.0315, 0.0, -1.0]

[rig.right]
hfov_degrees = 60.0
position = [0.0315, 0.0, 0.0]
look_at = [0.0315, 0.0, -1.0]

[capture]
source = { left = "left.png", right = "right.png" }
```

`andon relight left.png --scene stereo.toml --view left -o left-lit.png`: the photograph that is
given is that of the eye that `--view` names (left, unless named); the other eye keeps its own.
""",
    "ambient.source": """\
A real lamp or window whose light is in the photograph, described as a `[[lamp]]` is. It adds
nothing by itself: virtual objects and luminous bodies take away what they hide of it, so they cast
shadows in the light of the room. `removed` switches it off: its light is taken out of E0.

```toml
[ambient]
illuminance_lux = 300.0
removed = ["ceiling"]

[[ambient.source]]
preset = "window"
name = "window"
position = [-1.8, 1.4, -2.0]
direction = [1.0, 0.0, 0.0]

[[ambient.source]]
preset = "bulb"
name = "ceiling"
position = [0.0, 2.3, -1.5]
```

A source that stays costs two of the 64 lamps that a scene may have, one that is removed costs one.
""",
}


_PRESETS = """\
### `preset = "…"`

Instead of `kind`: a lamp with a name. Given keys override the preset's; a given quantity of light
or colour replaces the preset's. Also in `[[ambient.source]]` and
`--lamp preset=candle,position=0,1,-2`.

| preset | what | stands for | source |
|---|---|---|---|
"""


def preset_lines() -> list[str]:
    """The presets as rows of a Markdown table."""
    return [
        f"| `{name}` | {preset.what} | "
        f"{', '.join(f'`{key} = {_plain(value)}`' for key, value in preset.keys.items())} | "
        f"{preset.source} |"
        for name, preset in PRESETS.items()
    ]


def _plain(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def scene_reference_markdown() -> str:
    """Reference of every table as Markdown: keys, types, defaults, meaning."""
    parts = [_INTRODUCTION.format(example=EXAMPLE)]
    for name, info in Scene.model_fields.items():
        parts += _sections(name, info, seen=[])
    return "\n".join(parts)


def _sections(path: str, info: FieldInfo, seen: list[type[Table]]) -> Iterator[str]:
    tables, repeated = _tables(info.annotation)
    if any(issubclass(table, LampTable) for table in tables):
        if path == "lamp":
            yield from _lamp_sections()
        elif path in EXAMPLES:
            yield f"## `[[{path}]]`\n\n{EXAMPLES[path]}"
        return
    for table in tables:
        if table in seen:
            continue
        seen.append(table)
        head = f"[[{path}]]" if repeated else f"[{path}]"
        yield f"## `{head}`\n\n{getdoc(table)}\n"
        if table.model_fields:
            yield _key_table(table, list(table.model_fields))
        if path in EXAMPLES:
            yield EXAMPLES[path]
        for name, inner in table.model_fields.items():
            yield from _sections(f"{path}.{name}", inner, seen)


def _lamp_sections() -> Iterator[str]:
    common = [name for name in LampTable.model_fields if name != "kind"]
    yield "## `[[lamp]]`\n\nKeys of every lamp:\n"
    yield _key_table(LampTable, common)
    for kind, table in LAMP_KINDS.items():
        yield f'### `kind = "{kind}"`\n\n{getdoc(table)}\n'
        own = [name for name in table.model_fields if name not in common and name != "kind"]
        yield _key_table(table, sorted(own, key=lambda name: name not in table.__annotations__))
    yield _PRESETS + "\n".join(preset_lines()) + "\n"
    seen: list[type[Table]] = []
    for table in LAMP_KINDS.values():
        for name, info in table.model_fields.items():
            yield from _sections(f"lamp.{name}", info, seen)


def _tables(annotation: Any) -> tuple[list[type[Table]], bool]:
    """The tables that an annotation allows, and whether it is a list of them."""
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return [annotation], False
    found: list[type[Table]] = []
    repeated = get_origin(annotation) is tuple
    for argument in get_args(annotation):
        inner, inner_repeated = _tables(argument)
        found += inner
        repeated = repeated or inner_repeated
    return found, repeated


def _key_table(table: type[Table], names: list[str]) -> str:
    properties = table.model_json_schema(mode="validation").get("properties", {})
    lines = ["| key | value | default | meaning |", "|---|---|---|---|"]
    for name in names:
        info = table.model_fields[name]
        cells = (f"`{name}`", _words(properties[name]), _default(info), info.description or "")
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _default(info: FieldInfo) -> str:
    if info.is_required():
        return "**required**"
    if info.default is None or info.default in ((), "") or isinstance(info.default, Table):
        return ""
    return f"`{json.dumps(info.default, ensure_ascii=False)}`"


def _words(schema: dict[str, Any]) -> str:
    """A JSON schema of one value in words."""
    if "anyOf" in schema or "oneOf" in schema:
        choices = cast(list[dict[str, Any]], schema.get("anyOf") or schema["oneOf"])
        kinds = [_words(choice) for choice in choices if choice.get("type") != "null"]
        return " or ".join(dict.fromkeys(kinds))
    if "$ref" in schema:
        return "table"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    kind = schema.get("type")
    if kind == "array":
        return _list_words(schema)
    name = {"number": "number", "integer": "integer", "boolean": "true or false", "string": "text"}
    return " ".join([name[str(kind)], *_limits(schema)])


def _list_words(schema: dict[str, Any]) -> str:
    fixed = schema.get("prefixItems")
    if not fixed:
        inner = _words(schema["items"])
        return "tables" if inner.startswith("table") else f"list of {_plural(inner)}"
    inner = _words(fixed[0])
    return f"{len(fixed)} {_plural(inner)}"


def _plural(words: str) -> str:
    if words[0].isdigit():
        return f"lists of {words}"
    first, _, rest = words.partition(" ")
    return f"{first}s {rest}".strip()


def _limits(schema: dict[str, Any]) -> list[str]:
    if "minimum" in schema and "maximum" in schema:
        return [f"{schema['minimum']:g}…{schema['maximum']:g}"]
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    words = [f"{sign} {schema[key]:g}" for key, sign in signs.items() if key in schema]
    return [", ".join(words)] if words else []
