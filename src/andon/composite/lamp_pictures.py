"""Visible lamps and luminous bodies on the GPU, over the picture and alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.composite.records import DISC_RECORD, STRUCTS
from andon.composite.reference import Disc, drawn_lamps
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass, pipeline_layout, shader_module
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.lamps import Lamp
from andon.spaces import View, transform_points

__all__ = ["LampPictures", "body_rectangle", "disc_rectangle"]

BODIES = "andon/composite/bodies.wgsl"
TARGETS = ("rgba16float", "rgba16float")
# As many as there may be lamps.
MAX_DISCS = 64


def _blend(behind: str) -> dict[str, Any]:
    parts = {"operation": "add", "src_factor": "one", "dst_factor": behind}
    return {"color": parts, "alpha": parts}


# Premultiplied "over" for what hides the picture, "plus" for light of what is in it already.
OVER, PLUS = _blend("one-minus-src-alpha"), _blend("one")


class LampPictures:
    """Draws bodies' light and lamps' discs into two pictures: the frame's, and one without a room.

    Attributes
    ----------
    alone : rgba16float, luminous bodies and visible lamps alone, 0 elsewhere.
    within : (x, y, width, height) in pixels that holds all that was drawn into it last.
    """

    def __init__(
        self, gpu: Gpu, view: View, gbuffer_view: Any, view_buffer: Any, ambient_buffer: Any
    ) -> None:
        self.gpu, self.view = gpu, view
        self.alone = make_texture(gpu, TARGETS[1], view.width, view.height, label="bodies")
        self.within = (0, 0, view.width, view.height)
        self._scene = {0: ("uint", gbuffer_view), 1: ("uniform", view_buffer)}
        self._ambient = ambient_buffer
        self._disc_buffers = [
            uniform_buffer(gpu, DISC_RECORD.dtype.itemsize, "disc") for _ in range(MAX_DISCS)
        ]
        self._disc_groups = [bind_group(gpu, {0: ("uniform", b)}) for b in self._disc_buffers]
        self._discs = FullscreenPass(
            gpu,
            "andon/composite/discs.wgsl",
            "lamp_disc",
            TARGETS,
            [bind_group(gpu, self._scene), self._disc_groups[0]],
            structs=STRUCTS | gbuffer.STRUCTS,
            variants=gbuffer.projection_variant(view),
            blend=OVER,
        )
        self._nothing = make_texture(gpu, "rgba32float", 1, 1)
        self._body_group = self._group(self._nothing.view)
        self._bodies = self._body_pipeline("body_corner", "body_light")
        self._traced = self._body_pipeline("fullscreen", "traced_light")
        self._shells = self._body_pipeline("fullscreen", "shell_light")
        self._picture_groups: dict[Any, tuple[Any, BindGroup]] = {}

    def _group(self, traced: Any) -> BindGroup:
        own = {2: ("uniform", self._ambient), 3: ("float", traced)}
        return bind_group(self.gpu, self._scene | own, "bodies")

    def _body_pipeline(self, vertex: str, fragment: str) -> Any:
        structs = STRUCTS | gbuffer.STRUCTS
        module = shader_module(self.gpu, BODIES, structs, gbuffer.projection_variant(self.view))
        targets = [{"format": name, "blend": PLUS} for name in TARGETS]
        return self.gpu.device.create_render_pipeline(
            label=f"{BODIES}:{fragment}",
            layout=pipeline_layout(self.gpu, [self._body_group]),
            vertex={
                "module": module,
                "entry_point": vertex,
                "buffers": _BODY_BUFFERS if vertex == "body_corner" else [],
            },
            primitive={"topology": "triangle-list", "cull_mode": "none"},
            fragment={"module": module, "entry_point": fragment, "targets": targets},
        )

    def encode(
        self,
        encoder: Any,
        target: Any,
        seen: Any,
        lamps: Sequence[Lamp],
        luminance_per_unit: float,
    ) -> bool:
        """Records bodies and lamps over `target` and into `alone`; False if there are none.

        `seen` is the G-buffer of the frame, which knows where the bodies are.
        """
        discs = drawn_lamps(lamps, self.view.position)
        pictures = seen.body_light, seen.shell_light
        if not discs and not seen.bodies and pictures == (None, None):
            return False
        render = encoder.begin_render_pass(
            label="lamps",
            color_attachments=[
                {"view": target, "load_op": "load", "store_op": "store"},
                {
                    "view": self.alone.view,
                    "load_op": "clear",
                    "store_op": "store",
                    "clear_value": (0, 0, 0, 0),
                },
            ],
        )
        self.within = self._extent(seen, discs)
        self._encode_bodies(render, seen)
        self._encode_discs(render, discs, luminance_per_unit)
        render.end()
        return True

    def _extent(self, seen: Any, discs: Sequence[Disc]) -> tuple[int, int, int, int]:
        """A rectangle around all bodies and discs; the whole picture where that is not known."""
        whole = (0, 0, self.view.width, self.view.height)
        if seen.body_light is not None:
            return whole
        found = [disc_rectangle(self.view, disc.position_m, disc.radius_m) for disc in discs]
        found += [body_rectangle(self.view, body.positions) for body in seen.bodies]
        found += [] if seen.shells is None else [seen.shells.rectangle]
        inside = np.array([one for one in found if one is not None]).reshape(-1, 4)
        if not len(inside):
            return (0, 0, 0, 0)
        left, top = inside[:, :2].min(axis=0).tolist()
        right, bottom = (inside[:, :2] + inside[:, 2:]).max(axis=0).tolist()
        return left, top, right - left, bottom - top

    def _encode_bodies(self, render: Any, seen: Any) -> None:
        self._encode_picture(render, self._traced, seen.body_light)
        self._encode_picture(render, self._shells, seen.shell_light)
        if seen.bodies:
            render.set_pipeline(self._bodies)
            render.set_bind_group(0, self._body_group.group)
        for body in seen.bodies:
            render.set_vertex_buffer(0, body.vertices)
            render.set_vertex_buffer(1, body.light)
            render.set_index_buffer(body.indices, "uint32")
            render.draw_indexed(body.count)

    def _encode_picture(self, render: Any, pipeline: Any, light: Any) -> None:
        """Light that is a picture; None: there is none."""
        if light is None:
            return
        made = self._picture_groups.get(pipeline)
        if made is None or made[0] is not light:
            made = self._picture_groups[pipeline] = (light, self._group(light.view))
        render.set_pipeline(pipeline)
        render.set_bind_group(0, made[1].group)
        render.draw(3)

    def _encode_discs(self, render: Any, discs: Sequence[Disc], luminance_per_unit: float) -> None:
        """Far to near, each within its own rectangle."""
        eye = self.view.position
        if discs:
            render.set_pipeline(self._discs.pipeline)
            render.set_bind_group(0, self._discs.groups[0].group)
        for slot, disc in enumerate(discs):
            rectangle = disc_rectangle(self.view, disc.position_m, disc.radius_m)
            if rectangle is None:
                continue
            reach = disc.position_m - eye
            distance = float(np.linalg.norm(reach))
            record = DISC_RECORD.pack(
                direction=reach / distance,
                distance_m=distance - disc.glass_m,
                linear=disc.luminance_cd_m2 / luminance_per_unit,
                radius_radians=np.arcsin(min(1.0, disc.radius_m / distance)),
            )
            write_buffer(self.gpu, self._disc_buffers[slot], record)
            render.set_bind_group(1, self._disc_groups[slot].group)
            render.set_scissor_rect(*rectangle)
            render.draw(3)


_BODY_BUFFERS: list[dict[str, Any]] = [
    {
        "array_stride": gbuffer.VERTEX.itemsize,
        "step_mode": "vertex",
        "attributes": [{"format": "float32x3", "offset": 0, "shader_location": 0}],
    },
    {
        "array_stride": gbuffer.BODY_LIGHT.itemsize,
        "step_mode": "vertex",
        "attributes": [
            {"format": "float32x3", "offset": 0, "shader_location": 1},
            {"format": "float32x3", "offset": 12, "shader_location": 2},
        ],
    },
]


def disc_rectangle(
    view: View, position_m: NDArray[np.float64], radius_m: float, /
) -> tuple[int, int, int, int] | None:
    """(x, y, width, height) in pixels that holds a ball's disc, or None where it is not in view.

    For fisheye and latlong the whole picture: their discs can wrap around.
    """
    if view.projection != "pinhole":
        return 0, 0, view.width, view.height
    centre = transform_points(view.camera_from_world, position_m)
    if centre[2] <= radius_m:
        return None if centre[2] < -radius_m else (0, 0, view.width, view.height)
    column, row = view.project(centre)
    # A ball's outline is at most r/(z − r) away from its centre in units of the focal length,
    # stretched by 1/cos² off the axis, which |centre|²/z² is.
    stretch = float(centre @ centre) / centre[2] ** 2
    reach = radius_m / (centre[2] - radius_m) * stretch * max(view.fx, view.fy) + 2
    left, top = max(0, int(column - reach)), max(0, int(row - reach))
    right = min(view.width, int(np.ceil(column + reach)) + 1)
    bottom = min(view.height, int(np.ceil(row + reach)) + 1)
    return (left, top, right - left, bottom - top) if right > left and bottom > top else None


def body_rectangle(
    view: View, positions: NDArray[np.float64], /
) -> tuple[int, int, int, int] | None:
    """(x, y, width, height) in pixels that holds a body's vertices (n, 3), or None out of view.

    The whole picture for curved projections, and for a body that reaches behind the camera.
    """
    whole = (0, 0, view.width, view.height)
    if view.projection != "pinhole":
        return whole
    local = transform_points(view.camera_from_world, positions)
    if (local[:, 2] <= gbuffer.NEAR_M).all():
        return None
    if (local[:, 2] <= gbuffer.NEAR_M).any():
        return whole
    pixels = view.project(local)
    low = np.clip(np.floor(pixels.min(axis=0)) - 1, 0, (view.width, view.height)).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 2, 0, (view.width, view.height)).astype(int)
    width, height = (high - low).tolist()
    return (int(low[0]), int(low[1]), width, height) if width > 0 and height > 0 else None
