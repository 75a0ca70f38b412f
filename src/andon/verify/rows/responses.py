"""Rows of responses: of cameras from exposure series, of surfaces from known light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from andon.calibrate.camera import CameraCalibration
from andon.verify.gray_sphere import gray_sphere, offset_line
from andon.verify.known_cameras import exposure_error_ev, response_error, surface_error
from andon.verify.real_brackets import against_reconstruction, canal, church
from andon.verify.registry import Row

__all__ = ["ROWS"]

KNOWN = "a known camera, 11 stops of light, noise of 1.5 codes"
LIGHTS = "n·l of twelve known lights on a ball, taken to be equally strong"
# What shutters and apertures keep their stops to.
TOLERANCE_EV = 1 / 3


def _known_camera(camera: str, count: int, step_ev: float, bar: float | None) -> Row:
    return Row(
        f"relight.response.known.{camera}_{count}x{step_ev:g}ev",
        "relight",
        bar,
        "of the light, the worst code of 20 to 235",
        f"{KNOWN}, {count} exposures {step_ev:g} EV apart",
        lambda: response_error(camera, count, step_ev),
    )


def _known_surface(surface: str) -> Row:
    return Row(
        f"relight.response.surface.{surface}",
        "relight",
        0.02,
        "of the range, the worst",
        "a known curve under a texture, 9 illuminances, noise of 0.3 % of white",
        lambda: surface_error(surface),
    )


def _series(name: str, against: str, found: Callable[[], CameraCalibration]) -> tuple[Row, ...]:
    """Rows of a real series; its residuals are published, whatever they are."""

    def published(what: str, unit: str, measure: Callable[[], float]) -> Row:
        return Row(f"relight.response.{name}.{what}", "relight", None, unit, against, measure)

    return (
        published("rms_codes", "codes of 255", lambda: found().residuals.rms_codes),
        published("median_codes", "codes of 255", lambda: found().residuals.median_codes),
        published("rms_ev", "EV", lambda: found().residuals.rms_ev),
        Row(
            f"relight.response.{name}.exposure_worst",
            "relight",
            TOLERANCE_EV,
            "EV, absolute",
            f"{against}: stated times",
            lambda: float(np.nanmax(np.abs(found().exposure_error_ev))),
        ),
    )


def _reconstruction(name: str) -> tuple[Row, ...]:
    against = f"the church as another program merged it ({name}'s method)"
    parts = (("correlation", "of ln luminance"), ("slope", "ln over ln"), ("apart", "EV, median"))
    return tuple(
        Row(
            f"relight.response.church.{name}.{part}",
            "relight",
            None,
            unit,
            against,
            lambda k=k: against_reconstruction(name)[k],
        )
        for k, (part, unit) in enumerate(parts)
    )


ROWS: tuple[Row, ...] = (
    *(_known_camera(camera, 7, 1.0, bar=0.03) for camera in ("srgb", "pleasing")),
    # Of three photographs, g may swing in periods of their step; the smoothest g is taken.
    *(_known_camera("pleasing", 3, step_ev, bar=None) for step_ev in (2.0, 3.5)),
    Row(
        "relight.response.known.exposures",
        "relight",
        0.05,
        "EV, the worst photograph",
        "one of seven times stated half a stop too long",
        exposure_error_ev,
    ),
    *_series("church", "16 photographs on film, each predicted from the other 15", church),
    Row(
        "relight.response.church.exposure_median",
        "relight",
        None,
        "EV, absolute",
        "the published times of the 16 photographs",
        lambda: float(np.nanmedian(np.abs(church().exposure_error_ev))),
    ),
    *_reconstruction("debevec"),
    *_reconstruction("robertson"),
    *_series("canal", "3 photographs by hand, each predicted from the other two", canal),
    *(_known_surface(surface) for surface in ("linear", "gamma", "s")),
    Row(
        "relight.response.sphere.rms",
        "relight",
        None,
        "of what is predicted, green",
        LIGHTS,
        lambda: float(gray_sphere().rms_relative[1]),
    ),
    Row(
        "relight.response.sphere.straight",
        "relight",
        None,
        "of the range, green, off a line through 0",
        LIGHTS,
        lambda: float(gray_sphere().straightness[1]),
    ),
    Row(
        "relight.response.sphere.straight_with_offset",
        "relight",
        0.02,
        "of the range, green, off a line",
        f"{LIGHTS}, from a twentieth of the strongest on",
        lambda: offset_line()[0],
    ),
    Row(
        "relight.response.sphere.offset",
        "relight",
        None,
        "of the range, green",
        f"{LIGHTS}; what that line has at 0 lx",
        lambda: offset_line()[1],
    ),
)
