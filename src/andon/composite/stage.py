"""The composite on the GPU: what frame.wgsl needs of the photograph, and the visible lamps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.composite.model import Ambient
from andon.composite.records import AMBIENT_RECORD, DISC_RECORD, STRUCTS, pack_ambient
from andon.composite.reference import lamp_luminance
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.lamps import Lamp, PointLamp
from andon.quantities import CameraFrame
from andon.spaces import View, transform_points

__all__ = ["STRUCTS", "CompositeStage"]

# Premultiplied "over".
OVER = {
    part: {"operation": "add", "src_factor": "one", "dst_factor": "one-minus-src-alpha"}
    for part in ("color", "alpha")
}
MAX_DISCS = 64
MAX_MATERIALS = 256


class CompositeStage:
    """Holds the captured light and the settings of the ambient; draws visible lamps.

    Attributes
    ----------
    resources : bindings 2 to 5 of group 0 of frame.wgsl.
    has_maps : E0 is a picture, or dimming is the paper's.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        ambient: Ambient,
        gbuffer_view: Any,
        view_buffer: Any,
        emitted_cd_m2: NDArray[np.float64],
    ) -> None:
        self.gpu, self.view, self.ambient = gpu, view, ambient
        self.has_maps = ambient.illuminance_lux.ndim == 3 or ambient.dimming_mode == "paper"
        size = (view.width, view.height)
        self._captured = make_texture(gpu, "rgba16float", *size, label="captured")
        per_lux = size if self.has_maps else (1, 1)
        # 1/E0 of a dark corner and of the sun are five decades apart: too many for half floats.
        self._per_lux = make_texture(gpu, "rgba32float", *per_lux, label="per lux")
        self._ambient = uniform_buffer(gpu, AMBIENT_RECORD.dtype.itemsize, "ambient")
        self._emitted = uniform_buffer(gpu, 16 * MAX_MATERIALS, "emitted")
        table = np.zeros((MAX_MATERIALS, 4), np.float32)
        table[: len(emitted_cd_m2), :3] = emitted_cd_m2[:MAX_MATERIALS]
        write_buffer(gpu, self._emitted, table)
        self.resources: dict[int, tuple[str, Any]] = {
            2: ("uniform", self._ambient),
            3: ("float", self._captured.view),
            4: ("float", self._per_lux.view),
            5: ("uniform", self._emitted),
        }
        scene = bind_group(gpu, {0: ("uint", gbuffer_view), 1: ("uniform", view_buffer)})
        self._disc_buffers = [
            uniform_buffer(gpu, DISC_RECORD.dtype.itemsize, "disc") for _ in range(MAX_DISCS)
        ]
        self._disc_groups = [bind_group(gpu, {0: ("uniform", b)}) for b in self._disc_buffers]
        self._discs = FullscreenPass(
            gpu,
            "andon/composite/discs.wgsl",
            "lamp_disc",
            ["rgba16float"],
            [scene, self._disc_groups[0]],
            structs=STRUCTS | gbuffer.STRUCTS,
            variants=gbuffer.projection_variant(view),
            blend=OVER,
        )

    def load(self, frame: CameraFrame) -> None:
        """Takes a captured frame."""
        write_buffer(self.gpu, self._ambient, pack_ambient(self.ambient, frame.luminance_per_unit))
        linear = np.asarray(frame.linear, np.float64)
        if self.has_maps:
            dimming = np.asarray(self.ambient.dimming)
            per_lux = linear / self.ambient.illuminance_lux
            self._per_lux.write(_with_alpha(per_lux))
            if self.ambient.dimming_mode == "linear":
                linear = linear * dimming
            else:
                linear = frame.response.decode(dimming * frame.response.encode(linear))
        self._captured.write(_with_alpha(linear))

    def encode_lamps(
        self, encoder: Any, target: Any, lamps: Sequence[Lamp], luminance_per_unit: float
    ) -> None:
        """Records the visible lamps over `target`, far to near, each within its own rectangle."""
        eye = self.view.position
        drawn = [x for x in lamps if isinstance(x, PointLamp) and x.visible_radius_m > 0]
        # A lamp exactly at the eye lies in no direction.
        drawn = [x for x in drawn if np.linalg.norm(x.position_m - eye) > 0]
        drawn.sort(key=lambda x: -float(np.linalg.norm(x.position_m - eye)))
        rectangles = [disc_rectangle(self.view, x.position_m, x.visible_radius_m) for x in drawn]
        if not any(rectangles):
            return
        render = encoder.begin_render_pass(
            label="lamp discs",
            color_attachments=[{"view": target, "load_op": "load", "store_op": "store"}],
        )
        render.set_pipeline(self._discs.pipeline)
        render.set_bind_group(0, self._discs.groups[0].group)
        for slot, (lamp, rectangle) in enumerate(zip(drawn, rectangles, strict=True)):
            if rectangle is None:
                continue
            reach = lamp.position_m - eye
            distance = float(np.linalg.norm(reach))
            record = DISC_RECORD.pack(
                direction=reach / distance,
                distance_m=distance,
                linear=lamp_luminance(lamp, eye) / luminance_per_unit,
                radius_radians=np.arcsin(min(1.0, lamp.visible_radius_m / distance)),
            )
            write_buffer(self.gpu, self._disc_buffers[slot], record)
            render.set_bind_group(1, self._disc_groups[slot].group)
            render.set_scissor_rect(*rectangle)
            render.draw(3)
        render.end()


def _with_alpha(picture: NDArray[Any]) -> NDArray[np.float32]:
    out = np.ones((*picture.shape[:2], 4), np.float32)
    out[..., :3] = picture
    return out


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
