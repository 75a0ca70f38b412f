"""[[glass]] of a scene as solids: files read, scale folded in, checked and sorted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glass.closed import closed_geometry, glass_parts, moved, one_medium
from andon.glass.lens import cap_heights
from andon.glass.media import indices
from andon.glass.model import MAX_SOLIDS, Ball, Closed, LensShape, Slab, Solid
from andon.glass.nesting import check_eye, outermost_first
from andon.glass.pictures import backdrop_of, sticker_of
from andon.lamps.resources import mesh_in_metres

if TYPE_CHECKING:
    from andon.glass.media import Medium
    from andon.scene import Scene
    from andon.scene.objects import Glass

__all__ = ["check_eye", "solids_of"]

Float = NDArray[np.float64]

# Files state matrices with six digits or more: what deviates more from a rotation and one scale
# is meant.
SIMILAR = 1e-4


def solids_of(scene: Scene, /) -> tuple[Solid, ...]:
    """The transparent bodies of a scene, outermost first, in metres.

    Raises
    ------
    InputError
        for more than `MAX_SOLIDS`; a sphere, slab or lens that is scaled unevenly, sheared or
        mirrored; a lens without thickness at its rim, or flatter than its rim is wide; a mesh that
        is open, inside out or not finite, or whose materials differ; pictures and meshes that
        cannot be read or hold values out of range; a background whose up is along its normal.
    """
    if len(scene.glass) > MAX_SOLIDS:
        raise InputError(
            f"at most {MAX_SOLIDS} bodies, got {len(scene.glass)}",
            file=scene.file,
            field="glass",
            remedy="leave some out, or make one mesh of bodies of the same glass",
        )
    return outermost_first([_solid(scene, i, glass) for i, glass in enumerate(scene.glass)])


def _solid(scene: Scene, number: int, glass: Glass) -> Solid:
    field = f"glass[{number}]"
    shape, place, medium = _formed(scene, glass, field)
    stated = glass.model_fields_set
    index, spread, absorption = glass.index, glass.cauchy_b_um2, glass.absorption_per_m
    if medium is not None:
        index = index if "index" in stated else medium.index
        spread = spread if "cauchy_b_um2" in stated else medium.cauchy_b_um2
        absorption = absorption if "absorption_per_m" in stated else medium.absorption_per_m
    return Solid(
        glass.name,
        shape,
        place,
        indices(index, spread),
        absorption,
        glass.interfaces,
        sticker_of(scene, glass, field),
        backdrop_of(scene, glass.background, f"{field}.background"),
        glass.highlight_exponent,
        glass.casts_light,
    )


def _formed(
    scene: Scene, glass: Glass, field: str
) -> tuple[Ball | Slab | LensShape | Closed, Float, Medium | None]:
    """Shape with its scale in its lengths, rigid placement, and what a mesh file says of it."""
    matrix = glass.world_from_object()
    similar = _similarity(matrix[:3, :3])
    place = np.eye(4)
    place[:3, 3] = matrix[:3, 3]
    if glass.mesh is not None:
        where = (scene.file, f"{field}.mesh")
        read, media = glass_parts(
            mesh_in_metres(scene, glass.mesh, where[1]), str(scene.path(glass.mesh, where[1]))
        )
        medium = one_medium(media, glass.model_fields_set, where)
        if similar is not None:
            place[:3, :3] = similar[1]
        geometry = moved(read, place[:3, :3].T @ matrix[:3, :3])
        return Closed(closed_geometry(geometry, where)), place, medium
    if similar is None:
        raise InputError(
            f"a {glass.shape} must not be sheared, mirrored or scaled unevenly",
            file=scene.file,
            field=f"{field}.transform",
            remedy="state a rotation, one scale and a translation, change the lengths, or use "
            "shape mesh",
        )
    scale, place[:3, :3] = similar
    return _scaled(scene, glass, scale, field), place, None


def _similarity(linear: Float) -> tuple[float, Float] | None:
    """Scale and rotation of a (3, 3) matrix; None if it is more than that."""
    left, stretches, right = np.linalg.svd(linear)
    scale = float(np.cbrt(np.prod(stretches)))
    rotation: Float = left @ right
    if np.ptp(stretches) > SIMILAR * scale or np.linalg.det(rotation) < 0:
        return None
    return scale, rotation


def _scaled(scene: Scene, glass: Glass, scale: float, field: str) -> Ball | Slab | LensShape:
    if glass.size_m is not None:
        return Slab(scale * np.array(glass.size_m) / 2)
    radius = scale * (glass.radius_m or 0.0)
    if glass.curvature_m is None or glass.thickness_m is None:
        return Ball(radius)
    front, back = (scale * curvature for curvature in glass.curvature_m)
    lens = LensShape(radius, (front, back), scale * glass.thickness_m)
    for curvature in glass.curvature_m:
        if abs(curvature) < (glass.radius_m or 0.0):
            raise InputError(
                f"must not be smaller than the rim's radius of {glass.radius_m:g} m, "
                f"got {curvature:g} m",
                file=scene.file,
                field=f"{field}.curvature_m",
                remedy="a cap is at most a hemisphere: make radius_m smaller or curvature_m larger",
            )
    at_rim = float(np.subtract(*cap_heights(lens, np.array([radius])))[0]) / scale
    if at_rim < -1e-9 * (glass.thickness_m or 0.0):
        raise InputError(
            f"leaves the rim a thickness of {at_rim:.3g} m",
            file=scene.file,
            field=f"{field}.thickness_m",
            remedy=f"state at least {(glass.thickness_m or 0.0) - at_rim:.3g} m",
        )
    return lens
