"""Glare of one view on the GPU: sources, veil, needles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.engines.glare import MOST_SOURCES, SceneGlare, taken_share
from andon.engines.glare_lamps import UnpicturedLamps
from andon.glare.needles.stage import NeedleStage
from andon.glare.per_source.model import PerSource
from andon.glare.per_source.stage import PerSourceStage
from andon.glare.sources.live import LiveSources
from andon.glare.sources.stage import SourceStage
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.passes import PLUS, FullscreenPass, color_attachment
from andon.gpu.textures import HALF_MOST, Texture, make_texture, uniform_buffer, write_buffer
from andon.lamps import Lamp
from andon.quantities import CameraFrame, Geometry
from andon.transport.direct.records import MAX_LAMPS

__all__ = ["GlareView"]

SHARP = "andon/glare/sharp.wgsl"
TAKEN_SHARE = HostStruct("TakenShare", (("taken", "vec3f"), ("least", "f32")))


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
        geometry: Geometry,
        real_linear: NDArray[Any] | None = None,
        mirrored: Texture | None = None,
    ) -> None:
        """Makes all of it.

        Parameters
        ----------
        light : rgba16float.
        geometry : what hides lamps.
        real_linear : (H, W, 3) what glares by itself, behind a see-through display.
        mirrored : highlights alone, cd/m².
        """
        view, per_unit = frame.view, frame.luminance_per_unit
        self.gpu, self.glare, self.view = gpu, glare, view
        self.seen = make_texture(gpu, "rgba16float", view.width, view.height, label="seen")
        self.found = LiveSources(0.0)
        self._virtual: _Without | None = None
        self._shining: _Without | None = None
        self._sharp = _Sharp(gpu, light, self.seen)
        if real_linear is not None:
            self._virtual = _Without(gpu, light, _picture(gpu, real_linear))
            light = self._virtual.light
        shining = light
        if mirrored is not None and not glare.highlights:
            self._shining = _Without(gpu, light, mirrored, 1 / per_unit)
            shining = self._shining.light
        self._find = SourceStage(gpu, shining, glare.finder(view), per_unit)
        self._veil: WholePictureStage | None = None
        if glare.plans:
            self._veil = WholePictureStage(gpu, light, self.seen, glare.plans[view.name])
        self._stars = PerSourceStage(gpu, view, MOST_SOURCES, luminance_per_unit=per_unit)
        self._unpictured = UnpicturedLamps(geometry, HALF_MOST * per_unit)
        self._lamps = PerSourceStage(gpu, view, MAX_LAMPS, luminance_per_unit=per_unit)
        self._taken = _Taken(gpu, shining, self.seen, per_unit)
        self._needles: NeedleStage | None = None
        if glare.needles is not None:
            most = MOST_SOURCES * glare.needles.most
            self._needles = NeedleStage(
                gpu, view, most, model=glare.needles, luminance_per_unit=per_unit
            )

    def encode_sources(self, encoder: Any) -> None:
        """Records what `update` reads."""
        for part in (self._virtual, self._shining):
            if part is not None:
                part.encode(encoder)
        self._find.encode(encoder)

    def update(self, lamps: Sequence[Lamp]) -> None:
        """Finds the sources, once what was recorded has run."""
        found, unpictured = self._unpictured.split(
            lamps, self._find.read(), self.view, blooms=self._veil is None
        )
        self.found = found
        self._lamps.update(unpictured, self.glare.kernel)
        seen = self.glare.around(found, self.view)
        if self._needles is not None:
            self._needles.update(seen.needles)
        self._stars.update(
            [source.rounded() for source in found.sources],
            self.glare.kernel,
            halo=self.glare.ring,
            weights=seen.halo_weights.tolist(),
            settings=PerSource(bloom_drawn=self._veil is None),
        )
        share = taken_share(found, seen, self.glare.bloom_share(self.view))
        self._taken.update(found, share, self.glare.contrast)

    def encode(self, encoder: Any) -> None:
        """Records the picture as it is seen."""
        if self._veil is not None and self._virtual is None:
            self._veil.encode(encoder)
        else:
            self._encode_veil(encoder, self.seen)
            self._sharp.encode(encoder)
        if self._virtual is None:
            self._taken.encode(encoder)
        self._encode_stars(encoder, self.seen)

    def encode_glare(self, encoder: Any, target: Texture) -> None:
        """Records what glare adds alone, into `target` (rgba16float)."""
        self._encode_veil(encoder, target)
        self._encode_stars(encoder, target)

    def _encode_veil(self, encoder: Any, target: Texture) -> None:
        if self._veil is not None:
            self._veil.encode_glare(encoder, target)
        else:
            attachments = [color_attachment(target.view)]
            encoder.begin_render_pass(label="no veil", color_attachments=attachments).end()

    def _encode_stars(self, encoder: Any, target: Texture) -> None:
        self._stars.encode(encoder, target)
        self._lamps.encode(encoder, target)
        if self._needles is not None:
            self._needles.encode(encoder, target)


def _picture(gpu: Gpu, linear: NDArray[Any]) -> Texture:
    """A picture (H, W, 3) on the GPU."""
    height, width = linear.shape[:2]
    made = make_texture(gpu, "rgba16float", width, height, label="real")
    values = np.zeros((height, width, 4))
    values[..., :3] = np.clip(linear, 0, HALF_MOST)
    made.write(values)
    return made


class _Without:
    """Light of a picture that is not of another one: what a display adds, what is not mirrored."""

    def __init__(self, gpu: Gpu, light: Texture, other: Texture, unit: float = 1.0) -> None:
        self.light = make_texture(gpu, "rgba16float", light.width, light.height, label="without")
        group = [bind_group(gpu, {0: ("float", light.view), 1: ("float", other.view)}, "light")]
        scale = {"andon/glare/scale.wgsl": f"const OTHER_UNIT: f32 = {unit:.9g}f;"}
        formats = [self.light.format]
        self._pass = FullscreenPass(gpu, SHARP, "light_without", formats, group, variants=scale)

    def encode(self, encoder: Any) -> None:
        self._pass.encode(encoder, [self.light.view])


class _Sharp:
    """Adds the picture as it was to its glare."""

    def __init__(self, gpu: Gpu, light: Texture, target: Texture) -> None:
        self._target = target
        group = [bind_group(gpu, {0: ("float", light.view)}, "light")]
        self._pass = FullscreenPass(gpu, SHARP, "all_light", [target.format], group, blend=PLUS)

    def encode(self, encoder: Any) -> None:
        whole = (0, 0, self._target.width, self._target.height)
        self._pass.encode_within(encoder, [self._target.view], whole)


class _Taken:
    """Takes the light of halo and needles from the pixels of their sources."""

    def __init__(self, gpu: Gpu, light: Texture, target: Texture, per_unit: float) -> None:
        self.gpu, self._target, self._per_unit = gpu, target, per_unit
        self._record = uniform_buffer(gpu, TAKEN_SHARE.dtype.itemsize, "taken")
        self._within = (0, 0, 0, 0)
        self._pass = FullscreenPass(
            gpu,
            "andon/glare/taken.wgsl",
            "taken",
            [target.format],
            [bind_group(gpu, {0: ("float", light.view), 1: ("uniform", self._record)}, "taken")],
            structs={TAKEN_SHARE.name: TAKEN_SHARE},
            blend=PLUS,
        )

    def update(self, found: LiveSources, share: NDArray[np.float64], contrast: float) -> None:
        self._within = found.within if share.any() else (0, 0, 0, 0)
        least = contrast * found.ambient_cd_m2 / self._per_unit
        write_buffer(self.gpu, self._record, TAKEN_SHARE.pack(taken=share, least=least))

    def encode(self, encoder: Any) -> None:
        if self._within[2]:
            self._pass.encode_within(encoder, [self._target.view], self._within)
