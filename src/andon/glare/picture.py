"""What the eye makes of a picture: the picture with its glare, the glare alone, and numbers.

::

    luminance ─▶ whole picture: out = (1 − k)·L + veil ─┐
        │                                               ├─▶ picture, glare
        └─▶ sources ─▶ halo, needles (40 × ambient) ────┘
                └─▶ numbers: veil at the gaze, TI, UGR, DGP
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.cleaning import Cleaned, cleaned
from andon.glare.kernel import Kernel
from andon.glare.needles.model import Which
from andon.glare.numbers.measure import GlareNumbers, measured
from andon.glare.scatter import EngineName, scatter_all, scatter_sources
from andon.glare.sources.find import FoundSources, find_sources
from andon.glare.stars import stars_of
from andon.observer.spread.model import Eye, SpreadFunction
from andon.quantities import Photometry
from andon.spaces import View

__all__ = ["GlareResult", "Renderer", "glare_of_picture"]

Float = NDArray[np.float64]
Renderer = Literal["auto", "per-source", "whole-picture"]
AHEAD = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class GlareResult:
    """A picture as the eye sees it.

    Attributes
    ----------
    picture : (H, W, 3) with its glare, cd/m², or in the unit of what was given.
    glare : (H, W, 3) what glare adds to (1 − k)·L: veil, halo and needles.
    veil : (H, W, 3) of `glare` what is scattered evenly: without halo and needles.
    found : bright sources, from the strongest to the weakest.
    numbers : veil at the gaze, TI, UGR, DGP.
    share : k, of the picture's light that became veil.
    stars : how many sources have a halo, and how many have needles.
    view, eye, model, renderer, engine, photometry : as rendered.
    pixels : how many pixels were no light, and where.
    """

    picture: Float
    glare: Float
    veil: Float
    found: FoundSources
    numbers: GlareNumbers
    share: float
    stars: tuple[int, int]
    view: View
    eye: Eye
    model: SpreadFunction
    renderer: str
    engine: str
    photometry: Photometry
    pixels: Cleaned

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the pixels and the sources, a line each."""
        from andon.glare.report import warnings_of

        return warnings_of(self)

    def report(self, *, map_file: str | None = None, warnings: tuple[str, ...] = ()) -> Any:
        """The numbers as JSON holds them; see `andon.glare.report`."""
        from andon.glare.report import report

        return report(self, map_file=map_file, warnings=warnings)


def glare_of_picture(
    luminance_cd_m2: NDArray[np.floating[Any]],
    view: View,
    /,
    eye: Eye | None = None,
    model: str | SpreadFunction = "cie135",
    *,
    renderer: Renderer = "auto",
    engine: EngineName = "auto",
    with_stars: bool = True,
    seed: int = 0,
    which: Which = "mono",
    gaze: NDArray[np.float64] | None = None,
    photometry: Photometry = "absolute",
    clipped: NDArray[np.bool_] | None = None,
    shows: NDArray[np.bool_] | None = None,
) -> GlareResult:
    """The picture as `eye` sees it, and numbers of its glare.

    Parameters
    ----------
    luminance_cd_m2 : (H, W, 3) linear Rec.709; NaN, ±Inf and negative values count as 0.
    view : where its pixels look, without distortion.
    eye : whose; None: 25 years, brown eyes.
    model : a name of `andon.observer.spread`, or a spread function.
    renderer : ``whole-picture`` scatters all light, ``per-source`` that of the sources found;
        ``auto`` is the whole picture.
    engine : ``auto`` takes the GPU where there is an adapter.
    with_stars : halo and needles around sources 40 times brighter than the ambient luminance.
    seed, which : observer and eye, whose needles they are.
    gaze : (3,) camera frame, where the numbers are taken; None: straight ahead.
    photometry : ``relative`` where the picture is not calibrated.
    clipped : (H, W) bool, pixels at the white of the camera.
    shows : (H, W) bool, where the picture shows something: False outside the circle of a fish-eye,
        which counts as dark and stays so. None: everywhere.

    Returns
    -------
    GlareResult
        float64; the unit is that of the input.

    Raises
    ------
    InputError
        for a picture of another size than the view, without pixels or with more than 2²⁵, and
        for a model, renderer or engine that is not known.
    """
    for field, value, known in (
        ("renderer", renderer, get_args(Renderer)),
        ("engine", engine, get_args(EngineName)),
    ):
        if value not in known:
            raise InputError(f"must be one of {', '.join(known)}, got {value!r}", field=field)
    pixels = cleaned(luminance_cd_m2, view, shows)
    eye = Eye() if eye is None else eye
    spread = _spread(model, eye)
    kernel = Kernel(spread)
    ahead = AHEAD if gaze is None else _unit(gaze)
    found = find_sources(pixels.light, view, clipped=clipped)
    light = pixels.light
    if renderer == "per-source":
        spread_out = scatter_sources(light, view, kernel, found, engine)
    else:
        spread_out = scatter_all(light, view, kernel, engine)
    stars = stars_of(found, eye, view, kernel, seed=seed, which=which) if with_stars else None
    picture, glare = spread_out.picture, spread_out.veil
    if stars is not None:
        picture = picture + stars.added - stars.taken * light
        glare = glare + stars.added
    if shows is not None:
        picture, glare = (np.where(shows[..., None], part, 0) for part in (picture, glare))
    return GlareResult(
        picture,
        glare,
        spread_out.veil,
        found,
        measured(light, view, kernel, ahead, photometry),
        spread_out.share,
        (0, 0) if stars is None else (stars.halos, stars.needles),
        view,
        eye,
        spread,
        "per-source" if renderer == "per-source" else "whole-picture",
        spread_out.engine,
        photometry,
        pixels,
    )


def _spread(model: str | SpreadFunction, eye: Eye) -> SpreadFunction:
    if isinstance(model, SpreadFunction):
        return model
    from andon.observer.spread.family import spread_function

    return spread_function(model, eye)


def _unit(gaze: NDArray[np.float64]) -> Float:
    direction = np.asarray(gaze, np.float64)
    length = float(np.linalg.norm(direction))
    if direction.shape != (3,) or not np.isfinite(length) or length == 0:
        raise InputError("must be three numbers, not all 0", field="gaze")
    return direction / length
