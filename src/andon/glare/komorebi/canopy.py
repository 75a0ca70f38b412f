"""Leaves and the gaps between them, as a picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.komorebi.leaves import behind_gaps, lit_leaves
from andon.glare.komorebi.select import among_leaves, chosen
from andon.lamps.flicker.gaps import gaps_of
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["Canopy", "canopy_of_list", "canopy_of_mask", "canopy_of_picture"]

Float = NDArray[np.float64]

# An open sky and backlit leaves of a mask, which says nothing of light.
SKY_CD_M2 = 6000.0
# Of a picture's pixels so many are darker than the sky that shows between leaves, %.
SKY_PERCENTILE = 99.0


@dataclass(frozen=True, eq=False)
class Canopy:
    """A canopy as one eye sees it.

    Attributes
    ----------
    view : of the picture.
    leaves_cd_m2 : (H, W, 3) with all gaps closed.
    pixels : (m,) places of the gaps' pixels in the flattened picture, gap by gap, each from its
        middle to its outline.
    gap : (m,) number of the gap that each belongs to, rising.
    directions : (n, 3) unit, middles, camera frame.
    solid_angles_sr : (n,) of the wholly open gaps.
    sky_cd_m2 : of what is open to the sky beside the sun.
    """

    view: View
    leaves_cd_m2: Float
    pixels: NDArray[np.int64]
    gap: NDArray[np.int64]
    directions: Float
    solid_angles_sr: Float
    sky_cd_m2: float

    def __len__(self) -> int:
        return len(self.directions)

    def picture(self, open_shares: Float, luminance_cd_m2: Float, /) -> Float:
        """(H, W, 3) cd/m² where gap i is open by `open_shares[i]` and shows `luminance_cd_m2`."""
        cover = self.covers(open_shares)[:, None]
        found = self.leaves_cd_m2.copy()
        flat = found.reshape(-1, 3)
        flat[self.pixels] += cover * (luminance_cd_m2 - flat[self.pixels])
        return found

    def covers(self, open_shares: Float, /) -> Float:
        """(m,) share of each of `pixels` that is open; over a gap they sum to its share of area."""
        solid = self.view.solid_angles().ravel()[self.pixels]
        ends = np.cumsum(solid)
        first = np.searchsorted(self.gap, np.arange(len(self)))
        before = np.concatenate([[0.0], ends])[first]
        open_sr = (open_shares * self.solid_angles_sr)[self.gap]
        return np.clip((open_sr - (ends - solid - before[self.gap])) / solid, 0, 1)


def canopy_of_mask(is_open: NDArray[np.bool_], view: View, /, *, most: int = 500) -> Canopy:
    """Gaps where a mask (H, W) is white, between leaves that are made up.

    The `most` largest gaps; the others are closed. Raises `InputError` for a mask without a gap or
    of another size than the view.
    """
    _check(np.shape(is_open), view)
    labels = chosen(gaps_of(is_open).labels, view.solid_angles(), most)
    return _canopy(lit_leaves(view.shape, SKY_CD_M2), labels, view, SKY_CD_M2)


def canopy_of_list(gaps_degrees: Float, view: View, /, *, most: int = 500) -> Canopy:
    """Round gaps (n, 3) of azimuth, elevation and diameter, as `read_gap_list` has them.

    A gap has at least the pixel in its middle. Raises `InputError` where none is in the view.
    """
    azimuth, elevation, diameter = np.radians(gaps_degrees).T
    level = np.cos(elevation)
    middles = np.stack(
        [level * np.sin(azimuth), -np.sin(elevation), level * np.cos(azimuth)], axis=-1
    )
    towards, pixel = view.directions(), np.sqrt(view.solid_angles())
    is_open = np.zeros(view.shape, bool)
    for middle, across in zip(middles, diameter, strict=True):
        off = np.linalg.norm(towards - middle, axis=-1)
        nearest = np.unravel_index(int(np.argmin(off)), view.shape)
        is_open |= off <= 2 * np.sin(across / 4)
        is_open[nearest] |= off[nearest] <= pixel[nearest]
    return canopy_of_mask(is_open, view, most=most)


def canopy_of_picture(
    luminance_cd_m2: NDArray[np.float64],
    view: View,
    /,
    *,
    most: int = 40,
    sun: Float | None = None,
) -> Canopy:
    """Gaps where bright sky shows between dark leaves of a picture (H, W, 3), finite and ≥ 0.

    The `most` of them nearest to the sun flicker, the sky elsewhere stays. The `sun` is in the
    direction (3,), or, None, where such spots are densest. See `select`.
    Raises `InputError` where there are none, or for a picture of another size than the view.
    """
    _check(np.shape(luminance_cd_m2)[:2], view)
    labels = among_leaves(luminance_cd_m2, view, most, sun)
    sky = float(np.percentile(photometric(luminance_cd_m2), SKY_PERCENTILE))
    return _canopy(behind_gaps(luminance_cd_m2, labels > 0), labels, view, sky)


def _canopy(leaves: Float, labels: NDArray[np.int32], view: View, sky: float) -> Canopy:
    import cv2

    inside = np.asarray(labels > 0, np.uint8)
    depth = cv2.distanceTransform(inside, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    places = np.flatnonzero(inside)
    gap = labels.ravel()[places].astype(np.int64) - 1
    count = int(gap.max()) + 1
    solid = view.solid_angles().ravel()[places]
    towards = view.directions().reshape(-1, 3)[places]
    summed = np.stack([np.bincount(gap, solid * towards[:, k], count) for k in range(3)], axis=-1)
    middles = summed / np.linalg.norm(summed, axis=1, keepdims=True)
    # Deepest first; among equals those nearer to the middle, so that spots are round.
    off = np.linalg.norm(towards - middles[gap], axis=1)
    order = np.lexsort((off, -depth.ravel()[places], gap))
    areas = np.bincount(gap, solid, count).astype(np.float64)
    return Canopy(view, leaves, places[order], gap[order], middles, areas, sky)


def _check(shape: tuple[int, ...], view: View) -> None:
    if tuple(shape) != view.shape:
        raise InputError(
            f"must be {view.width}×{view.height} px as the view, got {shape[1]}×{shape[0]}",
            field="picture",
        )
