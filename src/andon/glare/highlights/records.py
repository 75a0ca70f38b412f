"""Host structs of highlights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.highlights.model import Finish
from andon.gpu.layout import HostStruct

__all__ = ["FINISH_RECORD", "STRUCTS", "WAVE_RECORD", "pack_finishes", "pack_waves"]

FINISH_RECORD = HostStruct(
    "FinishRecord",
    (
        ("axis", "vec3f"),  # 0: none
        ("kind", "f32"),  # 0 diffuse, then as KINDS
        ("straight", "vec3f"),  # Phong's I_s; below 0: from the base colour
        ("exponent", "f32"),
        ("alpha", "vec2f"),
        ("metallic", "f32"),
        ("around", "f32"),
        ("index", "f32"),
        ("takes_lamps", "f32"),
        ("first_wave", "f32"),
        ("waves", "f32"),
    ),
)

WAVE_RECORD = HostStruct(
    "WaveRecord",
    (
        ("number", "vec2f"),  # rad/m along x and z
        ("slope", "f32"),
        ("phase", "f32"),  # radians at this moment
    ),
)

STRUCTS = {struct.name: struct for struct in (FINISH_RECORD, WAVE_RECORD)}

KINDS = ("cook-torrance", "phong", "water")


def pack_finishes(finishes: Sequence[Finish | None], /) -> NDArray[Any]:
    """One `FINISH_RECORD` for each slot."""
    table = np.zeros(max(1, len(finishes)), FINISH_RECORD.dtype)
    first = 0
    for slot, finish in enumerate(finishes):
        if finish is None:
            continue
        count = 0 if finish.waves is None else len(finish.waves.slope)
        table[slot] = FINISH_RECORD.pack(
            axis=np.zeros(3) if finish.axis is None else finish.axis,
            kind=KINDS.index(finish.kind) + 1,
            straight=(-1.0,) * 3 if finish.reflectance is None else finish.reflectance,
            exponent=finish.exponent,
            alpha=finish.alpha,
            metallic=finish.metallic,
            around=finish.around,
            index=finish.index,
            takes_lamps=finish.takes_lamps,
            first_wave=first,
            waves=count,
        )[0]
        first += count
    return table


def pack_waves(finishes: Sequence[Finish | None], time_seconds: float, /) -> NDArray[Any]:
    """One `WAVE_RECORD` for each ripple; phases at a time, which float32 would not hold."""
    found = [f.waves for f in finishes if f is not None and f.waves is not None]
    table = np.zeros(max(1, sum(len(waves.slope) for waves in found)), WAVE_RECORD.dtype)
    first = 0
    for waves in found:
        rows = table[first : first + len(waves.slope)]
        rows["number"], rows["slope"] = waves.number, waves.slope
        phase = waves.phase - waves.frequency * time_seconds
        rows["phase"] = np.mod(phase, 2 * np.pi)
        first += len(waves.slope)
    return table
