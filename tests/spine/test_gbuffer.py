"""The packed G-buffer: what sixteen bytes keep, and that the shaders read the same."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.gbuffer import (
    OBJECT,
    STRUCTS,
    VALID,
    pack_surface,
    pack_view,
    projection_variant,
    unpack_surface,
)
from andon.gpu.bindings import bind_group
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.quantities import Surface
from andon.spaces import View, look_at
from comparison import assert_agree

VIEW = View("pinhole", 40, 30, 35.0, 36.0, 19.0, 15.0)
AXES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]


def random_surface(view, seed=0):
    generator = np.random.default_rng(seed)
    shape = view.shape
    normal = generator.normal(size=(*shape, 3))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    normal.reshape(-1, 3)[:6] = AXES[: normal.size // 3]
    valid = generator.random(shape) > 0.2
    valid.reshape(-1)[:6] = True
    depth = np.where(valid, generator.uniform(0.3, 40, shape), np.nan)
    return Surface(
        position=np.full((*shape, 3), np.nan),
        normal=np.where(valid[..., None], normal, np.nan),
        depth=depth,
        valid=valid,
        is_object=valid & (generator.random(shape) > 0.5),
        reflectance=np.where(valid[..., None], generator.random((*shape, 3)), 0),
        material_id=np.where(valid, generator.integers(0, 300, shape), -1).astype(np.int32),
        emitted_cd_m2=np.zeros((*shape, 3)),
        view=view,
    )


def test_what_is_packed_comes_back():
    surface = random_surface(VIEW)
    back = unpack_surface(pack_surface(surface), VIEW)
    mask = surface.valid
    for name in ("valid", "is_object", "material_id"):
        assert (back[name] == getattr(surface, name)).all(), name
    assert_agree(back["depth"][mask], surface.depth[mask].astype(np.float32))
    assert np.isnan(back["depth"][~mask]).all()
    # √ρ in 8 bits: half a step is 1/510, and dρ = 2·√ρ·d√ρ ≤ 1/255.
    assert_agree(back["reflectance"][mask], surface.reflectance[mask], atol=1 / 255)
    assert angle(back["normal"][mask], surface.normal[mask]).max() < 6.5e-5


def angle(a, b):
    return np.linalg.norm(np.cross(a, b), axis=-1)


@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3))
def test_every_normal_survives(vector):
    view = View("pinhole", 1, 1, 1.0, 1.0)
    normal = np.array(vector) / np.linalg.norm(vector)
    surface = random_surface(view)
    packed = pack_surface(Surface(**{**vars(surface), "normal": normal[None, None]}))
    back = unpack_surface(packed, view)["normal"][0, 0]
    assert angle(back, normal) < 6.5e-5
    assert back @ normal > 0.99


def shaded(gpu, view, code, **resources):
    """The picture (H, W, 4) of a fragment shader that returns vec4f."""
    buffer = uniform_buffer(gpu, pack_view(view).nbytes)
    write_buffer(gpu, buffer, pack_view(view))
    target = make_texture(gpu, "rgba32float", view.width, view.height)
    text = f"""
//!import andon/gbuffer/gbuffer.wgsl
@group(0) @binding(0) var<uniform> view: ViewRecord;
@group(0) @binding(1) var gbuffer: texture_2d<u32>;
@fragment fn probe(@builtin(position) pixel: vec4f) -> @location(0) vec4f {{
  let point = surface_point(textureLoad(gbuffer, vec2i(pixel.xy), 0), pixel.xy);
  {code}
}}
"""
    packed = make_texture(gpu, "rgba32uint", view.width, view.height)
    packed.write(resources.get("packed", np.ones((*view.shape, 4), np.uint32)))
    group = bind_group(gpu, {0: ("uniform", buffer), 1: ("uint", packed.view)})
    name = "andon/probe.wgsl"
    run = FullscreenPass(
        gpu, name, "probe", ["rgba32float"], [group],
        structs=STRUCTS, variants={name: text} | projection_variant(view),
    )  # fmt: skip
    encoder = gpu.device.create_command_encoder()
    run.encode(encoder, [target.view])
    gpu.device.queue.submit([encoder.finish()])
    return target.read()


POSE = look_at(np.array([0.4, 1.2, 2.0]), np.array([-0.3, 0.5, -1.0]))
VIEWS = [
    View("pinhole", 37, 21, 30.0, 33.0, 15.0, 11.0, world_from_camera=POSE),
    View("fisheye", 37, 21, 14.0, 13.0, 18.0, 10.0, world_from_camera=POSE),
    View("latlong", 36, 18, world_from_camera=POSE),
]


@pytest.mark.parametrize("view", VIEWS, ids=[view.projection for view in VIEWS])
def test_rays_of_the_shaders_are_those_of_the_view(gpu, view):
    rays = shaded(gpu, view, "return vec4f(ray_planar(pixel.xy), point.position.x);")
    assert_agree(rays[..., :3], view.rays_planar(), atol=2e-6)
    surface = random_surface(view)
    code = "return vec4f(point.position, f32(point.flags));"
    points = shaded(gpu, view, code, packed=pack_surface(surface))
    origin = view.position
    expected = origin + view.rays_planar() * surface.depth[..., None] @ POSE[:3, :3].T
    assert_agree(points[surface.valid][:, :3], expected[surface.valid], atol=1e-5, rtol=1e-6)


def test_shaders_unpack_what_the_host_packed(gpu):
    surface = random_surface(VIEW)
    packed = pack_surface(surface)
    host = unpack_surface(packed, VIEW)
    mask = surface.valid
    normal = shaded(gpu, VIEW, "return vec4f(point.normal, 0.0);", packed=packed)
    assert_agree(normal[mask][:, :3], host["normal"][mask], atol=1e-6)
    code = "return vec4f(point.reflectance, f32(point.flags));"
    rest = shaded(gpu, VIEW, code, packed=packed)
    assert_agree(rest[mask][:, :3], host["reflectance"][mask], atol=1e-6)
    flags = rest[..., 3].astype(np.int64)
    assert ((flags & VALID > 0) == surface.valid).all()
    assert ((flags & OBJECT > 0) == surface.is_object).all()


def test_shaders_pack_as_the_host_does(gpu):
    surface = random_surface(VIEW)
    mask = surface.valid
    code = "return vec4f(octahedral_decode(octahedral_encode(point.normal)), 0.0);"
    twice = shaded(gpu, VIEW, code, packed=pack_surface(surface))[mask][:, :3]
    assert angle(twice, surface.normal[mask]).max() < 1e-4


def test_the_half_pixel_is_in_one_place():
    """(cx, cy) = (0, 0) is the centre of the first pixel here, (0.5, 0.5) on the GPU."""
    record = pack_view(View("pinhole", 4, 4, 2.0, 2.0, 0.0, 1.0))
    assert record["centre"].tolist() == [[0.5, 1.5]]
