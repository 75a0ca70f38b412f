"""Scenes without a photograph: the surface is drawn as virtual objects are.

A photographed surface is what the photograph shows of it: only the light that is added counts, and
its reflectance is never asked for. Without a photograph there is nothing to relight, so the mesh
becomes the first of the virtual objects: its materials' ρ under whatever light falls on it, and
what they emit. It casts its shadows undecimated, since every triangle of it is seen.
"""

from __future__ import annotations

from dataclasses import replace

from andon.errors import InputError
from andon.quantities import MAX_OBJECT_MATERIALS, Geometry, merged
from andon.scene import Scene
from andon.surface.load import load_surface, mesh_geometry
from andon.surface.meshes import check_textures
from andon.surface.model import ObjectInfo, SurfaceModel
from andon.surface.objects import joined

__all__ = ["SURFACE", "virtual_surface", "with_mesh_as_object"]

# The mesh's name among the virtual objects, for messages.
SURFACE = "surface"


def virtual_surface(scene: Scene, /) -> SurfaceModel:
    """The geometry of a scene that has no photograph: objects alone, the mesh being the first.

    Raises
    ------
    InputError
        where there is neither mesh nor object, where the surface is that of a picture that is not
        there (a depth image, normals), and for files at fault.
    """
    _check(scene)
    model = load_surface(scene.model_copy(update={"surface": None}), {})
    if scene.surface is None:
        return model
    mesh, notes = mesh_geometry(scene)
    model = with_mesh_as_object(model, mesh)
    check_textures(model.objects, scene, "surface.mesh")
    slots = sum(info.slots for info in model.objects_table)
    if slots > MAX_OBJECT_MATERIALS:
        raise InputError(
            f"surface and objects have {slots} materials, at most {MAX_OBJECT_MATERIALS} can be "
            "told apart without a photograph",
            file=scene.file,
            field="surface.mesh",
            remedy="let parts share materials",
        )
    return replace(model, notes=(*notes, *model.notes))


def with_mesh_as_object(model: SurfaceModel, mesh: Geometry, /) -> SurfaceModel:
    """`model` with `mesh` before its other objects; their slots move up by those of the mesh."""
    own = ObjectInfo(SURFACE, 0, len(mesh.materials), len(mesh.triangles))
    others = [replace(info, first_slot=info.first_slot + own.slots) for info in model.objects_table]
    parts = [mesh, model.objects] if len(model.objects.triangles) else [mesh]
    return replace(
        model,
        objects=joined(parts),
        casters=merged(mesh, model.casters),
        objects_table=(own, *others),
    )


def _check(scene: Scene) -> None:
    surface = scene.surface
    if surface is None and not scene.object:
        raise InputError(
            "there is neither a photograph nor a mesh: nothing to be seen",
            file=scene.file,
            field="capture.source",
            remedy='state capture.source = "photo.png", or surface.mesh',
        )
    if surface is not None and surface.mesh is None:
        key = "depth" if surface.depth is not None else "normals"
        raise InputError(
            "belongs to a photograph, and there is none",
            file=scene.file,
            field=f"surface.{key}",
            remedy="state capture.source, or a surface.mesh with materials instead",
        )
