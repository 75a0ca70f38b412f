"""``andon lamp``: what a luminaire file says, and the lamps that have a name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from andon.cli.console import check_writable, printable
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.files.photometry import Distribution

__all__ = ["presets", "show"]

# Of the table with sources, which are sentences: wider than most terminals, for files and pagers.
LONG_COLUMNS = 160


def show(file: Path, out: Path | None) -> None:
    """Prints the figures of a photometric file and draws its polar diagram."""
    if out is not None:
        check_writable(out, (".png",), "--out")
        if out.resolve() == file.resolve():
            raise InputError("is also the input, and would be overwritten", file=out)
    from rich.console import Console
    from rich.table import Table

    from andon.files.photometry import read_photometry

    distribution = read_photometry(file)
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, value in _facts(distribution):
        table.add_row(name, value)
    Console(highlight=False, markup=False).print(table)
    if out is not None:
        _draw(distribution, file, out)
        print(out)


def _facts(distribution: Distribution) -> list[tuple[str, str]]:
    from andon.lamps.goniometry import (
        beam_degrees,
        field_degrees,
        flux_lm,
        main_planes,
        maximum_cd,
    )

    lumens = flux_lm(distribution)
    names = [plane.name for plane in main_planes(distribution)]
    horizontal, vertical = distribution.horizontal_degrees, distribution.vertical_degrees
    facts = [
        ("name", printable(distribution.name) or "not stated"),
        ("maker", printable(distribution.manufacturer) or "not stated"),
        ("flux", f"{lumens:.6g} lm, integrated over the sphere"),
        ("stated", _stated(distribution, lumens)),
        ("maximum", f"{maximum_cd(distribution):.6g} cd"),
        ("beam, 50 %", _widths(beam_degrees(distribution), names)),
        ("field, 10 %", _widths(field_degrees(distribution), names)),
        (
            "type",
            f"{distribution.photometry}; {len(horizontal)} horizontal angles "
            f"{horizontal[0]:g}…{horizontal[-1]:g}°, {len(vertical)} vertical "
            f"{vertical[0]:g}…{vertical[-1]:g}°",
        ),
        ("opening", _opening(distribution)),
    ]
    if distribution.watts:
        facts.append(("power", f"{distribution.watts:g} W, {lumens / distribution.watts:.4g} lm/W"))
    if distribution.tilt is not None:
        facts.append(("tilt", f"light falls to {distribution.tilt.factors.min():.0%} when tilted"))
    return facts


def _stated(distribution: Distribution, lumens: float) -> str:
    if distribution.stated_lumens is not None:
        difference = lumens / distribution.stated_lumens - 1
        return f"{distribution.stated_lumens:.6g} lm, the integral differs by {difference:+.2%}"
    if distribution.lamp_lumens:
        ratio = lumens / distribution.lamp_lumens
        return f"{distribution.lamp_lumens:.6g} lm of the bare lamps, of which {ratio:.1%} leave"
    return "nothing (absolute photometry)"


def _widths(degrees: tuple[float, float], names: list[str]) -> str:
    return ", ".join(f"{value:.1f}° in {name}" for value, name in zip(degrees, names, strict=True))


def _opening(distribution: Distribution) -> str:
    along, across, height = (1000 * metres for metres in distribution.opening_m)
    if not (along or across or height):
        return "a point"
    form = "round" if distribution.is_round else "rectangular"
    return f"{along:.4g} mm along C0, {across:.4g} mm along C90, {height:.4g} mm high; {form}"


def _draw(distribution: Distribution, file: Path, out: Path) -> None:
    from andon.display.polar import polar_picture
    from andon.files.pictures import write_png
    from andon.lamps.goniometry import flux_lm, main_planes, maximum_cd

    title = " · ".join(
        part
        for part in map(printable, (distribution.manufacturer, distribution.name or file.name))
        if part
    )
    facts = (
        f"{flux_lm(distribution):.5g} lm · {maximum_cd(distribution):.5g} cd · "
        f"type {distribution.photometry}"
    )
    write_png(out, polar_picture(main_planes(distribution), title, facts))


def presets(*, long: bool = False, json: bool = False) -> None:
    """Prints the lamps that have a name: a table of at most 80 columns, or all that is known."""
    if json:
        print(_json_text())
        return
    from rich.console import Console
    from rich.table import Table

    from andon.scene.presets import PRESETS

    table = Table(box=None, pad_edge=False)
    table.add_column("preset", no_wrap=True)
    table.add_column("what")
    for column in ("light", "colour", "kind"):
        table.add_column(column, no_wrap=True)
    if long:
        table.add_column("source")
    for name, preset in PRESETS.items():
        keys = preset.keys
        row = (name, preset.what, _light(keys), f"{keys['temperature_k']:g} K", keys["kind"])
        table.add_row(*row, *([preset.source] if long else []))
    Console(highlight=False, markup=False, width=LONG_COLUMNS if long else None).print(table)


def _json_text() -> str:
    """The presets as a JSON list; `keys` are those of a [[lamp]]."""
    from json import dumps

    from andon.scene.presets import PRESETS

    entries = [
        {"preset": name, "what": preset.what, "keys": dict(preset.keys), "source": preset.source}
        for name, preset in PRESETS.items()
    ]
    return dumps(entries, indent=2, ensure_ascii=False)


def _light(keys: Mapping[str, Any]) -> str:
    from andon.scene.presets import LIGHT_KEYS

    units = dict(zip(LIGHT_KEYS, ("cd", "lm", "cd/m²", "lx"), strict=True))
    return " ".join(f"{keys[key]:g} {unit}" for key, unit in units.items() if key in keys)
