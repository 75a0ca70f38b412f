"""Real photographs relit into one another: every pair as a number, and some as pictures.

python examples/photometric_stereo/figures.py -o OUT

Needs ``ANDON_DATA``, the folder that holds psm_uw; takes about two minutes. Writes for both things
``NAME-pairs.png`` (dB over the best global gain), ``NAME-examples.png``, and ``pairs.csv``; with
``--scenes`` instead ``NAME/NAME-I-J.toml`` for every pair, for ``andon relight --scene``.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.display.false_colour import GAP_PX, contact_sheet
from andon.files.pictures.write import write_png
from andon.responses import srgb_encode
from andon.verify.relit_photographs import (
    OBJECTS,
    Photographs,
    known_without,
    photographs,
    write_pair,
)
from andon.verify.relit_scores import METHODS, Pair, pairs_of, predictions, score

Rgb = NDArray[np.uint8]

INK, PAPER, EMPTY = (32, 32, 32), (250, 249, 246), (222, 220, 214)
CELL_PX, LEFT_PX, TOP_PX, BELOW_PX = (66, 42), 96, 92, 34
# Ends of the colours of the table, dB over the best gain.
LOW_DB, HIGH_DB = 0.0, 20.0
# Codes of difference in the pictures of errors are drawn so much larger, around mid-grey.
ERROR_FACTOR = 4


def table(name: str, pairs: Sequence[Pair]) -> Rgb:
    """dB over the best gain, photograph i down, j across; below, small: the PSNR itself."""
    from PIL import Image, ImageDraw

    count = 1 + max(pair.source for pair in pairs)
    size = LEFT_PX + (count + 1) * CELL_PX[0] + 12, TOP_PX + (count + 1) * CELL_PX[1] + BELOW_PX
    image = Image.new("RGB", size, PAPER)
    pen: Any = ImageDraw.Draw(image)
    over = np.full((count, count), np.nan)
    for pair in pairs:
        over[pair.source, pair.target] = pair.over("gain")
    psnr = {(pair.source, pair.target): pair.psnr_db["relit"] for pair in pairs}
    median = float(np.nanmedian(over))
    _text(
        pen,
        (12, 18),
        f"{name}: dB that relighting is nearer to the real photograph than the best gain, "
        f"median {median:.1f}",
        16,
    )
    _text(pen, (12, 42), "small: PSNR in dB, peak 255 of linear codes, pixels of the thing", 13)
    _text(pen, (LEFT_PX, 64), "into photograph j", 13)
    _text(pen, (12, TOP_PX - 10), "from i", 13)
    for i in range(count):
        _text(pen, _middle(-1, i, LEFT_PX - 18), str(i), 14, "mm")
        _text(pen, (_middle(i, 0)[0], TOP_PX - 10), str(i), 14, "mm")
        for j in range(count):
            _cell(pen, i, j, over[i, j], f"{psnr[i, j]:.1f}" if i != j else "")
        _cell(pen, i, count, float(np.nanmedian(over[i])), "median")
        _cell(pen, count, i, float(np.nanmedian(over[:, i])), "median")
    _cell(pen, count, count, median, "of all")
    below = f"scale of the colours: {LOW_DB:g} to {HIGH_DB:g} dB"
    _text(pen, (12, size[1] - BELOW_PX / 2), below, 13)
    return np.asarray(image)


def _middle(column: int, row: int, x: float | None = None) -> tuple[float, float]:
    across = LEFT_PX + (column + 0.5) * CELL_PX[0] if x is None else x
    return across, TOP_PX + (row + 0.5) * CELL_PX[1]


def _cell(pen: Any, row: int, column: int, value: float, small: str) -> None:
    x, y = _middle(column, row)
    half = CELL_PX[0] / 2 - 1, CELL_PX[1] / 2 - 1
    colour, ink = EMPTY, INK
    if np.isfinite(value):
        share = float(np.clip((value - LOW_DB) / (HIGH_DB - LOW_DB), 0, 1))
        colour = _viridis(share)
        ink = INK if share > 0.5 else PAPER
    pen.rectangle([x - half[0], y - half[1], x + half[0], y + half[1]], fill=colour)
    if np.isfinite(value):
        _text(pen, (x, y - 7), f"{value:.1f}", 15, "mm", ink)
        _text(pen, (x, y + 11), small, 11, "mm", ink)


def _viridis(share: float) -> tuple[int, int, int]:
    import cv2

    code = np.full((1, 1), round(share * 255), np.uint8)
    blue, green, red = np.asarray(cv2.applyColorMap(code, cv2.COLORMAP_VIRIDIS))[0, 0].tolist()
    return red, green, blue


def _text(
    pen: Any,
    at: tuple[float, float],
    text: str,
    size: int,
    anchor: str = "lm",
    ink: tuple[int, int, int] = INK,
) -> None:
    from PIL import ImageFont

    pen.text(at, text, fill=ink, font=ImageFont.load_default(size=size), anchor=anchor)


@dataclass(frozen=True)
class Choice:
    """A pair that is shown, and why."""

    why: str
    pair: Pair


def chosen(pairs: Sequence[Pair]) -> tuple[Choice, ...]:
    """The best, the median and the worst pair, and the one with most pixels unlit."""
    by_gain = sorted(pairs, key=lambda pair: pair.over("gain"))
    return (
        Choice("best", by_gain[-1]),
        Choice("median", by_gain[len(by_gain) // 2]),
        Choice("worst", by_gain[0]),
        Choice("most unlit", max(pairs, key=lambda pair: (pair.unlit_share, pair.over("gain")))),
    )


def examples(shots: Photographs, choices: Sequence[Choice]) -> Rgb:
    """A row for each pair: photographs i and j, and j by Andon, by gain and by ρ·E; the error."""
    tiles: list[tuple[str, Rgb]] = []
    for choice in choices:
        pair = choice.pair
        with TemporaryDirectory() as folder:
            known = known_without(shots, pair.target)
            shown = predictions(Path(folder), shots, known, pair.source, "reference")
        again = score(shots, known, pair.source, shown).psnr_db
        real = shots.codes[pair.target]
        tiles += [
            (f"{choice.why}: photograph {pair.source}", _shown(shots.codes[pair.source])),
            (f"photograph {pair.target}, real", _shown(real)),
            (f"relit: {again['relit']:.1f} dB", _shown(shown["relit"])),
            (f"its error, {ERROR_FACTOR} times", _error(shown["relit"], real, shots.mask)),
            (f"best gain: {again['gain']:.1f} dB", _shown(shown["gain"])),
            (f"no photograph: {again['lambert']:.1f} dB", _shown(shown["lambert"])),
        ]
    return contact_sheet(tiles, columns=6, gap_px=GAP_PX)


def _shown(codes: Rgb) -> Rgb:
    """Linear codes for people's screens."""
    return np.rint(np.asarray(srgb_encode(codes / 255)) * 255).astype(np.uint8)


def _error(ours: Rgb, real: Rgb, mask: NDArray[np.bool_]) -> Rgb:
    away = (ours.astype(float) - real) * mask[..., None]
    return np.clip(np.rint(128 + ERROR_FACTOR * away), 0, 255).astype(np.uint8)


def write_csv(path: Path, pairs: dict[str, Sequence[Pair]]) -> None:
    """Every score of every pair."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        heads = [f"{method}_psnr_db{lit}" for lit in ("", "_lit") for method in METHODS]
        writer.writerow(["thing", "from", "into", "unlit_share", *heads])
        for name, own in pairs.items():
            for pair in own:
                scores = [
                    by[method] for by in (pair.psnr_db, pair.lit_psnr_db) for method in METHODS
                ]
                numbers = [f"{value:.3f}" for value in scores]
                writer.writerow(
                    [name, pair.source, pair.target, f"{pair.unlit_share:.4f}", *numbers]
                )


def write_scenes(folder: Path, shots: Photographs) -> None:
    """A scene file for each pair, and the pictures that they name."""
    for target in range(len(shots.codes)):
        known = known_without(shots, target)
        for source in shots.others(target).tolist():
            write_pair(folder, shots, known, source)


def main() -> None:
    """Writes the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for the figures")
    parser.add_argument(
        "--scenes", action="store_true", help="write the scene files of all pairs instead"
    )
    arguments = parser.parse_args()
    folder: Path = arguments.output
    folder.mkdir(parents=True, exist_ok=True)
    if arguments.scenes:
        for name in OBJECTS:
            write_scenes(folder / name, photographs(name))
        return
    pairs: dict[str, Sequence[Pair]] = {name: pairs_of(name) for name in OBJECTS}
    for name, own in pairs.items():
        write_png(folder / f"{name}-pairs.png", table(name, own))
        write_png(folder / f"{name}-examples.png", examples(photographs(name), chosen(own)))
    write_csv(folder / "pairs.csv", pairs)


if __name__ == "__main__":
    main()
