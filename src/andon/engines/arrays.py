"""`Prepared` from arrays in memory instead of files."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.capture.still import frame_from_picture
from andon.composite.model import Ambient
from andon.engines.prepared import Prepared
from andon.errors import InputError
from andon.files.pictures import Picture
from andon.lamps import Lamp
from andon.quantities import Photometry, photometric
from andon.responses import Response
from andon.spaces import View
from andon.surface.depth import DepthEncoding, depth_from_raw
from andon.surface.load import surface_of_depth

__all__ = ["prepare_arrays"]


def prepare_arrays(
    photo: NDArray[Any],
    view: View,
    lamps: tuple[Lamp, ...],
    /,
    *,
    depth_m: NDArray[Any],
    ambient_lux: Any,
    dimming: Any,
    response: Response,
    photometry: Photometry,
) -> Prepared:
    """See `andon.relight`."""
    if view.distortion:
        raise InputError("must be undistorted", field="view", remedy="use andon.lenses.undistort")
    names = [lamp.name for lamp in lamps]
    if len(set(names)) < len(names):  # shadow maps are kept by name
        raise InputError(f"names must differ, got {names}", field="lamps", remedy="rename one")
    depth = depth_from_raw(np.asarray(depth_m, np.float64), view, DepthEncoding())
    ambient = Ambient(_lux(ambient_lux, view), _dimming(dimming))
    frame = frame_from_picture(
        _picture(photo),
        view,
        response,
        luminance_per_unit=float(photometric(ambient.mean_lux)) / np.pi,
    )
    return Prepared(
        frames={view.name: frame},
        surface=surface_of_depth(depth, view),
        ambient=ambient,
        lamps=lambda _: lamps,
        photometry=photometry,
    )


def _picture(photo: NDArray[Any]) -> Picture:
    is_codes = photo.dtype in (np.dtype(np.uint8), np.dtype(np.uint16))
    if (
        photo.ndim != 3
        or photo.shape[2] != 3
        or not (is_codes or np.issubdtype(photo.dtype, np.floating))
    ):
        raise InputError(
            f"must be (H, W, 3) uint8, uint16 or float, got {photo.shape} {photo.dtype}",
            field="photo",
        )
    return Picture(photo, "srgb" if is_codes else "linear")


def _lux(ambient_lux: Any, view: View) -> NDArray[np.float64]:
    lux = np.asarray(ambient_lux, np.float64)
    if lux.shape not in ((), (3,), (*view.shape, 3)):
        raise InputError(
            f"must be a number, three channels or (H, W, 3), got {lux.shape}", field="ambient_lux"
        )
    if not (np.isfinite(lux) & (lux > 0)).all():
        raise InputError("must be finite and > 0 lx everywhere", field="ambient_lux")
    return lux if lux.ndim == 3 else np.broadcast_to(lux, 3).copy()


def _dimming(dimming: Any) -> tuple[float, float, float]:
    share = np.asarray(dimming, np.float64)
    if share.shape not in ((), (3,)):
        raise InputError(f"must be a number or three channels, got {share.shape}", field="dimming")
    r, g, b = np.broadcast_to(share, 3)
    if not (np.isfinite([r, g, b]).all() and min(r, g, b) >= 0):
        raise InputError(f"must be ≥ 0, got {dimming}", field="dimming")
    return float(r), float(g), float(b)
