"""The scene: one file that describes everything a frame needs.

TOML, because people write scenes by hand: it has comments, no significant indentation, and its
reader is in the standard library. Validated by pydantic, because the same models then give the
errors, the JSON schema for editors and the reference manual, so that none of them can go stale.

============ ==================================== =========================================
alternative  gain                                 cost
============ ==================================== =========================================
JSON         read everywhere                      no comments, hard to write by hand
YAML         short                                surprises (``no`` is false), unsafe readers
glTF extras  geometry and lamps in one file       needs a DCC tool; no place for cameras, eyes
USD          layering, studios                    a 100 MB dependency
============ ==================================== =========================================

Rules that hold throughout: unknown keys are errors and name the nearest known key; units are in
the names; a table that is absent switches its stage off; paths are relative to the scene's folder
and stay inside it (`Scene.path` resolves them); attribute paths in Python are those of the file:
``scene.lamp[1].intensity_cd``.

Importing this package imports pydantic; ``import andon`` alone does not.
"""

from __future__ import annotations

from andon.scene.dump import dump_scene
from andon.scene.keyframes import lamp_at
from andon.scene.lamp import LAMP_KINDS
from andon.scene.load import load_scene, parse_scene, scene_from_dict
from andon.scene.model import Scene
from andon.scene.presets import PRESETS, Preset, expand_preset
from andon.scene.reference import scene_reference_markdown
from andon.scene.schema import json_schema

__all__ = [
    "LAMP_KINDS",
    "PRESETS",
    "Preset",
    "Scene",
    "dump_scene",
    "expand_preset",
    "json_schema",
    "lamp_at",
    "load_scene",
    "parse_scene",
    "scene_from_dict",
    "scene_reference_markdown",
]
