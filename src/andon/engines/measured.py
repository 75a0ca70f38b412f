"""From [surface] to what is measured of the real surface in each view."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient, MeasuredSurface
from andon.composite.per_lux import map_scale
from andon.errors import InputError
from andon.files.pictures import read_picture
from andon.lenses import undistort
from andon.quantities import CameraFrame
from andon.scene import Scene
from andon.spaces import View

__all__ = ["checked_reflectance", "measured_of", "refuse_without_photograph"]

Float = NDArray[np.float64]


# Beyond these ρ and photograph differ by more than an exposure that was guessed.
LIKELY_SCALES = (0.2, 5.0)


def measured_of(
    scene: Scene, views: Mapping[str, View], frames: Mapping[str, CameraFrame], ambient: Ambient, /
) -> tuple[dict[str, MeasuredSurface], tuple[str, ...]]:
    """Of each of `views` (as captured: with their distortion) what [surface] states of it; notes.

    Raises `InputError` for pictures of another size, of two views, or that are no reflectance.
    """
    if scene.surface is None or scene.surface.reflectance_map is None:
        return {}, ()
    name, view = _only_view(scene, views, "surface.reflectance_map")
    path = scene.path(scene.surface.reflectance_map, "surface.reflectance_map")
    picture = read_picture(path)
    if picture.shape != view.shape:
        height, width = picture.shape
        raise InputError(
            f"is {width}×{height} px but the camera is {view.width}×{view.height}",
            file=str(path),
            field="surface.reflectance_map",
            remedy="give ρ of the photograph's own pixels",
        )
    rho = checked_reflectance(picture.linear(), "surface.reflectance_map", path)
    # Where the lens saw nothing there is nothing to light.
    rho = np.nan_to_num(undistort(rho, view))
    scale = map_scale(rho, frames[name], ambient)
    return {name: MeasuredSurface(scale * rho)}, _on_scale(scale)


def _on_scale(scale: Float) -> tuple[str, ...]:
    low, high = LIKELY_SCALES
    if low <= scale.min() and scale.max() <= high:
        return ()
    times = ", ".join(f"{value:.2g}" for value in scale)
    return (
        f"where E0 is strong the photograph shows {times} times surface.reflectance_map (R, G, B): "
        "the map was scaled so; check capture.luminance_per_unit and E0",
    )


def checked_reflectance(rho: Float, field: str, path: Path | None = None, /) -> Float:
    """`rho` (H, W, 3). Raises `InputError` where a value is no reflectance."""
    bad = int(np.count_nonzero(~((rho >= 0) & (rho <= 1))))
    if bad:
        raise InputError(
            f"ρ must be in [0, 1] everywhere, {bad} of {rho.size} values are not "
            f"(lowest {np.nanmin(rho):g}, highest {np.nanmax(rho):g})",
            file=None if path is None else str(path),
            field=field,
            remedy="state linear reflectance: 0 black, 1 a perfect white",
        )
    return rho


def refuse_without_photograph(scene: Scene, /) -> None:
    """Raises `InputError` for what belongs to a photograph, where there is none."""
    if scene.surface is not None and scene.surface.reflectance_map is not None:
        raise InputError(
            "belongs to a photograph, and there is none",
            file=scene.file,
            field="surface.reflectance_map",
            remedy="state surface.reflectance, or colours in the mesh",
        )


def _only_view(scene: Scene, views: Mapping[str, View], field: str) -> tuple[str, View]:
    if len(views) > 1:
        raise InputError(
            "is one picture for two eyes",
            file=scene.file,
            field=field,
            remedy="leave it out, or relight one eye",
        )
    return next(iter(views.items()))
