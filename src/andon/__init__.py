"""Andon: light for mixed reality.

>>> import andon
>>> scene = andon.load_scene("room.toml")            # doctest: +SKIP
>>> frame = andon.render(scene)                      # doctest: +SKIP
>>> frame.image.rgb, frame.illuminance.lux           # (H, W, 3) uint8, lux   # doctest: +SKIP

>>> volume = andon.read_probe_volume("room.probes.glb")      # doctest: +SKIP
>>> light = andon.probe_light(volume)                        # doctest: +SKIP
>>> andon.probe_illuminance(light, points, normals)          # (n, 3) lux   # doctest: +SKIP

Everything here is imported when it is first used; `import andon` itself loads nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from andon import harmonics
    from andon.bake import Baked, BakeReport, bake_file, bake_probes, placed_in
    from andon.errors import AndonError, InputError, MachineError
    from andon.files import Distribution, read_photometry
    from andon.files.responses import read_surface_response
    from andon.files.volumes import Cells, Distances, ProbeVolume, Zone, plain_volume
    from andon.files.volumes import read_volume as read_probe_volume
    from andon.files.volumes import write_volume as write_probe_volume
    from andon.glare.picture import GlareResult, glare_of_picture
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
    from andon.responses import Response, SurfaceCurve
    from andon.scene import Scene, load_scene, scene_from_dict
    from andon.spaces import View, look_at
    from andon.transport.probes.light import (
        ProbeLight,
        probe_coefficients,
        probe_illuminance,
        probe_light,
    )
    from andon.transport.probes.locate import Mix
    from andon.transport.probes.placement import Placed
    from andon.transport.probes.space import ProbeSpace

__version__ = "0.1.0"

# name: the module that defines it, and its name there if that is another
_PUBLIC = {
    "AndonError": "errors",
    "BakeReport": "bake",
    "Baked": "bake",
    "CameraFrame": "quantities",
    "Cells": "files.volumes",
    "DirectionalLamp": "lamps",
    "DiskLamp": "lamps",
    "DisplayImage": "quantities",
    "Distances": "files.volumes",
    "Distribution": "files",
    "Frame": "pipeline",
    "Geometry": "quantities",
    "GlareResult": "glare.picture",
    "GoniometricLamp": "lamps",
    "HemisphereLamp": "lamps",
    "Illuminance": "quantities",
    "InputError": "errors",
    "Luminance": "quantities",
    "MachineError": "errors",
    "Material": "quantities",
    "MeshLamp": "lamps",
    "Mix": "transport.probes.locate",
    "Placed": "transport.probes.placement",
    "PointLamp": "lamps",
    "PolygonLamp": "lamps",
    "ProbeLight": "transport.probes.light",
    "ProbeSpace": "transport.probes.space",
    "ProbeVolume": "files.volumes",
    "Renderer": "pipeline",
    "Report": "pipeline",
    "Response": "responses",
    "Scene": "scene",
    "Shadow": "lamps",
    "SkyLamp": "lamps",
    "SphereLamp": "lamps",
    "SpotLamp": "lamps",
    "Surface": "quantities",
    "SurfaceCurve": "responses",
    "TubeLamp": "lamps",
    "View": "spaces",
    "Zone": "files.volumes",
    "bake_file": "bake",
    "bake_probes": "bake",
    "glare_of_picture": "glare.picture",
    "harmonics": "harmonics",
    "load_scene": "scene",
    "look_at": "spaces",
    "photometric": "quantities",
    "placed_in": "bake",
    "plain_volume": "files.volumes",
    "probe_coefficients": "transport.probes.light",
    "probe_illuminance": "transport.probes.light",
    "probe_light": "transport.probes.light",
    "read_photometry": "files",
    "read_probe_volume": "files.volumes:read_volume",
    "read_surface_response": "files.responses",
    "relight": "pipeline",
    "render": "pipeline",
    "scene_from_dict": "scene",
    "write_probe_volume": "files.volumes:write_volume",
}

__all__ = [
    "AndonError",
    "BakeReport",
    "Baked",
    "CameraFrame",
    "Cells",
    "DirectionalLamp",
    "DiskLamp",
    "DisplayImage",
    "Distances",
    "Distribution",
    "Frame",
    "Geometry",
    "GlareResult",
    "GoniometricLamp",
    "HemisphereLamp",
    "Illuminance",
    "InputError",
    "Luminance",
    "MachineError",
    "Material",
    "MeshLamp",
    "Mix",
    "Placed",
    "PointLamp",
    "PolygonLamp",
    "ProbeLight",
    "ProbeSpace",
    "ProbeVolume",
    "Renderer",
    "Report",
    "Response",
    "Scene",
    "Shadow",
    "SkyLamp",
    "SphereLamp",
    "SpotLamp",
    "Surface",
    "SurfaceCurve",
    "TubeLamp",
    "View",
    "Zone",
    "bake_file",
    "bake_probes",
    "glare_of_picture",
    "harmonics",
    "load_scene",
    "look_at",
    "photometric",
    "placed_in",
    "plain_volume",
    "probe_coefficients",
    "probe_illuminance",
    "probe_light",
    "read_photometry",
    "read_probe_volume",
    "read_surface_response",
    "relight",
    "render",
    "scene_from_dict",
    "write_probe_volume",
]


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'andon' has no attribute {name!r}")
    path, _, own = _PUBLIC[name].partition(":")
    module = import_module(f"andon.{path}")
    return module if path == name else getattr(module, own or name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
