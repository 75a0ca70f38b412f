"""Light of visible lamps that a picture does not hold, though it enters the eye and veils it.

- What is *beside* the picture: a lamp that leaves it would take its veil with it.
- What is *above* its numbers: half floats end at 65504 units, a car's headlight at night does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.glare.lamp_sources import source_of_lamp
from andon.glare.model import Source
from andon.glare.sources.live import LiveSources
from andon.lamps import AreaLamp, Lamp, PointLamp, SphereLamp
from andon.lamps.kinds import middle_of_area
from andon.quantities import Geometry
from andon.rays import RayScene
from andon.spaces import View, rotate

__all__ = ["UnpicturedLamps"]

Float = NDArray[np.float64]

# Points on a source by which its shares beside the picture and behind other things are told.
POINTS = 64
GOLDEN_TURN = np.pi * (3 - np.sqrt(5))
# A source found is the lamp that is nearer to it than so many radii of the lamp.
NEAR_OUTLINES = 2.0
# A directional lamp is looked for this far away.
FAR_M = 1e4


class UnpicturedLamps:
    """Visible lamps as round sources; what hides a part of a ball is asked of points on it."""

    def __init__(self, geometry: Geometry, most_cd_m2: float = np.inf) -> None:
        """`most_cd_m2`: the greatest luminance that the picture holds, in each channel."""
        self._geometry, self._most = geometry, most_cd_m2

    @cached_property
    def _rays(self) -> RayScene | None:
        return RayScene(self._geometry) if len(self._geometry.triangles) else None

    def split(
        self, lamps: Sequence[Lamp], found: LiveSources, view: View, /, *, blooms: bool
    ) -> tuple[LiveSources, list[Source]]:
        """The sources found with the light that the picture cut, and what it does not hold.

        The first are for needles, which go by all of a source's light; the second for bloom, which
        the picture's own light has already. With `blooms` the first have their own bloom, too, so
        that what was given to them is not among the second.
        """
        sources, left = list(found.sources), list[Source]()
        for lamp in lamps:
            source = source_of_lamp(lamp, view)
            if source is None:
                continue
            source = source.rounded()
            points = _points_on(source)
            inside = _in_picture(points, view)
            luminance = source.luminance_cd_m2
            cut = 1 - np.minimum(luminance, self._most) / np.maximum(
                luminance, np.finfo(float).tiny
            )
            if inside.all() and not cut.any():
                continue
            visible = self._visible(lamp, points, view)
            beside, held = np.mean(visible & ~inside), np.mean(visible & inside) * cut
            is_found = _complete(sources, source, held) if held.any() else False
            share = beside + np.zeros(3) if blooms and is_found else beside + held
            if share.any():
                left.append(replace(source, illuminance_lux=share * source.illuminance_lux))
        return replace(found, sources=tuple(sources)), left

    def _visible(self, lamp: Lamp, points: Float, view: View) -> NDArray[np.bool_]:
        """(n,) bool: nothing hides the points of a lamp in the unit directions (n, 3).

        Of flat and long lamps the middle is asked for all: what is round in their place would reach
        into the ceiling that they hang from.
        """
        if self._rays is None:
            return np.ones(len(points), bool)
        eye = view.position
        if isinstance(lamp, AreaLamp) and not isinstance(lamp, SphereLamp):
            seen = self._rays.is_visible(eye[None], middle_of_area(lamp))
            return np.full(len(points), bool(seen[0]))
        distance = FAR_M
        if isinstance(lamp, PointLamp | SphereLamp):
            distance = float(np.linalg.norm(lamp.position_m - eye))
        places = eye + distance * rotate(view.world_from_camera, points)
        return self._rays.is_visible(np.broadcast_to(eye, places.shape), places)


def _complete(sources: list[Source], lamp: Source, share: Float) -> bool:
    """Gives the source that a lamp was found as a share of the lamp's light; False: it was not."""
    reach = NEAR_OUTLINES * float(lamp.outline.radii_radians[0])
    apart = [float(np.linalg.norm(each.direction - lamp.direction)) for each in sources]
    if not apart or min(apart) > reach:
        return False
    number = int(np.argmin(apart))
    # Added, not scaled: two lamps that touch in the picture are one source there.
    light = sources[number].illuminance_lux + share * lamp.illuminance_lux
    sources[number] = replace(sources[number], illuminance_lux=light)
    return True


def _points_on(source: Source) -> Float:
    """(POINTS, 3) unit directions over a round source, each of an equal part of its solid angle."""
    right, down = source.axes
    radius = float(source.outline.radii_radians[0])
    index = np.arange(POINTS) + 0.5
    # Equal steps of the solid angle 2π(1 − cos θ).
    theta = 2 * np.arcsin(np.sin(radius / 2) * np.sqrt(index / POINTS))
    phi = GOLDEN_TURN * index
    across = np.cos(phi)[:, None] * right + np.sin(phi)[:, None] * down
    return np.cos(theta)[:, None] * source.direction + np.sin(theta)[:, None] * across


def _in_picture(directions: Float, view: View) -> NDArray[np.bool_]:
    """(n,) bool of directions (n, 3) in the camera's frame."""
    pixels = view.project(directions) + 0.5
    with np.errstate(invalid="ignore"):  # behind a pinhole
        return np.all((pixels >= 0) & (pixels < view.shape[::-1]), axis=-1)
