"""The JSON schema of the scene file, for editors, and the folder in which it is published."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from andon.scene.model import Scene
from andon.scene.reference import scene_reference_markdown

__all__ = ["json_schema", "publish"]


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of the scene file as people write it, shorthands included."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Scene.model_json_schema(mode="validation"),
        "title": "Andon scene",
    }


def publish(folder: Path) -> dict[Path, str]:
    """The published files in `folder` and their contents; nothing is written."""
    schema = json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"
    return {
        folder / "scene.schema.json": schema,
        folder / "scene-file.md": scene_reference_markdown(),
    }
