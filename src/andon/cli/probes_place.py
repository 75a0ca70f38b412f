"""``andon probes place``: where the probes of a scene go."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from andon.cli.console import check_writable, note, printable
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.transport.probes.placement import Placed

__all__ = ["place"]

# A list on the terminal: what is longer is read from the file.
SHOWN_NAMES = 8


def place(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML) with a [probes] table.")],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="TOML: [[probes.place]] to paste; GLB: nodes."),
    ] = None,
) -> None:
    """Say where the probes of a scene go, and write them as tables or as locators.

    Examples:

        andon probes place basic-lattice.toml

        andon probes place basic-lattice.toml -o places.toml

        andon probes place basic-lattice.toml -o locators.glb
    """
    from andon.bake.panoramas import check_panoramas
    from andon.bake.to_file import placed_in
    from andon.scene import load_scene

    if out is not None:
        check_writable(out, (".toml", ".glb"), "--out")
        if out.resolve() == scene.resolve():
            raise InputError("is also the input, and would be overwritten", file=out)
    loaded = load_scene(scene)
    placed = placed_in(loaded)
    check_panoramas(loaded, placed)
    _print(placed)
    for warning in placed.warnings:
        note(printable(warning))
    if out is not None:
        _write(placed, out, scene)
        print(out)


def _print(placed: Placed) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    for name, value in _facts(placed):
        table.add_row(name, value)
    Console(highlight=False, markup=False).print(table)


def _facts(placed: Placed) -> list[tuple[str, str]]:
    import numpy as np

    from andon.transport.probes.placement import nearest_distances_m

    roles = sorted(set(placed.roles), key=placed.roles.index)
    low, high = placed.positions.min(axis=0), placed.positions.max(axis=0)
    tally = placed.tally
    facts = [
        ("probes", str(placed.count)),
        ("roles", ", ".join(f"{placed.roles.count(role)} {role}" for role in roles)),
        ("bounds", " × ".join(f"{a:.3g}…{b:.3g}" for a, b in zip(low, high, strict=True)) + " m"),
    ]
    if placed.count > 1:
        near = nearest_distances_m(placed.positions)
        facts.append(
            (
                "nearest",
                f"{near.min():.3g}…{near.max():.3g} m to the next probe, median "
                f"{float(np.median(near)):.3g} m",
            )
        )
    panoramas = sum(panorama is not None for panorama in placed.panoramas)
    if panoramas:
        facts.append(("panoramas", f"{panoramas} of them are pictures"))
    more = ", …" if len(tally.in_walls) > SHOWN_NAMES else ""
    names = printable(", ".join(tally.in_walls[:SHOWN_NAMES]) + more)
    facts += [
        ("in walls", f"{len(tally.in_walls)}: {names}" if names else "none"),
        (
            "left out",
            f"{tally.merged} at the place of another, {tally.dropped_in_walls} in walls, "
            f"{tally.hidden} behind one, {tally.too_near} too near to a surface, {tally.crowded} "
            "to a probe",
        ),
    ]
    return facts


def _write(placed: Placed, out: Path, scene: Path) -> None:
    from andon.files.atomic import write_bytes
    from andon.transport.probes.placement import locators, place_tables

    if out.suffix.lower() == ".glb":
        from andon.files.meshes.gltf import write_gltf_nodes

        write_gltf_nodes(out, locators(placed), generator="andon probes place")
        return
    from andon.scene.dump import toml_text

    head = (
        f"# {placed.count} probes of {scene.name}. In a scene they stand instead of its\n"
        '# [[probes.place]], beside probes.placement.kind = "hand".\n'
    )
    text = toml_text({"probes": {"place": place_tables(placed)}})
    write_bytes(out, (head + "\n" + text).encode())
