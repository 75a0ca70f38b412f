"""Host structs: needles as instances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.needles.model import REFERENCE_NM, WAVELENGTHS_NM, NeedleModel, Needles
from andon.glare.needles.reference import EXTENT, LEAST_HALF_WIDTH, MARGIN
from andon.gpu.layout import HostStruct
from andon.spaces import View

__all__ = [
    "NEEDLE_CONSTANTS",
    "NEEDLE_RECORD",
    "STRUCTS",
    "pack_constants",
    "pack_needles",
    "pixel_radians",
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
        ("first", "f32"),  # θ from which on, and up to which, pixels are drawn
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
        ("margin", "f32"),  # angle that a needle's light reaches beyond it
        ("least", "f32"),  # half-width of a tent in pixels
        ("extent", "f32"),  # of the mean along a needle in pixels
    ),
)

STRUCTS = {struct.name: struct for struct in (NEEDLE_RECORD, NEEDLE_CONSTANTS)}


def pixel_radians(view: View, /) -> float:
    """Angle that no pixel of `view` is wider than."""
    if view.projection == "latlong":
        return float(max(2 * np.pi / view.width, np.pi / view.height))
    return float(1 / min(view.fx, view.fy))


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
        margin=MARGIN * pixel_radians(view),
        least=LEAST_HALF_WIDTH,
        extent=EXTENT,
    )


def pack_needles(
    needles: Sequence[Needles], view: View, luminance_per_unit: float, /
) -> NDArray[Any]:
    """(n,) `NEEDLE_RECORD` of all needles of all sources."""
    margin = MARGIN * pixel_radians(view)
    records = np.zeros(sum(len(star) for star in needles), NEEDLE_RECORD.dtype)
    begin = 0
    for star in needles:
        part = records[begin : begin + len(star)]
        begin += len(star)
        reach = star.length_radians[:, None] * (WAVELENGTHS_NM / REFERENCE_NM)
        part["source"], part["along"] = star.direction, star.along
        part["start"], part["length"] = star.start_radians, star.length_radians
        part["light"] = star.illuminance_lux / luminance_per_unit
        part["half_width"], part["reach"] = star.half_width_radians, reach
        part["first"] = star.start_radians - margin
        part["last"] = star.start_radians + reach.max(axis=-1) + margin
    return records
