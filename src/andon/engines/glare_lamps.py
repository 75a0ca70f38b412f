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
from andon.lamps import AreaLamp, DirectionalLamp, Lamp, PointLamp
from andon.lamps.kinds import middle_of_area
from andon.quantities import Geometry
from andon.rays import RayScene
from andon.spaces import View

__all__ = ["UnpicturedLamps"]

Float = NDArray[np.float64]

# Points on a source, of equal solid angle, by which its share beside the picture is told.
POINTS = 64
GOLDEN_TURN = np.pi * (3 - np.sqrt(5))
# A source found is the lamp that is nearer to it than so many radii of the lamp.
NEAR_OUTLINES = 2.0
# A directional lamp is looked for this far away.
FAR_M = 1e4


class UnpicturedLamps:
    """Visible lamps as round sources. Whether anything hides one is asked of its middle alone."""

    def __init__(self, geometry: Geometry, most_cd_m2: float = np.inf) -> None:
        """`most_cd_m2`: the greatest luminance that the picture holds, in each channel."""
        self._geometry, self._most = geometry, most_cd_m2

    @cached_property
    def _rays(self) -> RayScene | None:
        return RayScene(self._geometry) if len(self._geometry.triangles) else None

    def split(
        self, lamps: Sequence[Lamp], found: LiveSources, view: View, /
    ) -> tuple[LiveSources, list[Source]]:
        """The sources found with the light that the picture cut, and what it does not hold.

        The first are for needles, which go by all of a source's light; the second for bloom, which
        the picture's own light has already.
        """
        sources, left = list(found.sources), list[Source]()
        for lamp in lamps:
            source = source_of_lamp(lamp, view)
            if source is None:
                continue
            source = source.rounded()
            beside = _share_beside(source, view)
            cut = 1 - np.minimum(source.luminance_cd_m2, self._most) / np.maximum(
                source.luminance_cd_m2, np.finfo(float).tiny
            )
            share = beside + (1 - beside) * cut
            if not share.any() or not self._is_seen(lamp, view):
                continue
            left.append(replace(source, illuminance_lux=share * source.illuminance_lux))
            if beside < 1:
                _complete(sources, source, cut)
        return replace(found, sources=tuple(sources)), left

    def _is_seen(self, lamp: Lamp, view: View) -> bool:
        if self._rays is None:
            return True
        if isinstance(lamp, DirectionalLamp):
            place = view.position - FAR_M * lamp.direction
        elif isinstance(lamp, PointLamp):
            place = lamp.position_m
        else:
            assert isinstance(lamp, AreaLamp)  # others are no sources
            place = middle_of_area(lamp)
        return bool(self._rays.is_visible(view.position[None], place)[0])


def _complete(sources: list[Source], lamp: Source, cut: Float) -> None:
    """Gives the source that a lamp was found as the light that was cut from it."""
    reach = NEAR_OUTLINES * float(lamp.outline.radii_radians[0])
    apart = [float(np.linalg.norm(each.direction - lamp.direction)) for each in sources]
    if not apart or min(apart) > reach:
        return
    number = int(np.argmin(apart))
    light = sources[number].illuminance_lux / np.maximum(1 - cut, 1e-30)
    sources[number] = replace(sources[number], illuminance_lux=light)


def _share_beside(source: Source, view: View) -> float:
    """Share of a round source's solid angle that is not in the picture."""
    right, down = source.axes
    radius = float(source.outline.radii_radians[0])
    index = np.arange(POINTS) + 0.5
    # Equal steps of the solid angle 2π(1 − cos θ).
    theta = 2 * np.arcsin(np.sin(radius / 2) * np.sqrt(index / POINTS))
    phi = GOLDEN_TURN * index
    across = np.cos(phi)[:, None] * right + np.sin(phi)[:, None] * down
    points = np.cos(theta)[:, None] * source.direction + np.sin(theta)[:, None] * across
    pixels = view.project(points) + 0.5
    with np.errstate(invalid="ignore"):  # behind a pinhole
        inside = ((pixels >= 0) & (pixels < view.shape[::-1])).all(axis=-1)
    return float(1 - inside.mean())
