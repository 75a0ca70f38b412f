"""What is looked at through glass, how finely, and what is seen."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.pyramids import Pyramid, pyramid
from andon.quantities import Surface
from andon.spaces import View

__all__ = ["FAR_M", "MAX_JUMP", "Footprint", "SceneOfView", "Seen"]

Float = NDArray[np.float64]

# How far away light is that comes from infinity: its vergence, 1e-6 dioptres, is that of none.
FAR_M = 1e6
# Neighbours whose depths differ by more than this share are two surfaces (CONVENTIONS, jumps).
MAX_JUMP = 0.05


@dataclass(frozen=True)
class Footprint:
    """How n rays differ from those of the pixels beside them: the last two of a pencil's moves.

    Of a view ray that leaves the eye unmoved, 0 and e1, e2 times the pixel's angle in radians;
    carried along by ray differentials (Igehy 1999).

    Attributes
    ----------
    place : (n, 2, 3) metres that the origin moves by, for a step of one pixel along e1 and e2.
    course : (n, 2, 3) what the unit direction moves by.
    """

    place: Float
    course: Float

    def at(self, directions: Float, normals: Float, distance_m: Float, /) -> Float:
        """(n, 2, 3) metres that the hit moves by on a surface with `normals` (n, 3).

        Source: Igehy 1999, equations 10 to 12. `directions` (n, 3) unit, `distance_m` (n,).
        """
        moved = self.place + distance_m[:, None, None] * self.course
        across = np.einsum("nki,ni->nk", moved, normals)
        along = across / np.einsum("ni,ni->n", directions, normals)[:, None]
        return moved - along[..., None] * directions[:, None]


@dataclass(frozen=True)
class SceneOfView:
    """What one eye sees before there is glass.

    Attributes
    ----------
    luminance : (H, W, 3) cd/m², the frame before glass.
    surface : the scene's geometry as this view sees it.
    view : of the frame.
    luminance_per_unit : cd/m² of the frame's white, > 0: what 1 in a picture is.
    dimming : (3,) of the light of the photograph; pictures of kind texture are dimmed with it.
    """

    luminance: Float
    surface: Surface
    view: View
    luminance_per_unit: float = 1.0
    dimming: tuple[float, float, float] = (1.0, 1.0, 1.0)

    @cached_property
    def pyramid(self) -> Pyramid:
        """The frame, coarser and coarser."""
        return pyramid(self.luminance)

    def with_luminance(self, luminance: NDArray[Any], /) -> SceneOfView:
        """The same eye with another picture (H, W, 3)."""
        return replace(self, luminance=np.asarray(luminance, np.float64))


@dataclass(frozen=True)
class Seen:
    """What n rays find behind the glass.

    Attributes
    ----------
    light : (n, 3) cd/m²; 0 where `missed`.
    distance_m : (n,) metres along the ray, `FAR_M` where nothing was hit.
    missed : (n,) bool: nothing is there, so the body's environment is what is seen.
    beside : (n,) bool: the geometry is not in the frame, or is hidden in it. `light` is that of
        the frame's pixel where the ray went out of sight behind something, and `distance_m` to
        there; else of that in the ray's direction, of the nearest one on its border.
    """

    light: Float
    distance_m: Float
    missed: NDArray[np.bool_]
    beside: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, np.bool_))
