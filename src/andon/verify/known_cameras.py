"""Cameras and surfaces whose responses are known, photographed."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.camera import CameraCalibration, calibrate_camera
from andon.calibrate.surface import KnownLight, fit_surface
from andon.capture.brackets import bracket_of
from andon.responses import SRGB, Response

__all__ = ["exposure_error_ev", "response_error", "surface_error"]

Float = NDArray[np.float64]

KNOTS = np.linspace(0, 1, 33)[:, None]
# A camera that pleases: an S over a gamma, and each channel its own.
PLEASING = Response(
    "curve",
    linear=KNOTS ** [2.2, 2.0, 2.4],
    encoded=np.repeat(KNOTS - 0.06 * np.sin(2 * np.pi * KNOTS), 3, axis=1),
)
CAMERAS = {"srgb": SRGB, "pleasing": PLEASING}
SHAPE, STOPS, NOISE_CODES = (160, 200), 11.0, 1.5
# Between which the response is judged: ends are bounds, not measurements.
CODES = np.arange(20, 236)
WRONG_EV, WRONG = 0.5, 2

# Of E/1000 lx, 0…1.
SURFACES: dict[str, Callable[[Float], Float]] = {
    "linear": lambda share: 0.9 * share,
    "gamma": lambda share: 0.9 * share**0.5,
    "s": lambda share: 0.9 * share**2 * (3 - 2 * share),
}
LEVELS_LUX = (40, 90, 160, 250, 360, 490, 640, 810, 1000)


@cache
def _calibrated(
    camera: str, count: int, step_ev: float, is_wrong: bool = False
) -> CameraCalibration:
    """A hilly scene over `STOPS` in `count` photographs `step_ev` apart; a time may be wrong."""
    import cv2

    generator = np.random.default_rng(11)
    hills = np.asarray(cv2.GaussianBlur(generator.standard_normal(SHAPE), (0, 0), 8), np.float64)
    hills = (hills - hills.min()) / np.ptp(hills)
    scene = 2.0 ** (STOPS * (hills - 0.5))[..., None] * [1.0, 0.8, 0.6]
    seconds = 2.0 ** (step_ev * (np.arange(count) - (count - 1) / 2))
    response = CAMERAS[camera]
    codes: list[NDArray[np.uint8]] = []
    for t in seconds.tolist():
        clean = np.asarray(response.encode(np.clip(0.4 * scene * t, 0, 1)), np.float64) * 255
        noise = np.asarray(generator.normal(0, NOISE_CODES, scene.shape), np.float64)
        codes.append(np.clip(clean + noise + 0.5, 0, 255).astype(np.uint8))
    stated = seconds.copy()
    stated[WRONG] *= 2**WRONG_EV if is_wrong else 1
    return calibrate_camera(bracket_of([str(k) for k in range(count)], codes, stated.tolist()))


def response_error(camera: str, count: int, step_ev: float, /) -> float:
    """Largest error of light as a share of it, relative to code 128, over `CODES`."""
    curves = _calibrated(camera, count, step_ev).recovery.curves
    light = CAMERAS[camera].decode(np.repeat(CODES[:, None] / 255, 3, axis=1))
    middle = CAMERAS[camera].decode(np.full((1, 3), 128 / 255))
    return float(np.abs(np.exp(curves[CODES]) / (light / middle) - 1).max())


def exposure_error_ev() -> float:
    """The worst error of what is found, of a time stated `WRONG_EV` too long and of right ones."""
    found = _calibrated("pleasing", 7, 1.0, is_wrong=True).exposure_error_ev
    truth = np.where(np.arange(len(found)) == WRONG, -WRONG_EV, 0.0)
    return float(np.abs(found - truth).max())


@cache
def surface_error(surface: str, /) -> float:
    """Largest error of a surface's curve, as a share of its range, from noisy textured pictures."""
    generator = np.random.default_rng(5)
    texture = np.clip(0.5 + 0.15 * generator.standard_normal((60, 80, 1)), 0.1, 0.9)
    texture = texture * [1.0, 0.8, 0.6]
    curve = SURFACES[surface]
    photographs: list[KnownLight] = []
    for lux in LEVELS_LUX:
        linear = texture * curve(np.array(lux / 1000.0))
        linear = linear + generator.normal(0, 0.003, linear.shape)
        linear[:6, :8] += 0.3 * (lux == 250)  # something bright walks through
        photographs.append(
            KnownLight(
                f"{lux} lx", linear.astype(np.float32), linear > 0.98, np.full(3, float(lux))
            )
        )
    lux = np.linspace(LEVELS_LUX[0], LEVELS_LUX[-1], 200)
    found = fit_surface(photographs).curve.linear_of(np.repeat(lux[:, None], 3, axis=1))
    truth = curve(lux / 1000)[:, None] * texture.mean(axis=(0, 1))
    return float((np.abs(found - truth).max(axis=0) / truth.max(axis=0)).max())
