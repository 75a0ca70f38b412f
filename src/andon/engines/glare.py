"""Glare of a scene for both engines: whose eye, which model, and which sources have needles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.engines.adaptation import adaptation_cd_m2
from andon.errors import InputError
from andon.glare.around import Around, around, needles_within
from andon.glare.kernel import Kernel
from andon.glare.needles.model import NeedleModel, Which
from andon.glare.per_source.reference import veil_share
from andon.glare.sources.live import LiveSources, SourceFinder
from andon.glare.whole_picture.plan import WholePlan, plan_whole
from andon.observer.presets import eye_of
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye, SpreadFunction
from andon.quantities import CameraFrame, photometric
from andon.scene import Scene
from andon.spaces import View

Float = NDArray[np.float64]

__all__ = ["SceneGlare", "glare_of", "taken_share", "with_clipped_light"]

# Adaptation of relative scenes, which do not say how bright anything is: a room in the evening.
EVENING_CD_M2 = 10.0
# Sources with a halo and needles, the strongest first: more are one bright surface.
MOST_SOURCES = 16


@dataclass(frozen=True, eq=False)
class SceneGlare:
    """Glare of a scene, ready for both engines.

    Attributes
    ----------
    eye, kernel : whose eye, and how it scatters.
    contrast : luminance of a source over the ambient from which it has halo and needles.
    highlights : what is mirrored has halo and needles, too.
    needles : constants; None: no needles.
    seed : pattern of the needles.
    plans : of the whole picture, by view; none where only sources are scattered.
    """

    eye: Eye
    kernel: Kernel
    contrast: float
    highlights: bool
    needles: NeedleModel | None
    seed: int
    plans: Mapping[str, WholePlan]

    def bloom_share(self, view: View) -> float:
        """Share of a source's light that becomes bloom where only sources are scattered."""
        return 0.0 if self.plans else veil_share(view, self.kernel)

    @property
    def ring(self) -> SpreadFunction | None:
        """The spread function whose ring is drawn; None where the eye sees none."""
        spread = self.kernel.spread
        return None if spread.halo_per_sr is None else spread

    def finder(self, view: View, /) -> SourceFinder:
        """What finds the sources of a view's frames."""
        return SourceFinder(view, contrast=self.contrast, most=MOST_SOURCES)

    def around(self, found: LiveSources, view: View, /) -> Around:
        """Halo and needles of each source, as the eye of a view sees them."""
        which: Which = (
            "left" if view.name == "left" else "right" if view.name == "right" else "mono"
        )
        luminance = np.array([photometric(each.luminance_cd_m2) for each in found.sources])
        return around(
            found.sources,
            luminance,
            found.ambient_cd_m2,
            self.eye,
            self.kernel,
            seed=self.seed,
            which=which,
            needles=self.needles,
            contrast=self.contrast,
        )


def taken_share(found: LiveSources, seen: Around, bloom_share: float, /) -> Float:
    """(3,) share of all bright light that halo, needles and bloom of the sources are made of.

    All that is bright gives alike, be it one of the sources or beyond the most that are kept.
    """
    if not found.sources:
        return np.zeros(3)
    lux = np.array([source.illuminance_lux for source in found.sources])
    around = (seen.taken * lux).sum(axis=0) / np.maximum(lux.sum(axis=0), 1e-30)
    return found.kept_share * (around + bloom_share)


def glare_of(
    scene: Scene, frames: Mapping[str, CameraFrame], dimming: NDArray[np.float64], /
) -> SceneGlare | None:
    """The glare of a scene; None without [glare] or with its model ``glow``.

    Raises `InputError` where the model scatters more light than there is.
    """
    table = scene.glare
    if table is None or table.model == "glow":
        return None
    mean = adaptation_cd_m2(scene, frames, dimming)
    adapted = EVENING_CD_M2 if scene.photometry == "relative" else mean
    eye = eye_of(scene.observer, scene.atmosphere, adapted, table.adaptation)
    try:
        spread = spread_function(table.model, eye, halo=table.halo)
    except InputError as error:
        raise InputError(
            error.rule, file=scene.file, field="glare.model", remedy=error.remedy
        ) from error
    kernel = Kernel(spread, table.minimum_angle_degrees)
    whole = table.renderer != "per-source"
    return SceneGlare(
        eye,
        kernel,
        table.highlight_contrast,
        table.highlights,
        needles_within(kernel, _needle_model(scene, table.highlight_contrast, mean))
        if table.needles
        else None,
        scene.scene.seed if table.seed is None else table.seed,
        {name: plan_whole(frame.view, kernel) for name, frame in frames.items()} if whole else {},
    )


def _needle_model(scene: Scene, contrast: float, adapted_cd_m2: float) -> NeedleModel:
    """The needles' constants, in the scene's unit of light.

    Needles go by absolute light. A relative scene is taken to be as bright as an evening.
    """
    model = replace(NeedleModel(), contrast=contrast)
    if scene.photometry != "relative" or not adapted_cd_m2 > 0:
        return model
    unit = adapted_cd_m2 / EVENING_CD_M2
    return replace(
        model,
        illuminance_lux=unit * model.illuminance_lux,
        background_cd_m2=unit * model.background_cd_m2,
    )


def with_clipped_light(scene: Scene, frame: CameraFrame, /) -> CameraFrame:
    """The frame with capture.clipped_luminance_cd_m2 where the sensor clipped, its hue kept.

    What shines in a photograph is brighter than its white; how much, nobody can tell but the scene.
    Only a scene with glare asks: a display shows white for both.
    """
    stated = scene.capture.clipped_luminance_cd_m2 if scene.capture else None
    if stated is None or scene.glare is None or scene.glare.model == "glow":
        return frame
    if frame.clipped is None or not frame.clipped.any():
        return frame
    linear = frame.linear.copy()
    clipped = linear[frame.clipped]
    seen = photometric(clipped) * frame.luminance_per_unit
    factor = np.maximum(stated / np.maximum(seen, np.finfo(np.float32).tiny), 1.0)
    linear[frame.clipped] = (clipped * factor[:, None]).astype(np.float32)
    return replace(frame, linear=linear)
