"""Glare of one view on the GPU: sources, veil, needles."""

from __future__ import annotations

from typing import Any

from andon.engines.glare import MOST_SOURCES, SceneGlare
from andon.glare.model import Source
from andon.glare.needles.stage import NeedleStage
from andon.glare.sources.stage import SourceStage
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.device import Gpu
from andon.gpu.textures import Texture, make_texture
from andon.quantities import CameraFrame

__all__ = ["GlareView"]


class GlareView:
    """All of one view's glare that lives on the GPU; made once.

    Attributes
    ----------
    seen : rgba16float, the picture as the eye has it.
    sources : of the frame that was drawn last, strongest first.
    """

    def __init__(self, gpu: Gpu, glare: SceneGlare, frame: CameraFrame, light: Texture) -> None:
        view, per_unit = frame.view, frame.luminance_per_unit
        self.gpu, self.glare, self.view = gpu, glare, view
        self.seen = make_texture(gpu, "rgba16float", view.width, view.height, label="seen")
        self.sources: list[Source] = []
        self._find = SourceStage(gpu, light, view, glare.threshold_cd_m2, per_unit)
        self._veil = WholePictureStage(gpu, light, self.seen, glare.plans[view.name])
        self._needles: NeedleStage | None = None
        if glare.needles is not None:
            most = MOST_SOURCES * glare.needles.most
            self._needles = NeedleStage(
                gpu, view, most, model=glare.needles, luminance_per_unit=per_unit
            )

    def encode_sources(self, encoder: Any) -> None:
        """Records what `update` reads."""
        self._find.encode(encoder)

    def update(self) -> None:
        """Finds the sources, once what was recorded has run."""
        self.sources = self._find.read(MOST_SOURCES)
        if self._needles is not None:
            self._needles.update(self.glare.needles_of(self.sources, self.view))

    def encode(self, encoder: Any) -> None:
        """Records the picture as it is seen."""
        self._veil.encode(encoder)
        self._encode_sources(encoder, self.seen)

    def encode_glare(self, encoder: Any, target: Texture) -> None:
        """Records what glare adds alone, into `target` (rgba16float)."""
        self._veil.encode_glare(encoder, target)
        self._encode_sources(encoder, target)

    def _encode_sources(self, encoder: Any, target: Texture) -> None:
        if self._needles is not None:
            self._needles.encode(encoder, target)
