"""From a scene's [surface] and [[object]] tables to a `SurfaceModel`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.depth import read_depth_array
from andon.files.meshes import read_mesh
from andon.files.pictures import read_picture
from andon.lenses import undistort
from andon.quantities import MAX_OBJECT_MATERIALS, Geometry, Material, merged
from andon.rays import face_normals
from andon.scene import Scene
from andon.spaces import View, rotate, transform_points
from andon.surface.depth import DepthEncoding, depth_from_raw
from andon.surface.model import EMPTY_GEOMETRY, ObjectInfo, ShadowBias, SurfaceModel
from andon.surface.normals import normals_from_depth
from andon.surface.occluder import decimated
from andon.surface.textures import with_linear_textures
from andon.surface.triangulate import thickened, triangulate_depth

__all__ = [
    "check_textures",
    "load_surface",
    "mesh_geometry",
    "object_geometry",
    "surface_of_depth",
    "surface_of_mesh",
]

Float = NDArray[np.float64]

# Lift of receivers before a shadow is looked up: float32 rounding for meshes, more than stereo
# and structured light scatter for depth images, and twice the decimation's own error. Twice,
# since that error is a 95th percentile of unsigned distances: the worst of the other 5 % lie
# about twice as far, and lamps look at them at a slant. Measured against shadows of all
# triangles, the sum of false and lost shadows is smallest at 1.9 times the error on the
# demonstration, at 2.2 times on noisy Kinect depth and at 1 to 2 times in the furnished room,
# and flat around that; half as much lift doubles the false ones (acne), twice as much doubles
# the lost ones.
MESH_BIAS_M = 2e-4
DEPTH_BIAS_M = 5e-3
DECIMATION_MARGIN = 2.0

# An array texture has at least 256 layers on every adapter (WebGPU, table of limits).
MAX_TEXTURES = 256

# Camera axes of a file's normals → our camera frame (x right, y down, z forward).
NORMAL_AXES = {"opencv": np.eye(3), "opengl": np.diag([1.0, -1.0, -1.0])}

# Units and axes are the scene's for formats that do not define them; glTF is metres, +Y up.
UNITLESS_SUFFIXES = {".obj", ".ply"}
Y_UP_FROM_Z_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])


def load_surface(scene: Scene, views: Mapping[str, View]) -> SurfaceModel:
    """The geometry of `scene` for its `views` (as captured: with their distortion).

    Raises `InputError` for files that are missing, of the wrong size or without geometry.
    """
    objects = _objects(scene)
    if scene.surface is None:
        model = SurfaceModel()
    elif scene.surface.depth is not None:
        model = _from_depth(scene, views)
    elif scene.surface.mesh is not None:
        model = _from_mesh(scene, next(iter(views.values())))
    else:
        if scene.object:
            raise InputError(
                "needs a surface with a place, and normals alone have none",
                file=scene.file,
                field="object[0]",
                remedy="give a depth or a mesh, or leave the object out",
            )
        if len(views) > 1:
            raise InputError(
                "is one picture for two eyes",
                file=scene.file,
                field="surface.normals",
                remedy="give a depth or a mesh, which both eyes can see, or a rig of one camera",
            )
        normals = {name: _read_normals(scene, view) for name, view in views.items()}
        model = SurfaceModel(normals=normals)
    return replace(
        model,
        objects=objects.objects,
        casters=objects.casters,
        objects_table=objects.objects_table,
        notes=(*model.notes, *objects.notes),
    )


def _from_depth(scene: Scene, views: Mapping[str, View]) -> SurfaceModel:
    assert scene.surface is not None
    table = scene.surface.depth
    assert table is not None
    # One depth image belongs to one picture: the first view. Other views see its triangles.
    name, view = next(iter(views.items()))
    path = scene.path(table.file, "surface.depth.file")
    encoding = DepthEncoding(
        table.kind, table.scale_to_m, table.baseline_m, table.doffs_px, tuple(table.invalid)
    )
    seen_by = view if table.focal_px is None else replace(view, fx=table.focal_px)
    raw = read_depth_array(path)
    if raw.shape == view.shape:
        # First: distance becomes depth by the directions of the *undistorted* pixels.
        raw = undistort(raw, view, method="nearest")
    depth = depth_from_raw(raw, seen_by, encoding, file=str(path))
    given = None if scene.surface.normals is None else _read_normals(scene, view)
    return surface_of_depth(
        depth,
        replace(view.undistorted(), name=name),
        normals=given,
        max_jump=table.max_jump,
        thickness_m=table.thickness_m,
        occluder_triangles=scene.surface.occluder_triangles,
        file=str(path),
    )


def surface_of_depth(
    depth: Float,
    view: View,
    /,
    *,
    normals: Float | None = None,
    max_jump: float = 0.05,
    thickness_m: float | None = None,
    occluder_triangles: int = 30_000,
    file: str | None = None,
) -> SurfaceModel:
    """The model of a depth image (H, W) in metres, NaN in holes, of the undistorted `view`.

    Parameters
    ----------
    normals : (H, W, 3) unit, world; default: fitted to the depth.
    max_jump : relative step between neighbours that cuts the surface.
    thickness_m : closes objects at their back for shadows.
    occluder_triangles : budget of the shadow geometry; 0 keeps all.
    """
    is_whole = normals is None
    if normals is None:
        normals = normals_from_depth(depth, view, max_jump=max_jump)
    lit = np.where(np.isfinite(normals).all(axis=-1), depth, np.nan)
    real = triangulate_depth(lit, view, max_jump=max_jump, normals=normals)
    if len(real.triangles) == 0:
        raise InputError(
            "no three neighbouring pixels have a depth on one surface",
            file=file,
            field="surface.depth",
            remedy="check kind and scale_to_m",
        )
    sheet = real if is_whole else triangulate_depth(depth, view, max_jump=max_jump)
    # The sheet alone is thinned and judged: nobody sees its back. Closing it adds a back and walls,
    # which a third of the budget leaves room for.
    budget = occluder_triangles if thickness_m is None else occluder_triangles // 3
    occluder = decimated(sheet, budget, view.position)
    if thickness_m is not None:
        closed = thickened(occluder.geometry, view.position, thickness_m)
        occluder = replace(occluder, geometry=closed)
    bias = max(DEPTH_BIAS_M, DECIMATION_MARGIN * occluder.error_m)
    name = view.name
    return SurfaceModel(real, {name: depth}, {name: normals}, occluder=occluder, bias=_bias(bias))


def surface_of_mesh(
    real: Geometry, eye: Float, /, *, occluder_triangles: int = 30_000
) -> SurfaceModel:
    """The model of triangles in the world; `eye` (3,) is where decimation is judged from."""
    occluder = decimated(merged(real), occluder_triangles, eye)
    bias = max(MESH_BIAS_M, DECIMATION_MARGIN * occluder.error_m)
    return SurfaceModel(real, occluder=occluder, bias=_bias(bias))


def mesh_geometry(scene: Scene, /) -> tuple[Geometry, tuple[str, ...]]:
    """The triangles of ``surface.mesh`` in the world, and what is to be said of them."""
    assert scene.surface is not None
    assert scene.surface.mesh is not None
    path = scene.path(scene.surface.mesh, "surface.mesh")
    world_from_mesh = np.eye(4)
    if scene.surface.world_from_mesh is not None:
        world_from_mesh = np.array(scene.surface.world_from_mesh)
    real, notes = _read_geometry(scene, path, world_from_mesh)
    if scene.surface.reflectance is not None:
        real = _with_reflectance(real, scene.surface.reflectance)
    check_textures(real, scene, "surface.mesh")
    return real, notes


def _from_mesh(scene: Scene, view: View) -> SurfaceModel:
    assert scene.surface is not None
    real, notes = mesh_geometry(scene)
    budget = scene.surface.occluder_triangles
    model = surface_of_mesh(real, view.position, occluder_triangles=budget)
    return replace(model, notes=notes)


def _bias(real_m: float) -> ShadowBias:
    return ShadowBias(real_m=real_m, object_m=MESH_BIAS_M)


def _with_reflectance(geometry: Geometry, reflectance: Any) -> Geometry:
    triple = tuple(float(x) for x in np.broadcast_to(reflectance, 3))
    material = Material("surface", triple)  # type: ignore[arg-type]
    return replace(geometry, materials=(material,), material_ids=None)


def _read_geometry(
    scene: Scene, path: Path, world_from_mesh: Float
) -> tuple[Geometry, tuple[str, ...]]:
    """The triangles of a file in the world, and what is to be said of them."""
    mesh = read_mesh(path)
    geometry = mesh.geometry
    notes: tuple[str, ...] = ()
    if mesh.at_rest:
        what = " and ".join(mesh.at_rest)
        notes = (f"{path.name} has {what}: it is drawn in its pose of rest, and does not move",)
    if path.suffix.lower() in UNITLESS_SUFFIXES:
        scale = np.eye(4)
        scale[:3, :3] = np.eye(3) if scene.scene.up == "y" else Y_UP_FROM_Z_UP
        scale[:3, :3] *= scene.scene.metres_per_unit
        world_from_mesh = world_from_mesh @ scale
    return with_linear_textures(_placed(geometry, world_from_mesh)), notes


def _placed(geometry: Geometry, world_from_mesh: Float) -> Geometry:
    positions = transform_points(world_from_mesh, geometry.positions)
    triangles = geometry.triangles
    if np.linalg.det(world_from_mesh[:3, :3]) < 0:  # a mirror turns triangles inside out
        triangles = triangles[:, ::-1]
    normals = geometry.normals
    if normals is not None:
        turned = normals @ np.linalg.inv(world_from_mesh[:3, :3])
        length = np.linalg.norm(turned, axis=1, keepdims=True)
        normals = np.divide(turned, length, out=np.zeros_like(turned), where=length > 0)
    return replace(geometry, positions=positions, triangles=triangles, normals=normals)


def object_geometry(scene: Scene, index: int, /) -> Geometry:
    """The triangles of ``scene.object[index]`` in the world."""
    return _object(scene, index)[0]


def _object(scene: Scene, index: int) -> tuple[Geometry, tuple[str, ...]]:
    """Its triangles in the world, and what is to be said of them."""
    entry = scene.object[index]
    field = f"object[{index}]"
    for key in ("animation", "key"):
        if getattr(entry, key):
            raise InputError(
                f"{key} is in the schema but not rendered yet",
                file=scene.file,
                field=f"{field}.{key}",
                remedy="leave it out: the object stands still",
            )
    path = scene.path(entry.mesh, f"{field}.mesh")
    return _read_geometry(scene, path, entry.world_from_object())


def _objects(scene: Scene) -> SurfaceModel:
    """All virtual objects as one geometry with their materials, and those that cast shadows."""
    read = [_object(scene, index) for index in range(len(scene.object))]
    parts = [geometry for geometry, _ in read]
    if not parts:
        return SurfaceModel()
    casting = [p for p, entry in zip(parts, scene.object, strict=True) if entry.casts_shadow]
    objects = joined(parts)
    check_textures(objects, scene, "object")
    return SurfaceModel(
        objects=objects,
        casters=merged(*casting) if casting else EMPTY_GEOMETRY,
        objects_table=_objects_table(scene, parts),
        # One file may stand in several places.
        notes=tuple(dict.fromkeys(note for _, notes in read for note in notes)),
    )


def _objects_table(scene: Scene, parts: list[Geometry]) -> tuple[ObjectInfo, ...]:
    """Which slots each object has; refuses more than there are."""
    starts = np.cumsum([0, *(len(part.materials) for part in parts)]).tolist()
    if starts[-1] > MAX_OBJECT_MATERIALS:
        raise InputError(
            f"virtual objects have {starts[-1]} materials, at most {MAX_OBJECT_MATERIALS} can be "
            "told apart",
            file=scene.file,
            field="object",
            remedy="let parts share materials, or leave objects out",
        )
    table: list[ObjectInfo] = []
    for index, (entry, part) in enumerate(zip(scene.object, parts, strict=True)):
        name = entry.name if "name" in entry.model_fields_set else f"object[{index}]"
        own = (starts[index], len(part.materials), len(part.triangles))
        table.append(ObjectInfo(name, *own, entry.lit_by_probes, entry.lit_by_lamps))
    return tuple(table)


def check_textures(geometry: Geometry, scene: Scene, field: str) -> None:
    """Refuses more textures than can be drawn; `field` is for the message."""
    textured = sum(material.texture is not None for material in geometry.materials)
    if textured > MAX_TEXTURES:
        raise InputError(
            f"has {textured} materials with a texture, at most {MAX_TEXTURES} can be drawn",
            file=scene.file,
            field=field,
            remedy="let parts share materials, or put several textures into one picture",
        )


def joined(parts: list[Geometry], /) -> Geometry:
    """One geometry from several, with normals, texture coordinates and materials."""
    parts = [part if part.normals is not None else flat_shaded(part) for part in parts]
    points = merged(*parts)
    normals = np.concatenate([part.normals for part in parts if part.normals is not None])
    uvs = np.concatenate(
        [np.zeros((len(p.positions), 2)) if p.uvs is None else p.uvs for p in parts]
    )
    ids: list[NDArray[np.int32]] = []
    first = 0
    for part in parts:
        own = part.material_ids
        own = np.zeros(len(part.triangles), np.int32) if own is None else own
        ids.append((own + first).astype(np.int32))
        first += len(part.materials)
    materials = tuple(material for part in parts for material in part.materials)
    return replace(
        points, normals=normals, uvs=uvs, material_ids=np.concatenate(ids), materials=materials
    )


def flat_shaded(part: Geometry, /) -> Geometry:
    """The same triangles with three corners of their own each, and their plane's normal there."""
    corner = part.triangles.ravel()
    return replace(
        part,
        positions=part.positions[corner],
        normals=np.repeat(face_normals(part), 3, axis=0),
        uvs=None if part.uvs is None else part.uvs[corner],
        triangles=np.arange(len(corner), dtype=np.int32).reshape(-1, 3),
    )


def _read_normals(scene: Scene, view: View) -> Float:
    assert scene.surface is not None
    assert scene.surface.normals is not None
    path = scene.path(scene.surface.normals, "surface.normals")
    picture = read_picture(path)
    if picture.shape != view.shape:
        height, width = picture.shape
        raise InputError(
            f"is {width}×{height} px but the camera is {view.width}×{view.height}",
            file=str(path),
            field="surface.normals",
        )
    values = np.asarray(picture.values, np.float64)
    if picture.encoding == "srgb":  # codes hold −1…1, not light: no transfer function
        values = values / np.iinfo(picture.values.dtype).max * 2 - 1
    length = np.linalg.norm(values, axis=-1, keepdims=True)
    # Background of normal maps is black (−1, −1, −1) or mid grey (0, 0, 0): neither is unit.
    is_normal = np.abs(length - 1) < 0.2
    if not is_normal.any():
        raise InputError(
            "has no pixel with a unit normal",
            file=str(path),
            field="surface.normals",
            remedy="8 or 16 bit pictures hold n/2 + 1/2, EXR holds n",
        )
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = np.where(is_normal, values / length, np.nan)
    normals = undistort(normals, view, method="nearest")
    axes = scene.surface.normals_axes
    if axes == "world":
        return normals
    return rotate(view.world_from_camera, normals @ NORMAL_AXES[axes].T)
