"""What surfaces around a probe reflect of each other, all of it at once, by Radiance.

::

    cube map ─seen points▶ rtrace -I ─lux▶ ρ·E/π = what bounces add        (n, 3) lx

The direct light stays with the engines' own pictures, at their full resolution; Radiance is asked
only for what reaches a point after at least one reflection, and for what materials and the sky
send to it. These are two scenes of the same surfaces, so that nothing counts twice and a bounce
means the same as through probes: light that is seen was reflected at most `bounces` times.

===========  ==============================================  =======================
scene        what gives light                                illuminance of it
===========  ==============================================  =======================
``lamps``    lamps that stand somewhere or are directional   after 1 … bounces − 1
``emitted``  materials that emit, and the sky                after 0 … bounces − 1
===========  ==============================================  =======================

The sky reaches surfaces along rays, past what hides it. What lamps of ``in_probes = false`` give is
in neither, and E0 (with the photograph's own light) is not either: its reflections were measured
with it. Photographed surfaces reflect as the photograph shows them, with one ρ for each triangle,
the mean over it: nearby texture matters to what is seen of a surface, which the pictures hold, not
to what a whole room sends to it.

Not possible, and refused: light that is taken away (sources of E0), since Radiance has none below
0; and the paper's 8 bits, which are of pictures lit by probes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.engines.cubes import CubeSetting
from andon.errors import InputError
from andon.quantities import Geometry, Material
from andon.transport.probes.capture import Seen
from andon.transport.probes.photograph import Photograph

if TYPE_CHECKING:
    from andon.scene import Scene

__all__ = [
    "EMITTED",
    "LAMPS",
    "SeenPoints",
    "check_radiance",
    "light_scenes",
    "photographed_geometry",
    "seen_points",
]

Float = NDArray[np.float64]

# Names of the scenes.
LAMPS, EMITTED = "lamps", "emitted"

# Points of each photographed triangle where its ρ is looked up: below so many triangles several,
# for walls of two of them; those of depth images are as small as pixels.
FEW_TRIANGLES = 20_000
POINTS_OF_LARGE = 64
# ρ of photographed triangles is rounded to a multiple of 1 / this: as many materials at most as
# there are colours, and half a step is less than what a photograph's noise adds.
STEPS = 32


@dataclass(frozen=True, eq=False)
class SeenPoints:
    """Points of a cube map that are lit.

    Attributes
    ----------
    texels : (6, s, s) bool, those of the points.
    position, normal : (n, 3) float64, metres and unit, world; in the order of the texels.
    """

    texels: NDArray[np.bool_]
    position: Float
    normal: Float

    def spread(self, lux: NDArray[np.floating], /) -> Float:  # pyright: ignore[reportMissingTypeArgument]
        """(6, s, s, 3) float64 of `lux` (n, 3), 0 elsewhere."""
        cube = np.zeros((*self.texels.shape, 3))
        cube[self.texels] = lux
        return cube


def seen_points(seen: Seen, range_m: float, /) -> SeenPoints:
    """What a probe sees of surfaces within its range: beyond it they count as dark."""
    texels = seen.valid & (seen.distance_m <= range_m)
    return SeenPoints(texels, seen.position[texels], seen.normal[texels])


def check_radiance(scene: Scene, setting: CubeSetting, /) -> None:
    """Raises `InputError` where Radiance cannot compute the bounces of the scene's probes."""
    remedy = 'set probes.bounces_by to "probes", or leave that light out of the probes'
    if setting.takes_away:
        raise InputError(
            "cannot be 'radiance' where light is taken away: there are sources of E0 that virtual "
            "things hide, or that are removed, and Radiance has no light below 0",
            file=scene.file,
            field="probes.bounces_by",
            remedy=remedy,
        )
    if scene.probes is not None and scene.probes.encoding == "srgb8":
        raise InputError(
            "must be 'linear' where bounces are by Radiance: the paper's 8 bits are of pictures "
            "that probes light",
            file=scene.file,
            field="probes.encoding",
            remedy='set it to "linear", or probes.bounces_by to "probes"',
        )


def light_scenes(setting: CubeSetting, bounces: int, /) -> Mapping[str, Mapping[str, bytes]]:
    """Radiance's scenes that bounces need, name → files; without light there is none.

    Raises `InputError` for lamps and materials that cannot be said in Radiance's terms.
    """
    from andon.transport.baked.radiance.scene import radiance_bundle

    parts, bodies = _parts(setting), setting.moment.bodies
    scenes: dict[str, Mapping[str, bytes]] = {}
    # What was reflected once is in the first pictures.
    if setting.lamps and bounces > 1:
        scenes[LAMPS] = radiance_bundle(parts, setting.lamps, bodies, emission=False)
    if setting.emits and bounces > 0:
        sky = setting.lighting.sky
        scenes[EMITTED] = radiance_bundle(parts, sky, bodies, emission=True)
    return scenes


def _parts(setting: CubeSetting) -> tuple[Geometry, ...]:
    photograph, surface = setting.lighting.photograph, setting.surface
    real = surface.real
    if photograph is not None:
        real = photographed_geometry(real, photograph)
    return tuple(part for part in (real, surface.objects) if len(part.triangles))


def photographed_geometry(real: Geometry, photograph: Photograph, /) -> Geometry:
    """The surface with the ρ that a photograph shows of each triangle, 0…1, in steps.

    The mean of points spread evenly over it; where no photograph saw them they have its mean, as
    in captures.
    """
    count = len(real.triangles)
    weights = _spread_points(POINTS_OF_LARGE if count <= FEW_TRIANGLES else 1)
    corners = np.asarray(real.positions, np.float64)[real.triangles]
    points = np.einsum("pk,tkc->tpc", weights, corners)
    shown = photograph.at(points.reshape(-1, 3)).reflectance.reshape(count, len(weights), 3)
    steps = np.rint(STEPS * np.clip(shown.mean(axis=1), 0, 1)).astype(np.int64)
    colours, ids = np.unique(steps, axis=0, return_inverse=True)
    materials = tuple(
        Material(f"photographed {number}", (float(r), float(g), float(b)))
        for number, (r, g, b) in enumerate(colours / STEPS)
    )
    return replace(
        real, materials=materials, material_ids=ids.reshape(-1).astype(np.int32), uvs=None
    )


def _spread_points(count: int) -> Float:
    """(count, 3) barycentric weights of points spread evenly over a triangle; one: its middle."""
    if count == 1:
        return np.full((1, 3), 1 / 3)
    # Roberts' R2 sequence, folded at the diagonal of the unit square.
    ratio = 1.32471795724474602596
    number = np.arange(1, count + 1)[:, None]
    pair = (0.5 + number / np.array([ratio, ratio**2])) % 1
    folded: Float = np.where(pair.sum(axis=1, keepdims=True) > 1, 1 - pair, pair)
    return np.column_stack([folded, 1 - folded.sum(axis=1)])
