"""The JSON schema of the scene file, for editors, and the folder in which it is published."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from andon.scene.lamp import LAMP_KINDS
from andon.scene.model import Scene
from andon.scene.presets import PRESETS
from andon.scene.reference import scene_reference_markdown

__all__ = ["json_schema", "publish"]


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of the scene file as people write it, shorthands included."""
    schema = Scene.model_json_schema(mode="validation")
    # Presets are written out before the models see them, so the models do not know them.
    definitions: dict[str, Any] = schema["$defs"]
    definitions["PresetLamp"] = _preset_lamp()
    lamps = (schema["properties"]["lamp"], definitions["Ambient"]["properties"]["source"])
    for tables in lamps:
        tables["items"]["oneOf"].append({"$ref": "#/$defs/PresetLamp"})
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "Andon scene",
    }


def _preset_lamp() -> dict[str, Any]:
    """A lamp that begins with a preset; its other keys are those of any kind."""
    keys = sorted({key for table in LAMP_KINDS.values() for key in table.model_fields})
    names = {"enum": list(PRESETS), "description": "A lamp with a name, instead of a kind."}
    return {
        "type": "object",
        "description": "A lamp with a name; given keys override the preset's.",
        "properties": {"preset": names},
        "propertyNames": {"enum": ["preset", *keys]},
        "required": ["preset"],
    }


def publish(folder: Path) -> dict[Path, str]:
    """The published files in `folder` and their contents; nothing is written."""
    schema = json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"
    return {
        folder / "scene.schema.json": schema,
        folder / "scene-file.md": scene_reference_markdown(),
    }
