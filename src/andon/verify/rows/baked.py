"""Rows of baked light: frames with maps against Radiance at the frame's own points."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.display.ciede2000 import delta_e_2000, lab_of_linear
from andon.display.gaps import marked
from andon.files.pictures import write_png
from andon.pipeline import EngineName
from andon.responses import SRGB
from andon.verify.baked_room import (
    DIMMING,
    asked_pixels,
    baked_frame,
    captured_parts,
    relit_lux,
    white_cd_m2,
)
from andon.verify.psnr import psnr_db
from andon.verify.registry import Row

__all__ = ["ROWS", "added_error", "relit_difference"]

Float = NDArray[np.float64]

# Of this lamp there is direct light alone, in the rows that mix all three ways.
DIRECT = frozenset({"spot"})


@cache
def added_error(engine: EngineName) -> tuple[float, float, float]:
    """Median and 95th percentile of |ΔE − truth|/truth, and the share that no map sees.

    One lamp is direct, one baked, two are direct with a baked bounce. The photometric sum of three
    channels; shadow edges included.
    """
    frame, which = baked_frame(engine, direct=DIRECT), asked_pixels()
    truth = relit_lux(direct=DIRECT).sum(axis=1)
    ours = np.asarray(frame.illuminance.lux, np.float64)[which].sum(axis=1)
    error = np.abs(ours - truth) / truth
    assert frame.baked is not None
    _sheet(engine)
    return (
        float(np.median(error)),
        float(np.percentile(error, 95)),
        frame.baked.uncovered_share,
    )


@cache
def relit_difference(engine: EngineName) -> tuple[float, float, float]:
    """PSNR in dB of the relit picture, and mean and 95th percentile of ΔE₀₀, with all reflections.

    From an 8-bit photograph, at the pixels where the truth is known.
    """
    frame, which = baked_frame(engine), asked_pixels()
    reflectance, e0 = captured_parts()
    relit = reflectance[which] * (DIMMING * e0[which] + relit_lux()) / np.pi
    truth = np.clip(relit / white_cd_m2(), 0, 1)
    codes = np.asarray(SRGB.encode(truth) * 255 + 0.5, np.uint8) / 255
    ours = frame.image.rgb[which] / 255
    linear = np.asarray(SRGB.decode(ours), np.float64)
    off = delta_e_2000(lab_of_linear(linear), lab_of_linear(truth))
    return psnr_db(ours, codes), float(off.mean()), float(np.percentile(off, 95))


def _sheet(engine: EngineName) -> None:
    """Writes the relit picture beside what no map sees, where ANDON_SHEETS names a folder."""
    folder = os.environ.get("ANDON_SHEETS")
    frame = baked_frame(engine)
    if not folder or frame.baked is None:
        return
    Path(folder).mkdir(parents=True, exist_ok=True)
    gaps = marked(frame.image.rgb, frame.baked.uncovered)
    sheet = np.concatenate([frame.image.rgb, gaps], axis=1)
    write_png(Path(folder) / f"baked-{engine}.png", sheet)


ROOM = "Radiance at 250 pixels of the furnished room, each by itself, -ab 3, 1024 rays a hemisphere"


def _rows(engine: EngineName) -> tuple[Row, ...]:
    mixed = f"{ROOM}; spot direct, panel baked, ball and disk direct+bounce"
    relit = f"{ROOM}; four lamps with all reflections, 8-bit photograph"
    return (
        Row(f"baked.room.median.{engine}", "baked", 0.05, "relative", mixed,
            lambda: added_error(engine)[0]),
        Row(f"baked.room.p95.{engine}", "baked", None, "relative", mixed,
            lambda: added_error(engine)[1]),
        Row(f"baked.room.uncovered.{engine}", "baked", None, "share",
            "pixels that no map sees; four cameras found", lambda: added_error(engine)[2]),
        Row(f"baked.relit.psnr.{engine}", "baked", None, "dB", relit,
            lambda: relit_difference(engine)[0], at_least=True),
        Row(f"baked.relit.ciede2000.mean.{engine}", "baked", None, "ΔE₀₀", relit,
            lambda: relit_difference(engine)[1]),
        Row(f"baked.relit.ciede2000.p95.{engine}", "baked", None, "ΔE₀₀", relit,
            lambda: relit_difference(engine)[2]),
    )  # fmt: skip


ROWS: tuple[Row, ...] = (*_rows("reference"), *_rows("gpu"))
