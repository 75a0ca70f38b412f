"""The G-buffer of the shaders against the reference: rasterised or uploaded, one surface."""

from dataclasses import replace

import numpy as np
import pytest

from andon.quantities import Geometry, Material
from andon.spaces import View, look_at
from andon.surface import reference
from andon.surface.load import surface_of_depth
from andon.surface.model import SurfaceModel
from andon.surface.objects import joined
from andon.surface.stage import SurfaceStage
from comparison import assert_agree
from worlds import ball, block, sheet, sphere_depth

POSE = look_at(np.array([0.6, 1.2, 2.4]), np.array([0.0, 0.4, 0.0]))
PINHOLE = View("pinhole", 96, 72, 80.0, 84.0, 45.0, 37.0, world_from_camera=POSE)
FISHEYE = View("fisheye", 96, 72, 34.0, 33.0, 46.0, 35.0, world_from_camera=POSE)
LATLONG = View("latlong", 96, 48, world_from_camera=POSE)

CHECKS = (np.indices((64, 64)).sum(axis=0) // 8 % 2)[..., None] * np.array([0.8, 0.5, 0.3])


def textured(geometry):
    from andon.surface.textures import with_linear_textures

    positions = geometry.positions
    uvs = (positions[:, [0, 2]] - positions[:, [0, 2]].min(axis=0)) * 0.8
    material = Material("floor", (0.9, 0.8, 0.7), (CHECKS * 255).astype(np.uint8))
    return with_linear_textures(replace(geometry, uvs=uvs, materials=(material,)))


def painted(geometry, name, reflectance, **more):
    return replace(geometry, materials=(Material(name, reflectance, **more),))


FLOOR = textured(sheet((-3, 0, 3), (6, 0, 0), (0, 0, -6)))
RED = painted(ball(0.4, (0.1, 0.5, 0.2)), "red", (0.7, 0.1, 0.05))
LIT = painted(block((0.4, 0.7, 0.4), (-0.7, 0.35, -0.2)), "lit", (0.2, 0.3, 0.4),
              emissive_cd_m2=(5.0, 4.0, 3.0))  # fmt: skip
MESH = joined([FLOOR, RED, LIT])


def drawn(gpu, model, view):
    stage = SurfaceStage(gpu, model, view)
    encoder = gpu.device.create_command_encoder()
    seen = stage.encode(encoder)
    gpu.device.queue.submit([encoder.finish()])
    return seen.read()


def assert_same_surface(actual, expected, *, edge_share=0.01):
    """Same holes and objects but for pixels on edges; there alike in every field."""
    for name in ("valid", "is_object", "material_id"):
        differing = getattr(actual, name) != getattr(expected, name)
        assert differing.mean() <= edge_share, f"{name}: {differing.mean():.3%}"
    both = actual.valid & expected.valid & (actual.is_object == expected.is_object)
    both &= actual.material_id == expected.material_id
    assert both.sum() > 100
    compare = {"depth": (0, 2e-5), "position": (1e-4, 0), "reflectance": (1.5 / 255, 0)}
    for name, (atol, rtol) in compare.items():
        a, e = getattr(actual, name)[both], getattr(expected, name)[both]
        # A pixel on an edge between two facets takes either.
        assert_agree(a, e, atol=atol, rtol=rtol, share=edge_share, what=name)
    cross = np.linalg.norm(np.cross(actual.normal[both], expected.normal[both]), axis=-1)
    assert_agree(cross, np.zeros(both.sum()), atol=2e-4, share=edge_share, what="normal")
    along = np.einsum("ij,ij->i", actual.normal[both], expected.normal[both])
    assert along.min() > 0.2
    assert_agree(actual.emitted_cd_m2[both], expected.emitted_cd_m2[both], what="emitted")


@pytest.mark.parametrize("view", [PINHOLE, FISHEYE, LATLONG], ids=lambda view: view.projection)
def test_virtual_objects_before_nothing(gpu, view):
    model = SurfaceModel(objects=MESH)
    assert_same_surface(drawn(gpu, model, view), reference.see(model, view))


@pytest.mark.parametrize("view", [PINHOLE, FISHEYE, LATLONG], ids=lambda view: view.projection)
def test_a_real_mesh_with_an_object_in_it(gpu, view):
    model = SurfaceModel(real=joined([FLOOR, LIT]), objects=RED)
    expected = reference.see(model, view)
    # What a *real* mesh emits is in the photograph already; only objects add it.
    expected.emitted_cd_m2[~expected.is_object] = 0
    assert expected.is_object.sum() > 15
    assert_same_surface(drawn(gpu, model, view), expected)


def test_a_real_mesh_of_many_materials_without_objects(gpu):
    parts = [
        painted(block((0.2, 0.2, 0.2), (x / 3 - 1, 0.3, 0)), f"m{x}", (x / 8, 0.5, 0.5))
        for x in range(7)
    ]
    model = SurfaceModel(real=joined(parts))
    expected = reference.see(model, PINHOLE)
    assert set(np.unique(expected.material_id)) >= {-1, 0, 3, 6}
    actual = drawn(gpu, model, PINHOLE)
    both = actual.valid & expected.valid
    assert (actual.valid != expected.valid).mean() < 0.02
    assert (actual.material_id != expected.material_id)[both].mean() < 0.02


def test_smooth_normals(gpu):
    geometry = ball(0.5, (0.1, 0.5, 0.2), frequency=4)
    normals = geometry.positions - (0.1, 0.5, 0.2)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    model = SurfaceModel(objects=replace(geometry, normals=normals))
    assert_same_surface(drawn(gpu, model, PINHOLE), reference.see(model, PINHOLE))


@pytest.mark.parametrize("view", [PINHOLE, FISHEYE, LATLONG], ids=lambda view: view.projection)
def test_a_depth_image_is_uploaded_as_it_is(gpu, view):
    depth = sphere_depth(view, (0.1, 0, 1.8), 0.9)[0]
    model = surface_of_depth(depth, view)
    expected = reference.see(model, view)
    assert_same_surface(drawn(gpu, model, view), expected, edge_share=0)


def test_objects_hide_a_depth_image_and_are_hidden_by_it(gpu):
    depth = sphere_depth(PINHOLE, (0.2, 0, 2.2), 0.5)[0]
    model = replace(surface_of_depth(depth, PINHOLE), objects=MESH)
    expected = reference.see(model, PINHOLE)
    assert 0.1 < expected.is_object.mean() < 0.95
    assert (expected.valid & ~expected.is_object).mean() > 0.05
    assert_same_surface(drawn(gpu, model, PINHOLE), expected)


def test_another_eye_sees_the_triangles_of_the_first_eyes_depth(gpu):
    left = replace(PINHOLE, name="left")
    depth = sphere_depth(left, (0.1, 0, 2.2), 0.7)[0]
    model = surface_of_depth(depth, left)
    pose = POSE.copy()
    pose[:3, 3] += POSE[:3, 0] * 0.064
    right = replace(PINHOLE, name="right", world_from_camera=pose)
    expected = reference.see(model, right)
    assert expected.valid.mean() > 0.1
    assert_same_surface(drawn(gpu, model, right), expected, edge_share=0.02)


def test_nothing_at_all_is_a_hole(gpu):
    surface = drawn(gpu, SurfaceModel(), PINHOLE)
    assert not surface.valid.any()
    assert np.isnan(surface.position).all()


def test_drawing_twice_gives_the_same_bytes(gpu):
    stage = SurfaceStage(gpu, SurfaceModel(objects=MESH), PINHOLE)
    pictures = []
    for _ in range(2):
        encoder = gpu.device.create_command_encoder()
        stage.encode(encoder)
        gpu.device.queue.submit([encoder.finish()])
        pictures.append(stage.surface.texture.read())
    assert (pictures[0] == pictures[1]).all()


def test_vertices_are_shared_only_where_they_may_be():
    from andon.surface.vertices import vertex_arrays

    flat, smooth = ball(1, (0, 0, 0), 2), None
    smooth = replace(flat, normals=flat.positions)
    assert len(vertex_arrays(flat)[0]) == 3 * len(flat.triangles)
    assert len(vertex_arrays(smooth)[0]) == len(flat.positions)
    two = Geometry(
        smooth.positions, smooth.triangles, smooth.normals, None,
        np.arange(len(flat.triangles), dtype=np.int32) % 2, (Material(), Material()),
    )  # fmt: skip
    vertices, indices = vertex_arrays(two)
    assert vertices["material"][indices].reshape(-1, 3)[:4].tolist() == [[0] * 3, [1] * 3] * 2
