"""What is worth knowing of a fit, in words."""

from __future__ import annotations

import numpy as np

from andon.calibrate.lamps.model import LampFit

__all__ = ["notes_of"]

# Above it so much contradicts the fit that one should look why.
NOTABLE_REJECTED = 0.1
# From such a share of the picture holes catch the eye, and from such an error of encoded values
# (34 dB) more than the camera's noise is wrong.
NOTABLE_HOLES, NOTABLE_ERROR = 0.005, 0.02


def notes_of(fit: LampFit, /) -> tuple[str, ...]:
    """One line each."""
    on_scene = (*_on_holes(fit), *_on_ambient(fit))
    on_fit = (*_on_motion(fit), *_on_terms(fit), *_on_white(fit), *_on_error(fit))
    return (*_on_same(fit), *on_fit, *on_scene)


def _on_same(fit: LampFit) -> list[str]:
    if not np.array_equal(fit.photograph, fit.reference):
        return []
    return ["the reference is the photograph itself: there is nothing to fit"]


def _on_motion(fit: LampFit) -> list[str]:
    motion = fit.motion
    if np.isnan(motion.correlation):
        return []
    if not motion.is_told:
        return [
            "photograph and reference have too little in common to tell whether the camera moved "
            f"(correlation of fine structure {motion.correlation:.2f})"
        ]
    if motion.is_still:
        return []
    return [
        f"the reference was moved by up to {motion.corner_px:.1f} px onto the photograph "
        f"(correlation of fine structure {motion.correlation:.2f}); --fit-align none leaves it"
    ]


def _on_terms(fit: LampFit) -> list[str]:
    alike = [light.name for light in fit.lamps if not light.told_apart]
    alike += ["dimming"] if fit.dimming is not None and not fit.dimming.told_apart else []
    alike += ["bounce"] if fit.fill is not None and not fit.fill.told_apart else []
    notes: list[str] = []
    if alike:
        notes.append(
            f"no pixel tells {' from '.join(alike)}: only their sum is known, and how it is "
            "shared out is arbitrary (between dimming and bounce: all to dimming)"
        )
    notes += [
        f"the lamp {light.name!r} got no light: the reference is no brighter where it shines"
        for light in fit.lamps
        if not light.factor.any()
    ]
    return notes


def _on_white(fit: LampFit) -> list[str]:
    if fit.luminance_per_unit is None:
        return []
    return [
        f"lit shades are as bright as the reference shows them if the camera's white is "
        f"{fit.luminance_per_unit:.4g} cd/m² ({fit.photometry}): capture.luminance_per_unit"
    ]


def _on_error(fit: LampFit) -> list[str]:
    notes: list[str] = []
    if fit.rejected_share > NOTABLE_REJECTED:
        notes.append(
            f"{fit.rejected_share:.0%} of what the fit looked at contradicts it and counts for "
            "nothing: things that moved, or light that is not modelled"
        )
    whole = fit.measures["inside" if fit.mask is not None else "whole"]
    best = min(("unchanged", "gain_one", "gain_channels"), key=lambda n: whole[n].rmse_encoded)
    if whole["fitted"].rmse_encoded > whole[best].rmse_encoded:
        notes.append(
            f"the trivial prediction {best!r} is nearer to the reference than the fit: check "
            "places of lamps, E0 and the response"
        )
    return notes


def _on_holes(fit: LampFit) -> list[str]:
    surface = None if fit.scene is None else fit.scene.surface
    if surface is None or surface.depth is None or surface.depth.fill_px:
        return []
    share = float(fit.holes.mean())
    if share < NOTABLE_HOLES:
        return []
    return [
        f"{share:.1%} of the picture are holes of the depth, which get no light: "
        "surface.depth.fill_px closes those of up to so many pixels"
    ]


def _on_ambient(fit: LampFit) -> list[str]:
    ambient = None if fit.scene is None else fit.scene.ambient
    is_even = ambient is not None and ambient.illuminance_lux is not None
    whole = fit.measures["inside" if fit.mask is not None else "whole"]
    if not is_even or whole["fitted"].rmse_encoded < NOTABLE_ERROR:
        return []
    return [
        "E0 is stated as the same everywhere: what was in shadow gets too little light, and what "
        "was in bright light too much; andon calibrate ambient estimates a map of it"
    ]
