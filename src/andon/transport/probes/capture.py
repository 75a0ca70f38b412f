"""What a probe sees: the light that six pictures around a place hold, from what their rays meet.

What
    Surfaces answer as diffuse reflectors, L = ρ·E/π plus what they emit; rays that meet nothing see
    the sky, or around what a photograph shows surroundings of the luminance E0/π. The light is kept
    in parts, since not all of them may be reflected once more:

==============  ================================  ==============================================
part            is                                in later bounces
==============  ================================  ==============================================
``ambient``     the photograph's own light (or    no: E0 was measured, all its reflections are
                E0 on surfaces without one), and  in it already
                that of its surroundings
``emitted``     of materials, and the sky         the first light that is reflected
``reflected``   of lamps, or of earlier bounces   yes
==============  ================================  ==============================================

Why surroundings
    A photograph shows a part of what lights the things in it. The rest is known by E0 alone:
    uniform surroundings of E0/π are those that give E0.

Why the photograph is looked up
    A photographed surface has no reflectance of its own: it is what the picture shows of it, and
    ρ = π·L/E0. Points are projected into the picture; what it did not see takes the picture's mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.harmonics import cube_solid_angles
from andon.lamps import HemisphereLamp, SkyLamp
from andon.responses import srgb_decode, srgb_encode
from andon.transport.probes.photograph import Photograph

__all__ = ["Capture", "Lighting", "Seen", "captured", "quantised", "sky_luminance"]

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Seen:
    """What the rays of a cube map meet; all (6, s, s, …), in the layout of `cube_directions`.

    Attributes
    ----------
    position : (6, s, s, 3) metres, world; NaN where nothing is met.
    normal : (6, s, s, 3) unit, turned to the probe; NaN where nothing is met.
    distance_m : (6, s, s) along the ray; inf where nothing is met.
    is_object : (6, s, s) bool, virtual; else the real surface, or nothing.
    reflectance : (6, s, s, 3) ρ of materials.
    emitted_cd_m2 : (6, s, s, 3) luminance of materials.
    """

    position: Float
    normal: Float
    distance_m: Float
    is_object: NDArray[np.bool_]
    reflectance: Float
    emitted_cd_m2: Float

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(6, s, s) a surface is met."""
        return np.isfinite(self.distance_m)


@dataclass(frozen=True, eq=False)
class Lighting:
    """What light there is besides that of lamps.

    Attributes
    ----------
    ambient_lux : (3,) E0 that surfaces stand in which no photograph shows, dimmed.
    photograph : what shows the real surface; None: its materials do.
    sky : lamps that are seen where nothing else is.
    surroundings_cd_m2 : (3,) luminance of what a photograph does not show, where nothing else is;
        None: it is dark there.
    """

    ambient_lux: Float
    photograph: Photograph | None = None
    sky: tuple[SkyLamp | HemisphereLamp, ...] = ()
    surroundings_cd_m2: Float | None = None


@dataclass(frozen=True, eq=False)
class Capture:
    """The light around a probe.

    Attributes
    ----------
    ambient_cd_m2, emitted_cd_m2, reflected_cd_m2 : (6, s, s, 3) its parts. What is reflected is
        negative where light is taken away; the sum is ≥ 0.
    distance_m : (6, s, s) to the first surface, inf where there is none; not cut at the range.
    unphotographed_share : of the texels that show the real surface, those that no photograph saw.
    surroundings_share : of the solid angle of all directions, that of the surroundings.
    not_finite : texels whose light was no number and is counted as none.
    """

    ambient_cd_m2: Float
    emitted_cd_m2: Float
    reflected_cd_m2: Float
    distance_m: Float
    unphotographed_share: float = 0.0
    surroundings_share: float = 0.0
    not_finite: int = 0

    @property
    def luminance_cd_m2(self) -> Float:
        """(6, s, s, 3) all of it, ≥ 0."""
        return np.maximum(self.ambient_cd_m2 + self.emitted_cd_m2 + self.reflected_cd_m2, 0)


def captured(
    seen: Seen,
    directions: Float,
    lighting: Lighting,
    /,
    *,
    lux: Float,
    range_m: float = np.inf,
) -> Capture:
    """The light of a cube map.

    Parameters
    ----------
    directions : (6, s, s, 3) unit.
    lux : (6, s, s, 3) what lamps and earlier bounces give to each point.
    range_m : surfaces beyond are dark; the sky is not cut.
    """
    valid = seen.valid
    ambient = seen.reflectance * lighting.ambient_lux / np.pi
    emitted = seen.emitted_cd_m2.copy()
    reflectance = seen.reflectance
    share = 0.0
    own = valid & ~seen.is_object
    if lighting.photograph is not None and own.any():
        shown = lighting.photograph.at(seen.position[own])
        ambient[own] = shown.luminance_cd_m2
        reflectance = reflectance.copy()
        reflectance[own] = shown.reflectance
        share = 1 - float(shown.seen.mean())
    # What is taken away of the photograph's light is at most all of it.
    reflected = np.maximum(reflectance * lux / np.pi, -ambient)
    dark = ~(valid & (seen.distance_m <= range_m))
    parts = (ambient, emitted, reflected)
    for part in parts:
        part[dark] = 0
    around = 0.0
    if lighting.surroundings_cd_m2 is not None:
        ambient[~valid] = lighting.surroundings_cd_m2
        around = _share(~valid)
    sky = sky_luminance(lighting.sky, directions[~valid])
    emitted[~valid] = np.maximum(sky, -ambient[~valid])
    bad = ~np.isfinite(ambient + emitted + reflected).all(axis=-1)
    for part in parts:
        part[bad] = 0
    return Capture(*parts, seen.distance_m, share, around, int(np.count_nonzero(bad)))


def _share(texels: NDArray[np.bool_]) -> float:
    """Of the solid angle of a cube map (6, s, s), that of `texels`."""
    angles = np.broadcast_to(cube_solid_angles(texels.shape[-1]), texels.shape)
    return float(angles[texels].sum() / angles.sum())


def sky_luminance(sky: Sequence[SkyLamp | HemisphereLamp], directions: Float, /) -> Float:
    """Luminance (n, 3) in cd/m² of the sky in unit `directions` (n, 3).

    A dome of luminance E/π above the horizon gives E to a surface that faces the zenith; of a
    hemisphere lamp the ground below likewise.
    """
    total = np.zeros_like(directions)
    for lamp in sky:
        above: NDArray[np.bool_] = (directions @ lamp.up > 0)[:, None]
        if isinstance(lamp, SkyLamp):
            upper, lower = lamp.illuminance_lux, np.zeros(3)
        else:
            upper, lower = lamp.sky_illuminance_lux, lamp.ground_illuminance_lux
        total += np.where(above, upper, lower) / np.pi
    return total


def quantised(luminance_cd_m2: Float, white_cd_m2: float, /) -> tuple[Float, int]:
    """The light as 8-bit sRGB codes hold it, and how many texels the codes clip.

    This is what the capture paper's browser stores; here its codes are linearised again.
    """
    share = np.asarray(luminance_cd_m2, np.float64) / white_cd_m2
    codes: Float = np.rint(srgb_encode(np.clip(share, 0, 1)) * 255).astype(np.float64)
    clipped = int(np.count_nonzero((share > 1).any(axis=-1)))
    return np.asarray(srgb_decode(codes / 255) * white_cd_m2, np.float64), clipped
