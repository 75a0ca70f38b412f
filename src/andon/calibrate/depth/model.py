"""Relative depth, what is known of the scene, and what was found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lenses import captured_rays
from andon.spaces import View, another_size
from andon.surface.resample import SAME_PICTURE, same_aspect

__all__ = [
    "At",
    "DepthFit",
    "Floor",
    "Kind",
    "Knowledge",
    "Length",
    "Plane",
    "RelativeDepth",
    "Row",
    "relative_depth",
]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]
Kind = Literal["inverse", "depth"]
Pixel = tuple[int, int]


@dataclass(frozen=True)
class RelativeDepth:
    """An estimator's numbers and the rays that they lie on.

    Attributes
    ----------
    values : (H, W), NaN in holes: 1/z = a·r + b (``inverse``) or z = a·r + b (``depth``).
    kind : which of the two.
    rays : (H, W, 3) camera-frame rays with z = 1 of the pixels *as captured*.
    up : (3,) the world's +Y in the camera frame.
    """

    values: Float
    kind: Kind
    rays: Float
    up: Float

    def metric(self, scale: float, shift: float, /) -> Float:
        """Depth (H, W) in metres, NaN in holes and where the model is behind the camera."""
        with np.errstate(divide="ignore", invalid="ignore"):
            modelled = scale * self.values + shift
            depth = 1 / modelled if self.kind == "inverse" else modelled
            return np.where((modelled > 0) & np.isfinite(depth), depth, np.nan)


@dataclass(frozen=True)
class Length:
    """Distance in space, m, between the surface points under two pixels (column, row)."""

    first: Pixel
    second: Pixel
    metres: float


@dataclass(frozen=True)
class At:
    """Depth z, m, of the surface under a pixel (column, row)."""

    pixel: Pixel
    metres: float


@dataclass(frozen=True)
class Plane:
    """Pixels (H, W) that lie on one plane; `name` is for messages."""

    mask: Mask
    name: str


@dataclass(frozen=True)
class Floor:
    """A level plane below the camera, by the camera's pose; `height_m` of the camera over it."""

    plane: Plane
    height_m: float | None = None


@dataclass(frozen=True)
class Knowledge:
    """All that is known of a scene.

    Attributes
    ----------
    planes : pixels that are flat.
    perpendicular : pairs of indices into `planes`, −1 for the floor, that stand at right angles.
    known_m : (H, W) metric depth z of some pixels, NaN elsewhere; may be noisy, with outliers.
    """

    lengths: tuple[Length, ...] = ()
    points: tuple[At, ...] = ()
    planes: tuple[Plane, ...] = ()
    floor: Floor | None = None
    perpendicular: tuple[tuple[int, int], ...] = ()
    known_m: Float | None = None


@dataclass(frozen=True)
class Row:
    """What was stated beside what was found; `share` is the relative error, or radians of angles.

    `unit` is ``m`` or ``degrees``. `pixels` are the places (column, row) it is about.
    """

    name: str
    stated: float
    found: float
    unit: Literal["m", "degrees"]
    share: float
    pixels: tuple[Pixel, ...] = ()


@dataclass(frozen=True)
class DepthFit:
    """Scale and shift, how well they are known, and what disagrees.

    Attributes
    ----------
    scale, shift : a and b of the model (1/m or m per unit of r; 1/m or m).
    shift_is_assumed : nothing determined it; it is 0.
    error_share : (3,) standard error of z, relative, at the nearest, the median and the farthest
        2 % of the picture; NaN where there are no more constraints than unknowns to judge by and
        no scatter: then it is that of the stated precision alone.
    percentiles_m : (3,) z at those.
    rows : one for each thing known.
    flatness : (RMS relative distance from the plane, name) of each plane.
    scatter_share : of `known_m`: median |z/known − 1|; None without.
    outlier_share : of `known_m`: what the robust fit set aside; None without.
    behind_pixels : pixels with a number whose depth is not positive: holes of the result.
    """

    scale: float
    shift: float
    shift_is_assumed: bool
    error_share: tuple[float, float, float]
    percentiles_m: tuple[float, float, float]
    rows: tuple[Row, ...]
    flatness: tuple[tuple[float, str], ...] = ()
    scatter_share: float | None = None
    outlier_share: float | None = None
    behind_pixels: int = 0
    notes: tuple[str, ...] = field(default=())


def relative_depth(
    values: Float, view: View, kind: Kind, /, *, invalid: tuple[float, ...] = (), file: str = ""
) -> RelativeDepth:
    """Relative depth of the photograph of `view`; of a resolution of its own, it keeps it.

    Parameters
    ----------
    values : (h, w) as read; NaN, ±inf and `invalid` are holes.

    Raises `InputError` where it is no picture of the view, or all holes.
    """
    if view.projection != "pinhole":
        raise InputError(f"relative depth needs a pinhole camera, not {view.projection}")
    shape = (values.shape[0], values.shape[1])
    if not same_aspect(shape, view.shape):
        raise another_size(shape, view, file=file, remedy=SAME_PICTURE)
    own = view.resized(shape[1], shape[0])
    holes = ~np.isfinite(values) | np.isin(values, invalid)
    kept = np.where(holes, np.nan, values)
    if holes.all():
        raise InputError("has no pixel with a number", file=file, remedy="check --invalid")
    if np.nanmin(kept) == np.nanmax(kept):
        raise InputError(f"is {np.nanmin(kept):g} everywhere: there is no relief", file=file)
    return RelativeDepth(kept, kind, captured_rays(own), view.camera_from_world[:3, 1].copy())
