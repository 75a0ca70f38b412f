"""The photograph of a scene, its surface and its known sources, as the estimate wants them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.capture.still import frame_from_picture
from andon.engines.ambient_light import source_lux
from andon.engines.reading import read_pictures, response_of, source_of, view_of
from andon.errors import InputError
from andon.lenses import distorted_pixels
from andon.quantities import CameraFrame, Surface
from andon.scene import Scene
from andon.spaces import View
from andon.surface import reference as surface
from andon.surface.load import load_surface
from andon.surface.model import SurfaceModel

__all__ = ["Photograph", "as_captured", "photograph_of"]

Float = NDArray[np.float64]

# Rounds in which a lens's mapping is turned round; each gains about a digit.
ROUNDS = 12


@dataclass(frozen=True, eq=False)
class Photograph:
    """One view of a scene.

    Attributes
    ----------
    frame : its light, of the undistorted view. Without a `luminance_per_unit` in the scene it is 1,
        and `has_unit` False.
    seen : the real surface.
    captured : the view with its distortion.
    sources : name of each known source → (H, W, 3) lux that it gives directly.
    """

    frame: CameraFrame
    seen: Surface
    captured: View
    sources: Mapping[str, Float]
    has_unit: bool


def photograph_of(scene: Scene, view_name: str | None = None, /) -> Photograph:
    """Reads one view of a scene; default: its only or first one.

    Raises `InputError` for files that do not fit, and where there is no surface.
    """
    if scene.surface is None:
        raise InputError(
            "is missing: light needs geometry to fall on",
            file=scene.file,
            field="surface",
            remedy="add [surface] with depth, mesh or normals",
        )
    pictures = read_pictures(scene)
    name = view_name or next(iter(pictures))
    if name not in pictures:
        raise InputError(
            f"there is no view {name!r}, this rig has {' and '.join(pictures)}", field="--view"
        )
    views = {own: view_of(scene, own, picture.shape) for own, picture in pictures.items()}
    model = load_surface(scene, views)
    unit = scene.capture.luminance_per_unit if scene.capture else None
    frame = frame_from_picture(
        pictures[name],
        views[name],
        response_of(scene, pictures[name]),
        luminance_per_unit=unit or 1.0,
        file=source_of(scene, name)[0],
    )
    real = replace(model, objects=SurfaceModel().objects, objects_table=(), movers=())
    seen = surface.see(real, replace(frame.view, name=name))
    return Photograph(
        frame, seen, views[name], source_lux(scene, model, seen), has_unit=unit is not None
    )


def as_captured(lux: Float, view: View, /) -> Float:
    """E0 (H, W, 3) of the undistorted view as `view`, which is distorted, saw it.

    What ``ambient.map`` holds: pixels of the photograph as it was captured. Each of its pixels is
    looked for by turning the lens's mapping round, step by step; E0 is smooth, so that a tenth of
    a pixel is enough.
    """
    if not view.distortion:
        return lux
    import cv2

    grid = view.pixel_grid()
    shift = (distorted_pixels(view) - grid).astype(np.float32)
    found = grid.astype(np.float32)
    for _ in range(ROUNDS):
        moved = cv2.remap(
            shift, found[..., 0], found[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        found = (grid - moved).astype(np.float32)
    whole = cv2.remap(
        lux, found[..., 0], found[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    return np.asarray(whole, np.float64)
