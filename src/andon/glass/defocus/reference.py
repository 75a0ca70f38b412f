"""Blurring in float64: a gather at every pixel, with the disc of that pixel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glass.defocus.kernels import LEAST_BLUR_PX, Kernel, kernel
from andon.glass.layers import Layers
from andon.glass.model import Blur

__all__ = ["blurred", "extended", "gathered"]

Float = NDArray[np.float64]


def blurred(layers: Layers, kind: Blur = "optical", /) -> Layers:
    """The layers as an eye sees them that is focused elsewhere, premultiplied by coverage.

    What is refracted and what is mirrored are images that go on behind the rim of the glass
    (`extended`), each gathered with its own disc; what sticks to the glass, and the rim itself
    (`coverage`), with the disc of the surface. In mode ``paper`` the refracted image is left as it
    is: there its backdrop was blurred. Diameters come back extended beyond the rim.

    Raises `InputError` for shapes that differ, diameters or coverage that are negative or not
    finite.
    """
    _check(layers)
    if kind == "off":
        return layers
    shape, cover = kernel(kind), layers.coverage
    surface_px = extended(layers.surface_px, cover)
    sheet = np.dstack([layers.surface, layers.surface_alpha, cover])
    sheet = gathered(sheet, surface_px, shape)
    rim = sheet[..., 4]

    def image(premultiplied: Float, diameters: Float, sharp: bool = False) -> tuple[Float, Float]:
        size = extended(diameters, cover)
        picture = extended(_divided(premultiplied, cover), cover)
        after = picture if sharp else gathered(picture, size, shape)
        return rim[..., None] * after, size

    refracted, refracted_px = image(layers.refracted, layers.refracted_px, kind == "paper")
    reflected, reflected_px = image(layers.reflected, layers.reflected_px)
    return replace(
        layers,
        coverage=rim,
        refracted=refracted,
        surface=sheet[..., :3],
        surface_alpha=sheet[..., 3],
        reflected=reflected,
        refracted_px=refracted_px,
        surface_px=surface_px,
        reflected_px=reflected_px,
    )


def gathered(picture: Float, diameter_px: Float, shape: Kernel, /) -> Float:
    """(H, W, n): each pixel the mean of `picture` over its own disc; the border goes on outside.

    Pixels are taken in the order of their discs, so that each neighbour is read only by those
    whose disc holds it.
    """
    size = shape.sizes(diameter_px).ravel()
    order = np.argsort(-size, kind="stable")
    order = order[diameter_px.ravel()[order] >= LEAST_BLUR_PX]
    result = np.array(picture, np.float64)
    if not len(order):
        return result
    size = size[order]
    far = int(np.ceil(shape.reach(size[:1])[0]))
    width, channels = picture.shape[1:]
    padded = np.pad(result, ((far, far), (far, far), (0, 0)), mode="edge").reshape(-1, channels)
    stride = width + 2 * far
    middle = (order // width + far) * stride + order % width + far
    total, light = np.zeros(len(order)), np.zeros((len(order), channels))
    reaches = -shape.reach(size)
    for dy in range(-far, far + 1):
        for dx in range(-far, far + 1):
            nearest = max(abs(dy), abs(dx)) if shape.kind == "paper" else np.hypot(dy, dx)
            count = int(np.searchsorted(reaches, -nearest, side="left"))
            if count:
                weight = shape.weights(dy, dx, size[:count])
                total[:count] += weight
                light[:count] += weight[:, None] * padded[middle[:count] + (dy * stride + dx)]
    result.reshape(-1, channels)[order] = light / total[:, None]
    return result


def extended(values: Float, coverage: Float, /) -> Float:
    """`values` (H, W) or (H, W, n) where `coverage` (H, W) is not 0, and what is near beyond.

    A pyramid of means, weighted by coverage; where a level knows nothing the next coarser one
    answers, by linear interpolation. All zero where nothing is covered at all.
    """
    flat = values.reshape(*coverage.shape, -1)
    if not (coverage > 0).any():
        return np.zeros_like(values)
    if (coverage > 0).all():
        return values
    parts, cover = _halved(flat * coverage[..., None]), _halved(coverage[..., None])[..., 0]
    coarse = extended(_divided(parts, cover), cover)
    beyond = _doubled(coarse)[: coverage.shape[0], : coverage.shape[1]]
    return np.where(coverage[..., None] > 0, flat, beyond).reshape(values.shape)


def _divided(premultiplied: Float, coverage: Float) -> Float:
    """What a share of a pixel shows, 0 where there is none."""
    share = coverage[..., None]
    return np.divide(premultiplied, share, out=np.zeros_like(premultiplied), where=share > 0)


def _halved(values: Float) -> Float:
    """(⌈H/2⌉, ⌈W/2⌉, n) means with weights 1 3 3 1 along each axis; the border goes on outside."""
    for axis in (0, 1):
        along = np.moveaxis(values, axis, 0)
        odd = along.shape[0] % 2
        wide = np.pad(along, ((1, 1 + odd), (0, 0), (0, 0)), mode="edge")
        means = (wide[0:-3:2] + 3 * wide[1:-2:2] + 3 * wide[2:-1:2] + wide[3::2]) / 8
        values = np.moveaxis(means, 0, axis)
    return values


def _doubled(values: Float) -> Float:
    """(2H, 2W, n) interpolated: a pixel's centre lies a quarter of a cell off its cell's."""
    for axis in (0, 1):
        along = np.moveaxis(values, axis, 0)
        before = np.concatenate([along[:1], along[:-1]])
        after = np.concatenate([along[1:], along[-1:]])
        pairs = np.stack([0.75 * along + 0.25 * before, 0.75 * along + 0.25 * after], axis=1)
        values = np.moveaxis(pairs.reshape(-1, *along.shape[1:]), 0, axis)
    return values


def _check(layers: Layers) -> None:
    size = layers.coverage.shape
    for name in ("refracted", "surface", "reflected"):
        if getattr(layers, name).shape != (*size, 3):
            got = getattr(layers, name).shape
            raise InputError(f"must be {(*size, 3)}, got {got}", field=f"layers.{name}")
    for name in ("coverage", "surface_alpha", "refracted_px", "surface_px", "reflected_px"):
        values = getattr(layers, name)
        if values.shape != size:
            raise InputError(f"must be {size}, got {values.shape}", field=f"layers.{name}")
        if not (np.isfinite(values).all() and (values >= 0).all()):
            raise InputError("must be finite and ≥ 0", field=f"layers.{name}")
