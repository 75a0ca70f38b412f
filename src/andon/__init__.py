"""Andon: light for mixed reality.

>>> import andon
>>> scene = andon.load_scene("room.toml")            # doctest: +SKIP
>>> frame = andon.render(scene)                      # doctest: +SKIP
>>> frame.image.rgb, frame.illuminance.lux           # (H, W, 3) uint8, lux   # doctest: +SKIP

Everything here is imported when it is first used; `import andon` itself loads nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from andon.errors import AndonError, InputError, MachineError
    from andon.files import Distribution, read_photometry
    from andon.lamps import (
        DirectionalLamp,
        DiskLamp,
        GoniometricLamp,
        HemisphereLamp,
        MeshLamp,
        PointLamp,
        PolygonLamp,
        Shadow,
        SkyLamp,
        SphereLamp,
        SpotLamp,
        TubeLamp,
    )
    from andon.pipeline import Frame, Renderer, Report, relight, render
    from andon.quantities import (
        CameraFrame,
        DisplayImage,
        Geometry,
        Illuminance,
        Luminance,
        Material,
        Surface,
        photometric,
    )
    from andon.responses import Response
    from andon.scene import Scene, load_scene, scene_from_dict
    from andon.spaces import View, look_at

__version__ = "0.1.0"

# name: module that defines it
_PUBLIC = {
    "AndonError": "errors",
    "CameraFrame": "quantities",
    "DirectionalLamp": "lamps",
    "DiskLamp": "lamps",
    "DisplayImage": "quantities",
    "Distribution": "files",
    "Frame": "pipeline",
    "Geometry": "quantities",
    "GoniometricLamp": "lamps",
    "HemisphereLamp": "lamps",
    "Illuminance": "quantities",
    "InputError": "errors",
    "Luminance": "quantities",
    "MachineError": "errors",
    "Material": "quantities",
    "MeshLamp": "lamps",
    "PointLamp": "lamps",
    "PolygonLamp": "lamps",
    "Renderer": "pipeline",
    "Report": "pipeline",
    "Response": "responses",
    "Scene": "scene",
    "Shadow": "lamps",
    "SkyLamp": "lamps",
    "SphereLamp": "lamps",
    "SpotLamp": "lamps",
    "Surface": "quantities",
    "TubeLamp": "lamps",
    "View": "spaces",
    "load_scene": "scene",
    "look_at": "spaces",
    "photometric": "quantities",
    "read_photometry": "files",
    "relight": "pipeline",
    "render": "pipeline",
    "scene_from_dict": "scene",
}

__all__ = [
    "AndonError",
    "CameraFrame",
    "DirectionalLamp",
    "DiskLamp",
    "DisplayImage",
    "Distribution",
    "Frame",
    "Geometry",
    "GoniometricLamp",
    "HemisphereLamp",
    "Illuminance",
    "InputError",
    "Luminance",
    "MachineError",
    "Material",
    "MeshLamp",
    "PointLamp",
    "PolygonLamp",
    "Renderer",
    "Report",
    "Response",
    "Scene",
    "Shadow",
    "SkyLamp",
    "SphereLamp",
    "SpotLamp",
    "Surface",
    "TubeLamp",
    "View",
    "load_scene",
    "look_at",
    "photometric",
    "read_photometry",
    "relight",
    "render",
    "scene_from_dict",
]


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'andon' has no attribute {name!r}")
    return getattr(import_module(f"andon.{_PUBLIC[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
