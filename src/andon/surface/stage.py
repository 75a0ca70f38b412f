"""The G-buffer on the GPU: uploaded where a depth image is its own view, rasterised otherwise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
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
from andon.surface.draws import Draw, storage_buffer
from andon.surface.model import EMPTY_GEOMETRY, SurfaceModel
from andon.surface.mover_mesh import MoverMesh
from andon.surface.shells import ShellsInView

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
    shells, shell_light : what is seen of real shells, and their own light as a picture, cd/m².
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
        self.shells: ShellsInView | None = None
        self.shell_light: Texture | None = None
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
        if self.shell_light is not None:
            light = self.shell_light.read()[..., :3].astype(np.float64)
            fields["shell_cd_m2"] = np.where(is_object[..., None], 0.0, light)
        return replace(points, **fields, emitted_cd_m2=emitted)


class SurfaceStage:
    """Sees one model through one view, as often as the frame is drawn.

    A pinhole view is rasterised every time. Fisheye and latlong views, whose straight lines are
    curved, are traced by Embree: what stands still when the stage is made, what moves every time.
    `bodies` and `movers` are those of the start: later ones have the same triangles.
    """

    def __init__(
        self,
        gpu: Gpu,
        model: SurfaceModel,
        view: View,
        bodies: Sequence[Body] = (),
        movers: Sequence[Geometry] = (),
        shells: ShellsInView | None = None,
    ) -> None:
        self.gpu, self.model, self.view = gpu, model, view
        _check_bodies(bodies)
        drawn = [(number, body) for number, body in enumerate(bodies) if not body.real]
        self._has_bodies = len(drawn) > 0
        objects = model.objects
        self.surface = GpuSurface(gpu, view, model.emitted_cd_m2, model)
        self._on_host = view.projection != "pinhole"
        # What of a real surface is a shell is known by its pixels, so meshes are traced for it.
        has_picture = view.name in model.depth or model.is_distant_only or shells is not None
        self._draws: list[Draw] = []
        self._bodies: list[BodyMesh] = []
        self._movers: list[MoverMesh] = []
        self._background: Texture | None = None
        self._still: Surface | None = None
        self._show_shells(shells)
        if self._on_host or (has_picture and not model.has_objects and not drawn):
            self._still = reference.see(model, view, shells)
            self.surface.texture.write(pack_surface(self._still))
            return
        if has_picture:
            real = reference.see(replace(model, objects=EMPTY_GEOMETRY), view, shells)
            self._background = make_texture(gpu, "rgba32uint", view.width, view.height)
            self._background.write(pack_surface(real))
        self._make_pipelines()
        if not has_picture and len(model.real.triangles):
            self._draws.append(Draw(gpu, self.bind, model.real, VALID))
        if len(objects.triangles):
            self._draws.append(Draw(gpu, self.bind, objects, VALID | OBJECT))
        for info, geometry in zip(model.moving_table, movers, strict=True):
            mesh, first = MoverMesh(gpu, geometry), info.first_slot
            flags = VALID | OBJECT
            draw = Draw(gpu, self.bind, geometry, flags, mesh=mesh, first_slot=first, bends=True)
            self._draws.append(draw)
            self._movers.append(mesh)
        for number, body in drawn:
            mesh = BodyMesh(gpu, body, number)
            flags = VALID | OBJECT | ((number + 1) << BODY_SHIFT)
            look = replace(body.geometry, materials=(Material(reflectance=body.reflectance),))
            self._draws.append(Draw(gpu, self.bind, look, flags, mesh=mesh))
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

    def _show_shells(self, shells: ShellsInView | None) -> None:
        """Makes room for the light of real shells."""
        self._lit: list[Body] = []
        if shells is not None:
            self.surface.shells = shells
            size = (self.view.width, self.view.height)
            self.surface.shell_light = make_texture(self.gpu, "rgba32float", *size, label="shells")

    def _light_shells(self, bodies: Sequence[Body]) -> None:
        """Brings the light of real shells up to date."""
        shells, picture = self.surface.shells, self.surface.shell_light
        if shells is None or picture is None:
            return
        real = [body for body in bodies if body.real]
        if len(real) == len(self._lit) and all(map(_as_bright, real, self._lit)):
            return
        self._lit = real
        light = shells.light(bodies)
        picture.write(np.concatenate([light, np.zeros_like(light[..., :1])], axis=-1))

    def _make_pipelines(self) -> None:
        gpu, view, model = self.gpu, self.view, self.model
        variants = projection_variant(view)
        drawn = (model.real, model.objects, *(mover.geometry for mover in model.movers))
        materials = chain.from_iterable(geometry.materials for geometry in drawn)
        if any(material.texture is not None for material in materials):
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
        table = storage_buffer(gpu, np.zeros((1, 4), np.float32))
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

    def _see_on_host(
        self, still: Surface, bodies: Sequence[Body], movers: Sequence[Geometry]
    ) -> None:
        """Curved projections: what moves is traced, and the light of bodies is a picture."""
        seen = reference.with_movers(still, self.model, movers)
        seen = reference.with_bodies(seen, bodies)
        self.surface.texture.write(pack_surface(seen))
        if not bodies:
            return
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

    def encode(
        self,
        encoder: Any,
        bodies: Sequence[Body] = (),
        movers: Sequence[Geometry] = (),
    ) -> GpuSurface:
        """Records the drawing of the G-buffer; returns where it will be.

        `bodies` and `movers` are those of the start, where they are now.
        """
        self._light_shells(bodies)
        bodies_drawn = [body for body in bodies if not body.real]
        if self._still is not None:
            if bodies_drawn or movers:
                self._see_on_host(self._still, bodies, movers)
            return self.surface
        for moving, geometry in zip(self._movers, movers, strict=True):
            moving.move(geometry)
        for mesh, body in zip(self._bodies, bodies_drawn, strict=True):
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


def _as_bright(body: Body, other: Body) -> bool:
    return np.array_equal(body.outside_cd_m2, other.outside_cd_m2) and np.array_equal(
        body.inside_cd_m2, other.inside_cd_m2
    )


def _check_bodies(bodies: Sequence[Body]) -> None:
    if len(bodies) > MAX_BODIES:
        raise InputError(f"{len(bodies)} luminous bodies, at most {MAX_BODIES}", field="lamp")
