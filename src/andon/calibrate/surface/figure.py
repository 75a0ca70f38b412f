"""A surface's curve as a picture: over its data, and what is left."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.surface.model import SurfaceFit
from andon.display.time_series import INK, Curve, Panel, Points, drawn

__all__ = ["surface_figure"]

Float = NDArray[np.float64]

CHANNELS = "red", "green", "blue"
COLOURS = ((190, 40, 30), (20, 130, 60), (40, 80, 190))
# The same on paper, as if seen through: thousands of points must not hide their curve.
PALE = ((236, 176, 168), (168, 214, 180), (178, 192, 236))
POINTS = 2000
LEAST_REACH = 0.1
MIDDLE_GREY, WIDTH_OF_POINT_PX = (150, 148, 140), 3.0


def surface_figure(fit: SurfaceFit, /) -> NDArray[np.uint8]:
    """(H, W, 3) uint8: two diagrams.

    Above linear camera values over illuminance, pixels divided by their texture; the dashed line
    is the straight one that fits the green channel best. Below what is left, as a share of what is
    predicted.
    """
    return drawn([_curves(fit), _residuals(fit)])


def _chosen(fit: SurfaceFit, channel: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """(pixel, photograph) of some residuals that are known."""
    pixel, photograph = np.nonzero(np.isfinite(fit.relative[..., channel]))
    count = min(POINTS, len(pixel))
    pick = np.random.default_rng(0).choice(len(pixel), count, replace=False)
    return pixel[pick], photograph[pick]


def _points(fit: SurfaceFit, channel: int, lux: Float, values: Float) -> Points:
    return Points("", PALE[channel], lux, values, WIDTH_OF_POINT_PX)


def _curves(fit: SurfaceFit) -> Panel:
    knots, curve = fit.curve.illuminance_lux, fit.curve.linear
    top = float(knots[-1]), float(curve.max()) * 1.15
    points: list[Points] = []
    for c in range(3):
        at = _chosen(fit, c)
        lux, linear = fit.samples.lux[..., c][at], fit.samples.linear[..., c][at]
        flat = linear / fit.texture[at[0], c]
        shown = np.where((flat >= 0) & (flat <= top[1]), flat, np.nan)
        points.append(_points(fit, c, lux, shown))
    gain = float(knots @ curve[:, 1] / (knots @ knots))
    # Pieces short enough for dashes to show.
    across = np.linspace(0.0, top[0], 40, dtype=np.float64)
    straight = Curve("straight", MIDDLE_GREY, across, gain * across, 1.5, dash_px=6.0)
    lines = [Curve(name, COLOURS[c], knots, curve[:, c], 2.5) for c, name in enumerate(CHANNELS)]
    start = ", 0 at 0 lx assumed" if fit.zero_assumed else ""
    return Panel(
        f"Surface {fit.name}: camera value over illuminance, texture divided out{start}",
        "illuminance of the channel, lx",
        "linear camera value, relative",
        (0.0, top[0]),
        (0.0, top[1]),
        [straight, *lines],
        points=points,
        height_px=520,
    )


def _residuals(fit: SurfaceFit) -> Panel:
    rms = float(np.max(fit.rms_relative))
    reach = max(LEAST_REACH, float(np.ceil(40 * rms) / 10))
    points: list[Points] = []
    for c in range(3):
        at = _chosen(fit, c)
        left = fit.relative[..., c][at]
        shown = np.where(np.abs(left) <= reach, left, np.nan)
        points.append(_points(fit, c, fit.samples.lux[..., c][at], shown))
    ends = 0.0, float(fit.curve.illuminance_lux[-1])
    parts = ", ".join(
        f"{name} {100 * value:.1f} %"
        for name, value in zip(CHANNELS, fit.rms_relative, strict=True)
    )
    return Panel(
        f"What is left, RMS: {parts}; {100 * fit.outlier_share:.1f} % outliers left out",
        "illuminance of the channel, lx",
        "photographed minus predicted, as a share of it",
        ends,
        (-reach, reach),
        [
            Curve("", INK, np.array(ends), np.zeros(2), 1.0),
            *(Curve(name, COLOURS[c], *_running(fit, c), 2.0) for c, name in enumerate(CHANNELS)),
        ],
        points=points,
    )


def _running(fit: SurfaceFit, channel: int) -> tuple[Float, Float]:
    """Medians of the residuals of twenty parts of equally many values, over the middle of each."""
    known = np.isfinite(fit.relative[..., channel])
    lux, left = fit.samples.lux[..., channel][known], fit.relative[..., channel][known]
    order = np.argsort(lux, kind="stable")
    parts = [part for part in np.array_split(order, 20) if len(part)]
    x = np.array([np.median(lux[part]) for part in parts])
    return x, np.array([np.median(left[part]) for part in parts])
