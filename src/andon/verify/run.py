"""``andon verify``: measures rows and prints them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from andon.errors import InputError, MachineError, nearest_name
from andon.verify.registry import NotShown, Row, rows

__all__ = ["chosen", "measured", "run"]


def chosen(names: Sequence[str], known: Sequence[Any]) -> list[Any]:
    """The rows whose names begin with one of `names`; all for none. Raises `InputError`."""
    for name in names:
        if not any(row.name.startswith(name) for row in known):
            near = nearest_name(name, [row.name for row in known])
            raise InputError(
                f"there is no row {name!r}",
                field="names",
                remedy=f"did you mean {near!r}?" if near else "andon verify lists them all",
            )
    return [row for row in known if not names or any(row.name.startswith(n) for n in names)]


def measured(row: Row) -> dict[str, Any]:
    """The row as JSON: name, stage, bar, figure, unit, holds, against; why not, if not shown."""
    result: dict[str, Any] = {"name": row.name, "stage": row.stage, "bar": row.bar}
    try:
        figure = float(row.measure())
    except (NotShown, MachineError) as reason:
        # A row that could not be measured counts as not held: nothing was shown.
        result |= {"figure": None, "unit": row.unit, "holds": False, "against": row.against}
        return result | {"not_shown": str(reason)}
    result |= {"figure": figure, "unit": row.unit, "holds": row.holds(figure)}
    return result | {"against": row.against}


def run(names: tuple[str, ...], json_path: Path | None) -> int:
    """Prints a line a row as it is measured; returns 1 if a bar is not met, else 0."""
    from andon.cli.console import check_writable

    if json_path is not None:
        check_writable(json_path, (".json",), "--json")
    results: list[dict[str, Any]] = []
    for row in chosen(names, rows()):
        result = measured(row)
        results.append(result)
        _print(row, result)
    if json_path is not None:
        from andon.files.atomic import write_bytes

        write_bytes(json_path, (json.dumps(results, indent=2) + "\n").encode())
    missed = [r["name"] for r in results if r["holds"] is False]
    held = sum(1 for r in results if r["holds"])
    published = sum(1 for r in results if r["holds"] is None)
    print(f"{held} hold, {len(missed)} do not, {published} published without a bar")
    return 1 if missed else 0


def _print(row: Row, result: dict[str, Any]) -> None:
    if result.get("not_shown"):
        print(f"not shown  {row.name}: {result['not_shown']}", flush=True)
        return
    word = {True: "holds    ", False: "NOT MET  ", None: "published"}[result["holds"]]
    sign = "≥" if row.at_least else "≤"
    bar = "" if row.bar is None else f" ({sign} {row.bar:g})"
    line = f"{word}  {row.name}: {result['figure']:.4g} {row.unit}{bar} against {row.against}"
    print(line, flush=True)
