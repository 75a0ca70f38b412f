"""The work of a bake's tasks: a function of files and numbers each, run wherever workers are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.illuminance_maps import geometry_bytes, light_bytes
from andon.files.pictures import npy_bytes
from andon.quantities import Surface
from andon.spaces import View, transform_points
from andon.transport.baked.radiance.quality import QUALITIES
from andon.transport.baked.radiance.trace import traced_illuminance

__all__ = [
    "GEOMETRY",
    "LIGHT",
    "VERSION",
    "geometry",
    "light",
    "points_bundle",
    "quality_settings",
    "view_settings",
]

GEOMETRY, LIGHT = "andon.bake.maps.work:geometry", "andon.bake.maps.work:light"
# Of both; results of another version are computed again.
VERSION = 1


def points_bundle(surface: Surface, /) -> dict[str, bytes]:
    """What a map sees, as files: NPY of depth (h, w) in metres and of normals (h, w, 3), float32.

    NaN where there is no surface. The map stores the same numbers, so its light is that of exactly
    its points: positions follow from depth and view, 0.2 µm off at 3 m, where light is measured
    0.1 mm above them.
    """
    hole = ~(surface.valid & np.isfinite(surface.normal).all(axis=-1) & (surface.depth > 0))
    depth = np.where(hole, np.nan, surface.depth).astype("<f4")
    normal = np.where(hole[..., None], np.nan, surface.normal).astype("<f4")
    return {"depth.npy": npy_bytes(depth), "normal.npy": npy_bytes(normal)}


def view_settings(view: View, /) -> dict[str, Any]:
    """Where the pixels of a map look, as settings of a task; its name is no part of it."""
    numbers = {key: float(getattr(view, key)) for key in ("fx", "fy", "cx", "cy")}
    if view.projection == "latlong":
        numbers = {}
    pose = [[float(value) for value in row] for row in view.world_from_camera]
    size = {"width": int(view.width), "height": int(view.height)}
    return {"projection": view.projection, **size, **numbers, "world_from_camera": pose}


def _view(settings: Mapping[str, Any]) -> View:
    table: dict[str, Any] = dict(settings)
    table["world_from_camera"] = np.array(table["world_from_camera"])
    return View(**table)


def geometry(inputs: Mapping[str, Path], settings: Mapping[str, Any], /) -> bytes:
    """The file with depths and normals of what a map sees (``points``)."""
    return geometry_bytes(_read(inputs["points"], "depth"), _read(inputs["points"], "normal"))


def light(inputs: Mapping[str, Path], settings: Mapping[str, Any], /) -> bytes:
    """The file with the illuminance of one lamp (``world``) on what a map sees (``points``).

    Settings: ``view``, ``quality`` (a name and its options), ``bounces``, ``part``,
    ``direct_bounces``, ``photometry``.
    """
    quality = QUALITIES[settings["quality"]["name"]]
    if quality_settings(quality.name) != dict(settings["quality"]):
        raise InputError(
            "this worker's Radiance settings are those of another version",
            field="quality",
            remedy="install the same version of Andon everywhere",
        )
    view = _view(settings["view"])
    depth, normal = _read(inputs["points"], "depth"), _read(inputs["points"], "normal")
    valid = np.isfinite(depth)
    local = view.rays_planar()[valid] * depth[valid, None].astype(np.float64)
    lux = np.zeros((*valid.shape, 3), np.float32)
    lux[valid] = traced_illuminance(
        inputs["world"],
        transform_points(view.world_from_camera, local),
        normal[valid],
        quality=quality,
        bounces=settings["bounces"],
        part=settings["part"],
        direct_bounces=settings["direct_bounces"],
    )
    return light_bytes(lux, photometry=settings["photometry"])


# What was measured of a quality, and changes nothing.
MEASURED = ("median_error", "p95_error", "seconds_per_100k_points")


def quality_settings(name: str, /) -> dict[str, Any]:
    """All of a quality that results depend on, as settings of a task."""
    known = asdict(QUALITIES[name])
    return {key: value for key, value in known.items() if key not in MEASURED}


def _read(folder: Path, name: str) -> NDArray[Any]:
    return np.load(folder / f"{name}.npy", allow_pickle=False)
