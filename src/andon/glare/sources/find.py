"""Bright regions of a picture as sources of glare.

What
    Connected pixels brighter than a threshold, each region with the direction, illuminance, solid
    angle and outline (an ellipse of its second moments) that it has *on the sphere*: over the
    seam and the poles of a latlong picture, too.
Threshold
    By default 40 times the ambient luminance, the gate of the glare paper for halo and needles.
    Ambient is the mean of what is not a source itself, so that one sun does not raise it.
Specks
    A real picture has thousands of regions of a few pixels (leaves, water, windows). The brightest
    region takes in what lies within `merge_degrees` of it, then the next; the `most` strongest by
    illuminance are kept. What is left over stays in the picture: only per-source treatment ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.gate import HIGHLIGHT_CONTRAST
from andon.glare.model import Outline, Source
from andon.glare.sources.moments import Moments, pixel_moments, sources_of
from andon.glare.sources.regions import connected_regions
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["FoundSources", "background_luminance", "find_sources"]

Float = NDArray[np.float64]

# Axes of an outline that is not taken for a circle, and of how many sources outlines are kept.
ELONGATED, SHAPED = 1.5, 4
# The mean without sources falls from round to round and the sources grow; real pictures take 3…12.
ROUNDS = 40


@dataclass(frozen=True, eq=False)
class FoundSources:
    """What was found.

    Attributes
    ----------
    sources : from the strongest at the eye to the weakest.
    solid_angle_sr : (n,) of each, the sum of its pixels'.
    labels : (H, W) int32, 0 where no kept source is, else its place in `sources` + 1.
    threshold_cd_m2 : what counts as bright.
    ambient_cd_m2 : mean luminance of what does not.
    regions : connected regions before merging.
    left_out : regions that were neither kept nor merged, and their share of the bright light.
    """

    sources: tuple[Source, ...]
    solid_angle_sr: Float
    labels: NDArray[np.int32]
    threshold_cd_m2: float
    ambient_cd_m2: float
    regions: int
    left_out: int
    left_out_share: float

    def simplified(self, shaped: int = SHAPED, /) -> tuple[Source, ...]:
        """The sources, round but for the elongated among the `shaped` strongest ones.

        A table of the veil around an outline takes a tenth of a second, that of a circle none.
        """
        return tuple(
            source if place < shaped and _elongated(source.outline) else source.rounded()
            for place, source in enumerate(self.sources)
        )

    @property
    def luminance_cd_m2(self) -> Float:
        """(n, 3) mean over each source's pixels."""
        lux = np.array([source.illuminance_lux for source in self.sources]).reshape(-1, 3)
        return lux / self.solid_angle_sr[:, None]


def find_sources(
    luminance_cd_m2: NDArray[np.floating],
    view: View,
    /,
    *,
    threshold_cd_m2: float | None = None,
    at_least_cd_m2: float = 0.0,
    merge_degrees: float = 0.5,
    most: int = 64,
    clipped: NDArray[np.bool_] | None = None,
) -> FoundSources:
    """The bright regions of a picture.

    Parameters
    ----------
    luminance_cd_m2 : (H, W, 3) finite, ≥ 0; any unit, if `at_least_cd_m2` is in the same.
    view : where the pixels look.
    threshold_cd_m2 : photometric luminance > 0 above which a pixel is bright; None: 40 × ambient.
    at_least_cd_m2 : the threshold is no lower, ≥ 0.
    merge_degrees : ≥ 0, see the module.
    most : sources that are kept, ≥ 1.
    clipped : (H, W) bool, pixels at the white of the camera: a source with one is `clipped`.

    Raises
    ------
    InputError
        if the picture has not the size of the view or is not finite.
    """
    light = _checked(luminance_cd_m2, view)
    bright = photometric(light)
    solid = view.solid_angles()
    background = background_luminance(bright, solid)
    threshold = HIGHLIGHT_CONTRAST * background if threshold_cd_m2 is None else threshold_cd_m2
    threshold = max(threshold, at_least_cd_m2, np.finfo(float).tiny)
    regions, count = connected_regions(bright > threshold, view)
    inside = np.flatnonzero(regions.ravel())
    region = regions.ravel()[inside] - 1
    omega = solid.ravel()[inside]
    moments = pixel_moments(
        view.directions().reshape(-1, 3)[inside],
        light.reshape(-1, 3)[inside],
        omega,
        region,
        count,
    )
    group, kept = _groups(moments, np.radians(merge_degrees), most)
    labels = np.zeros(view.shape, np.int32)
    labels.ravel()[inside] = group[region] + 1
    power = photometric(moments.illuminance_lux)
    return FoundSources(
        _named(sources_of(moments.merged(group, kept)), labels, clipped),
        np.bincount(labels.ravel()[inside], omega, kept + 1)[1:].astype(np.float64),
        labels,
        float(threshold),
        float(background),
        count,
        int(np.count_nonzero(group < 0)),
        float(power[group < 0].sum() / power.sum()) if count else 0.0,
    )


def background_luminance(
    luminance_cd_m2: Float, solid_angles_sr: Float, /, *, contrast: float = HIGHLIGHT_CONTRAST
) -> float:
    """Mean over (H, W) of what is at most `contrast` times that mean itself."""
    values, weights = luminance_cd_m2.ravel(), solid_angles_sr.ravel()
    kept = np.ones(len(values), bool)
    mean = 0.0
    for _ in range(ROUNDS):
        mean = float(np.average(values[kept], weights=weights[kept]))
        still = values <= contrast * mean
        if not still.any() or np.array_equal(still, kept):
            break
        kept = still
    return mean


def _checked(luminance: NDArray[np.floating], view: View) -> Float:
    light = np.asarray(luminance, np.float64)
    if light.shape != (*view.shape, 3):
        raise InputError(
            f"must be {view.height}×{view.width}×3 as the view, got {light.shape}",
            field="luminance_cd_m2",
        )
    if not np.isfinite(light).all() or light.min() < 0:
        raise InputError("must be finite and ≥ 0", field="luminance_cd_m2")
    return light


def _groups(moments: Moments, within: float, most: int) -> tuple[NDArray[np.int64], int]:
    """(regions,) which kept source each belongs to, −1: none; and how many are kept.

    Kept sources are in the order of their illuminance.
    """
    total = photometric(moments.illuminance_lux)
    middle = moments.first / np.maximum(np.linalg.norm(moments.first, axis=1), 1e-300)[:, None]
    group = np.full(len(moments), -1)
    kept = 0
    while kept < most and (group < 0).any():
        strongest = int(np.argmax(np.where(group < 0, total, -1.0)))
        near = np.linalg.norm(middle - middle[strongest], axis=1) <= 2 * np.sin(within / 2)
        near[strongest] = True
        group[(group < 0) & near] = kept
        kept += 1
    power = np.bincount(group[group >= 0], total[group >= 0], kept)
    place = np.empty(kept + 1, np.int64)
    place[np.argsort(-power, kind="stable")] = np.arange(kept)
    place[-1] = -1
    return place[group], kept


def _elongated(outline: Outline) -> bool:
    return bool(outline.radii_radians.max() > ELONGATED * outline.radii_radians.min())


def _named(
    sources: list[Source], labels: NDArray[np.int32], clipped: NDArray[np.bool_] | None
) -> tuple[Source, ...]:
    """The sources with their numbers as names, and flagged where a pixel of theirs is clipped."""
    flags = np.zeros(len(sources) + 1, bool)
    if clipped is not None:
        flags[labels[clipped]] = True
    return tuple(
        replace(source, name=f"found[{number}]", clipped=bool(flags[number + 1]))
        for number, source in enumerate(sources)
    )
