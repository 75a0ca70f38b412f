"""A camera's response from an exposure series, and how well the series agrees with it.

===================  ==========================================================================
question             answered by
===================  ==========================================================================
what is g?           `recover_curves`: least squares with the stated exposures
how good is it?      each photograph predicted from the light that all *others* give, through g:
                     the residual in codes, and in stops
are the times true?  exposures are fitted too, with g, until both agree; what is left of their
                     difference from the stated ones is printed for each photograph
where is it known?   codes that too few equations speak of are named
===================  ==========================================================================

Times can be checked against each other only: a common factor is another unit of light, and a common
power another g (Debevec & Malik 1997, section 2.1; Mitsunaga & Nayar 1999, section 5). So a line
over ln t is taken off, the one from which the fewest photographs differ; two photographs say
nothing, and of three it is not told which of them is wrong.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.camera_residuals import Residuals, residuals_of
from andon.capture.align import align
from andon.capture.brackets import Bracket, check_exposures
from andon.capture.recovery import CODES, Recovery, recover_curves, seconds_of
from andon.errors import InputError
from andon.responses import Response

__all__ = [
    "CHANNELS",
    "CameraCalibration",
    "calibrate_camera",
    "check_calibration",
    "check_still",
]

Float = NDArray[np.float64]

CHANNELS = "red", "green", "blue"
# Equations that a code needs to be known by itself and not by its neighbours.
LEAST_SUPPORT = 4
# Exposures and g are found in turn, until no exposure moves by more.
ROUNDS, SETTLED_EV = 12, 0.003
ROUND_PIXELS = 40_000
# Shutters and apertures keep their stops to a third; what is off by so many stops is no tolerance.
CONTRADICTING_EV = 1.0
# A fall of so many standard errors and stops is none of noise.
FALL_ERRORS, LEAST_FALL_EV = 4.0, 0.1
# What is left of a motion that alignment found: more than what it leaves of those that it corrects.
MOST_SHIFT_PX, MOST_TURN_DEGREES = 1.5, 0.3
# A tenth of the range: no curve explains such photographs.
MOST_RMS_CODES = 25.0


@dataclass(frozen=True)
class CameraCalibration:
    """What a bracket says of its camera.

    Attributes
    ----------
    recovery : the curves, their support, and where they fell before they were made to rise.
    residuals : of each photograph predicted from all others.
    exposure_error_ev : (n,) log₂ of the exposure that the pictures say over the stated one; NaN
        where a photograph has too few pixels that say anything, or where there are only two.
    used_share : share of all pixels of all photographs that are neither clipped nor border.
    kept_share : share of the sampled pixels that fitted, the least of the three channels.
    """

    recovery: Recovery
    residuals: Residuals
    exposure_error_ev: Float
    used_share: float
    kept_share: float

    @property
    def response(self) -> Response:
        """What `capture.response.file` takes."""
        return self.recovery.response

    def unsupported(self, channel: int, /) -> list[tuple[int, int]]:
        """Runs of codes (first, last) that fewer than `LEAST_SUPPORT` equations speak of."""
        support = self.recovery.channels[channel].support
        missing = np.flatnonzero(support < LEAST_SUPPORT)
        runs = groupby(enumerate(missing.tolist()), key=lambda pair: pair[1] - pair[0])
        codes = [[code for _, code in run] for _, run in runs]
        return [(run[0], run[-1]) for run in codes]


def calibrate_camera(bracket: Bracket, /) -> CameraCalibration:
    """The response of the camera that took `bracket`, aligned, with its errors.

    Raises `InputError` for exposures that tell nothing (`check_exposures`). What contradicts
    itself is refused by `check_calibration`.
    """
    check_exposures(bracket)
    recovery = recover_curves(bracket)
    residuals = residuals_of(bracket, recovery.curves)
    used = [
        ((codes > 0) & (codes < CODES - 1)).all(axis=-1) & seen
        for codes, seen in zip(bracket.codes, bracket.seen, strict=True)
    ]
    return CameraCalibration(
        recovery,
        residuals,
        _exposure_errors(bracket),
        float(np.mean(used)),
        min(channel.kept_share for channel in recovery.channels),
    )


def check_still(bracket: Bracket, /) -> None:
    """Refuses photographs that, aligned or not, still lie off each other. Raises `InputError`."""
    for name, move in zip(bracket.names, align(bracket, "auto")[1], strict=True):
        x, y = move.shift_px
        if np.hypot(x, y) > MOST_SHIFT_PX or abs(move.turn_degrees) > MOST_TURN_DEGREES:
            raise InputError(
                f"lies {x:+.1f}, {y:+.1f} px off {bracket.names[bracket.middle]}, turned by "
                f"{move.turn_degrees:+.2f}°, after alignment",
                file=name,
                field="--align",
                remedy="--align auto, or ecc where the camera was turned; or leave it out",
            )


def check_calibration(bracket: Bracket, calibration: CameraCalibration, /) -> None:
    """Refuses a response that its own photographs contradict. Raises `InputError`.

    Contradictions: a curve that falls beyond noise, a photograph whose exposure is off by a stop
    and more, a residual that no curve of a camera leaves.
    """
    _check_times(bracket, calibration.exposure_error_ev)
    rms = calibration.residuals.rms_codes
    if rms > MOST_RMS_CODES:
        raise InputError(
            f"the photographs contradict each other by {rms:.0f} codes of 255 (RMS): no response "
            "explains them",
            field="PHOTOS",
            remedy="a still scene from one place, or --align auto for a camera that moved",
        )
    for name, channel in zip(CHANNELS, calibration.recovery.channels, strict=True):
        fall = channel.fall
        if fall is not None and fall.ev > max(FALL_ERRORS * fall.noise_ev, LEAST_FALL_EV):
            raise InputError(
                f"the {name} channel's response falls by {fall.ev:.2f} EV from code "
                f"{fall.codes[0]} to {fall.codes[1]} (noise {fall.noise_ev:.2f} EV): brighter "
                "light would have made darker pixels",
                field="PHOTOS",
                remedy="photographs of one light, each developed alike, without local tone mapping",
            )


def _check_times(bracket: Bracket, errors: Float) -> None:
    if not np.isfinite(errors).any():
        return
    worst = int(np.nanargmax(np.abs(errors)))
    if abs(errors[worst]) > CONTRADICTING_EV:
        stated = seconds_of(bracket)[worst]
        raise InputError(
            f"is exposed {abs(errors[worst]):.1f} EV {'more' if errors[worst] > 0 else 'less'} "
            f"than stated, by what it shows: about {stated * 2 ** errors[worst]:.3g} s for "
            f"{stated:.3g} s",
            file=bracket.names[worst],
            field="--seconds",
            remedy="correct its time, or leave it out",
        )


def _exposure_errors(bracket: Bracket) -> Float:
    """(n,) EV; see `CameraCalibration`."""
    logs = np.log2(seconds_of(bracket))
    errors = np.zeros(len(logs))
    if len(logs) < 3:
        return np.full(len(logs), np.nan)
    bias = errors
    for _ in range(ROUNDS):
        fitted = replace(bracket, seconds=2 ** (logs + errors))
        curves = recover_curves(fitted).curves
        bias = residuals_of(fitted, curves, pixels=ROUND_PIXELS).exposure_ev
        found = errors + np.nan_to_num(bias)
        found = found - np.polyval(np.polyfit(logs, found, 1), logs)
        step, errors = np.abs(found - errors).max(), found
        if step < SETTLED_EV:
            break
    known = np.isfinite(bias)
    errors = np.where(known, errors - _line_of_most(logs[known], errors[known])(logs), np.nan)
    return errors


def _line_of_most(x: Float, y: Float) -> np.poly1d:
    """The line of least absolute deviations: outliers do not pull at it."""
    weights = np.ones(len(x))
    line = np.poly1d([0.0])
    for _ in range(50):
        line = np.poly1d(np.polyfit(x, y, 1, w=np.sqrt(weights)))
        weights = 1 / np.maximum(np.abs(y - line(x)), 1e-4)
    return line
