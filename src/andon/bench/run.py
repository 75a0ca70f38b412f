"""``andon bench``: times rows beside their peers and prints them."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from andon.bench.registry import BenchRow, Duel, rows
from andon.errors import MachineError
from andon.verify.registry import NotShown
from andon.verify.run import chosen

__all__ = ["measured", "run"]

REPEATS, QUICK_REPEATS = 21, 5


def machine() -> str:
    """Processor and versions, for the record."""
    from andon import __version__

    cores = os.cpu_count()
    python = platform.python_version()
    return f"{platform.machine()}, {cores} cores, Python {python}, andon {__version__}"


def _timed(step: Callable[[], object]) -> float:
    start = perf_counter()
    step()
    return perf_counter() - start


def _alternating(duel: Duel, repeats: int) -> tuple[list[float], list[float]]:
    """Seconds of each repetition of both sides, in turn; each warmed up once."""
    duel.ours()
    duel.peer()
    if duel.ours_less:
        duel.ours_less()
    peer_repeats = min(repeats, duel.peer_repeats)
    repeats = min(repeats, duel.ours_repeats or repeats)
    ours: list[float] = []
    peer: list[float] = []
    for index in range(repeats):
        besides = _timed(duel.ours_less) if duel.ours_less else 0.0
        ours.append(_timed(duel.ours) - besides)
        if index < peer_repeats:
            less = _timed(duel.peer_less) if duel.peer_less else 0.0
            peer.append((_timed(duel.peer) - less) / duel.peer_parts)
    return ours, peer


def measured(row: BenchRow, quick: bool) -> dict[str, Any]:
    """The row as JSON: name, stage, ours_seconds, peer, peer_seconds, ratio, agreement, …"""
    result: dict[str, Any] = {"name": row.name, "stage": row.stage, "peer": row.peer}
    try:
        duel = row.prepare()
    except (NotShown, MachineError) as reason:
        return result | {"holds": False, "not_shown": str(reason)}
    try:
        if duel.agreement < duel.agreed:
            reason = f"the two disagree: {duel.agreement:.4f} < {duel.agreed}, no time is given"
            return result | {"holds": False, "agreement": duel.agreement, "not_shown": reason}
        ours, peer = _alternating(duel, QUICK_REPEATS if quick else REPEATS)
    finally:
        duel.close()
    a, b = median(ours), median(peer)
    return {
        **result,
        "ours_seconds": a,
        "ours_p95_seconds": float(np.percentile(ours, 95)),
        "peer_seconds": b,
        "ratio": b / a,
        "agreement": duel.agreement,
        "pixels": row.pixels,
        "mpix_per_second": row.pixels / a / 1e6,
        "adapter": duel.adapter,
        "machine": machine(),
        "bar": row.bar,
        "holds": row.holds(a, b),
    }


def run(
    names: tuple[str, ...], quick: bool, json_path: Path | None, plot_path: Path | None = None
) -> int:
    """Prints a line a row as it is timed; returns 1 if a bar is not met, else 0."""
    from andon.cli.console import check_writable

    if json_path is not None:
        check_writable(json_path, (".json",), "--json")
    print(machine())
    if plot_path is not None:
        check_writable(plot_path, (".png",), "--plot")
        from andon.bench.area_plot import write_plot

        write_plot(plot_path, quick)
        return 0
    results: list[dict[str, Any]] = []
    for row in chosen(names, rows()):
        result = measured(row, quick)
        results.append(result)
        _print(row, result)
    if json_path is not None:
        from andon.files.atomic import write_bytes

        write_bytes(json_path, (json.dumps(results, indent=2) + "\n").encode())
    return 1 if any(result["holds"] is False for result in results) else 0


def _print(row: BenchRow, result: dict[str, Any]) -> None:
    if "not_shown" in result:
        print(f"not shown  {row.name}: {result['not_shown']}", flush=True)
        return
    word = {True: "holds    ", False: "NOT MET  ", None: "published"}[result["holds"]]
    unit = "Mpix/s" if row.bar_is_rate else "ms" if row.bar_is_milliseconds else "×"
    sign = "≤" if row.bar_is_milliseconds else "≥"
    bar = "" if row.bar is None else f" (bar {sign} {row.bar:g} {unit})"
    print(
        f"{word}  {row.name}: {result['ours_seconds'] * 1e3:.1f} ms, "
        f"{result['mpix_per_second']:.1f} Mpix/s; "
        f"{row.peer} {result['peer_seconds'] * 1e3:.1f} ms; "
        f"ratio {result['ratio']:.2f}{bar}; agreement {result['agreement']:.4f}; "
        f"{result['adapter']}",
        flush=True,
    )
