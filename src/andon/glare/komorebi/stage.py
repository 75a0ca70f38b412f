"""A canopy as an eye sees it, on the GPU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glare.komorebi.seen import Seen
from andon.glare.needles import NeedleModel
from andon.glare.needles.stage import NeedleStage
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.device import Gpu
from andon.gpu.textures import make_texture

__all__ = ["SeenStage"]

# Half floats end at 65504. The sun has this value, so that nothing is cut off.
BRIGHTEST = 60_000.0


class SeenStage:
    """Draws frames of `seen` as `Seen.picture` does, to half floats of the sun's luminance."""

    def __init__(self, gpu: Gpu, seen: Seen) -> None:
        canopy = seen.komorebi.canopy
        view = canopy.view
        most = max(
            float(seen.komorebi.luminance_cd_m2.max()), float(canopy.leaves_cd_m2.max()), 1e-30
        )
        self.gpu, self.seen, self.cd_m2_per_unit = gpu, seen, most / BRIGHTEST
        self._light = make_texture(gpu, "rgba32float", view.width, view.height, label="leaves")
        self._target = make_texture(gpu, "rgba16float", view.width, view.height, label="seen")
        self._bloom = WholePictureStage(gpu, self._light, self._target, seen.plan)
        capacity = len(canopy) * NeedleModel().most
        self._needles = NeedleStage(gpu, view, capacity, luminance_per_unit=self.cd_m2_per_unit)

    def picture(self, time_seconds: float, /) -> NDArray[np.float64]:
        """(H, W, 3) cd/m²."""
        light, stars = self.seen.parts(time_seconds)
        filled = np.ones((*light.shape[:2], 4), np.float32)
        filled[..., :3] = light / self.cd_m2_per_unit
        self._light.write(filled)
        self._needles.update([star for star in stars if len(star)])
        encoder = self.gpu.device.create_command_encoder()
        self._bloom.encode(encoder)
        self._needles.encode(encoder, self._target)
        self.gpu.device.queue.submit([encoder.finish()])
        return self._target.read()[..., :3].astype(np.float64) * self.cd_m2_per_unit
