"""Rows of the veil of known sources: points in every projection, and shapes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glare import shapes
from andon.glare.kernel import Kernel
from andon.glare.model import Outline, Source
from andon.glare.per_source.coordinates import chord
from andon.glare.per_source.reference import has_core, veil_of_sources
from andon.glare.per_source.stage import PerSourceStage
from andon.glare.per_source.tables import table_of
from andon.glare.pixels import pixel_radians
from andon.gpu.device import open_gpu
from andon.gpu.textures import make_texture
from andon.observer.spread.family import spread_function
from andon.spaces import View, pinhole_view
from andon.verify.registry import Row

__all__ = ["ROWS"]

Float = NDArray[np.float64]

POINT = shapes.circle(np.radians(0.002))
ANGLES = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
# Nearer to a source, in pixels, nothing is claimed.
NEAREST_PIXELS = 6.0
# Cells of a rasterised shape, along its radius and around.
ALONG, AROUND = 300, 4800


def _kernel() -> Kernel:
    return Kernel(spread_function("cie146-general"))


def _pinhole(degrees: float) -> View:
    width = 1280
    return pinhole_view(width, 720, width / 2 / np.tan(np.radians(degrees) / 2))


def _cases() -> list[tuple[View, Float]]:
    """Views of 20° to 120°, fisheye and latlong; sources near their middle and near a corner."""
    focal = 720 / np.pi
    fisheye = View("fisheye", 720, 720, focal, focal, 359.5, 359.5)
    views = [*(_pinhole(degrees) for degrees in (20.0, 60.0, 120.0)), fisheye]
    views.append(View("latlong", 1024, 512))
    places = [
        (view, view.directions_at(np.array([view.width * x, view.height * y])))
        for view in views
        for x, y in ((0.503, 0.51), (0.13, 0.14))
    ]
    seam, pole = np.array([0.01, 0.1, -1.0]), np.array([0.02, -1.0, 0.05])
    return places + [(views[-1], v / np.linalg.norm(v)) for v in (seam, pole)]


def _angle(directions: Float, towards: Float) -> Float:
    return 2 * np.arcsin(np.clip(np.linalg.norm(directions - towards, axis=-1) / 2, 0, 1))


def _means(view: View, kernel: Kernel, pixels: Float, towards: Float) -> Float:
    """The model's mean over squares of pixels: Gauss–Legendre of 8 × 8."""
    u, weight = np.polynomial.legendre.leggauss(8)
    offsets = np.stack(np.meshgrid(u / 2, u / 2), axis=-1).reshape(-1, 2)
    theta = _angle(view.directions_at(pixels[:, None] + offsets), towards)
    value = kernel.per_sr(theta, core=has_core(view, kernel))
    return value @ (np.outer(weight, weight).ravel() / 4)


def _drawn(view: View, source: Source, kernel: Kernel) -> Float:
    gpu = open_gpu()
    stage = PerSourceStage(gpu, view, 1)
    stage.update([source], kernel)
    target = make_texture(gpu, "rgba16float", view.width, view.height)
    target.write(np.zeros((*view.shape, 4)))
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, target)
    gpu.device.queue.submit([encoder.finish()])
    return target.read()[..., 0].astype(np.float64)


def point(*, roundness: bool = False) -> float:
    """% by which the profile is off the model at most; or half its spread around the source."""
    kernel, worst = _kernel(), 0.0
    for view, towards in _cases():
        veil = _drawn(view, Source(towards, np.ones(3), POINT), kernel)
        theta, pixel = _angle(view.directions(), towards), pixel_radians(view)
        for degrees in ANGLES:
            angle = np.radians(degrees)
            band = (np.abs(theta - angle) < pixel / 2) & (theta > NEAREST_PIXELS * pixel)
            if np.sum(band) < 8:
                continue
            ratio = veil[band] / _means(view, kernel, view.pixel_grid()[band], towards)
            off = np.ptp(ratio) / 2 if roundness else abs(np.mean(ratio) - 1)
            worst = max(worst, float(off) * 100)
    return worst


def parity() -> float:
    """% by which the stage is off the reference at most, all views, an ellipse."""
    kernel, worst = _kernel(), 0.0
    outline = shapes.ellipse(np.radians(3), np.radians(1))
    for view, towards in _cases()[::2]:
        source = Source(towards, np.full(3, 30.0), outline)
        expected = veil_of_sources([source], view, kernel)[..., 0]
        seen = _angle(view.directions(), towards) < np.radians(100)
        off = np.abs(_drawn(view, source, kernel) / np.maximum(expected, 1e-30) - 1)[seen]
        worst = max(worst, float(off.max()) * 100)
    return worst


def _outlines() -> list[Outline]:
    d = np.pi / 180
    return [
        shapes.circle(1 * d),
        shapes.ellipse(3 * d, 1 * d),
        shapes.cylinder(5 * d, 0.2 * d),
        shapes.hemisphere(2 * d),
        shapes.pear(2 * d, 0.6 * d, 3 * d),
        shapes.polygon(d * np.array([[-2, -1], [2, -1], [2, 1], [-2, 1]])),
    ]


def shapes_off() -> float:
    """% by which tables are off K summed over the rasterised shape, at most."""
    kernel, generator, worst = _kernel(), np.random.default_rng(7), 0.0
    for outline in _outlines():
        phi = generator.uniform(0, 2 * np.pi, 16)
        beyond = np.radians(10 ** generator.uniform(-1, 1.5, 16))
        theta = outline.radius(phi) + beyond
        theta[::4] = 0.7 * outline.radius(phi[::4])
        table = table_of(kernel, outline, core=True)
        turned = phi - table.frame.axis_radians
        actual = table.at(chord(theta) * np.cos(turned), chord(theta) * np.sin(turned))
        around = (np.arange(AROUND) + 0.5) / AROUND * 2 * np.pi
        edge = outline.radius(around)
        inside = (np.arange(ALONG)[:, None] + 0.5) / ALONG * edge
        weight = np.sin(inside) * edge
        cells = _unit(inside, around)
        for value, place in zip(actual, _unit(theta, phi), strict=True):
            veil = kernel.per_sr(_angle(cells, place), core=True)
            expected = np.sum(veil * weight) / np.sum(weight)
            worst = max(worst, float(abs(value / expected - 1)) * 100)
    return worst


def _unit(theta: Float, phi: Float) -> Float:
    sine = np.sin(theta)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)], axis=-1)


ROWS: tuple[Row, ...] = (
    Row(
        "glare.source_point",
        "glare",
        2.0,
        "% of the model",
        "CIE 146 averaged over pixels, at 0.1 to 30° where ≥ 6 px from the source; 20° to 120°, "
        "fisheye, latlong with its seam and pole, on and off the axis",
        point,
    ),
    Row(
        "glare.source_point.round",
        "glare",
        1.0,
        "% of the model",
        "the same pixels: half the spread around the source on the sphere",
        lambda: point(roundness=True),
    ),
    Row(
        "glare.source_parity",
        "glare",
        0.5,
        "% of the reference",
        "the stage against the reference, an ellipse of 6° × 2° in the same views",
        parity,
    ),
    Row(
        "glare.shapes",
        "glare",
        2.0,
        "% of the convolution",
        "K summed over the rasterised shape: circle, ellipse, cylinder, dome, pear, rectangle, "
        "inside and 0.1° to 30° outside",
        shapes_off,
    ),
)
