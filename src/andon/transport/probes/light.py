"""Light of probes on surfaces: the reference, in float64.

``E(x, n) = max(0, Σ_j W_j(x, n) Σ_k A_k c_jk Y_k(n))`` in lux: the coefficients c of luminance are
mixed with the weights W of `ProbeSpace.locate`, less what walls hide, and convolved with the
cosine (`andon.harmonics`). `probes.wgsl` has the same functions by the same names.

=========== ============================================================ ====================
lookup      what it does                                                 costs
=========== ============================================================ ====================
per pixel   position and normal of each pixel                            a walk a pixel
per vertex  `probe_illuminance` of a mesh's vertices, to be interpolated a walk a vertex
per object  one mix at the object's middle, normals of each pixel        a walk an object
=========== ============================================================ ====================

Per object is the paper's. It is blind to what changes within the object: a train half in a tunnel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.model import ProbeVolume
from andon.harmonics import basis, convolved, deringed, order_of
from andon.transport.probes.cells import build_cells
from andon.transport.probes.hidden import Walls, hidden_mix, walls_of
from andon.transport.probes.points import points_of
from andon.transport.probes.space import Mix, ProbeSpace
from andon.transport.probes.states import state_coefficients

__all__ = [
    "ProbeLight",
    "light_between",
    "probe_coefficients",
    "probe_illuminance",
    "probe_light",
    "probe_mix",
]

Float = NDArray[np.float64]

# Points that are looked up at once: where walls hide probes, four texels of 36 of them each.
CHUNK = 1 << 14


@dataclass(frozen=True, eq=False)
class ProbeLight:
    """A volume's light, ready to be looked up.

    Attributes
    ----------
    space : between its probes.
    coefficients : (n, k, 3) of luminance, cd/m², world axes; smoothed where they are to be.
    walls : what hides probes; None: nothing does.
    """

    space: ProbeSpace
    coefficients: Float
    walls: Walls | None = None


def probe_light(
    volume: ProbeVolume,
    /,
    *,
    state: str | None = None,
    blend_state: str | None = None,
    blend: float = 0.0,
    zones: Sequence[str] = (),
    dering: bool = True,
    visibility: bool = True,
) -> ProbeLight:
    """A volume's light as frames look it up.

    Parameters
    ----------
    volume : from `read_volume` or a bake; its cells are built where nobody did.
    state : which of its states; None: the first.
    blend_state, blend : a second state, of which there is a share of 0…1.
    zones : names of those in use; none given: all.
    dering : smooth each probe as little as keeps its irradiance from going negative.
    visibility : walls hide probes, where the volume has distances.

    Raises
    ------
    InputError : there is no such state or zone; `blend` is not in 0…1 or has no second state; what
        `build_cells` refuses.
    """
    coefficients = state_coefficients(volume, state, blend_state, blend)
    if dering:
        coefficients = deringed(coefficients)
    return light_between(volume, coefficients, zones, visibility=visibility)


def light_between(
    volume: ProbeVolume,
    coefficients: Float,
    zones: Sequence[str] = (),
    /,
    *,
    visibility: bool = True,
) -> ProbeLight:
    """Any light (n, k, 3), cd/m², between the probes of a volume; else as `probe_light`."""
    cells = volume.cells or build_cells(volume.positions, volume.zones)
    space = ProbeSpace(replace(volume, cells=cells), zones)
    return ProbeLight(space, coefficients, walls_of(volume, cells) if visibility else None)


def probe_mix(
    light: ProbeLight, points: Float, normals: Float | None = None, /, start: Mix | None = None
) -> Mix:
    """The probes that light points (q, 3), and their weights; of 4 or 36 probes each.

    `normals` (q, 3), unit, of the surfaces that the points lie on; None: in free air. `start` is
    an earlier mix of the same points, which have moved a little since.
    """
    mix = light.space.locate(points, None if start is None else start.cells)
    return mix if light.walls is None else hidden_mix(light.walls, mix, points, normals)


def probe_illuminance(
    light: ProbeLight, points: Float, normals: Float, /, *, signed: bool = False
) -> Float:
    """Illuminance (q, 3) in lux at points (q, 3), metres, world, that face normals (q, 3).

    Normals may have any length but 0. Never negative, unless `signed`: of light that is the
    difference of two. NaN for a point or a normal that is not finite, and for a normal of 0.
    Raises `InputError` for arrays that are not (q, 3).
    """
    points, normals = points_of(points, "points"), points_of(normals, "normals")
    if len(points) != len(normals):
        raise InputError(
            f"must be as many as points, {len(points)}, got {len(normals)}", field="normals"
        )
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    lit = convolved(light.coefficients)
    order = order_of(lit.shape[1])
    lux = np.empty((len(points), 3))
    for first in range(0, len(points), CHUNK):
        part = slice(first, first + CHUNK)
        mix = probe_mix(light, points[part], normals[part])
        own = light.space.mixed(mix, lit)
        lux[part] = np.einsum("qkc,qk->qc", own, basis(normals[part], order))
    return lux if signed else np.maximum(lux, 0)


def probe_coefficients(light: ProbeLight, points: Float, /) -> Float:
    """Coefficients (q, k, 3) of luminance, cd/m², at points (q, 3) in free air."""
    return light.space.mixed(probe_mix(light, points), light.coefficients)
