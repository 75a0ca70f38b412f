"""A camera's response as a picture: the curves on their data, what is left, and the exposures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.camera import CHANNELS, CameraCalibration
from andon.capture.brackets import Bracket
from andon.capture.recovery import seconds_of
from andon.display.time_series import INK, Curve, Panel, Points, drawn

__all__ = ["camera_figure"]

Float = NDArray[np.float64]

COLOURS = ((190, 40, 30), (20, 130, 60), (40, 80, 190))
# The same on paper, as if seen through: thousands of points must not hide their curve.
PALE = ((236, 176, 168), (168, 214, 180), (178, 192, 236))
POINTS = 1500
# Darker exposures are the curve's own invention where no code stands for them.
LEAST_EV, MOST_EV = -12.0, 6.0
BAND_CODES = 8


def camera_figure(bracket: Bracket, calibration: CameraCalibration, /) -> NDArray[np.uint8]:
    """(H, W, 3) uint8: three diagrams.

    Above the code over the exposure in EV from that of code 128, a curve for each channel; pale
    points are pixels in one photograph, their exposure told by all others. In the middle what
    those points differ from the curve by, and the root mean square of bands of codes. Below what
    the exposure of each photograph is off by.
    """
    panels = [_curves(calibration), _residuals(calibration)]
    if np.isfinite(calibration.exposure_error_ev).any():
        panels.append(_exposures(bracket, calibration))
    return drawn(panels)


def _chosen(calibration: CameraCalibration, channel: int) -> tuple[Float, Float, Float]:
    """Exposure in EV, code, residual in codes of some pixels, the same number of each code."""
    residuals = calibration.residuals
    known = np.isfinite(residuals.predicted[..., channel])
    codes = residuals.codes[..., channel][known].astype(float)
    exposure = residuals.log_exposure[..., channel][known] / np.log(2)
    left = codes - residuals.predicted[..., channel][known]
    rarity = 1 / np.bincount(codes.astype(int), minlength=256)[codes.astype(int)]
    count, generator = min(POINTS, len(codes)), np.random.default_rng(0)
    pick = generator.choice(len(codes), count, replace=False, p=rarity / rarity.sum())
    return exposure[pick], codes[pick], left[pick]


def _curves(calibration: CameraCalibration) -> Panel:
    curves = calibration.recovery.curves / np.log(2)
    codes = np.arange(len(curves), dtype=float)
    low, high = max(float(curves[1].min()), LEAST_EV), min(float(curves[-2].max()) + 0.5, MOST_EV)
    points: list[Points] = []
    lines: list[Curve] = []
    for c, name in enumerate(CHANNELS):
        exposure, code, _ = _chosen(calibration, c)
        points.append(Points("", PALE[c], _within(exposure, low, high), code))
        inside = (curves[:, c] >= low) & (curves[:, c] <= high)
        shown = np.where(_is_supported(calibration, c) & inside, codes, np.nan)
        lines.append(Curve(name, COLOURS[c], curves[:, c], shown, 2.5))
    return Panel(
        "Response of the camera: code over exposure, of each pixel as its other photographs say",
        "exposure, EV from that of code 128 (relative)",
        "code of 255",
        (low, high),
        (0.0, 255.0),
        lines,
        points=points,
        height_px=560,
    )


def _is_supported(calibration: CameraCalibration, channel: int) -> NDArray[np.bool_]:
    supported = np.ones(256, bool)
    for first, last in calibration.unsupported(channel):
        # A code or two that are missing lie safely between their neighbours.
        if last - first > 1 or first == 0 or last == 255:
            supported[first : last + 1] = False
    return supported


def _within(values: Float, low: float, high: float) -> Float:
    return np.where((values >= low) & (values <= high), values, np.nan)


def _residuals(calibration: CameraCalibration) -> Panel:
    residuals = calibration.residuals
    bands = [_bands(calibration, c) for c in range(3)]
    most = max(float(np.nanmax(rms, initial=0.0)) for _, rms in bands)
    reach = float(max(10.0, np.ceil(most / 10) * 10))
    points: list[Points] = []
    lines = [Curve("", INK, np.array([0.0, 255.0]), np.zeros(2), 1.0)]
    for c, name in enumerate(CHANNELS):
        _, code, left = _chosen(calibration, c)
        points.append(Points("", PALE[c], code - left, _within(left, -reach, reach)))
        lines.append(Curve(f"{name}: RMS", COLOURS[c], *bands[c], 2.0))
    return Panel(
        f"What is left: {residuals.rms_codes:.1f} codes RMS, {residuals.median_codes:.1f} in the "
        f"median, {residuals.rms_ev:.2f} EV RMS",
        "code predicted by all other photographs",
        "photographed minus predicted, codes",
        (0.0, 255.0),
        (-reach, reach),
        lines,
        points=points,
    )


def _bands(calibration: CameraCalibration, channel: int) -> tuple[Float, Float]:
    """Middles of bands of predicted codes, and the RMS of what is left in them."""
    residuals = calibration.residuals
    predicted = residuals.predicted[..., channel]
    known = np.isfinite(predicted)
    left = residuals.codes[..., channel][known] - predicted[known]
    band = (predicted[known] // BAND_CODES).astype(int)
    count = np.bincount(band, minlength=256 // BAND_CODES)
    squares = np.bincount(band, left**2, 256 // BAND_CODES)
    rms: Float = np.sqrt(squares / np.maximum(count, 1))
    middle = (np.arange(len(rms), dtype=np.float64) + 0.5) * BAND_CODES
    return middle, np.where(count >= 20, rms, np.nan)


def _exposures(bracket: Bracket, calibration: CameraCalibration) -> Panel:
    logs = np.log2(seconds_of(bracket))
    order, errors = np.argsort(logs), calibration.exposure_error_ev
    reach = float(max(0.5, np.ceil(np.nanmax(np.abs(errors)) * 5) / 4))
    ends = float(logs.min()) - 0.5, float(logs.max()) + 0.5
    return Panel(
        "Exposures: what the pictures say against what is stated",
        "stated exposure, log2 of seconds",
        "EV more than stated",
        ends,
        (-reach, reach),
        [
            Curve("", INK, np.array(ends), np.zeros(2), 1.0),
            Curve("", COLOURS[2], logs[order], errors[order], 1.5),
        ],
        points=[Points("a photograph", COLOURS[2], logs, errors, 8.0)],
        height_px=300,
    )
