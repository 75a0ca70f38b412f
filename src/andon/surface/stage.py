"""The G-buffer on the GPU: uploaded where a depth image is its own view, rasterised otherwise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.gbuffer import (
    BODY_SHIFT,
    MAX_BODIES,
    OBJECT,
    STRUCTS,
    VALID,
    VERTEX,
    VIEW_RECORD,
    pack_surface,
    pack_view,
    projection_variant,
    unpack_surface,
)
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import color_attachment, pipeline_layout, shader_module
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.lamps.bodies import Body
from andon.quantities import Geometry, Material, Surface
from andon.spaces import View
from andon.surface import reference
from andon.surface.body_mesh import BodyMesh
from andon.surface.model import SurfaceModel
from andon.surface.textures import TEXTURE_SIDE_PX
from andon.surface.vertices import is_flat, vertex_arrays

__all__ = ["GpuSurface", "SurfaceStage"]

SHADER = "andon/surface/raster.wgsl"
# Integer division costs a software rasteriser more than all the rest of the shader.
PLAIN, TEXTURED = "andon/surface/plain.wgsl", "andon/surface/textured.wgsl"


class GpuSurface:
    """A packed G-buffer and the view it belongs to.

    Attributes
    ----------
    texture : (H, W) rgba32uint, see gbuffer.wgsl.
    view_buffer : one `VIEW_RECORD`.
    emitted_cd_m2 : (materials, 3), what the materials of virtual objects emit.
    bodies : luminous bodies as triangles with their light; none where they are traced.
    body_light : their light as a picture, cd/m², where they are traced.
    model : what is seen; says which pixels have a material and a position of their own.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        emitted_cd_m2: NDArray[np.float64],
        model: SurfaceModel,
    ) -> None:
        self.view, self.model = view, model
        self.emitted_cd_m2 = emitted_cd_m2
        self.bodies: tuple[BodyMesh, ...] = ()
        self.body_light: Texture | None = None
        self.texture = make_texture(gpu, "rgba32uint", view.width, view.height, label="g-buffer")
        self.view_buffer = uniform_buffer(gpu, VIEW_RECORD.dtype.itemsize, "view")
        write_buffer(gpu, self.view_buffer, pack_view(view))

    def read(self) -> Surface:
        """The surface as arrays; precision of the packing: normals 6.5e-5 rad, depth float32."""
        fields = unpack_surface(self.texture.read(), self.view)
        is_object = fields["is_object"]
        if self.model.is_distant_only:
            normals = np.where(fields["valid"][..., None], fields["normal"], np.nan)
            points = reference.from_normals(normals, self.view)
        else:
            points = reference.from_depth(fields["depth"], fields["normal"], self.view)
        if self.view.name in self.model.depth or self.model.is_distant_only:
            fields["material_id"] = np.where(is_object, fields["material_id"], -1)
        emitted = np.zeros_like(points.reflectance)
        # Numbers of materials are the objects' own; the real surface's emission is in the photo.
        own = is_object & (fields["body_id"] < 0)
        emitted[own] = self.emitted_cd_m2[fields["material_id"][own]]
        fields["normal"] = points.normal
        return replace(points, **fields, emitted_cd_m2=emitted)


class SurfaceStage:
    """Sees one model through one view, as often as the frame is drawn.

    A pinhole view is rasterised every time. Fisheye and latlong views, whose straight lines are
    curved, are traced by Embree when the stage is made and uploaded.
    """

    def __init__(
        self, gpu: Gpu, model: SurfaceModel, view: View, bodies: Sequence[Body] = ()
    ) -> None:
        self.gpu, self.model, self.view = gpu, model, view
        _check_bodies(bodies)
        self._has_bodies = len(bodies) > 0
        objects = model.objects
        emitted = np.array([m.emissive_cd_m2 for m in objects.materials], float).reshape(-1, 3)
        self.surface = GpuSurface(gpu, view, emitted, model)
        self._on_host = view.projection != "pinhole"
        has_picture = view.name in model.depth or model.is_distant_only
        self._draws: list[_Draw] = []
        self._bodies: list[BodyMesh] = []
        self._background: Texture | None = None
        self._still: Surface | None = None
        if self._on_host or (has_picture and len(objects.triangles) == 0 and not bodies):
            self._still = reference.see(model, view)
            self.surface.texture.write(pack_surface(self._still))
            return
        if has_picture:
            real = reference.see(SurfaceModel(depth=model.depth, normals=model.normals), view)
            self._background = make_texture(gpu, "rgba32uint", view.width, view.height)
            self._background.write(pack_surface(real))
        self._make_pipelines()
        if not has_picture and len(model.real.triangles):
            self._draws.append(_Draw(self, model.real, VALID))
        if len(objects.triangles):
            self._draws.append(_Draw(self, objects, VALID | OBJECT))
        for number, body in enumerate(bodies):
            mesh = BodyMesh(gpu, body, number)
            flags = VALID | OBJECT | ((number + 1) << BODY_SHIFT)
            self._draws.append(_Draw(self, body.geometry, flags, mesh, body.reflectance))
            self._bodies.append(mesh)
        self.surface.bodies = tuple(self._bodies)

    @property
    def has_bodies(self) -> bool:
        """Luminous bodies are drawn."""
        return self._has_bodies

    @property
    def is_static(self) -> bool:
        """Nothing is drawn: the G-buffer was uploaded once."""
        return not self._draws

    def _make_pipelines(self) -> None:
        gpu, view, model = self.gpu, self.view, self.model
        variants = projection_variant(view)
        if any(m.texture is not None for m in (*model.real.materials, *model.objects.materials)):
            variants |= {PLAIN: TEXTURED}
        module = shader_module(gpu, SHADER, STRUCTS, variants)
        self._depth = make_texture(gpu, "depth32float", view.width, view.height)
        attributes = [
            {"format": "float32x3", "offset": 0, "shader_location": 0},
            {"format": "float32x3", "offset": 12, "shader_location": 1},
            {"format": "float32x2", "offset": 24, "shader_location": 2},
            {"format": "uint32", "offset": 32, "shader_location": 3},
        ]
        buffers = [
            {"array_stride": VERTEX.itemsize, "step_mode": "vertex", "attributes": attributes}
        ]
        flags = self.surface.view_buffer
        empty = make_texture(gpu, "rgba16float", 1, 1, layers=1)
        table = gpu.device.create_buffer(size=16, usage=_storage_usage())
        background = self._background or make_texture(gpu, "rgba32uint", 1, 1)
        layout = self.bind(flags, table, empty, background)
        self.pipelines = {
            entry: self._pipeline(layout, module, "corner", entry, buffers, "greater")
            for entry in ("surface", "flat_surface")
        }
        self._fill: Any = None
        if self._background is not None:
            self._fill = self._pipeline(layout, module, "fullscreen", "background", [], "always")
            self._fill_group = layout

    def _see_on_host(self, still: Surface, bodies: Sequence[Body]) -> None:
        """Curved projections: bodies are traced, and their light is a picture."""
        seen = reference.with_bodies(still, bodies)
        self.surface.texture.write(pack_surface(seen))
        if self.surface.body_light is None:
            size = (self.view.width, self.view.height)
            self.surface.body_light = make_texture(self.gpu, "rgba32float", *size)
        light = np.zeros((*self.view.shape, 4))
        own = seen.body_id
        if own is not None:
            light[own >= 0, :3] = seen.emitted_cd_m2[own >= 0]
        self.surface.body_light.write(light)

    def bind(self, flags: Any, materials: Any, textures: Texture, background: Texture) -> BindGroup:
        """Group 0 of raster.wgsl."""
        return bind_group(
            self.gpu,
            {
                0: ("uniform", self.surface.view_buffer),
                1: ("uniform", flags),
                2: ("storage", materials),
                3: ("float array", textures.view),
                4: ("uint", background.view),
            },
            "surface",
        )

    def _pipeline(
        self,
        group: BindGroup,
        module: Any,
        vertex: str,
        fragment: str,
        buffers: list[dict[str, Any]],
        compare: str,
    ) -> Any:
        return self.gpu.device.create_render_pipeline(
            label=f"{SHADER}:{fragment}",
            layout=pipeline_layout(self.gpu, [group]),
            vertex={"module": module, "entry_point": vertex, "buffers": buffers},
            primitive={"topology": "triangle-list", "cull_mode": "none"},
            depth_stencil={
                "format": "depth32float",
                "depth_write_enabled": True,
                "depth_compare": compare,
            },
            fragment={
                "module": module,
                "entry_point": fragment,
                "targets": [{"format": "rgba32uint"}],
            },
        )

    def encode(self, encoder: Any, bodies: Sequence[Body] = ()) -> GpuSurface:
        """Records the drawing of the G-buffer; returns where it will be.

        `bodies` are those of the start, where they are now.
        """
        if self._still is not None:
            if bodies:
                self._see_on_host(self._still, bodies)
            return self.surface
        for mesh, body in zip(self._bodies, bodies, strict=True):
            mesh.move(body)
        render = encoder.begin_render_pass(
            label="surface",
            color_attachments=[color_attachment(self.surface.texture.view)],
            depth_stencil_attachment={
                "view": self._depth.view,
                "depth_load_op": "clear",
                "depth_store_op": "discard",
                "depth_clear_value": 0.0,
            },
        )
        if self._fill is not None:
            render.set_pipeline(self._fill)
            render.set_bind_group(0, self._fill_group.group)
            render.draw(3)
        for draw in self._draws:
            render.set_pipeline(self.pipelines[draw.entry_point])
            draw.encode(render)
        render.end()
        return self.surface


def _check_bodies(bodies: Sequence[Body]) -> None:
    if len(bodies) > MAX_BODIES:
        raise InputError(f"{len(bodies)} luminous bodies, at most {MAX_BODIES}", field="lamp")


class _Draw:
    """Buffers of one geometry."""

    def __init__(
        self,
        stage: SurfaceStage,
        geometry: Geometry,
        flags: int,
        body: BodyMesh | None = None,
        reflectance: tuple[float, float, float] | None = None,
    ) -> None:
        import wgpu

        gpu = stage.gpu
        self.entry_point = "flat_surface" if is_flat(geometry) else "surface"
        device, usage = gpu.device, wgpu.BufferUsage
        if body is None:
            vertices, indices = vertex_arrays(geometry)
            self.count = indices.size
            self.vertices = device.create_buffer_with_data(data=vertices, usage=usage.VERTEX)
            self.indices = device.create_buffer_with_data(data=indices, usage=usage.INDEX)
        else:
            self.count, self.vertices, self.indices = body.count, body.vertices, body.indices
        if reflectance is not None:
            geometry = replace(geometry, materials=(Material(reflectance=reflectance),))
        flag_buffer = uniform_buffer(gpu, 16, "draw flags")
        write_buffer(gpu, flag_buffer, np.array([flags, 0, 0, 0], np.uint32))
        table, textures = _material_table(gpu, geometry)
        materials = device.create_buffer_with_data(data=table, usage=usage.STORAGE)
        nothing = make_texture(gpu, "rgba32uint", 1, 1)
        self.group = stage.bind(flag_buffer, materials, textures, nothing)

    def encode(self, render: Any) -> None:
        render.set_bind_group(0, self.group.group)
        render.set_vertex_buffer(0, self.vertices)
        render.set_index_buffer(self.indices, "uint32")
        render.draw_indexed(self.count)


def _storage_usage() -> int:
    import wgpu

    return wgpu.BufferUsage.STORAGE


def _material_table(gpu: Gpu, geometry: Geometry) -> tuple[NDArray[np.float32], Texture]:
    textured = [m for m in geometry.materials if m.texture is not None]
    side = TEXTURE_SIDE_PX if textured else 1
    # Half floats hold linear light to 0.05 %; 8 bits would band in the darks.
    stack = make_texture(gpu, "rgba16float", side, side, layers=max(1, len(textured)))
    table = np.full((len(geometry.materials), 4), -1.0, np.float32)
    layer = 0
    for row, material in zip(table, geometry.materials, strict=True):
        row[:3] = material.reflectance
        if material.texture is not None and geometry.uvs is not None:
            stack.write(np.dstack([material.texture, np.ones((side, side))]), layer)
            row[3] = layer
            layer += 1
    return table, stack
