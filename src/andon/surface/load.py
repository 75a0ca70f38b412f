"""From a scene's [surface] and [[object]] tables to a `SurfaceModel`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.depth import read_depth_array
from andon.files.pictures import read_picture
from andon.lenses import undistort
from andon.quantities import Geometry, Material, merged
from andon.scene import Scene
from andon.scene.surface import Depth
from andon.spaces import View, another_size, rotate
from andon.surface.depth import DepthEncoding, depth_from_raw
from andon.surface.filling import filled, hidden_behind
from andon.surface.meshes import check_textures, read_geometry, rest_note
from andon.surface.model import ShadowBias, SurfaceModel
from andon.surface.normals import planes_of_depth
from andon.surface.objects import load_objects
from andon.surface.occluder import decimated
from andon.surface.resample import resampled, same_aspect
from andon.surface.triangulate import thickened, triangulate_depth

__all__ = ["load_surface", "mesh_geometry", "surface_of_depth", "surface_of_mesh"]

Float = NDArray[np.float64]

# Least lift of receivers before a shadow is looked up: float32 rounding for meshes, more than
# stereo and structured light scatter for depth images, and twice the decimation's own error. Twice,
# since that error is a 95th percentile of unsigned distances: the worst of the other 5 % lie
# about twice as far, and lamps look at them at a slant. Measured against shadows of all
# triangles, the sum of false and lost shadows is smallest at 1.9 times the error on the
# demonstration, at 2.2 times on noisy Kinect depth and at 1 to 2 times in the furnished room,
# and flat around that; half as much lift doubles the false ones (acne), twice as much doubles
# the lost ones.
MESH_BIAS_M = 2e-4
DEPTH_BIAS_M = 5e-3
DECIMATION_MARGIN = 2.0

# Camera axes of a file's normals → our camera frame (x right, y down, z forward).
NORMAL_AXES = {"opencv": np.eye(3), "opengl": np.diag([1.0, -1.0, -1.0])}


def load_surface(scene: Scene, views: Mapping[str, View]) -> SurfaceModel:
    """The geometry of `scene` for its `views` (as captured: with their distortion).

    Raises `InputError` for files that are missing, of the wrong size or without geometry.
    """
    objects = load_objects(scene)
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
        movers=objects.movers,
        notes=(*model.notes, *objects.notes),
    )


def _from_depth(scene: Scene, views: Mapping[str, View]) -> SurfaceModel:
    assert scene.surface is not None
    table = scene.surface.depth
    assert table is not None
    # One depth image belongs to one picture: the first view. Other views see its triangles.
    name, view = next(iter(views.items()))
    path = scene.path(table.file, "surface.depth.file")
    raw = read_depth_array(path)
    depth = _depth_of(raw, view, table, str(path))
    given = None if scene.surface.normals is None else _read_normals(scene, view)
    model = surface_of_depth(
        depth,
        replace(view.undistorted(), name=name),
        normals=given,
        max_jump=table.max_jump,
        thickness_m=table.thickness_m,
        occluder_triangles=scene.surface.occluder_triangles,
        fill_px=table.fill_px,
        file=str(path),
    )
    return replace(model, notes=(*_on_size(raw.shape, view, path.name), *model.notes))


def _depth_of(raw: Float, view: View, table: Depth, file: str) -> Float:
    """Depth (H, W) in metres of the undistorted view, from a file's numbers of any resolution."""
    encoding = DepthEncoding(
        table.kind,
        table.scale_to_m,
        table.baseline_m,
        table.doffs_px,
        tuple(table.invalid),
        table.shift_m,
    )
    own = view
    if raw.shape != view.shape and same_aspect((raw.shape[0], raw.shape[1]), view.shape):
        own = view.resized(raw.shape[1], raw.shape[0])
    if raw.shape == own.shape:
        # First: distance becomes depth by the directions of the *undistorted* pixels.
        raw = undistort(raw, own, method="nearest")
    seen_by = own if table.focal_px is None else replace(own, fx=table.focal_px)
    depth = depth_from_raw(raw, seen_by, encoding, file=file)
    return depth if own is view else resampled(depth, view.shape, max_jump=table.max_jump)


def _on_size(shape: tuple[int, ...], view: View, name: str) -> tuple[str, ...]:
    if shape == view.shape:
        return ()
    sizes = f"{shape[1]}×{shape[0]} px for a picture of {view.width}×{view.height}"
    return (f"{name} has {sizes}: resampled, edges kept",)


def surface_of_depth(
    depth: Float,
    view: View,
    /,
    *,
    normals: Float | None = None,
    max_jump: float = 0.05,
    thickness_m: float | None = None,
    occluder_triangles: int = 30_000,
    fill_px: int = 0,
    file: str | None = None,
) -> SurfaceModel:
    """The model of a depth image (H, W) in metres, NaN in holes, of the undistorted `view`.

    Parameters
    ----------
    normals : (H, W, 3) unit, world; default: fitted to the depth.
    max_jump : relative step between neighbours that cuts the surface.
    thickness_m : closes objects at their back for shadows.
    occluder_triangles : budget of the shadow geometry; 0 keeps all.
    fill_px : how wide gaps are that are closed, see `andon.surface.filling`.
    """
    measured = np.isfinite(depth)
    if fill_px:
        depth = filled(depth, fill_px, max_jump=max_jump)
    is_whole = normals is None
    if normals is None:
        normals, depth = planes_of_depth(depth, view, max_jump=max_jump)
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
    if fill_px:
        sheet = merged(sheet, hidden_behind(depth, view, fill_px, max_jump=max_jump))
    # The sheet alone is thinned and judged: nobody sees its back. Closing it adds a back and walls,
    # which a third of the budget leaves room for.
    budget = occluder_triangles if thickness_m is None else occluder_triangles // 3
    occluder = decimated(sheet, budget, view.position)
    if thickness_m is not None:
        closed = thickened(occluder.geometry, view.position, thickness_m)
        occluder = replace(occluder, geometry=closed)
    bias = max(DEPTH_BIAS_M, DECIMATION_MARGIN * occluder.error_m)
    name = view.name
    model = SurfaceModel(real, {name: depth}, {name: normals}, occluder=occluder, bias=_bias(bias))
    if not fill_px:
        return model
    guessed = ~measured & np.isfinite(depth)
    note = (
        f"{guessed.sum()} of {(~measured).sum()} hole pixels have the depth of what is beside "
        f"them: surface.depth.fill_px = {fill_px}"
    )
    return replace(model, filled={name: guessed}, notes=(note,))


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
    real, file = read_geometry(scene, path, world_from_mesh)
    if scene.surface.reflectance is not None:
        real = _with_reflectance(real, scene.surface.reflectance)
    check_textures(real, scene, "surface.mesh")
    return real, rest_note(path, file)


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


def _read_normals(scene: Scene, view: View) -> Float:
    assert scene.surface is not None
    assert scene.surface.normals is not None
    path = scene.path(scene.surface.normals, "surface.normals")
    picture = read_picture(path)
    if picture.shape != view.shape:
        field, remedy = "surface.normals", "give normals of the photograph's own pixels"
        raise another_size(picture.shape, view, file=path, field=field, remedy=remedy)
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
