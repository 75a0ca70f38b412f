"""Light of probes on the GPU: a picture of it, drawn where virtual objects are.

A pass of its own, unlike direct light: a software rasteriser pays for both sides of a branch in
every pixel, and a pass can be kept to the rectangles of the objects. Its picture is kept, too:
camera and probes stand still, so that only what moves changes it. A frame without such objects
has no pass, and its shaders nothing of this.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass, color_attachment
from andon.gpu.textures import Texture, make_texture
from andon.spaces import View
from andon.transport.probes.light import ProbeLight, probe_coefficients
from andon.transport.probes.records import (
    DATA_WIDTH,
    pack_distances,
    pack_light,
    pack_space,
    settings_text,
)

__all__ = ["PROBE_PICTURE", "SETTINGS", "VARIANTS", "ProbeBuffers", "ProbePicture"]

Lookup = Literal["pixel", "object"]
Rectangle = tuple[int, int, int, int]

_FOLDER = "andon/transport/probes"
PROBE_PICTURE = f"{_FOLDER}/picture.wgsl"
SETTINGS = f"{_FOLDER}/settings.wgsl"
# What can stand in for what picture.wgsl imports.
VARIANTS = {
    "object": {f"{_FOLDER}/per_pixel.wgsl": f"{_FOLDER}/per_object.wgsl"},
    "walls": {f"{_FOLDER}/walls_none.wgsl": f"{_FOLDER}/walls.wgsl"},
}


class ProbeBuffers:
    """A volume's light on the GPU, shared by all views.

    Attributes
    ----------
    resources : bindings 2 to 4 of group 0 of picture.wgsl.
    variants : of picture.wgsl.
    """

    def __init__(
        self,
        gpu: Gpu,
        light: ProbeLight,
        lookup: Lookup = "pixel",
        slots: NDArray[np.int32] | None = None,
    ) -> None:
        self.gpu, self.light, self.lookup = gpu, light, lookup
        self.slots = np.zeros(0, np.int32) if slots is None else slots
        packed = pack_space(light.space, light.walls)
        rows = len(self.slots) if lookup == "object" else len(light.coefficients)
        texels = pack_light(np.zeros((rows, *light.coefficients.shape[1:])))
        per_pixel = lookup == "pixel"
        self._data = self._picture(
            packed.texels if per_pixel else np.zeros((1, 1, 4)), "rgba32float"
        )
        self._light = make_texture(gpu, "rgba32float", DATA_WIDTH, len(texels), label="probe light")
        has_walls = per_pixel and light.walls is not None
        distances = np.zeros((1, 1, 2))
        if has_walls and light.walls is not None:
            distances = pack_distances(light.walls.distances)
        self._distances = self._picture(distances, "rg32float")
        terms = 14 if light.coefficients.shape[1] >= 25 else 7
        self.variants = {SETTINGS: settings_text(light.space, packed, terms, light.walls)}
        self.variants |= VARIANTS["walls"] if has_walls else {}
        self.variants |= {} if per_pixel else VARIANTS["object"]
        self._middles: NDArray[np.float64] | None = None
        if per_pixel:
            self._light.write(pack_light(light.coefficients))
        self.resources: dict[int, tuple[str, Any]] = {
            2: ("float", self._data.view),
            3: ("float", self._light.view),
            4: ("float", self._distances.view),
        }

    def _picture(self, texels: NDArray[Any], format: str) -> Texture:
        height, width = texels.shape[:2]
        texture = make_texture(self.gpu, format, width, height, label="probes")
        texture.write(texels)
        return texture

    def move(self, middles: NDArray[np.float64]) -> None:
        """Looks up light at the objects' middles (objects, 3) in metres, if it is done by object.

        The rows of the picture of light are the objects' materials; `slots` says whose each is.
        """
        if self.lookup == "pixel" or not len(self.slots):
            return
        if self._middles is not None and np.array_equal(self._middles, middles):
            return
        self._middles = np.array(middles)
        self._light.write(pack_light(probe_coefficients(self.light, middles)[self.slots]))


class ProbePicture:
    """Reads a G-buffer, writes the light of probes on its objects.

    Attributes
    ----------
    lux : rgba32float, illuminance in lux where it was drawn, and kept since; elsewhere 0.
    """

    def __init__(
        self, buffers: ProbeBuffers, view: View, gbuffer_view: Any, view_buffer: Any
    ) -> None:
        gpu = buffers.gpu
        self.view = view
        self.lux = make_texture(gpu, "rgba32float", view.width, view.height, label="probe lux")
        scene = {0: ("uint", gbuffer_view), 1: ("uniform", view_buffer)}
        self._pass = FullscreenPass(
            gpu,
            PROBE_PICTURE,
            "probe_picture",
            [self.lux.format],
            [bind_group(gpu, scene | buffers.resources, "probes")],
            structs=gbuffer.STRUCTS,
            variants=gbuffer.projection_variant(view) | buffers.variants,
        )

    def encode(self, encoder: Any, rectangles: Sequence[Rectangle]) -> None:
        """Records the drawing within (x, y, width, height) in pixels, which may overlap.

        The rest stays as it is: at first 0.
        """
        if not rectangles:
            return
        render = encoder.begin_render_pass(
            label=self._pass.label, color_attachments=[color_attachment(self.lux.view, load=True)]
        )
        render.set_pipeline(self._pass.pipeline)
        render.set_bind_group(0, self._pass.groups[0].group)
        for rectangle in rectangles:
            render.set_scissor_rect(*rectangle)
            render.draw(3)
        render.end()
