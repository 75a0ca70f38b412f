"""What is asked of a fit, and what it gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.measures import Measures
from andon.calibrate.lamps.motion import Aligning, Motion
from andon.errors import InputError
from andon.pipeline import EngineName, Frame
from andon.quantities import Photometry
from andon.responses import Response
from andon.scene import Scene

__all__ = ["Dimming", "FitSettings", "FittedFill", "FittedLight", "LampFit"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]
Dimming = Literal["auto", "off", "one", "channels"]


@dataclass(frozen=True)
class FitSettings:
    """What is free, and what is drawn.

    Attributes
    ----------
    lamps : names of the lamps whose light is fitted; None: all of the scene's own.
    dimming : what of E0 is left: ``off``, as the scene states; ``one`` factor, which also takes up
        another exposure of the reference; three ``channels``, which take up a white balance;
        ``auto``, one where the reference is darker than the photograph somewhere, since light
        that is added darkens nothing.
    colour : each lamp's three channels are free; else its flux alone, in its own colour.
    bounce : a sky and a ground of equal luminances are fitted too, for what surfaces reflect.
    response : the camera's response is chosen from a family, by the error in encoded values.
    align : ``auto`` finds how the camera moved and brings the reference back; or ``none``.
    time_seconds, view, engine : as in `andon.render`.
    """

    lamps: tuple[str, ...] | None = None
    dimming: Dimming = "off"
    colour: bool = True
    bounce: bool = False
    response: bool = False
    align: Aligning = "auto"
    time_seconds: float = 0.0
    view: str | None = None
    engine: EngineName = "auto"

    def __post_init__(self) -> None:
        for name, words in (("dimming", get_args(Dimming)), ("align", get_args(Aligning))):
            if getattr(self, name) not in words:
                raise InputError(
                    f"must be one of {', '.join(words)}, got {getattr(self, name)!r}",
                    field=f"fit_{name}",
                )


@dataclass(frozen=True, eq=False)
class FittedLight:
    """How much of a thing's light explains the reference.

    Attributes
    ----------
    name : of the lamp; or ``dimming``.
    factor : (3,) ≥ 0, times what the scene states of it, per channel.
    error : (3,) standard error of `factor`, from squares of the picture that err together; NaN
        where no pixel tells anything.
    share : of the light that the fit adds to the pixels that it saw, 0…1; of dimming NaN.
    told_apart : False where other things of the fit make the same picture; `factor` is then one
        of many that fit as well.
    """

    name: str
    factor: Float
    error: Float
    share: float
    told_apart: bool


@dataclass(frozen=True, eq=False)
class FittedFill:
    """The light that is fitted for what surfaces reflect: a lamp of kind ``hemisphere``.

    Attributes
    ----------
    sky_lux, ground_lux : (3,) on a surface that faces up, and on one that faces down.
    sky_error_lux, ground_error_lux : (3,) standard errors.
    share : of the light that the fit adds to the pixels that it saw, 0…1.
    told_apart : as in `FittedLight`.
    """

    sky_lux: Float
    ground_lux: Float
    sky_error_lux: Float
    ground_error_lux: Float
    share: float
    told_apart: bool


@dataclass(frozen=True, eq=False)
class LampFit:
    """The light of lamps, fitted to a reference photograph.

    Attributes
    ----------
    lamps : fitted, in the order of the scene.
    dimming : None where it was not asked for.
    fill : None where no bounce was asked for.
    response : of the camera, stated or chosen.
    responses : RMSE in encoded values of each response that was tried, by name; else empty.
    motion : of the camera, between photograph and reference.
    measures : error of the prediction and of the trivial ones, by region: ``whole``; with a mask
        ``inside`` and ``outside``; each also without holes and what the reference does not show.
    photograph, reference, predicted : (H, W, 3) linear camera values; the reference undistorted
        and aligned.
    mask : (H, W), where the fit looked; None: everywhere.
    compared : (H, W), pixels that the reference shows.
    holes : (H, W), pixels without geometry, which stay unchanged.
    rejected_share : of the cells that the fit saw, those that contradict it and count for nothing.
    frame : the picture with the fitted lamps.
    scene : with the fitted values in its tables; None for arrays.
    photometry : of the numbers.
    notes : what is worth knowing, in words.
    luminance_per_unit : cd/m² of the linear value 1, as lit real shades tell it where the scene
        does not state it; else None.
    """

    lamps: tuple[FittedLight, ...]
    dimming: FittedLight | None
    fill: FittedFill | None
    response: Response
    responses: Mapping[str, float]
    motion: Motion
    measures: Mapping[str, Mapping[str, Measures]]
    photograph: Float
    reference: Float
    predicted: Float
    mask: Mask | None
    compared: Mask
    holes: Mask
    rejected_share: float
    frame: Frame
    scene: Scene | None
    photometry: Photometry
    notes: tuple[str, ...]
    luminance_per_unit: float | None = None
