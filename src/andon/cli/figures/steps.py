"""A picture step by step as an eye sees it: original, bloom, halo, needles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.cli.figures.model import Asked, Panel
from andon.display.eye_response import printed
from andon.glare.around import around
from andon.glare.gate import HIGHLIGHT_CONTRAST
from andon.glare.kernel import Kernel
from andon.glare.needles import NeedleModel
from andon.glare.needles.reference import draw
from andon.glare.per_source.reference import halos_of_sources
from andon.glare.scatter import scatter_all
from andon.glare.sources.find import FoundSources, find_sources
from andon.glare.stars import MOST_STARS
from andon.observer.spread.family import spread_function
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["Steps", "panels_of", "seen_in_steps"]

Float = NDArray[np.float64]

# The printed curve is at its middle at so many times the ambient luminance.
HALF_AMBIENTS = 4.0
CAPTIONS = ("original", "bloom", "bloom and halo", "bloom, halo and needles")
NAMES = ("original", "bloom", "halo", "needles")


@dataclass(frozen=True, eq=False)
class Steps:
    """One picture in the order in which the eye's light is added, each (H, W, 3) cd/m².

    Attributes
    ----------
    pictures : original, with bloom, with halo, with needles.
    ambient_cd_m2 : mean of what is no source.
    """

    pictures: tuple[Float, Float, Float, Float]
    ambient_cd_m2: float

    def printed(self, index: int, /, *, finer: int, seed: int) -> NDArray[np.uint8]:
        """One of `pictures` as sRGB, `finer` of its pixels for one."""
        half = HALF_AMBIENTS * self.ambient_cd_m2
        return printed(self.pictures[index], half, finer=finer, seed=seed)


def seen_in_steps(light: Float, view: View, asked: Asked, step: Callable[[], None], /) -> Steps:
    """What the eye of `asked` adds to `light` (H, W, 3) cd/m²; it calls `step` three times.

    Each step takes its light from the sources.
    """
    found = find_sources(light, view)
    eye = asked.eye(found.ambient_cd_m2)
    kernel = Kernel(spread_function(asked.model, eye))
    bloomed = scatter_all(light, view, kernel, asked.engine).picture
    step()
    sources = found.simplified()[:MOST_STARS]
    seen = around(
        sources,
        photometric(found.luminance_cd_m2[: len(sources)]),
        found.ambient_cd_m2,
        eye,
        kernel,
        seed=asked.seed,
        needles=NeedleModel(),
        contrast=HIGHLIGHT_CONTRAST,
    )
    needles = np.array([star.share for star in seen.needles]).reshape(-1, 1) * np.ones(3)
    haloed = bloomed - _of_pixels(found, seen.taken - needles) * light
    if seen.halo_weights.any():
        weights = seen.halo_weights.tolist()
        haloed += halos_of_sources(sources, view, kernel, kernel.spread, weights=weights)
    step()
    needled = haloed + draw(seen.needles, view) - _of_pixels(found, needles) * light
    step()
    return Steps((light, bloomed, haloed, needled), found.ambient_cd_m2)


def _of_pixels(found: FoundSources, shares: Float) -> Float:
    """(H, W, 3) from the shares (n, 3) of the strongest sources; 0 elsewhere."""
    whole = np.zeros((len(found.sources) + 1, 3))
    whole[1 : len(shares) + 1] = shares
    return whole[found.labels]


def panels_of(steps: Steps, prefix: str, /, *, finer: int, seed: int) -> tuple[Panel, ...]:
    """A panel of each step; its file's name begins with `prefix`."""
    return tuple(
        Panel(f"{prefix}-{name}", caption, steps.printed(index, finer=finer, seed=seed))
        for index, (name, caption) in enumerate(zip(NAMES, CAPTIONS, strict=True))
    )
