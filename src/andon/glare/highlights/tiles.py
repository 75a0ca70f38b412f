"""Highlights as sources of glare: sums over small tiles, merged into blobs on the host.

::

    picture ─survey▶ tiles: peak, surround ─ambient_luminance▶ threshold
            ─light▶  tiles: Σ L·ω, Σ Y·ω·(x, y, x², y², xy) ─sources_of_tiles▶ [Source]

Both engines give the same tiles; the host does the rest. x and y are components on two tangents of
a tile's own middle (`outlines.frames`), so that float32 holds the width of a highlight of a
milliradian, which squares of whole directions do not.

A pixel's light counts by a smooth step about the threshold, and every tile with light belongs to a
blob with its eight neighbours. So what a blob sends to the eye is a sum over pixels that knows no
tiles: it does not jump when the blob moves over their borders.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.highlights.contrast import AmbientLevel, ambient_luminance, contrast
from andon.glare.highlights.outlines import frames
from andon.glare.model import Source
from andon.glare.sources.moments import Moments, sources_of
from andon.quantities import photometric
from andon.spaces import View

__all__ = [
    "SIDE_PX",
    "Highlight",
    "LightTiles",
    "SurveyTiles",
    "highlights_of_tiles",
    "light_tiles",
    "sources_of_tiles",
    "survey_tiles",
    "threshold_cd_m2",
    "tile_middles",
]

Float = NDArray[np.float64]

SIDE_PX = 8
# The threshold of a blob, as a share of what glares at all: its foot carries little light.
FOOT = 0.1


@dataclass(frozen=True, eq=False)
class SurveyTiles:
    """What there is before anything is chosen.

    Attributes
    ----------
    peak_cd_m2 : (r, c) brightest highlight.
    surround : (r, c) Σ Y·ω of the picture without highlights, lx.
    solid_angle_sr : (r, c).
    """

    peak_cd_m2: Float
    surround: Float
    solid_angle_sr: Float

    def ambient(self, probe_lux: Float | None, gate: float) -> AmbientLevel:
        """I_a, see `ambient_luminance`."""
        solid = self.solid_angle_sr.ravel()
        mean = self.surround.ravel() / np.maximum(solid, 1e-30)
        return ambient_luminance(mean, solid, probe_lux=probe_lux, gate=gate)


@dataclass(frozen=True, eq=False)
class LightTiles:
    """Highlights above the threshold.

    Attributes
    ----------
    illuminance_lux : (r, c, 3) Σ L·ω.
    sums : (r, c, 5) Σ Y·ω·(x, y, x² + ω/12, y² + ω/12, xy).
    """

    illuminance_lux: Float
    sums: Float


@dataclass(frozen=True)
class Highlight:
    """A source, the greatest luminance in it, and that over the ambient level."""

    source: Source
    peak_cd_m2: float
    contrast: float
    glares: bool


def tile_middles(view: View, /) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows (r,) and columns (c,) of the pixels in the middles of the tiles."""
    return tuple(  # type: ignore[return-value]
        np.minimum(np.arange(0, size, SIDE_PX) + SIDE_PX // 2, size - 1) for size in view.shape
    )


def threshold_cd_m2(ambient: AmbientLevel, gate: float, /) -> float:
    """From where on light belongs to a highlight."""
    return FOOT * gate * ambient.cd_m2


def survey_tiles(view: View, luminance_cd_m2: Float, highlights_cd_m2: Float, /) -> SurveyTiles:
    """The survey of a picture (H, W, 3) and its highlights alone (H, W, 3)."""
    omega = view.solid_angles()
    rest = np.maximum(photometric(luminance_cd_m2) - photometric(highlights_cd_m2), 0)
    peak = _blocks(photometric(highlights_cd_m2)).max(axis=(1, 3))
    return SurveyTiles(peak, _sum(rest * omega), _sum(omega))


def light_tiles(view: View, highlights_cd_m2: Float, threshold: float, /) -> LightTiles:
    """The light of highlights (H, W, 3) above `threshold` in cd/m²."""
    value, omega = photometric(highlights_cd_m2), view.solid_angles()
    step = np.clip(value / threshold - 0.5, 0, 1)
    omega_kept = omega * step * step * (3 - 2 * step)
    weight = value * omega_kept
    directions = view.rays_world()[1]
    a, b = (
        np.repeat(np.repeat(axis, SIDE_PX, 0), SIDE_PX, 1)[: view.height, : view.width]
        for axis in frames(_middle_directions(view))
    )
    x, y = (np.einsum("hwi,hwi->hw", directions, axis) for axis in (a, b))
    own = omega / 12
    sums = [weight * part for part in (x, y, x * x + own, y * y + own, x * y)]
    light = [omega_kept * highlights_cd_m2[..., channel] for channel in range(3)]
    return LightTiles(
        np.stack([_sum(part) for part in light], -1), np.stack([_sum(part) for part in sums], -1)
    )


def _middle_directions(view: View) -> Float:
    rows, columns = tile_middles(view)
    return view.rays_world()[1][np.ix_(rows, columns)]


def _blocks(values: Float) -> Float:
    height, width = (-(-size // SIDE_PX) for size in values.shape)
    padded = np.zeros((height * SIDE_PX, width * SIDE_PX))
    padded[: values.shape[0], : values.shape[1]] = values
    return padded.reshape(height, SIDE_PX, width, SIDE_PX)


def _sum(values: Float) -> Float:
    return _blocks(values).sum(axis=(1, 3))


def highlights_of_tiles(
    light: LightTiles, survey: SurveyTiles, ambient: AmbientLevel, view: View, gate: float, /
) -> list[Highlight]:
    """The highlights of a view, from the strongest at the eye to the weakest."""
    moments = _moments(light, survey, view)
    labels, count = _labels(photometric(light.illuminance_lux) > 0, view)
    blobs = moments.merged(labels.ravel() - 1, count)
    found: list[Highlight] = []
    for blob in range(count):
        alone = blobs.merged(np.where(np.arange(count) == blob, 0, -1), 1)
        for source in sources_of(alone, name="highlight"):
            peak = float(alone.peak_cd_m2[0])
            ratio = float(contrast(peak, ambient.cd_m2))
            found.append(Highlight(source, peak, ratio, ratio >= gate))
    return sorted(found, key=lambda one: -float(photometric(one.source.illuminance_lux)))


def sources_of_tiles(
    light: LightTiles, survey: SurveyTiles, ambient: AmbientLevel, view: View, gate: float, /
) -> list[Source]:
    """The sources that pass the gate: those that have a halo and needles."""
    found = highlights_of_tiles(light, survey, ambient, view, gate)
    return [one.source for one in found if one.glares]


def _moments(light: LightTiles, survey: SurveyTiles, view: View) -> Moments:
    """One blob for each tile, in the camera frame."""
    middle = _middle_directions(view).reshape(-1, 3)
    a, b = frames(middle)
    x, y, xx, yy, xy = np.moveaxis(light.sums.reshape(-1, 5), -1, 0)
    lux = light.illuminance_lux.reshape(-1, 3)
    weight = photometric(lux)
    # d = √(1 − x² − y²)·middle + x·a + y·b, to the second degree.
    along = weight - (xx + yy) / 2
    first = along[:, None] * middle + x[:, None] * a + y[:, None] * b
    basis = np.stack([a, b, middle], axis=-1)
    local = np.stack(
        [
            np.stack([xx, xy, x], -1),
            np.stack([xy, yy, y], -1),
            np.stack([x, y, weight - xx - yy], -1),
        ],
        axis=-2,
    )
    second = basis @ local @ np.swapaxes(basis, -1, -2)
    turn = view.world_from_camera[:3, :3]
    peak = survey.peak_cd_m2.ravel()
    return Moments(lux, first @ turn, turn.T @ second @ turn, peak)


def _labels(lit: NDArray[np.bool_], view: View) -> tuple[NDArray[np.int32], int]:
    """(r, c) blob of each tile from 1 on, 0 for none, and how many; latlong closes at its seam."""
    import cv2

    count, labels = cv2.connectedComponents(lit.astype(np.uint8), connectivity=8)
    labels = np.asarray(labels, np.int32)
    if view.projection == "latlong":
        for row in range(len(labels)):
            for other in labels[max(row - 1, 0) : row + 2, -1]:
                if labels[row, 0] and other and labels[row, 0] != other:
                    labels[labels == other] = labels[row, 0]
    return labels, count - 1
