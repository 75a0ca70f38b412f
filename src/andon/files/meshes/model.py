"""What every mesh reader returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry

__all__ = ["MeshFile", "MeshLight"]


@dataclass(frozen=True)
class MeshLight:
    """A light of glTF's KHR_lights_punctual, placed.

    Attributes
    ----------
    name : the light's, else its node's.
    node : the name of its node, else of the light, else the node's place in the file; two nodes
        may share one light.
    kind : ``point``, ``spot`` or ``directional``.
    colour : (3,) linear Rec.709 factors ≥ 0, multiply `intensity`.
    intensity : cd for point and spot, lx for directional, ≥ 0.
    range : distance beyond which it has no effect, in the file's unit of length, or None.
    inner_radians, outer_radians : half angles of a spot, 0 ≤ inner < outer ≤ π/2.
    world_from_light : (4, 4) float64; spot and directional shine along its −Z axis.
    """

    name: str
    kind: Literal["point", "spot", "directional"]
    colour: tuple[float, float, float]
    intensity: float
    range: float | None
    inner_radians: float
    outer_radians: float
    world_from_light: NDArray[np.float64]
    node: str


@dataclass(frozen=True)
class MeshFile:
    """A mesh as read: unit of length and axes are still the file's own.

    Attributes
    ----------
    geometry : all triangles; `positions` are *not* yet metres with +Y up unless the file's are
        (glTF's are). Texture coordinates have v down. Degenerate triangles are kept.
    lights : lights in the file (glTF only).
    names : objects and groups (OBJ) or nodes (glTF) in the order of the file.
    at_rest : what of it would move, and does not: ``skin``, ``animation``, ``morph targets``
        (glTF only).
    """

    geometry: Geometry
    lights: tuple[MeshLight, ...] = ()
    names: tuple[str, ...] = ()
    at_rest: tuple[str, ...] = ()
