"""What is published of the models: a JSON schema for editors and a reference for readers."""

from __future__ import annotations

from typing import Any

from andon.scene.model import Scene

__all__ = ["json_schema", "scene_reference_markdown"]


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of the scene file, as a TOML editor wants it."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Scene.model_json_schema(mode="validation"),
        "title": "Andon scene",
    }


def scene_reference_markdown() -> str:
    """Reference of every table, as Markdown."""
    return ""
