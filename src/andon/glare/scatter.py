"""The veil of a picture by either renderer and either engine.

============= ============================== ============================ ========================
renderer      scatters                       reference                    gpu
============= ============================== ============================ ========================
whole-picture all light                      `whole_picture.reference`    `whole_picture.stage`
per-source    that of the sources found      `per_source.reference`       (as the reference)
============= ============================== ============================ ========================

The GPU's veil comes in half floats, brought to their range first: 0.05 % of the veil. What stays,
and the sum, are in float64 always.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.per_source.model import PerSource
from andon.glare.per_source.reference import veil_of_sources
from andon.glare.sources.find import FoundSources
from andon.glare.whole_picture.plan import WholePlan, plan_whole
from andon.glare.whole_picture.reference import resolved, veil
from andon.spaces import View

__all__ = ["EngineName", "Scatter", "scatter_all", "scatter_sources"]

Float = NDArray[np.float64]
EngineName = Literal["auto", "gpu", "reference"]

# Half floats end at 65504; the brightest pixel is brought to this.
BRIGHTEST = 60000.0
# Of a source's veil what is below this share of the ambient luminance is not drawn.
UNSEEN = 1e-3


@dataclass(frozen=True, eq=False)
class Scatter:
    """A picture with its veil.

    Attributes
    ----------
    picture, veil : (H, W, 3); picture = (1 − k)·light + veil. Veil holds what is scattered by less
        than a pixel, too, so that k does not depend on the size of pixels.
    share : k, the mean over the light of the picture.
    engine : ``gpu`` or ``reference``.
    """

    picture: Float
    veil: Float
    share: float
    engine: str


def scatter_all(light: Float, view: View, kernel: Kernel, engine: EngineName, /) -> Scatter:
    """Scatters all light (H, W, 3), finite and ≥ 0, of a picture of `view`."""
    plan = plan_whole(view, kernel)
    leaves = resolved(plan)
    share: Float = np.maximum(leaves, kernel.share)
    by_gpu = engine == "gpu" or (engine == "auto" and _has_gpu())
    glare = _glare_on_gpu(light, plan) if by_gpu else veil(light, plan)
    glare = glare + (share - leaves)[..., None] * light
    return _summed(light, glare, share, view, kernel, "gpu" if by_gpu else "reference")


def scatter_sources(light: Float, view: View, kernel: Kernel, found: FoundSources, /) -> Scatter:
    """Scatters the light of the sources `found` in (H, W, 3); all other light stays."""
    settings = PerSource(least_cd_m2=UNSEEN * found.ambient_cd_m2)
    spread = veil_of_sources(found.simplified(), view, kernel, settings=settings)
    share = np.where(found.labels > 0, kernel.share, 0.0)
    return _summed(light, spread, share, view, kernel, "reference")


def _summed(
    light: Float, glare: Float, share: Float, view: View, kernel: Kernel, engine: str
) -> Scatter:
    """`glare` (H, W, 3) is added, `share` (H, W) of each pixel's light taken."""
    weight = light.sum(axis=-1) * view.solid_angles()
    total = float(weight.sum())
    mean = float((share * weight).sum() / total) if total > 0 else kernel.share
    return Scatter((1 - share[..., None]) * light + glare, glare, mean, engine)


def _has_gpu() -> bool:
    from andon.gpu.device import adapter_summary

    return adapter_summary() is not None


def _glare_on_gpu(light: Float, plan: WholePlan) -> Float:
    """(H, W, 3) what is scattered to other pixels."""
    from andon.glare.whole_picture.stage import WholePictureStage
    from andon.gpu.device import open_gpu
    from andon.gpu.textures import make_texture

    gpu = open_gpu()
    height, width = plan.view.shape
    scale = BRIGHTEST / max(float(light.max()), 1e-30)
    source = make_texture(gpu, "rgba32float", width, height, label="light")
    target = make_texture(gpu, "rgba16float", width, height, label="veil")
    source.write(np.dstack([light * scale, np.ones((height, width))]))
    stage = WholePictureStage(gpu, source, target, plan)
    encoder = gpu.device.create_command_encoder()
    stage.encode_glare(encoder, target)
    gpu.device.queue.submit([encoder.finish()])
    return target.read()[..., :3].astype(np.float64) / scale
