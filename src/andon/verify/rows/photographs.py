"""Real photographs of one thing, each relit into every other one."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from andon.verify.photometric_stereo import photometric_stereo
from andon.verify.registry import Row
from andon.verify.relit_photographs import known_without, photographs, write_pair
from andon.verify.relit_scores import METHODS, pairs_of, relit

__all__ = ["ROWS", "median_over_gain", "median_psnr", "normals_error", "parity", "unlit_share"]

# dB over the best global gain, in the median of the pairs.
BARS = {"sphere": 7.0, "cat": 3.0}
# From lights in front to the one most at the side, back, and between neighbours.
PARITY_PAIRS = (("sphere", 2, 0), ("sphere", 0, 10), ("cat", 0, 4), ("cat", 7, 8))


def median_over_gain(name: str, /, *, lit_only: bool = False) -> float:
    """dB by which Andon is nearer to the photograph than the best global gain is."""
    return float(np.median([pair.over("gain", lit_only=lit_only) for pair in pairs_of(name)]))


def median_psnr(name: str, method: str, /) -> float:
    """PSNR of a method in dB."""
    return float(np.median([pair.psnr_db[method] for pair in pairs_of(name)]))


def unlit_share(name: str, /) -> float:
    """Of a thing's pixels those that its photograph's light does not reach: mean of the pairs."""
    return float(np.mean([pair.unlit_share for pair in pairs_of(name)]))


@cache
def normals_error() -> float:
    """Degrees between fitted normals and those of a ball that fills the sphere's mask: median."""
    shots = photographs("sphere")
    rows, columns = np.nonzero(shots.mask)
    radius = np.sqrt(len(rows) / np.pi)
    x, y = (columns - columns.mean()) / radius, -(rows - rows.mean()) / radius
    inside = np.hypot(x, y) < 1
    ball = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=1)
    fitted = photometric_stereo(shots.values, shots.directions).normals
    cosine = (ball * fitted).sum(axis=1)[inside]
    return float(np.degrees(np.median(np.arccos(np.clip(cosine, -1, 1)))))


def parity() -> float:
    """Largest difference of both engines in codes, over `PARITY_PAIRS`."""
    largest = 0
    for name, source, target in PARITY_PAIRS:
        shots = photographs(name)
        with TemporaryDirectory() as folder:
            scene = write_pair(Path(folder), shots, known_without(shots, target), source)
            ours, truth = relit(scene, "gpu").astype(int), relit(scene, "reference").astype(int)
        largest = max(largest, int(np.abs(ours - truth).max()))
    return float(largest)


PAIRS = "132 pairs of real photographs (psm_uw), median"
MEANING = {
    "unchanged": "photograph i itself",
    "gain": "photograph i times the factor that fits j best",
    "ratio": "Andon without a picture of ρ",
    "relit": "Andon",
    "lambert": "ρ·E of photometric stereo, no photograph",
}


def _rows(name: str) -> tuple[Row, ...]:
    stem = f"relight.photograph.{name}"
    over = f"{PAIRS}, over the best global gain"
    return (
        Row(stem, "relight", BARS[name], "dB", over, lambda: median_over_gain(name), at_least=True),
        Row(
            f"{stem}_lit",
            "relight",
            None,
            "dB",
            f"{over}; pixels that light i reaches",
            lambda: median_over_gain(name, lit_only=True),
            at_least=True,
        ),
        Row(
            f"{stem}_unlit_share",
            "relight",
            None,
            "of the pixels",
            "the normals: pixels that light i does not reach, mean",
            lambda: unlit_share(name),
        ),
        *(_psnr_row(name, method) for method in METHODS),
    )


def _psnr_row(name: str, method: str) -> Row:
    return Row(
        f"relight.photograph.{name}_psnr.{method}",
        "relight",
        None,
        "dB PSNR",
        f"{PAIRS}: {MEANING[method]}",
        lambda: median_psnr(name, method),
        at_least=True,
    )


ROWS: tuple[Row, ...] = (
    *_rows("sphere"),
    *_rows("cat"),
    Row(
        "relight.photograph.normals",
        "relight",
        None,
        "degrees",
        "the shape of a ball: photometric stereo on 12 real photographs, median",
        normals_error,
    ),
    Row(
        "relight.photograph.parity",
        "relight",
        1,
        "of 255 codes",
        "the reference on four pairs of real photographs, largest difference",
        parity,
    ),
)
