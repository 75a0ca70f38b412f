"""The composite in float64."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.composite.curves import dimmed_light, linear_of
from andon.composite.model import Ambient, MeasuredSurface
from andon.composite.per_lux import per_lux
from andon.lamps import Lamp, PointLamp, SphereLamp, intensity_cd
from andon.quantities import CameraFrame, Surface

__all__ = [
    "Disc",
    "bodies_luminance",
    "compose",
    "disc_of",
    "draw_lamps",
    "drawn_lamps",
    "lamp_luminance",
    "object_luminance",
    "relit_linear",
    "unlit_linear",
]

Float = NDArray[np.float64]


def relit_linear(
    frame: CameraFrame,
    ambient: Ambient,
    added_lux: Float,
    /,
    measured: MeasuredSurface | None = None,
) -> Float:
    """Linear camera values (H, W, 3) under the new light: captured × (dimming·E0 + ΔE)/E0.

    Where `measured` has a curve f that is f(f⁻¹(captured) × (dimming·E0 + ΔE)/E0); where it has ρ,
    what a lux of ΔE adds is `per_lux`. Where light is taken away ΔE is negative; no light at all is
    the least that is left.
    """
    if measured is None and ambient.dimming_mode == "linear":
        captured, e0 = np.asarray(frame.linear, np.float64), ambient.lux_of(frame.view.name)
        return captured * np.maximum(np.asarray(ambient.dimming) + added_lux / e0, 0)
    dimmed = dimmed_light(frame, ambient, measured)
    light = dimmed + per_lux(frame, ambient, measured) * added_lux
    return linear_of(np.maximum(light, np.minimum(dimmed, 0)), measured)


def unlit_linear(
    frame: CameraFrame, ambient: Ambient, /, measured: MeasuredSurface | None = None
) -> Float:
    """Linear camera values (H, W, 3) in what dimming leaves of E0, without any lamp."""
    return relit_linear(frame, ambient, np.zeros(3), measured)


def object_luminance(
    surface: Surface, ambient: Ambient, added_lux: Float, /, standing_lux: Float | None = None
) -> Float:
    """Luminance (H, W, 3) in cd/m² of diffuse virtual objects: ρ·E/π plus what they emit.

    They stand in the mean of E0, dimmed, or in `standing_lux` (H, W, 3) where it is not NaN.
    """
    standing = ambient.standing_lux
    if standing_lux is not None:
        standing = np.where(np.isnan(standing_lux), standing, standing_lux)
    received = np.maximum(standing + added_lux, 0)
    return surface.reflectance * received / np.pi + surface.emitted_cd_m2


def bodies_luminance(surface: Surface, lamps: Sequence[Lamp], /) -> Float:
    """Luminance (H, W, 3) in cd/m² of luminous bodies and visible lamps alone; 0 elsewhere."""
    alone = np.zeros((*surface.view.shape, 3))
    if surface.body_id is not None:
        alone = np.where(surface.body_id[..., None] >= 0, surface.emitted_cd_m2, 0.0)
    if surface.shell_cd_m2 is not None:
        alone = alone + surface.shell_cd_m2
    return draw_lamps(alone, surface, lamps)


def compose(
    frame: CameraFrame,
    surface: Surface,
    ambient: Ambient,
    added_lux: Float,
    lamps: Sequence[Lamp],
    /,
    standing_lux: Float | None = None,
    mirror: Callable[[Float], Float] | None = None,
    measured: MeasuredSurface | None = None,
) -> Float:
    """Luminance (H, W, 3) in cd/m² of the whole picture.

    `added_lux` (H, W, 3) is ΔE, 0 in holes; `standing_lux` as in `object_luminance`; `mirror` adds
    what virtual objects mirror to the picture of diffuse light; `measured` is of the real surface.
    """
    real = frame.luminance_per_unit * relit_linear(frame, ambient, added_lux, measured)
    virtual = object_luminance(surface, ambient, added_lux, standing_lux)
    luminance = np.where(surface.is_object[..., None], virtual, real)
    if surface.shell_cd_m2 is not None:
        luminance = luminance + surface.shell_cd_m2
    luminance = luminance if mirror is None else mirror(luminance)
    return draw_lamps(luminance, surface, lamps)


def lamp_luminance(lamp: PointLamp, eye: Float, /) -> Float:
    """(3,) cd/m² of the lamp's visible disc as seen from `eye` (3,): I towards the eye / (π r²)."""
    reach = eye - lamp.position_m
    towards_eye = reach / np.linalg.norm(reach)
    return intensity_cd(lamp, towards_eye) / (np.pi * lamp.visible_radius_m**2)


@dataclass(frozen=True)
class Disc:
    """A lamp as it is drawn: `position_m` (3,), `radius_m`, and `luminance_cd_m2` (3,).

    What is nearer to its middle than `glass_m` does not hide it.
    """

    position_m: Float
    radius_m: float
    luminance_cd_m2: Float
    glass_m: float = 0.0


def disc_of(lamp: Lamp, eye: Float, /) -> Disc | None:
    """The disc that `lamp` is drawn as for `eye` (3,); None for what is not drawn so.

    Lamps with an area are drawn as the bodies that they are; a ball without one as a disc.
    """
    if isinstance(lamp, SphereLamp) and lamp.drawn and not lamp.body:
        return Disc(lamp.position_m, lamp.radius_m, lamp.luminance_cd_m2, lamp.glass_m)
    if not isinstance(lamp, PointLamp) or lamp.visible_radius_m <= 0:
        return None
    luminance = lamp_luminance(lamp, eye)
    return Disc(lamp.position_m, lamp.visible_radius_m, luminance, lamp.glass_m)


def drawn_lamps(lamps: Sequence[Lamp], eye: Float, /) -> list[Disc]:
    """The discs of a picture, far to near."""
    # A lamp exactly at the eye lies in no direction.
    away = [(lamp, getattr(lamp, "position_m", eye) - eye) for lamp in lamps]
    found = [disc_of(lamp, eye) for lamp, reach in away if np.linalg.norm(reach) > 0]
    discs = [disc for disc in found if disc is not None]
    return sorted(discs, key=lambda disc: -float(np.linalg.norm(disc.position_m - eye)))


def draw_lamps(luminance: Float, surface: Surface, lamps: Sequence[Lamp], /) -> Float:
    """The picture with visible lamps in it: discs, hidden by whatever is nearer.

    A hole hides what is behind its cover. The rim is blended over one pixel's angle.
    """
    view = surface.view
    discs = drawn_lamps(lamps, view.position)
    if not discs:
        return luminance
    origin, directions = view.rays_world()
    pixel_angle = np.sqrt(view.solid_angles())
    distance = surface.distance_m
    for disc in discs:
        reach = disc.position_m - origin
        away = float(np.linalg.norm(reach))
        radius = np.arcsin(min(1.0, disc.radius_m / away))
        angle = _angle_between(directions, reach / away)
        cover = np.clip((radius - angle) / pixel_angle + 0.5, 0, 1) * (
            away - disc.glass_m < distance
        )
        luminance = luminance + cover[..., None] * (disc.luminance_cd_m2 - luminance)
    return luminance


def _angle_between(directions: Float, axis: Float) -> Float:
    """Angles (H, W), precise near 0 where arccos is not."""
    return 2 * np.arcsin(np.clip(np.linalg.norm(directions - axis, axis=-1) / 2, 0, 1))
