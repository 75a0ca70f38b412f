"""Which bright spots of a picture are gaps between leaves.

::

    log luminance ─Otsu▶ bright ─ minus what a disc of LARGEST fits into ▶ spots ─▶ gaps
                                                                             └─ densest place

Sky between leaves is bright in small pieces. What is open on a larger scale (sky beside the tree, a
meadow in the sun) is bright as well and no gap; its outline has pieces that only look like some, so
spots must be surrounded by dark.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.flicker.gaps import gaps_of
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["among_leaves", "chosen"]

Float = NDArray[np.float64]
Labels = NDArray[np.int32]

# A gap has at most the area of a disc of this diameter, and nothing as wide as half of it fits in.
LARGEST_DEGREES = 0.8
# Nearer ones blur into one another.
APART_DEGREES = 0.8
# Gaps are counted within about this angle to find where they are densest.
AROUND_DEGREES = 5.0
# Light below this share of the picture's largest is black to Otsu's histogram.
DARKEST = 1e-4


def chosen(labels: Labels, solid_angles_sr: Float, most: int, /) -> Labels:
    """The `most` largest of the gaps 1…n of `labels`, numbered 1… in their order; 0 elsewhere."""
    if most < 1:
        raise InputError(f"must be ≥ 1, got {most}", field="gaps")
    area = np.bincount(labels.ravel(), solid_angles_sr.ravel())
    area[0] = 0
    return _kept(labels, np.sort(np.argsort(-area, kind="stable")[: min(most, len(area) - 1)]))


def among_leaves(
    luminance_cd_m2: Float, view: View, most: int, sun: Float | None = None, /
) -> Labels:
    """(H, W) 0, or 1 + the number of the gap: the `most` nearest to the `sun` (3,).

    None: it is where gaps are densest.
    """
    import cv2

    if most < 1:
        raise InputError(f"must be ≥ 1, got {most}", field="gaps")
    bright = np.asarray(_is_bright(photometric(luminance_cd_m2)), np.uint8)
    pixel = np.sqrt(float(np.median(view.solid_angles())))
    size = max(1, round(np.radians(LARGEST_DEGREES) / pixel / 4))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * size + 1, 2 * size + 1))
    wide = cv2.dilate(cv2.morphologyEx(bright, cv2.MORPH_OPEN, disc), np.ones((3, 3), np.uint8))
    spots = (bright > 0) & (wide == 0)
    if not spots.any():
        raise InputError(
            "shows no bright spots among leaves", field="picture", remedy="give a mask of the gaps"
        )
    found = gaps_of(spots)
    labels = _apart(found.labels, wide > 0)
    most_px = np.pi * (np.radians(LARGEST_DEGREES) / pixel / 2) ** 2
    labels = np.where(np.append(0, found.pixels)[labels] > most_px, 0, labels)
    towards_sun = _densest(labels, view, pixel) if sun is None else sun
    x, y = np.minimum(np.rint(found.middles).astype(int), np.array(view.shape[::-1]) - 1).T
    towards = view.directions()[y, x]
    off = np.linalg.norm(towards - towards_sun, axis=1)
    off[np.setdiff1d(np.arange(len(off)), np.unique(labels)[1:] - 1)] = np.inf
    order = np.argsort(off, kind="stable")
    order = order[np.isfinite(off[order])]
    taken = _spread(towards[order], np.radians(APART_DEGREES), most)
    return _kept(labels, np.sort(order[taken]) + 1)


def _densest(labels: Labels, view: View, pixel: float) -> Float:
    """(3,) where the gaps have most area within some 5°."""
    import cv2

    gaps = np.asarray(labels > 0, np.float32)
    near = cv2.GaussianBlur(gaps, (0, 0), np.radians(AROUND_DEGREES) / pixel)
    return view.directions().reshape(-1, 3)[int(np.argmax(near))]


def _spread(places: Float, apart: float, most: int) -> list[int]:
    """Numbers of the first `most` directions (n, 3) that are `apart` from those before them."""
    taken: list[int] = []
    for number, place in enumerate(places):
        if len(taken) == most:
            break
        if not taken or np.linalg.norm(places[taken] - place, axis=1).min() >= apart:
            taken.append(number)
    return taken


def _is_bright(luminance: Float) -> NDArray[np.bool_]:
    """Brighter than Otsu's threshold of log luminance, which splits a picture in two."""
    import cv2

    most = float(luminance.max())
    if not most > 0:
        raise InputError("is black", field="picture")
    logs = np.log(np.maximum(luminance / most, DARKEST)) / -np.log(DARKEST) + 1
    codes = np.asarray(np.rint(255 * logs), np.uint8)
    threshold, _ = cv2.threshold(codes, 0, 255, cv2.THRESH_OTSU)
    return codes > threshold


def _apart(labels: Labels, wide: NDArray[np.bool_]) -> Labels:
    """The spots that touch nothing wide: bays of an open sky are none."""
    import cv2

    beside = cv2.dilate(np.asarray(wide, np.uint8), np.ones((3, 3), np.uint8)) > 0
    return np.where(np.isin(labels, np.unique(labels[beside])), 0, labels)


def _kept(labels: Labels, numbers: NDArray[np.int64]) -> Labels:
    """Those labels alone, numbered anew from 1."""
    if not len(numbers):
        raise InputError(
            "shows no bright spots among leaves", field="picture", remedy="give a mask of the gaps"
        )
    table = np.zeros(int(labels.max()) + 1, np.int32)
    table[numbers] = np.arange(1, len(numbers) + 1)
    return table[labels]
