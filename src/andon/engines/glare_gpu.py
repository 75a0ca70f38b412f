"""Glare of one view on the GPU: sources, veil, needles."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.engines.glare import MOST_SOURCES, SceneGlare
from andon.glare.needles.stage import NeedleStage
from andon.glare.sources.live import LiveSources
from andon.glare.sources.stage import SourceStage
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, make_texture
from andon.quantities import CameraFrame

__all__ = ["GlareView"]

HALF_MOST = float(np.finfo(np.float16).max)
PLUS = {
    part: {"operation": "add", "src_factor": "one", "dst_factor": "one"}
    for part in ("color", "alpha")
}


class GlareView:
    """All of one view's glare that lives on the GPU; made once.

    Attributes
    ----------
    seen : rgba16float, the picture as the eye has it.
    found : sources of the frame that was drawn last.
    """

    def __init__(
        self,
        gpu: Gpu,
        glare: SceneGlare,
        frame: CameraFrame,
        light: Texture,
        real_linear: NDArray[Any] | None = None,
    ) -> None:
        """`light` rgba16float; `real_linear` (H, W, 3): what glares by itself, see-through."""
        view, per_unit = frame.view, frame.luminance_per_unit
        self.gpu, self.glare, self.view = gpu, glare, view
        self.seen = make_texture(gpu, "rgba16float", view.width, view.height, label="seen")
        self.found = LiveSources(0.0)
        self._see_through: _SeeThrough | None = None
        if real_linear is not None:
            self._see_through = _SeeThrough(gpu, light, real_linear, self.seen)
            light = self._see_through.virtual
        self._find = SourceStage(gpu, light, glare.finder(view), per_unit)
        self._veil = WholePictureStage(gpu, light, self.seen, glare.plans[view.name])
        self._needles: NeedleStage | None = None
        if glare.needles is not None:
            most = MOST_SOURCES * glare.needles.most
            self._needles = NeedleStage(
                gpu, view, most, model=glare.needles, luminance_per_unit=per_unit
            )

    def encode_sources(self, encoder: Any) -> None:
        """Records what `update` reads."""
        if self._see_through is not None:
            self._see_through.encode_virtual(encoder)
        self._find.encode(encoder)

    def update(self) -> None:
        """Finds the sources, once what was recorded has run."""
        self.found = self._find.read()
        if self._needles is not None:
            self._needles.update(self.glare.needles_of(self.found, self.view))

    def encode(self, encoder: Any) -> None:
        """Records the picture as it is seen."""
        if self._see_through is None:
            self._veil.encode(encoder)
        else:
            self._veil.encode_glare(encoder, self.seen)
            self._see_through.encode_all(encoder)
        self._encode_sources(encoder, self.seen)

    def encode_glare(self, encoder: Any, target: Texture) -> None:
        """Records what glare adds alone, into `target` (rgba16float)."""
        self._veil.encode_glare(encoder, target)
        self._encode_sources(encoder, target)

    def _encode_sources(self, encoder: Any, target: Texture) -> None:
        if self._needles is not None:
            self._needles.encode(encoder, target)


class _SeeThrough:
    """What a see-through display adds to the real light, and both on top of its glare."""

    def __init__(
        self, gpu: Gpu, light: Texture, real_linear: NDArray[Any], target: Texture
    ) -> None:
        size = (light.width, light.height)
        real = make_texture(gpu, "rgba16float", *size, label="real")
        codes = np.zeros((*real_linear.shape[:2], 4))
        codes[..., :3] = np.clip(real_linear, 0, HALF_MOST)
        real.write(codes)
        self.virtual = make_texture(gpu, "rgba16float", *size, label="virtual")
        self._target = target
        group = [bind_group(gpu, {0: ("float", light.view), 1: ("float", real.view)}, "light")]
        module, formats = "andon/glare/see_through.wgsl", [target.format]
        self._split = FullscreenPass(gpu, module, "virtual_light", formats, group)
        self._join = FullscreenPass(gpu, module, "all_light", formats, group, blend=PLUS)

    def encode_virtual(self, encoder: Any) -> None:
        self._split.encode(encoder, [self.virtual.view])

    def encode_all(self, encoder: Any) -> None:
        whole = (0, 0, self._target.width, self._target.height)
        self._join.encode_within(encoder, [self._target.view], whole)
