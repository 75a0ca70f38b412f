"""The confidence in a frame that was drawn, by either engine."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.capture.noise import noise_codes
from andon.composite.confidence import Cause, Confidence, confidence_of
from andon.composite.curves import beyond_curves
from andon.composite.reference import relit_linear
from andon.display.reference import shown_codes
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.pipeline import Frame

__all__ = ["confidence_of_frame"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]


def confidence_of_frame(frame: Frame, /, sigma: Float | None = None) -> Confidence:
    """How far each pixel of a frame that was drawn may be trusted.

    `sigma` (H, W, 3) is the standard deviation of what was captured, as an encoded value; default:
    as noisy as the photograph looks (`noise_codes`), and at least its steps.

    Light that glow and glare spread over a pixel is taken for certain. Codes are those of the
    camera's own display: of the tone ``fusion`` as without a tone, and of an optical see-through
    display those of its simulated view.
    """
    captured, prepared = frame.captured, frame.prepared
    if prepared is None:
        raise InputError("is missing: only what was drawn has it", field="frame.prepared")
    lux = np.asarray(frame.illuminance.lux, np.float64)
    linear = np.asarray(captured.linear, np.float64)
    measured = prepared.measured.get(captured.view.name)

    def relit(light: Float) -> Float:
        changed: Any = light  # float64, so that steps of 16 bits are not lost
        return relit_linear(replace(captured, linear=changed), prepared.ambient, lux, measured)

    white = captured.luminance_per_unit
    new = relit(linear)
    spread = np.asarray(frame.luminance.cd_m2, np.float64) / white - new
    exposure = prepared.exposure
    tone = replace(exposure, tone="none") if exposure.tone == "fusion" else exposure

    def shown(light: Float) -> Float:
        return shown_codes((light + spread) * white, tone, captured.response, white)

    sigma = noise_codes(captured) if sigma is None else sigma
    causes = _causes(frame, lux, beyond_curves(linear, new, measured))
    return confidence_of(captured, relit, shown, causes, sigma)


def _causes(frame: Frame, lux: Float, beyond: Mask | None) -> dict[Cause, Mask]:
    """Pixels of which the photograph does not tell."""
    surface = frame.surface
    virtual = surface.is_object.copy()
    if frame.bodies is not None:
        virtual |= (np.asarray(frame.bodies.cd_m2) > 0).any(axis=-1)
    causes = {Cause.VIRTUAL: virtual}
    if beyond is not None:
        causes[Cause.BEYOND] = beyond
    if lux.any():
        causes[Cause.HOLE] = ~surface.valid
    if frame.baked is not None:
        causes[Cause.UNCOVERED] = frame.baked.uncovered
    if frame.glass is not None:
        causes[Cause.GLASS] = np.asarray(frame.glass.layers.coverage > 0, bool)
    return causes
