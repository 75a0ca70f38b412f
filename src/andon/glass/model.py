"""Transparent bodies and the settings of the stage."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.spaces import transform_points

__all__ = [
    "MAX_HIGHLIGHTS",
    "MAX_SOLIDS",
    "Backdrop",
    "Ball",
    "Blur",
    "Closed",
    "Focus",
    "GlassModel",
    "Highlight",
    "LensShape",
    "Slab",
    "Solid",
    "Sticker",
]

Float = NDArray[np.float64]
Blur = Literal["optical", "gaussian", "paper", "off"]

# Rows of the table of mirrored lamps on the GPU: the brightest are kept.
MAX_HIGHLIGHTS = 16
# Bits of the mask of what a ray is inside of, and rows of the table on the GPU.
MAX_SOLIDS = 8


@dataclass(frozen=True)
class Ball:
    """A sphere around the body's origin; `radius_m` > 0."""

    radius_m: float


@dataclass(frozen=True)
class Slab:
    """A box around the body's origin; `half_m` (3,) half of width x, height y, thickness z."""

    half_m: Float


@dataclass(frozen=True)
class LensShape:
    """Two spherical caps on the z axis, cut by a cylinder; the front looks along +z.

    ::

          back   │   front          thickness along z at the axis, the origin in its middle
        z = −t/2 ( │ ) z = +t/2     curvature (front, back) in metres, convex positive

    Attributes
    ----------
    radius_m : of the rim.
    curvature_m : (front, back) radii, signed, neither 0.
    thickness_m : at the axis, > 0; at the rim it must be ≥ 0.
    """

    radius_m: float
    curvature_m: tuple[float, float]
    thickness_m: float


@dataclass(frozen=True)
class Closed:
    """A closed triangle mesh in the body's own frame, metres; normals point out of the glass.

    `geometry.normals` are what light is refracted at; None: flat facets.
    """

    geometry: Geometry


@dataclass(frozen=True)
class Sticker:
    """What sticks to the outside of a body.

    Attributes
    ----------
    picture : (h, w, 4) float32: diffuse reflectance, linear Rec.709, and cover in [0, 1].
    transmittance : [0, 1] of what the cover is; α = (1 − transmittance)·cover.
    """

    picture: NDArray[np.float32]
    transmittance: float


@dataclass(frozen=True)
class Backdrop:
    """What is seen through a body.

    Attributes
    ----------
    kind : ``surface`` (geometry of the scene with the frame on it), ``frame`` (the frame on a
        sphere around the eye), ``texture`` (a picture on a plane).
    distance_m : of kind frame, from the eye.
    picture : (h, w, 3) float32 of kind texture, linear; 1 is the white of the frame.
    centre_m, right_m, up_m : (3,) of kind texture: the plane's centre, and *half* its width and
        height as vectors; row 0 of the picture is at +up.
    """

    kind: Literal["frame", "surface", "texture"] = "surface"
    distance_m: float = 1.0
    picture: NDArray[np.float32] | None = None
    centre_m: Float = field(default_factory=lambda: np.zeros(3))
    right_m: Float = field(default_factory=lambda: np.array([0.5, 0.0, 0.0]))
    up_m: Float = field(default_factory=lambda: np.array([0.0, 0.5, 0.0]))


@dataclass(frozen=True)
class Solid:
    """One transparent body, placed.

    Attributes
    ----------
    shape : its form in its own frame, metres (scale is in its lengths).
    world_from_glass : (4, 4) rigid.
    index : (3,) refractive index for the red, green and blue channel, ≥ 1.
    absorption_per_m : (3,) Beer–Lambert, 1/m.
    interfaces : 1, entry only; 2, all of them.
    """

    name: str
    shape: Ball | Slab | LensShape | Closed
    world_from_glass: Float = field(default_factory=lambda: np.eye(4))
    index: tuple[float, float, float] = (1.51, 1.51, 1.51)
    absorption_per_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    interfaces: int = 2
    sticker: Sticker | None = None
    backdrop: Backdrop = field(default_factory=Backdrop)
    highlight_exponent: float = 2000.0
    casts_light: bool = True

    @property
    def ball_around(self) -> tuple[Float, float]:
        """Centre (3,), world, and radius in metres of a ball that holds the body."""
        centre = np.zeros(3)
        match self.shape:
            case Ball(radius):
                reach = radius
            case Slab(half):
                reach = float(np.linalg.norm(half))
            case LensShape(rim, curvature, thickness):
                # Caps rise over the rim, or sink below it, by less than the rim's radius.
                high = max(abs(r) - np.sqrt(max(r * r - rim * rim, 0)) for r in curvature)
                reach = float(np.hypot(rim, thickness / 2 + high))
            case Closed(geometry):
                low, high = geometry.positions.min(axis=0), geometry.positions.max(axis=0)
                centre, reach = (low + high) / 2, float(np.linalg.norm(high - low) / 2)
        return transform_points(self.world_from_glass, centre), reach

    @property
    def is_dispersive(self) -> bool:
        """The channels have different indices."""
        return len(set(self.index)) > 1


@dataclass(frozen=True)
class Highlight:
    """One lamp as one solid mirrors it.

    Attributes
    ----------
    solid : which of the solids.
    towards : (3,) position of the lamp in metres; where `distant`, unit direction towards it.
    light : (3,) cd towards the solid; where `distant`, lx on a plane across.
    """

    solid: int
    towards: Float
    light: Float
    distant: bool = False


@dataclass(frozen=True)
class Focus:
    """What the eyes are focused on.

    Attributes
    ----------
    dioptres : vergence of what is sharp, ≥ 0, 1/m from the eye.
    layer : ``surface``, ``background``, or ``distance`` where no layer was chosen.
    state : ``seen``; ``held``, the last good one; ``fallback``, the surface for want of any.
    clamped : the layer's own vergence is outside [0, what the eye can accommodate].
    """

    dioptres: float
    layer: Literal["surface", "background", "distance"] = "distance"
    state: Literal["seen", "held", "fallback"] = "seen"
    clamped: bool = False


@dataclass(frozen=True)
class GlassModel:
    """All transparent bodies of a scene, and how their layers are blurred.

    Attributes
    ----------
    solids : outermost first: where two overlap, the later one is what the light is in.
    blur : of layers that are not looked at.
    pupil_m : diameter of the pupil.
    defocus_frame : what is seen beside the glass is blurred, too.
    environment : (n, 9, 3) SH of luminance (order of `andon.harmonics`) around each solid, in
        cd/m²: what a ray finds that hits nothing.
    """

    solids: tuple[Solid, ...]
    blur: Blur = "optical"
    pupil_m: float = 0.004
    defocus_frame: bool = False
    environment: Float = field(default_factory=lambda: np.zeros((0, 9, 3)))
