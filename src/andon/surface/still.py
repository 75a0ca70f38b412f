"""What of a scene stands still: where light can be captured once for all times."""

from __future__ import annotations

from andon.errors import InputError
from andon.quantities import Geometry
from andon.scene import Scene
from andon.surface.load import mesh_geometry
from andon.surface.model import EMPTY_GEOMETRY
from andon.surface.objects import joined, object_geometry

__all__ = ["still_geometry", "still_objects"]


def still_objects(scene: Scene, /) -> tuple[int, ...]:
    """Numbers of the virtual objects that neither move nor play an animation."""
    return tuple(
        index
        for index, entry in enumerate(scene.object)
        if not entry.key and entry.animation is None
    )


def still_geometry(scene: Scene, /, *, real: Geometry | None = None) -> Geometry:
    """The surface and the virtual objects that stand still: triangles, materials, world, metres.

    Parameters
    ----------
    real : triangles of the surface, for one that only its view can make triangles of: a depth
        image. Default: those of ``surface.mesh``; without a [surface], none.

    Raises `InputError` for a depth image or normals without `real`, and for files at fault.
    """
    parts: list[Geometry] = []
    if real is not None:
        parts.append(real)
    elif scene.surface is not None:
        if scene.surface.mesh is None:
            raise InputError(
                "needs a surface that does not depend on a view",
                file=scene.file,
                field="surface",
                remedy="give surface.mesh",
            )
        parts.append(mesh_geometry(scene)[0])
    parts += [object_geometry(scene, index) for index in still_objects(scene)]
    return joined(parts) if parts else EMPTY_GEOMETRY
