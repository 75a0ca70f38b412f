"""Sources in a frame, found anew in each: only bright pixels are looked at.

::

    picture ─survey▶ tiles ─ambient_level▶ ambient ─▶ 40 × ambient
               │                                                  │
               └─ tiles with a brighter pixel ─▶ pixels × gate ─▶ regions ─moments▶ [Source]

A pixel counts with the weight of the gate, 0 at 40 and 1 from 50 times the ambient level on, so
what a source sends does not jump when a pixel becomes part of it. Regions that do not touch are
not merged: a source does not jump to its neighbour when they come near.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from andon.glare.gate import gate
from andon.glare.model import Source
from andon.glare.sources.moments import pixel_moments, sources_of
from andon.glare.sources.regions import connected_regions
from andon.glare.sources.survey import SIDE_PX, Survey, ambient_level, tile_solid_angles
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["LightOf", "LiveSources", "SourceFinder"]

Float = NDArray[np.float64]
# Rows (n,), columns (n,) → luminance (n, 3) in cd/m², ≥ 0.
LightOf = Callable[[NDArray[np.intp], NDArray[np.intp]], Float]


@dataclass(frozen=True, eq=False)
class LiveSources:
    """What is bright in a frame.

    Attributes
    ----------
    ambient_cd_m2 : mean luminance, of what is 40 times brighter no more than that.
    sources : strongest first.
    kept_share : (3,) what those have of the light of all that is bright; 1 unless there are more.
    within : (x, y, width, height) in pixels that holds all that is bright.
    """

    ambient_cd_m2: float
    sources: tuple[Source, ...] = ()
    kept_share: Float = field(default_factory=lambda: np.ones(3))
    within: tuple[int, int, int, int] = (0, 0, 0, 0)


class SourceFinder:
    """Finds the sources of frames of one view.

    Parameters
    ----------
    contrast : luminance over the ambient level from which a pixel belongs to a source.
    most : sources that are kept.
    """

    def __init__(self, view: View, *, contrast: float, most: int) -> None:
        self.view, self.contrast, self.most = view, contrast, most
        self._tiles, self._solid = tile_solid_angles(view), view.solid_angles()

    def find(self, survey: Survey, light_of: LightOf, /) -> LiveSources:
        """The sources of a frame; `survey` in cd/m², `light_of` is asked where it is bright."""
        ambient = ambient_level(survey.mean, self._tiles, self.contrast)
        bright = survey.peak > self.contrast * ambient
        if not bright.any():
            return LiveSources(ambient)
        inside = np.repeat(np.repeat(bright, SIDE_PX, 0), SIDE_PX, 1)
        rows, columns = np.nonzero(inside[: self.view.height, : self.view.width])
        light = light_of(rows, columns)
        weight = gate(photometric(light), ambient, contrast=self.contrast)
        kept = weight > 0
        rows, columns = rows[kept], columns[kept]
        light = light[kept] * weight[kept, None]
        if not len(rows):
            return LiveSources(ambient)
        left, top = int(columns.min()), int(rows.min())
        size = int(columns.max()) - left + 1, int(rows.max()) - top + 1
        sources = tuple(self._sources(rows, columns, light))
        bright = (light * self._solid[rows, columns, None]).sum(axis=0)
        kept = np.sum([source.illuminance_lux for source in sources], axis=0)
        share = np.clip(kept / np.maximum(bright, np.finfo(float).tiny), 0, 1)
        return LiveSources(ambient, sources, share, (left, top, *size))

    def _sources(
        self, rows: NDArray[np.intp], columns: NDArray[np.intp], light: Float
    ) -> list[Source]:
        mask = np.zeros(self.view.shape, bool)
        mask[rows, columns] = True
        regions, count = connected_regions(mask, self.view)
        region, solid = regions[rows, columns] - 1, self._solid[rows, columns]
        power = np.bincount(region, photometric(light) * solid, count)
        strongest = np.argsort(-power, kind="stable")[: self.most]
        place = np.full(count, -1)
        place[strongest] = np.arange(len(strongest))
        directions = self.view.directions_at(np.stack([columns, rows], axis=-1))
        moments = pixel_moments(directions, light, solid, place[region], len(strongest))
        return sources_of(moments, name="frame")
