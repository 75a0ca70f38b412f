"""``andon probes info``: what a probe volume holds."""

from __future__ import annotations

from collections.abc import Mapping
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from andon.cli.console import printable

if TYPE_CHECKING:
    from andon.files.volumes import ProbeVolume

__all__ = ["facts_of", "show"]

# Zones and states that the table lists; the JSON has all.
LISTED = 12


def show(file: Path, *, json: bool) -> None:
    """Prints what the probe volume `file` holds, as a table or as JSON."""
    from andon.cli.probe_volume import volume_of

    facts = facts_of(volume_of(file), file.stat().st_size)
    if json:
        print(dumps(facts, indent=2, ensure_ascii=False))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    for name, value in _rows(facts):
        table.add_row(name, value)
    Console(highlight=False, markup=False).print(table)


def facts_of(volume: ProbeVolume, file_bytes: int) -> dict[str, Any]:
    """Everything that is said about a volume, with units in the names."""
    terms = (volume.order + 1) ** 2
    low, high = volume.positions.min(axis=0), volume.positions.max(axis=0)
    limited = volume.ranges_m[np.isfinite(volume.ranges_m)]
    moved = np.linalg.norm(volume.capture_positions - volume.positions, axis=1)
    distances = volume.distances
    return {
        "photometry": volume.photometry,
        "probes": volume.count,
        "roles": {role: volume.roles.count(role) for role in dict.fromkeys(volume.roles)},
        "low_m": low.tolist(),
        "high_m": high.tolist(),
        "ranges_m": [float(limited.min()), float(limited.max())] if len(limited) else None,
        "probes_with_range": len(limited),
        "probes_captured_elsewhere": int((moved > 0).sum()),
        "farthest_capture_m": float(moved.max()),
        "order": volume.order,
        "coefficients": terms,
        "states": [{"name": name, **_light(values)} for name, values in volume.states.items()],
        "zones": _zones(volume),
        "tetrahedra": 0 if volume.cells is None else len(volume.cells.corners),
        "facets": 0 if volume.cells is None else len(volume.cells.facets),
        "joined": volume.cells is not None,
        "distances": None
        if distances is None
        else {"side_px": distances.mean_m.shape[-1], "far_m": distances.far_m},
        "bytes": _bytes(volume, terms) | {"file": file_bytes},
        "notes": dict(volume.notes),
    }


def _light(values: np.ndarray[Any, np.dtype[np.float64]]) -> dict[str, Any]:
    """Mean luminance over all directions, L00/√(4π), of the probes."""
    from andon.quantities import photometric

    mean = values[:, 0] / np.sqrt(4 * np.pi)
    one = photometric(mean)
    return {
        "mean_cd_m2": mean.mean(axis=0).tolist(),
        "mean_luminance_cd_m2": float(one.mean()),
        "darkest_probe_cd_m2": float(one.min()),
        "brightest_probe_cd_m2": float(one.max()),
    }


def _zones(volume: ProbeVolume) -> list[dict[str, Any]]:
    cells = volume.cells
    return [
        {
            "name": zone.name,
            "probes": len(zone.probes),
            "boxes_m": None if zone.boxes is None else zone.boxes.tolist(),
            "tetrahedra": 0 if cells is None else int(cells.zone_cells[number, 1]),
            "facets": 0 if cells is None else int(cells.zone_facets[number, 1]),
        }
        for number, zone in enumerate(volume.zones)
    ]


def _bytes(volume: ProbeVolume, terms: int) -> dict[str, int]:
    """Of float32 and int32, as in the file and on a GPU."""
    cells, distances = volume.cells, volume.distances
    return {
        "light": 4 * 3 * volume.count * terms * len(volume.states),
        "cells": 0 if cells is None else 4 * sum(values.size for values in vars(cells).values()),
        "distances": 0 if distances is None else 2 * 4 * distances.mean_m.size,
    }


def _rows(facts: Mapping[str, Any]) -> list[tuple[str, str]]:
    unit = "cd/m²" if facts["photometry"] == "absolute" else "relative units"
    roles = ", ".join(f"{count} {role}" for role, count in facts["roles"].items())
    low, high = (", ".join(f"{x:.4g}" for x in facts[key]) for key in ("low_m", "high_m"))
    rows = [
        ("photometry", facts["photometry"]),
        ("probes", f"{facts['probes']}: {roles}"),
        ("bounds", f"({low}) … ({high}) m"),
        ("order", f"L{facts['order']}, {facts['coefficients']} coefficients a channel"),
    ]
    if facts["ranges_m"] is not None:
        least, most = facts["ranges_m"]
        probes = _counted(facts["probes_with_range"], "probe")
        rows.append(("ranges", f"{probes}, {least:.4g}…{most:.4g} m"))
    if facts["probes_captured_elsewhere"]:
        rows.append(
            (
                "captured",
                f"{_counted(facts['probes_captured_elsewhere'], 'probe')} up to "
                f"{facts['farthest_capture_m']:.3g} m from where they count",
            )
        )
    rows += [("state", _state(state, unit)) for state in facts["states"][:LISTED]]
    rows += [("zone", _zone(zone)) for zone in facts["zones"][:LISTED]]
    if len(facts["zones"]) > LISTED:
        rows.append(("", f"{len(facts['zones']) - LISTED} zones more, see --json"))
    return [*rows, *_parts(facts)]


def _parts(facts: Mapping[str, Any]) -> list[tuple[str, str]]:
    joined = _cells(facts)
    distances = facts["distances"]
    rows = [
        ("cells", joined if facts["joined"] else "none: nobody joined the probes yet"),
        (
            "distances",
            "none: walls hide nothing"
            if distances is None
            else f"{distances['side_px']}² directions a probe, up to {distances['far_m']:g} m",
        ),
        ("memory", " · ".join(f"{name} {_size(n)}" for name, n in facts["bytes"].items())),
    ]
    return rows + [("note", f"{printable(k)}: {printable(v)}") for k, v in facts["notes"].items()]


def _state(state: Mapping[str, Any], unit: str) -> str:
    red, green, blue = state["mean_cd_m2"]
    return (
        f"{printable(state['name'])}: mean {state['mean_luminance_cd_m2']:.4g} {unit} "
        f"(R {red:.4g}, G {green:.4g}, B {blue:.4g}), probes "
        f"{state['darkest_probe_cd_m2']:.4g}…{state['brightest_probe_cd_m2']:.4g}"
    )


def _zone(zone: Mapping[str, Any]) -> str:
    boxes = zone["boxes_m"]
    where = "all of space" if boxes is None else _counted(len(boxes), "box", "boxes")
    probes = _counted(zone["probes"], "probe")
    return f"{printable(zone['name'])}: {probes}, {_cells(zone)}, {where}"


def _cells(counts: Mapping[str, Any]) -> str:
    tetrahedra = _counted(counts["tetrahedra"], "tetrahedron", "tetrahedra")
    return f"{tetrahedra}, {_counted(counts['facets'], 'facet')}"


def _counted(count: int, one: str, many: str | None = None) -> str:
    return f"{count} {one if count == 1 else many or one + 's'}"


def _size(count: int) -> str:
    """Bytes in the largest unit of which there are one or more."""
    for power, unit in ((9, "GB"), (6, "MB"), (3, "kB")):
        if count >= 10**power:
            return f"{count / 10**power:.4g} {unit}"
    return f"{count} B"
