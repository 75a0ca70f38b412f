"""The photograph, and E0: the light that it is taken in.

Each pixel is the mean of 16 rays, L = ρ·E/π, with ρ from the texture and E from Radiance, one value
for each surface that the pixel shows. Its E0 is π·mean(L)/mean(ρ): what a flat pixel has, and what
makes added light come out right in pixels that show an edge. For the glowing paper of the shoji
that is the illuminance in which paper without daylight behind it would look the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.cameras import write_camera
from andon.files.pictures import write_png
from andon.quantities import Geometry
from andon.responses import srgb_encode
from andon.spaces import View
from tatami.daylight import SHOJI_CD_M2, SHOJI_RGB, illuminance
from tatami.textures import noise
from tatami.tracing import GRID, Samples, Tracer

Float = NDArray[np.float64]
# Every so many pixels, first: see daylight.illuminance.
OVERTURE_PX = 6
# Curved surfaces are facets that shade themselves: their points are lifted.
CURVED_LIFT_M = 1e-3
# The exposure: cd/m² of linear value 1.
LUMINANCE_PER_UNIT = 150.0


@dataclass(frozen=True)
class Photograph:
    """`luminance` (H, W, 3) cd/m² and `e0` (H, W, 3) lx."""

    luminance: Float
    e0: Float


@dataclass(frozen=True)
class _Needs:
    """For each (pixel, surface) that is seen: where E is asked, and Σρ, Σ glow over its rays."""

    pixel: NDArray[np.int64]
    position: Float
    normal: Float
    reflectance: Float
    glow: Float


def photograph(geometry: Geometry, view: View) -> Photograph:
    """Takes minutes: about a million points are asked of Radiance."""
    tracer = Tracer(geometry)
    paper = [m.name for m in geometry.materials].index("paper.shoji")
    bands = [_needs(samples, paper) for samples in tracer.bands(view)]
    needs = _Needs(
        *(np.concatenate([getattr(b, k) for b in bands]) for k in _Needs.__annotations__)
    )
    row, column = np.divmod(needs.pixel, view.width)
    first = np.flatnonzero((row % OVERTURE_PX == 0) & (column % OVERTURE_PX == 0))
    lux = illuminance(geometry, needs.position, needs.normal, first)
    light = needs.reflectance * lux / np.pi + needs.glow
    count, rays = view.width * view.height, GRID**2
    luminance = _summed(needs.pixel, light, count) / rays
    reflectance = _summed(needs.pixel, needs.reflectance, count) / rays
    shape = (*view.shape, 3)
    return Photograph(luminance.reshape(shape), (np.pi * luminance / reflectance).reshape(shape))


def write_photograph(folder: Path, picture: Photograph, view: View) -> None:
    """photo.png, e0.exr and camera.toml."""
    light = picture.luminance / LUMINANCE_PER_UNIT
    # Rounded up or down by chance, so that no steps show where the dark is brightened.
    chance = np.random.default_rng(77).random(light.shape)
    codes = np.floor(np.clip(srgb_encode(np.minimum(light, 1)), 0, 1) * 255 + chance)
    write_png(folder / "photo.png", np.clip(codes, 0, 255).astype(np.uint8))
    _write_half(folder / "e0.exr", picture.e0)
    write_camera(folder / "camera.toml", view)


def _write_half(path: Path, lux: Float) -> None:
    """Three half-float channels; 9 of 11 bits are kept, 0.1 %, which compress better."""
    import OpenEXR

    power = 2.0 ** (np.floor(np.log2(lux)) - 8)
    values = (np.round(lux / power) * power).astype(np.float16)
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "andon:unit": "lx",
        "andon:photometry": "absolute",
    }
    planes = {name: np.ascontiguousarray(values[..., k]) for k, name in enumerate("RGB")}
    OpenEXR.File(header, planes).write(str(path))


def _needs(samples: Samples, paper: int) -> _Needs:
    keys = np.stack([samples.pixel, samples.group], axis=-1)
    # Samples come nearest to the pixel's centre first, so the first of a key is its best place.
    found, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    glow = np.where((samples.material == paper)[:, None], _glow(samples.position), 0.0)
    groups = inverse.reshape(-1)
    lift = np.where(samples.group < 0, CURVED_LIFT_M, 0.0)
    return _Needs(
        found[:, 0],
        samples.position[first] + lift[first, None] * samples.normal[first],
        samples.normal[first],
        _summed(groups, samples.reflectance, len(found)),
        _summed(groups, glow, len(found)),
    )


def _summed(groups: NDArray[np.int64], values: Float, count: int) -> Float:
    return np.stack([np.bincount(groups, values[:, k], count) for k in range(3)], axis=-1)


def _glow(position: Float) -> Float:
    """(n, 3) cd/m² of daylight through the paper: brighter above, with a garden's soft shades."""
    side = 256
    clouds = 0.5 * noise((side, side), (16, 11), 40) + 0.3 * noise((side, side), (6, 5), 41)
    row = (position[:, 1] / 2.0 * side).astype(np.int64) % side
    column = ((position[:, 2] + 1.5) / 3.0 * side).astype(np.int64) % side
    shade = 1 + 0.035 * clouds[row, column] + 0.06 * (position[:, 1] - 1.0)
    return SHOJI_CD_M2 * SHOJI_RGB * shade[:, None]
