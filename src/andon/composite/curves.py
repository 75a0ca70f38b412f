"""Curves of surfaces on whole pictures: f⁻¹ of what was captured, and f of the new light.

A pixel with a curve is relit in lux, those of the surface that the curve was measured on: its own
texture is a factor on them. One without has f(x) = x: what is relit is its linear camera value.

::

    light = f⁻¹(captured)  ──▶  max(dimming·light + per_lux·ΔE, 0)  ──▶  f

Less than none is no light to scale: a camera that delivered less than the surface gives it in the
dark (its own black level, noise) keeps that, whatever E0 does.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient, MeasuredSurface
from andon.quantities import CameraFrame
from andon.responses import SurfaceCurve

__all__ = ["beyond_curves", "dimmed_light", "light_of", "linear_of"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Of the ends of a curve: what was captured in codes and lit in float32 meets them inexactly.
ROUNDING = 1e-4
# Of a value: f of f⁻¹ of it differs by this much at most.
UNCHANGED = 1e-6


def light_of(linear: Float, measured: MeasuredSurface | None, /) -> Float:
    """f⁻¹: the light of linear camera values (H, W, 3), in lux where a pixel has a curve."""
    light = np.array(linear, np.float64)
    for curve, own in _pixels(measured):
        light[own] = curve.lux_of(light[own])
    return light


def linear_of(light: Float, measured: MeasuredSurface | None, /) -> Float:
    """f: linear camera values of what `light_of` gives; never less than 0 where a curve is."""
    linear = np.array(light, np.float64)
    for curve, own in _pixels(measured):
        linear[own] = np.maximum(curve.linear_of(linear[own]), 0)
    return linear


def dimmed_light(
    frame: CameraFrame, ambient: Ambient, measured: MeasuredSurface | None, /
) -> Float:
    """`light_of` what was captured, with what dimming leaves of E0."""
    captured, dimming = np.asarray(frame.linear, np.float64), np.asarray(ambient.dimming)
    if ambient.dimming_mode == "paper":
        codes = dimming * frame.response.encode(captured)
        return np.asarray(frame.response.decode(codes), np.float64)
    light = light_of(captured, measured)
    return np.where(light < 0, light, dimming * light)


def beyond_curves(
    captured: Float, relit: Float, measured: MeasuredSurface | None, /
) -> Mask | None:
    """(H, W) pixels whose curve was not measured as far: a channel of what was captured, or of the
    relit picture, both linear (H, W, 3), lies outside it. What was not changed needs no curve.
    None without curves.
    """
    if measured is None or not measured.curves:
        return None
    beyond = np.zeros(captured.shape[:2], bool)
    for curve, own in _pixels(measured):
        low, high = curve.linear[0], curve.linear[-1]
        slack = ROUNDING * (high - low)
        for linear in (captured[own], relit[own]):
            beyond[own] |= ((linear < low - slack) | (linear > high + slack)).any(axis=-1)
    return beyond & ~np.isclose(captured, relit, rtol=UNCHANGED, atol=0).all(axis=-1)


def _pixels(measured: MeasuredSurface | None) -> Iterator[tuple[SurfaceCurve, Mask]]:
    """Each curve with the pixels (H, W) that have it."""
    if measured is None or measured.curve_of is None:
        return
    for number, curve in enumerate(measured.curves):
        own = measured.curve_of == number
        if own.any():
            yield curve, own
