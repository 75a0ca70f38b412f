"""Base-colour textures: one stack of linear pictures that both engines sample alike."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.responses import srgb_decode

__all__ = ["TEXTURE_SIDE_PX", "sample_bilinear", "with_linear_textures"]

Float = NDArray[np.float64]

# One side for all textures of a frame, since a texture array has one size: 1024² × RGBA8 is 4 MB.
TEXTURE_SIDE_PX = 1024


def with_linear_textures(geometry: Geometry, /) -> Geometry:
    """The geometry with its textures decoded to linear light and brought to one size.

    Each texture becomes (1024, 1024, 3) float32: area-averaged where it was larger, bilinear where
    it was smaller.
    """
    if all(material.texture is None for material in geometry.materials):
        return geometry
    materials = tuple(
        material
        if material.texture is None
        else replace(material, texture=_linear_square(material.texture))
        for material in geometry.materials
    )
    return replace(geometry, materials=materials)


def _linear_square(texture: NDArray[Any]) -> NDArray[np.float32]:
    import cv2

    linear = srgb_decode(texture / 255.0) if texture.dtype == np.uint8 else texture
    larger = min(texture.shape[:2]) > TEXTURE_SIDE_PX
    side = (TEXTURE_SIDE_PX, TEXTURE_SIDE_PX)
    method = cv2.INTER_AREA if larger else cv2.INTER_LINEAR
    return np.asarray(
        cv2.resize(np.asarray(linear, np.float32), side, interpolation=method), np.float32
    )


def sample_bilinear(texture: NDArray[Any], uv: Float, /) -> Float:
    """Values (n, 3) at `uv` (n, 2), repeated; (0, 0) is the top left corner of the picture."""
    height, width = texture.shape[:2]
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    x0, y0 = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    fx, fy = (x - x0)[:, None], (y - y0)[:, None]

    def texel(column: NDArray[np.int64], row: NDArray[np.int64]) -> Float:
        return np.asarray(texture[row % height, column % width, :3], np.float64)

    top = texel(x0, y0) * (1 - fx) + texel(x0 + 1, y0) * fx
    bottom = texel(x0, y0 + 1) * (1 - fx) + texel(x0 + 1, y0 + 1) * fx
    return top * (1 - fy) + bottom * fy
