"""Panoramas in place of captures: linear light, turned to the world, its faults counted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.capture.still import CLIPPED_CODES, linear_from_picture
from andon.errors import InputError
from andon.files.pictures import Picture, read_picture
from andon.harmonics import clipped, nonnegative, project_latlong, rotated
from andon.responses import SRGB
from andon.scene import Scene
from andon.transport.probes.placement import Panorama, Placed

__all__ = ["PanoramaLight", "check_panoramas", "panorama_light"]

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PanoramaLight:
    """What a panorama holds.

    Attributes
    ----------
    coefficients : (k, 3) luminance, cd/m², world axes.
    clipped_share : of the sphere, at the end of the picture's range; 0 for HDR pictures.
    negative : values below 0, which count as 0.
    """

    coefficients: Float
    clipped_share: float
    negative: int


def panorama_light(scene: Scene, panorama: Panorama, order: int, /) -> PanoramaLight:
    """The light of a panorama: HDR pictures as they are, others through sRGB.

    Raises `InputError` for one that is not 2:1, or has values that are not finite.
    """
    path, picture = _read(scene, panorama)
    linear = linear_from_picture(picture, SRGB)
    bad = int(np.count_nonzero(~np.isfinite(linear).all(axis=-1)))
    if bad:
        raise InputError(
            f"has {bad} pixels that are NaN or infinite", file=str(path), field=panorama.field
        )
    share = 0.0
    if picture.encoding == "srgb":
        top = np.iinfo(picture.values.dtype).max
        share = clipped(picture.values, top - CLIPPED_CODES).share
    light = nonnegative(linear)
    coefficients = project_latlong(light.values, order)
    per_unit = panorama.luminance_per_unit / np.asarray(panorama.white)
    turned = rotated(coefficients * per_unit, heading(panorama.heading_degrees))
    return PanoramaLight(turned, share, light.count)


def check_panoramas(scene: Scene, placed: Placed, /) -> None:
    """Raises `InputError` for a panorama that cannot be read, or is not 2:1."""
    for panorama in placed.panoramas:
        if panorama is not None:
            _read(scene, panorama)


def _read(scene: Scene, panorama: Panorama) -> tuple[Path, Picture]:
    path = scene.path(panorama.reference, panorama.field)
    picture = read_picture(path)
    height, width = picture.shape
    if width != 2 * height:
        raise InputError(
            f"must be twice as wide as high, got {width}×{height} px",
            file=str(path),
            field=panorama.field,
            remedy="a latlong panorama shows 360° × 180°; crop, pad or stitch it to 2:1",
        )
    return path, picture


def heading(degrees: float, /) -> Float:
    """(3, 3) turn around +Y that takes −Z towards +X."""
    angle = np.radians(degrees)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
