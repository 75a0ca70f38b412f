"""From [surface] to what is measured of the real surface in each view."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.composite.curves import beyond_curves
from andon.composite.model import Ambient, MeasuredSurface
from andon.composite.per_lux import map_scale
from andon.composite.reference import relit_linear
from andon.engines.measured_curves import curves_of, one_view
from andon.errors import InputError
from andon.files.pictures import read_picture
from andon.lenses import undistort
from andon.quantities import CameraFrame
from andon.scene import Scene
from andon.spaces import View, another_size
from andon.surface.model import SurfaceModel

if TYPE_CHECKING:
    from andon.engines.prepared import Prepared

__all__ = [
    "beyond_curves_of",
    "checked_reflectance",
    "curved_pixels",
    "measured_of",
    "refuse_without_photograph",
]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Beyond these ρ and photograph differ by more than an exposure that was guessed.
LIKELY_SCALES = (0.2, 5.0)


def measured_of(
    scene: Scene,
    views: Mapping[str, View],
    frames: Mapping[str, CameraFrame],
    ambient: Ambient,
    model: SurfaceModel,
    /,
) -> tuple[dict[str, MeasuredSurface], tuple[str, ...]]:
    """Of each of `views` (as captured: with their distortion) what [surface] states of it; notes.

    Raises `InputError` for pictures of another size, of two views, or that are no reflectance, and
    for curves of surfaces that are not there.
    """
    found = curves_of(scene, views, model)
    if scene.surface is None or scene.surface.reflectance_map is None:
        return found, ()
    rho = _reflectance(scene, scene.surface.reflectance_map, views)
    name = next(iter(views))
    scale = map_scale(rho, frames[name], ambient)
    found[name] = replace(found.get(name, MeasuredSurface()), reflectance=scale * rho)
    return found, _on_scale(scale)


def _reflectance(scene: Scene, reference: str, views: Mapping[str, View]) -> Float:
    """(H, W, 3) ρ of the undistorted view."""
    view = one_view(scene, views, "surface.reflectance_map")
    path = scene.path(reference, "surface.reflectance_map")
    picture = read_picture(path)
    if picture.shape != view.shape:
        field, remedy = "surface.reflectance_map", "give ρ of the photograph's own pixels"
        raise another_size(picture.shape, view, file=path, field=field, remedy=remedy)
    rho = checked_reflectance(picture.linear(), "surface.reflectance_map", path)
    # Where the lens saw nothing there is nothing to light.
    return np.nan_to_num(undistort(rho, view))


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


def _on_scale(scale: Float) -> tuple[str, ...]:
    low, high = LIKELY_SCALES
    if low <= scale.min() and scale.max() <= high:
        return ()
    times = ", ".join(f"{value:.2g}" for value in scale)
    return (
        f"where E0 is strong the photograph shows {times} times surface.reflectance_map (R, G, B): "
        "the map was scaled so; check capture.luminance_per_unit and E0",
    )


def curved_pixels(measured: MeasuredSurface | None, /) -> Mask:
    """(H, W) pixels that have a curve."""
    if measured is None or measured.curve_of is None:
        return np.zeros((), bool)
    return measured.curve_of >= 0


def beyond_curves_of(
    prepared: Prepared, captured: CameraFrame, added_lux: NDArray[Any], /
) -> Mask | None:
    """(H, W) pixels that are darker or brighter than their curve was measured; None without curves.

    `added_lux` (H, W, 3) is ΔE.
    """
    measured = prepared.measured.get(captured.view.name)
    linear, lux = np.asarray(captured.linear, np.float64), np.asarray(added_lux, np.float64)
    if measured is None or measured.curve_of is None:
        return None
    relit = relit_linear(captured, prepared.ambient, lux, measured)
    return beyond_curves(linear, relit, measured)


def refuse_without_photograph(scene: Scene, /) -> None:
    """Raises `InputError` for what belongs to a photograph, where there is none."""
    table = scene.surface
    for key, remedy in (
        ("reflectance_map", "state surface.reflectance, or colours in the mesh"),
        ("response", "leave it out: virtual surfaces have no camera"),
    ):
        if table is not None and getattr(table, key):
            raise InputError(
                "belongs to a photograph, and there is none",
                file=scene.file,
                field=f"surface.{key}",
                remedy=remedy,
            )
