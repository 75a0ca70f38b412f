"""Host structs: needles as instances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.needles.model import REFERENCE_NM, WAVELENGTHS_NM, NeedleModel, Needles
from andon.glare.needles.reference import EXTENT, LEAST_HALF_WIDTH
from andon.glare.pixels import pixel_radians
from andon.gpu.layout import HostStruct
from andon.spaces import View

__all__ = [
    "MOST_PARTS",
    "NEEDLE_CONSTANTS",
    "NEEDLE_RECORD",
    "STRUCTS",
    "pack_constants",
    "pack_needles",
    "strip_pixels",
]

NEEDLE_RECORD = HostStruct(
    "NeedleRecord",
    (
        ("source", "vec3f"),  # direction, unit, camera
        ("start", "f32"),  # θ of the outline
        ("along", "vec3f"),  # unit, perpendicular to source
        ("length", "f32"),  # of light of 568 nm
        ("light", "vec3f"),  # lx in units of the picture
        ("half_width", "f32"),
        ("reach", "vec3f"),  # length of each channel
        ("first", "f32"),  # θ from which on, and below which, this part is drawn
        ("last", "f32"),
    ),
)

NEEDLE_CONSTANTS = HostStruct(
    "NeedleConstants",
    (
        ("power", "f32"),
        ("knee", "f32"),
        ("end", "f32"),  # of the profile, taken off so that it ends at 0
        ("scale", "f32"),  # 1/integral of the profile
        ("taper", "f32"),
        ("pixel", "f32"),  # angle that no pixel is wider than
        ("least", "f32"),  # half-width of a tent in pixels
        ("extent", "f32"),  # of the mean along a needle in pixels
    ),
)

# Where great circles bend a needle is drawn in boxes: parts so long are about as wide with their
# margins, and boxes of fewer and longer parts would hold more pixels that are dark.
PART_PIXELS, MOST_PARTS = 8.0, 32

STRUCTS = {struct.name: struct for struct in (NEEDLE_RECORD, NEEDLE_CONSTANTS)}


def pack_constants(model: NeedleModel, view: View, /) -> NDArray[Any]:
    """One `NEEDLE_CONSTANTS`."""
    end = (1 + 1 / model.knee) ** -model.power
    whole = model.knee / (model.power - 1) * (1 - (1 + 1 / model.knee) ** (1 - model.power)) - end
    return NEEDLE_CONSTANTS.pack(
        power=model.power,
        knee=model.knee,
        end=end,
        scale=1 / whole,
        taper=model.taper,
        pixel=pixel_radians(view),
        least=LEAST_HALF_WIDTH,
        extent=EXTENT,
    )


def pack_needles(
    needles: Sequence[Needles], view: View, luminance_per_unit: float, /
) -> NDArray[Any]:
    """(n,) `NEEDLE_RECORD` of all needles of all sources, each in its parts one after the other."""
    parts = [_parts(star, view) for star in needles]
    records = np.zeros(sum(int(counts.sum()) for counts in parts), NEEDLE_RECORD.dtype)
    begin = 0
    for star, counts in zip(needles, parts, strict=True):
        end = begin + int(counts.sum())
        _fill(records[begin:end], star, counts, pixel_radians(view))
        records["light"][begin:end] /= luminance_per_unit
        begin = end
    return records


def strip_pixels(needles: Sequence[Needles], view: View, /) -> float:
    """How many pixels the quads of all needles cover near the axis of a pinhole view."""
    pixel = pixel_radians(view)
    half = [np.maximum(star.half_width_radians, LEAST_HALF_WIDTH * pixel) for star in needles]
    areas = [
        (_whole(star, pixel) * (2 * side + pixel)).sum()
        for star, side in zip(needles, half, strict=True)
    ]
    return float(np.sum(areas)) / pixel**2


def _whole(star: Needles, pixel: float) -> NDArray[np.float64]:
    """(n,) angles from the first light of each needle to its last."""
    return star.length_radians * float(WAVELENGTHS_NM.max() / REFERENCE_NM) + EXTENT * pixel


def _parts(star: Needles, view: View) -> NDArray[np.int64]:
    """(n,) in how many parts each needle is drawn."""
    if view.projection == "pinhole":
        return np.ones(len(star), np.int64)
    pixel = pixel_radians(view)
    counts = np.ceil(_whole(star, pixel) / (PART_PIXELS * pixel))
    return np.clip(counts, 1, MOST_PARTS).astype(np.int64)


def _fill(records: NDArray[Any], star: Needles, parts: NDArray[np.int64], pixel: float) -> None:
    of = np.repeat(np.arange(len(star)), parts)
    place = np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts)
    first, whole = star.start_radians - EXTENT / 2 * pixel, _whole(star, pixel)
    records["source"], records["along"] = star.direction, star.along[of]
    records["start"], records["length"] = star.start_radians[of], star.length_radians[of]
    records["light"], records["half_width"] = star.illuminance_lux[of], star.half_width_radians[of]
    records["reach"] = (star.length_radians[:, None] * (WAVELENGTHS_NM / REFERENCE_NM))[of]
    # The end of a part and the beginning of the next are the same float, so no pixel is in both.
    records["first"] = first[of] + whole[of] * (place / parts[of])
    records["last"] = first[of] + whole[of] * ((place + 1) / parts[of])
