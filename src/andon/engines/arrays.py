"""`Prepared` from arrays in memory instead of files."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast, get_args

import numpy as np
from numpy.typing import NDArray

from andon.capture.still import frame_from_picture
from andon.composite.model import Ambient
from andon.engines.array_checks import described, numbers
from andon.engines.measured_arrays import measured_arrays
from andon.engines.prepared import Prepared
from andon.errors import InputError
from andon.files.pictures import Picture
from andon.lamps import AnyAreaLamp, Lamp, body_of
from andon.quantities import Photometry, photometric
from andon.responses import Response
from andon.spaces import View
from andon.surface.depth import DepthEncoding, depth_from_raw
from andon.surface.load import surface_of_depth

__all__ = ["listed", "prepare_arrays"]


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
    reflectance_map: Any = None,
    curves: Any = (),
) -> Prepared:
    """See `andon.relight`."""
    _check_types(view, lamps, response, photometry)
    names = [lamp.name for lamp in lamps]
    if len(set(names)) < len(names):  # shadow maps are kept by name
        raise InputError(f"names must differ, got {names}", field="lamps", remedy="rename one")
    picture = _picture(photo)
    depth = depth_from_raw(_depth(depth_m, view), view, DepthEncoding())
    ambient = Ambient(_lux(ambient_lux, view), _dimming(dimming))
    frame = frame_from_picture(
        picture,
        view,
        response,
        luminance_per_unit=float(photometric(ambient.mean_lux)) / np.pi,
    )
    measured = measured_arrays(reflectance_map, curves, frame, ambient)
    shining = tuple(_with_a_body(lamp) for lamp in lamps)
    bodies = tuple(body_of(x) for x in lamps if isinstance(x, AnyAreaLamp) and x.drawn)
    return Prepared(
        frames={view.name: frame},
        surface=surface_of_depth(depth, view),
        ambient=ambient,
        lamps=lambda _: shining,
        bodies=lambda _: bodies,
        photometry=photometry,
        measured={} if measured is None else {view.name: measured},
    )


def _with_a_body(lamp: Lamp) -> Lamp:
    """An area lamp that is drawn shines through the body that it is."""
    if not isinstance(lamp, AnyAreaLamp) or not lamp.drawn:
        return lamp
    shadow = lamp.shadow
    if shadow is not None:
        shadow = replace(shadow, through=shadow.through | {lamp.name})
    return replace(lamp, body=lamp.name, shadow=shadow)


def listed(lamps: Any, /) -> tuple[Any, ...]:
    """`lamps` as a tuple. Raises `InputError` for what is no list."""
    if isinstance(lamps, list | tuple):
        return tuple(cast("list[Any]", lamps))
    raise InputError(
        f"must be a list of lamps, got {described(lamps)}",
        field="lamps",
        remedy="write [lamp], also for one",
    )


def _check_types(view: Any, lamps: tuple[Any, ...], response: Any, photometry: Any) -> None:
    """What a type checker would have said, for those who use none."""
    if not isinstance(view, View):
        raise InputError(
            f"must be an andon.View, got {described(view)}",
            field="view",
            remedy='e.g. andon.View("pinhole", width, height, fx, fy, cx, cy)',
        )
    if view.distortion:
        raise InputError("must be undistorted", field="view", remedy="use andon.lenses.undistort")
    for index, lamp in enumerate(lamps):
        if not isinstance(lamp, get_args(Lamp)):
            raise InputError(
                f"must be a lamp, got {described(lamp)}",
                field=f"lamps[{index}]",
                remedy="e.g. andon.PointLamp(name, position_m, intensity_cd)",
            )
    if not isinstance(response, Response):
        raise InputError(
            f"must be an andon.Response, got {described(response)}",
            field="response",
            remedy='e.g. andon.Response("srgb")',
        )
    if photometry not in get_args(Photometry):
        words = " or ".join(get_args(Photometry))
        raise InputError(f"must be {words}, got {described(photometry)}", field="photometry")


def _depth(depth_m: Any, view: View) -> NDArray[np.float64]:
    wanted = f"an array ({view.height}, {view.width}) of metres"
    depth = numbers(depth_m, "depth_m", wanted)
    if depth.shape != view.shape:
        raise InputError(
            f"must be {wanted}, the view's (height, width), got {depth.shape}",
            field="depth_m",
            remedy="give depth and view of the same picture",
        )
    return depth


def _picture(photo: Any) -> Picture:
    if not hasattr(photo, "__array__"):
        raise InputError(
            f"must be an array (H, W, 3), got {described(photo)}",
            field="photo",
            remedy="e.g. np.asarray(photo, np.uint8)",
        )
    pixels: NDArray[Any] = np.asarray(photo)
    is_codes = pixels.dtype in (np.dtype(np.uint8), np.dtype(np.uint16))
    if (
        pixels.ndim != 3
        or pixels.shape[2] != 3
        or not (is_codes or np.issubdtype(pixels.dtype, np.floating))
    ):
        raise InputError(
            f"must be (H, W, 3) uint8, uint16 or float, got {pixels.shape} {pixels.dtype}",
            field="photo",
        )
    return Picture(pixels, "srgb" if is_codes else "linear")


def _lux(ambient_lux: Any, view: View) -> NDArray[np.float64]:
    lux = numbers(ambient_lux, "ambient_lux", "a number, three channels or (H, W, 3)")
    if lux.shape not in ((), (3,), (*view.shape, 3)):
        raise InputError(
            f"must be a number, three channels or (H, W, 3), got {lux.shape}", field="ambient_lux"
        )
    if not (np.isfinite(lux) & (lux > 0)).all():
        raise InputError("must be finite and > 0 lx everywhere", field="ambient_lux")
    return lux if lux.ndim == 3 else np.broadcast_to(lux, 3).copy()


def _dimming(dimming: Any) -> tuple[float, float, float]:
    share = numbers(dimming, "dimming", "a number or three channels")
    if share.shape not in ((), (3,)):
        raise InputError(f"must be a number or three channels, got {share.shape}", field="dimming")
    r, g, b = np.broadcast_to(share, 3)
    if not (np.isfinite([r, g, b]).all() and min(r, g, b) >= 0):
        raise InputError(f"must be ≥ 0, got {dimming}", field="dimming")
    return float(r), float(g), float(b)
