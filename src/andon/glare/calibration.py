"""What a picture file says of its angles and of its light.

============ ======================================================== ==========================
matter       where it comes from, the first that there is             otherwise
============ ======================================================== ==========================
angles       a stated view or projection; Radiance's VIEW line;       60° across, with a warning
             EXR's ``envmap``; EXIF's focal length; 2:1 is latlong
light        a stated scale; ``andon:unit`` = cd/m2 or EXR's          relative: 1 is 1 cd/m²
             ``whiteLuminance``; 179 lm/W where a VIEW line says that
             Radiance made the picture
============ ======================================================== ==========================

An EXPOSURE line alone makes no picture absolute: programs that know nothing of radiance write it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.pictures import Picture
from andon.files.pictures.radiance_view import from_hemispherical, radiance_view
from andon.quantities import Photometry
from andon.spaces import Projection, View

__all__ = ["DEFAULT_HFOV_DEGREES", "Calibrated", "calibrated", "projected"]

DEFAULT_HFOV_DEGREES = 60.0
# A fish-eye whose picture is this wide ends in a circle, not at the picture's border.
CIRCLE_FROM_DEGREES = 160.0
# As Radiance converts: 179 lm/W for each channel.
LUMENS_PER_WATT = 179.0
# Codes this close to white count as clipped: sensor noise keeps many off the very last.
CLIPPED_CODES = 1


@dataclass(frozen=True, eq=False)
class Calibrated:
    """A picture as luminance, with where its pixels look.

    Attributes
    ----------
    luminance_cd_m2 : (H, W, 3) float32, as stored: negative and non-finite values are kept.
    view : without distortion.
    photometry : ``relative`` where nothing says what 1 is.
    cd_m2_per_unit : what the file's values were multiplied by.
    shows : (H, W) bool, False outside the circle of a fish-eye; None: all pixels show something.
    clipped : (H, W) bool, at the white of an 8- or 16-bit picture; None: of HDR.
    angles_from, light_from : where the two came from, in words.
    warnings : what was assumed.
    """

    luminance_cd_m2: NDArray[np.float32]
    view: View
    photometry: Photometry
    cd_m2_per_unit: float
    shows: NDArray[np.bool_] | None
    clipped: NDArray[np.bool_] | None
    angles_from: str
    light_from: str
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class _Angles:
    view: View
    source: str
    warning: str | None = None
    hemispherical: bool = False


def calibrated(
    picture: Picture,
    /,
    *,
    view: View | None = None,
    cd_m2_per_unit: float | None = None,
    file: str = "",
) -> Calibrated:
    """The picture as luminance.

    Parameters
    ----------
    view : of the picture, where it is known; its distortion is taken out.
    cd_m2_per_unit : cd/m² of linear 1, > 0, where it is known.
    file : for messages.

    Raises
    ------
    InputError
        for a scale that is not > 0, a view of another size, or a VIEW line that cannot be used.
    """
    angles = _angles(picture, view, file)
    scale, light_from = _scale(picture, cd_m2_per_unit)
    values = np.asarray(picture.linear() * scale, np.float32)
    white = _white(picture)
    if angles.view.distortion:
        values, white = _undistorted(values, white, angles.view)
    if angles.hemispherical:
        values = from_hemispherical(values, angles.view)
    warnings = [angles.warning] if angles.warning else []
    if light_from is None:
        warnings.append(
            "nothing says what the picture's 1 is in cd/m²: luminances are relative; state "
            "--luminance-scale"
        )
    if white is not None:
        warnings.append(
            f"{int(np.count_nonzero(white))} pixels are at the white of an 8- or 16-bit picture: "
            "what is brighter there is lost, and its glare is too weak"
        )
    return Calibrated(
        values,
        angles.view.undistorted(),
        "relative" if light_from is None else "absolute",
        scale,
        _circle(angles.view),
        white,
        angles.source,
        light_from or "nothing: relative",
        tuple(warnings),
    )


def projected(
    projection: Projection | None, hfov_degrees: float | None, width: int, height: int, /
) -> View | None:
    """A view of square pixels with its axis in the middle; None where neither is stated.

    A fish-eye without an angle is 180° across; a pinhole without one has to get it elsewhere.
    """
    if projection == "latlong":
        if hfov_degrees is not None and hfov_degrees != 360:
            raise InputError(
                f"a latlong picture is 360° across, got {hfov_degrees:g}", field="hfov_degrees"
            )
        return View("latlong", width, height)
    if hfov_degrees is None:
        if projection != "fisheye":
            return None
        hfov_degrees = 180.0
    most = 360.0 if projection == "fisheye" else 179.0
    if not 0.01 <= hfov_degrees <= most:
        raise InputError(f"must be 0.01…{most:g}°, got {hfov_degrees:g}", field="hfov_degrees")
    half = math.radians(hfov_degrees) / 2
    focal = width / 2 / (half if projection == "fisheye" else math.tan(half))
    middle = ((width - 1) / 2, (height - 1) / 2)
    return View(projection or "pinhole", width, height, focal, focal, *middle)


def _angles(picture: Picture, view: View | None, file: str) -> _Angles:
    height, width = picture.shape
    if view is not None:
        if view.shape != picture.shape:
            raise InputError(
                f"is {width}×{height} px, the view {view.width}×{view.height}", file=file
            )
        return _Angles(view, "stated")
    if picture.view_line is not None:
        read = radiance_view(picture.view_line, width, height, file=file)
        return _Angles(read.view, "VIEW line of the header", None, read.hemispherical)
    if picture.attributes.get("envmap") == "latlong":
        return _Angles(View("latlong", width, height), "envmap of the header")
    if picture.hfov_degrees is not None:
        found = projected("pinhole", picture.hfov_degrees, width, height)
        assert found is not None
        return _Angles(found, "focal length of the EXIF data")
    if width == 2 * height:
        return _Angles(View("latlong", width, height), "its shape, 2:1: latlong")
    found = projected("pinhole", DEFAULT_HFOV_DEGREES, width, height)
    assert found is not None
    return _Angles(
        found,
        "nothing: assumed",
        f"nothing says how wide the picture sees: taken as pinhole, {DEFAULT_HFOV_DEGREES:g}° "
        "across; state --camera, or --projection and --hfov-degrees",
    )


def _scale(picture: Picture, stated: float | None) -> tuple[float, str | None]:
    """cd/m² per unit, and where that comes from; None: from nowhere."""
    if stated is not None:
        if not (math.isfinite(stated) and stated > 0):
            raise InputError(f"must be > 0 and finite, got {stated:g}", field="luminance_scale")
        return stated, "stated"
    facts = picture.attributes
    if facts.get("andon:unit") == "cd/m2":
        absolute = facts.get("andon:photometry", "absolute") == "absolute"
        return 1.0, "andon:unit of the header" if absolute else None
    white = facts.get("whiteLuminance")
    if isinstance(white, int | float) and math.isfinite(white) and white > 0:
        return float(white), "whiteLuminance of the header"
    if picture.view_line is not None:
        return LUMENS_PER_WATT, "Radiance's 179 lm/W"
    return 1.0, None


def _white(picture: Picture) -> NDArray[np.bool_] | None:
    if picture.encoding == "linear":
        return None
    top = np.iinfo(picture.values.dtype).max - CLIPPED_CODES
    return np.asarray((picture.values >= top).any(axis=-1), bool)


def _undistorted(
    values: NDArray[np.float32], white: NDArray[np.bool_] | None, view: View
) -> tuple[NDArray[np.float32], NDArray[np.bool_] | None]:
    from andon.lenses import undistort

    straight = np.nan_to_num(undistort(values, view)).astype(np.float32)
    if white is None:
        return straight, None
    return straight, undistort(np.asarray(white, np.uint8), view, method="nearest") > 0


def _circle(view: View) -> NDArray[np.bool_] | None:
    """(H, W) what a circular fish-eye shows; None for views that fill their picture."""
    if view.projection != "fisheye":
        return None
    half = max(view.width / view.fx, view.height / view.fy) / 2
    if half < math.radians(CIRCLE_FROM_DEGREES) / 2:
        return None
    x, y = np.moveaxis(view.pixel_grid(), -1, 0)
    theta = np.hypot((x - view.cx) / view.fx, (y - view.cy) / view.fy)
    return theta <= min(half, math.pi)
