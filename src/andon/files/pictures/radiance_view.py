"""Radiance's VIEW line: which pixel of the picture looks where.

========= ================================ =============================================
type      Radiance's name                  here
========= ================================ =============================================
``-vtv``  perspective                      ``pinhole``
``-vta``  angular fish-eye, r ∝ θ          ``fisheye``
``-vth``  hemispherical fish-eye, r ∝ sin  ``fisheye``, after `from_hemispherical`
``-vtl``  parallel                         refused: all its pixels look in one direction
``-vtc``  cylindrical panorama             refused
``-vts``  planisphere (stereographic)      refused
========= ================================ =============================================

``-vh -vv`` are the angles across; ``-vs -vl`` shift the picture to the right and up, in its own
widths and heights. ``-vp -vd -vu`` and the others say nothing of where in the camera's frame a
pixel looks. Source: Radiance's manual of ``rpict`` and its file format notes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.spaces import View

__all__ = ["RadianceView", "from_hemispherical", "line_of_view", "radiance_view"]

# Radiance's own defaults.
ANGLES = {"-vh": 45.0, "-vv": 45.0, "-vs": 0.0, "-vl": 0.0}
REFUSED = {
    "l": "a parallel view has no angular scale; render it as -vtv or -vta",
    "c": "a cylindrical view is not read; warp it to -vta with Radiance's pinterp",
    "s": "a planisphere is not read; warp it to -vta with Radiance's pinterp",
}


@dataclass(frozen=True)
class RadianceView:
    """What a VIEW line says.

    Attributes
    ----------
    view : of the picture; of a hemispherical one after `from_hemispherical`.
    hemispherical : it has to be resampled first.
    """

    view: View
    hemispherical: bool = False


def radiance_view(line: str, width: int, height: int, /, *, file: str = "") -> RadianceView:
    """The view of a picture of `width` × `height` pixels whose header says ``VIEW=`` `line`.

    Raises
    ------
    InputError
        where the type of the view is not one of the first three above, or an angle is impossible.
    """
    kind, values = _parsed(line, file)
    if kind in REFUSED:
        raise InputError(f"is of type -vt{kind}", file=file, field="VIEW", remedy=REFUSED[kind])
    most = {"v": 180.0, "a": 360.0, "h": 180.0}.get(kind)
    if most is None:
        raise InputError(f"must be of type v, a or h, got {kind[:8]!r}", file=file, field="VIEW")
    across, up = values["-vh"], values["-vv"]
    for key in ("-vh", "-vv"):
        if not 0 < values[key] <= most or (kind == "v" and values[key] == most):
            raise InputError(
                f"{key} must be > 0° and at most {most:g}°, got {values[key]:g}",
                file=file,
                field="VIEW",
            )
    cx = (width - 1) / 2 - values["-vs"] * width
    cy = (height - 1) / 2 + values["-vl"] * height
    fx, fy = _focal(kind, width, across), _focal(kind, height, up)
    name = "pinhole" if kind == "v" else "fisheye"
    return RadianceView(View(name, width, height, fx, fy, cx, cy), hemispherical=kind == "h")


def line_of_view(view: View, /) -> str | None:
    """What a VIEW line says of `view`, so that `radiance_view` reads it back; None for latlong."""
    if view.projection == "latlong":
        return None
    half = [view.width / 2 / view.fx, view.height / 2 / view.fy]
    if view.projection == "pinhole":
        half = [math.atan(part) for part in half]
    across, up = (math.degrees(2 * part) for part in half)
    right = ((view.width - 1) / 2 - view.cx) / view.width
    lift = (view.cy - (view.height - 1) / 2) / view.height
    kind = "-vtv" if view.projection == "pinhole" else "-vta"
    return f"{kind} -vh {across:.9g} -vv {up:.9g} -vs {right:.9g} -vl {lift:.9g}"


def _focal(kind: str, side: int, degrees: float) -> float:
    half = math.radians(degrees) / 2
    return side / 2 / (math.tan(half) if kind == "v" else half)


def _parsed(line: str, file: str) -> tuple[str, dict[str, float]]:
    """The type and the numbers of `ANGLES`; of what is said twice the last counts."""
    kind, values = "v", dict(ANGLES)
    words = line.split()
    for place, word in enumerate(words):
        if word.startswith("-vt") and len(word) > 3:
            kind = word[3:]
        elif word in values:
            following = words[place + 1] if place + 1 < len(words) else ""
            try:
                values[word] = float(following)
            except ValueError:
                values[word] = math.nan
            if not math.isfinite(values[word]):
                raise InputError(
                    f"{word} must be a number, got {following[:20]!r}", file=file, field="VIEW"
                )
    return kind, values


def from_hemispherical(values: NDArray[np.float32], view: View, /) -> NDArray[np.float32]:
    """A ``-vth`` picture (H, W, 3) as the equidistant `view` (fisheye) of as many pixels sees it.

    Bilinear in luminance; what lies outside the old picture is 0. Both show the same directions
    at their rims, so that only what is between them moves.
    """
    import cv2

    x, y = np.moveaxis(view.pixel_grid(), -1, 0)
    x, y = (x - view.cx) / view.fx, (y - view.cy) / view.fy
    theta = np.hypot(x, y)
    # At the rims of the picture r is sin of half the angle across, which need not be 90°.
    half_x, half_y = view.width / 2 / view.fx, view.height / 2 / view.fy
    scale = np.sinc(theta / np.pi)  # sin θ / θ
    column = x * scale / math.sin(half_x) * view.width / 2 + view.cx
    row = y * scale / math.sin(half_y) * view.height / 2 + view.cy
    out = cv2.remap(
        np.ascontiguousarray(values, np.float32),
        column.astype(np.float32),
        row.astype(np.float32),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
    )
    out[theta > math.pi / 2] = 0
    return np.asarray(out, np.float32)
