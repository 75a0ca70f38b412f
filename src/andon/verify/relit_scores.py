"""How well every photograph of a set is predicted from every other one, beside cheaper ways.

========== =====================================================================================
method     predicts photograph j by
========== =====================================================================================
unchanged  photograph i
gain       photograph i times the number that fits j best: it is *told* j
ratio      Andon, without a picture of ρ: what is black in i stays black
relit      Andon
lambert    ρ·E_j, the same photometric stereo without any photograph
========== =====================================================================================

PSNR: peak 255 of linear codes, all three channels, pixels of the thing alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.pipeline import EngineName, render
from andon.scene import load_scene
from andon.verify.psnr import psnr_db
from andon.verify.relit_photographs import (
    LIGHT_LUX,
    Known,
    Photographs,
    known_without,
    photographs,
    write_pair,
)

__all__ = [
    "METHODS",
    "Pair",
    "best_gain",
    "pairs_of",
    "predictions",
    "relit",
    "score",
    "unlit",
]

Float = NDArray[np.float64]
Bytes = NDArray[np.uint8]

METHODS = ("unchanged", "gain", "ratio", "relit", "lambert")
# A pixel counts as unlit by a light whose cosine on it is below this: light of a twentieth shows
# a matte surface in some 9 of 255 codes.
UNLIT = 0.05


@dataclass(frozen=True)
class Pair:
    """Scores of one pair.

    Attributes
    ----------
    psnr_db, lit_psnr_db : of each method, in all pixels and in those that light i reaches.
    unlit_share : of the pixels, those that light i does not reach.
    """

    source: int
    target: int
    psnr_db: Mapping[str, float]
    lit_psnr_db: Mapping[str, float]
    unlit_share: float

    def over(self, baseline: str, method: str = "relit", *, lit_only: bool = False) -> float:
        """dB that `method` is better than `baseline`."""
        scores = self.lit_psnr_db if lit_only else self.psnr_db
        return scores[method] - scores[baseline]


def best_gain(shown: NDArray[np.generic], real: NDArray[np.generic], /) -> float:
    """The number by which `shown` fits `real` best, in least squares."""
    shown, real = np.asarray(shown, np.float64), np.asarray(real, np.float64)
    return float((shown * real).sum() / (shown**2).sum())


def unlit(shots: Photographs, known: Known, light: int, /) -> NDArray[np.bool_]:
    """(n,) pixels of the thing that a light does not reach, by the normals."""
    return known.normals[shots.mask] @ shots.directions[light] < UNLIT


def predictions(
    folder: Path, shots: Photographs, known: Known, source: int, engine: EngineName, /
) -> dict[str, Bytes]:
    """Photograph `known.target` from photograph `source` by each of `METHODS`: (H, W, 3) codes."""
    photo, real = shots.codes[source], shots.codes[known.target]
    gain = best_gain(photo[shots.mask], real[shots.mask])
    cosine = np.maximum(known.normals @ shots.directions[known.target], 0)
    received = known.rest_lux + (known.lux[known.target] * np.nan_to_num(cosine))[..., None]
    return {
        "unchanged": photo,
        "gain": _codes(photo / 255 * gain),
        "ratio": relit(write_pair(folder, shots, known, source, with_map=False), engine),
        "relit": relit(write_pair(folder, shots, known, source), engine),
        "lambert": _codes(known.reflectance * received / LIGHT_LUX),
    }


def relit(scene: Path, engine: EngineName, /) -> Bytes:
    """(H, W, 3) codes of a scene."""
    return render(load_scene(scene), engine=engine).image.rgb


def _codes(linear: Float) -> Bytes:
    return np.rint(np.clip(linear, 0, 1) * 255).astype(np.uint8)


def score(shots: Photographs, known: Known, source: int, predicted: Mapping[str, Bytes], /) -> Pair:
    """Compares what was predicted with photograph `known.target`."""
    real = shots.codes[known.target][shots.mask]
    lit = ~unlit(shots, known, source)
    shown = {name: picture[shots.mask] for name, picture in predicted.items()}
    return Pair(
        source,
        known.target,
        {name: psnr_db(codes, real, peak=255) for name, codes in shown.items()},
        {name: psnr_db(codes[lit], real[lit], peak=255) for name, codes in shown.items()},
        float(1 - lit.mean()),
    )


@cache
def pairs_of(name: str, /) -> tuple[Pair, ...]:
    """All 132 ordered pairs of a thing, by the reference engine."""
    shots = photographs(name)
    pairs: list[Pair] = []
    for target in range(len(shots.codes)):
        known = known_without(shots, target)
        with TemporaryDirectory() as folder:
            for source in shots.others(target).tolist():
                predicted = predictions(Path(folder), shots, known, source, "reference")
                pairs.append(score(shots, known, source, predicted))
    return tuple(pairs)
