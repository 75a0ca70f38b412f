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

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.model import Outline, Source
from andon.quantities import photometric
from andon.spaces import View, perpendicular

__all__ = ["HIGHLIGHT_CONTRAST", "FoundSources", "background_luminance", "find_sources"]

Float = NDArray[np.float64]

HIGHLIGHT_CONTRAST = 40.0
# Corners of the outline's table; an ellipse of axes 8:1 is then within 0.5 % of its radii.
CORNERS = 64
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
    regions, count = _regions(bright > threshold, view)
    inside = np.flatnonzero(regions.ravel())
    pixels = _Pixels(
        inside,
        regions.ravel()[inside] - 1,
        view.directions().reshape(-1, 3)[inside],
        solid.ravel()[inside],
        light.reshape(-1, 3)[inside],
    )
    group, kept = _merged(pixels, count, np.radians(merge_degrees), most)
    labels = np.zeros(view.shape, np.int32)
    labels.ravel()[inside] = group[pixels.region] + 1
    flags = np.zeros(kept, bool) if clipped is None else _flags(labels, clipped, kept)
    of_group = group[pixels.region]
    sources = tuple(_source(pixels, of_group == i, f"found[{i}]", flags[i]) for i in range(kept))
    power = photometric(pixels.light) * pixels.solid
    return FoundSources(
        sources,
        np.bincount(of_group[of_group >= 0], pixels.solid[of_group >= 0], kept),
        labels,
        float(threshold),
        float(background),
        count,
        int(np.count_nonzero(group < 0)),
        float(power[of_group < 0].sum() / power.sum()) if len(power) else 0.0,
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


@dataclass(frozen=True, eq=False)
class _Pixels:
    """The bright ones: place (n,), region from 0 (n,), direction (n, 3), sr (n,), cd/m² (n, 3)."""

    place: NDArray[np.intp]
    region: NDArray[np.int32]
    direction: Float
    solid: Float
    light: Float


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


def _regions(bright: NDArray[np.bool_], view: View) -> tuple[NDArray[np.int32], int]:
    """(H, W) numbers from 1 of regions that touch, also diagonally, and how many there are."""
    import cv2

    count, found = cv2.connectedComponents(bright.astype(np.uint8), connectivity=8)
    labels = np.asarray(found, np.int32)
    if view.projection != "latlong":
        return labels, count - 1
    pairs: list[tuple[int, int]] = []
    for shift in (-1, 0, 1):
        pairs += zip(labels[:, 0].tolist(), np.roll(labels[:, -1], shift).tolist(), strict=True)
    # The pixels of the first row all touch at the pole, and those of the last row at the other.
    for row in (labels[0], labels[-1]):
        lit = row[row > 0].tolist()
        pairs += [(lit[0], other) for other in lit[1:]]
    return _united(labels, count, pairs)


def _united(
    labels: NDArray[np.int32], count: int, pairs: list[tuple[int, int]]
) -> tuple[NDArray[np.int32], int]:
    """The labels with the pairs made one, numbered anew without gaps."""
    parent = list(range(count))

    def root(label: int) -> int:
        while parent[label] != label:
            parent[label] = parent[parent[label]]
            label = parent[label]
        return label

    for first, second in pairs:
        if first > 0 and second > 0:
            parent[max(root(first), root(second))] = min(root(first), root(second))
    roots = np.array([root(label) for label in range(count)])
    names, numbers = np.unique(roots, return_inverse=True)
    return numbers.astype(np.int32)[labels], len(names) - 1


def _merged(pixels: _Pixels, count: int, within: float, most: int) -> tuple[NDArray[np.int64], int]:
    """(count,) which kept source each region belongs to, −1: none; and how many are kept."""
    group = np.full(count, -1)
    if count == 0:
        return group, 0
    power = photometric(pixels.light) * pixels.solid
    total = np.bincount(pixels.region, power, count)
    middle = np.stack(
        [np.bincount(pixels.region, power * pixels.direction[:, i], count) for i in range(3)], -1
    )
    middle /= np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), 1e-300)
    for kept in range(most):
        free = group < 0
        if not free.any():
            return group, kept
        strongest = int(np.argmax(np.where(free, total, -1.0)))
        near = np.linalg.norm(middle - middle[strongest], axis=1) <= 2 * np.sin(within / 2)
        near[strongest] = True
        group[free & near] = kept
    return group, most


def _flags(labels: NDArray[np.int32], clipped: NDArray[np.bool_], kept: int) -> NDArray[np.bool_]:
    return np.bincount(labels[clipped], minlength=kept + 1)[1:] > 0


def _source(pixels: _Pixels, chosen: NDArray[np.bool_], name: str, clipped: bool) -> Source:
    """One source from its pixels.

    The outline is the ellipse of the second moments of the light, scaled to the solid angle of
    the pixels, so that E/ω is their mean luminance.
    """
    direction, solid = pixels.direction[chosen], pixels.solid[chosen]
    light = pixels.light[chosen]
    power = photometric(light) * solid
    centre = power @ direction
    centre /= np.linalg.norm(centre)
    right, down = perpendicular(centre)
    place = direction @ np.stack([right, down], axis=1)
    weight = power / power.sum()
    # A pixel is no point: its own second moment is ω/12 along either axis.
    moments = (weight[:, None] * place).T @ place + np.eye(2) * (weight @ solid) / 12
    moments -= np.outer(weight @ place, weight @ place)
    variances, axes = np.linalg.eigh(moments)
    long, short = np.sqrt(np.maximum(variances[::-1], 1e-20))
    major = axes[0, 1] * right + axes[1, 1] * down
    scale = np.sqrt(solid.sum() / (np.pi * long * short))
    outline = Outline(_ellipse(min(long * scale, 1.5), min(short * scale, 1.5)), "ellipse")
    return Source(centre, solid @ light, outline, right=major, name=name, clipped=bool(clipped))


def _ellipse(long: float, short: float) -> Float:
    phi = 2 * np.pi * np.arange(CORNERS) / CORNERS
    return long * short / np.hypot(short * np.cos(phi), long * np.sin(phi))
