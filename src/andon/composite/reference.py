"""The composite in float64."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.lamps import Lamp, PointLamp, intensity_cd
from andon.quantities import CameraFrame, Surface
from andon.spaces import View

__all__ = ["compose", "draw_lamps", "lamp_luminance", "object_luminance", "relit_linear"]

Float = NDArray[np.float64]


def relit_linear(frame: CameraFrame, ambient: Ambient, added_lux: Float, /) -> Float:
    """Linear camera values (H, W, 3) under the new light: captured × (dimming·E0 + ΔE)/E0."""
    captured = np.asarray(frame.linear, np.float64)
    dimming = np.asarray(ambient.dimming)
    if ambient.dimming_mode == "linear":
        return captured * (dimming + added_lux / ambient.illuminance_lux)
    dimmed = frame.response.decode(dimming * frame.response.encode(captured))
    return dimmed + captured * (added_lux / ambient.illuminance_lux)


def object_luminance(surface: Surface, ambient: Ambient, added_lux: Float, /) -> Float:
    """Luminance (H, W, 3) in cd/m² of diffuse virtual objects: ρ·E/π plus what they emit."""
    received = np.asarray(ambient.dimming) * ambient.mean_lux + added_lux
    return surface.reflectance * received / np.pi + surface.emitted_cd_m2


def compose(
    frame: CameraFrame,
    surface: Surface,
    ambient: Ambient,
    added_lux: Float,
    lamps: Sequence[Lamp],
    /,
) -> Float:
    """Luminance (H, W, 3) in cd/m² of the whole picture.

    `added_lux` (H, W, 3) is ΔE, 0 in holes.
    """
    real = frame.luminance_per_unit * relit_linear(frame, ambient, added_lux)
    virtual = object_luminance(surface, ambient, added_lux)
    luminance = np.where(surface.is_object[..., None], virtual, real)
    return draw_lamps(luminance, surface, lamps)


def lamp_luminance(lamp: PointLamp, eye: Float, /) -> Float:
    """(3,) cd/m² of the lamp's visible disc as seen from `eye` (3,): I towards the eye / (π r²)."""
    reach = eye - lamp.position_m
    towards_eye = reach / np.linalg.norm(reach)
    return intensity_cd(lamp, towards_eye) / (np.pi * lamp.visible_radius_m**2)


def draw_lamps(luminance: Float, surface: Surface, lamps: Sequence[Lamp], /) -> Float:
    """The picture with visible lamps in it: discs, hidden by whatever is nearer.

    A hole hides nothing. The rim is blended over one pixel's angle.
    """
    drawn = [x for x in lamps if isinstance(x, PointLamp) and x.visible_radius_m > 0]
    if not drawn:
        return luminance
    view = surface.view
    origin, directions = view.rays_world()
    # A lamp exactly at the eye lies in no direction.
    drawn = [x for x in drawn if np.linalg.norm(x.position_m - origin) > 0]
    pixel_angle = np.sqrt(view.solid_angles())
    distance = _distance(surface, view)
    for lamp in sorted(drawn, key=lambda x: -float(np.linalg.norm(x.position_m - origin))):
        reach = lamp.position_m - origin
        away = float(np.linalg.norm(reach))
        radius = np.arcsin(min(1.0, lamp.visible_radius_m / away))
        angle = _angle_between(directions, reach / away)
        cover = np.clip((radius - angle) / pixel_angle + 0.5, 0, 1) * (away < distance)
        luminance = luminance + cover[..., None] * (lamp_luminance(lamp, origin) - luminance)
    return luminance


def _angle_between(directions: Float, axis: Float) -> Float:
    """Angles (H, W), precise near 0 where arccos is not."""
    return 2 * np.arcsin(np.clip(np.linalg.norm(directions - axis, axis=-1) / 2, 0, 1))


def _distance(surface: Surface, view: View) -> Float:
    """(H, W) distance of the surface from the camera, inf in holes."""
    distance = np.linalg.norm(surface.position - view.position, axis=-1)
    return np.where(surface.valid & np.isfinite(distance), distance, np.inf)
