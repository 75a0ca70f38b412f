"""``andon doctor``: what this machine has, what is missing, what would install it."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

__all__ = ["Finding", "findings", "run"]


@dataclass(frozen=True)
class Finding:
    """One line of the report.

    Attributes
    ----------
    what : the part.
    found : what is there, or None.
    remedy : the one command that installs it.
    needed_for : what does not work without it.
    """

    what: str
    found: str | None
    remedy: str
    needed_for: str


def _package(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _adapter() -> str | None:
    from andon.gpu.device import adapter_summary

    return adapter_summary()


def _exr() -> str | None:
    """OpenEXR, if it can really write and read a picture."""
    from pathlib import Path
    from tempfile import TemporaryDirectory

    import numpy as np

    from andon.files.pictures import read_picture, write_exr

    with TemporaryDirectory() as folder:
        path = Path(folder) / "probe.exr"
        write_exr(path, np.full((2, 2, 3), 1.5, np.float32), unit="lx")
        if float(read_picture(path).values.max()) != 1.5:
            return None
    return _package("OpenEXR")


def _rtrace() -> str | None:
    """Radiance's programs, which the wheel may lack on some platforms."""
    from andon.errors import MachineError
    from andon.files.radiance_programs import package_folder, radiance_version

    try:
        program = package_folder() / "bin" / "rtrace"
    except MachineError:
        return None
    return f"pyradiance {radiance_version()}" if program.exists() else None


def findings() -> list[Finding]:
    """All parts, looked for now."""
    return [
        Finding(
            "GPU adapter",
            _adapter(),
            "apt-get install mesa-vulkan-drivers",
            "the fast engine (the reference engine needs none)",
        ),
        Finding("rays (embreex)", _package("embreex"), "pip install embreex", "shadows, tracing"),
        Finding("EXR", _exr(), "pip install OpenEXR", "illuminance maps"),
        Finding("OpenCV", _package("opencv-python-headless"), "pip install andon", "lenses"),
        Finding(
            "SciPy", _package("scipy"), "pip install 'andon[probes]'", "andon bake, probes bake"
        ),
        Finding(
            "Numba",
            _package("numba"),
            "pip install 'andon[probes]'",
            "fast lookups of many points (NumPy does without)",
        ),
        Finding(
            "Radiance", _rtrace(), "pip install 'andon[radiance]'", "andon bake, verify, bench"
        ),
        Finding(
            "Dask",
            _package("distributed"),
            "pip install 'andon[cluster]'",
            "bakes on many machines",
        ),
        Finding("pygfx", _package("pygfx"), "pip install 'andon[bench]'", "andon bench"),
    ]


def run() -> None:
    """Prints the report; missing parts are no failure: the reference engine needs none of them."""
    from rich.console import Console
    from rich.table import Table

    from andon import __version__

    table = Table(box=None, pad_edge=False)
    for column in ("part", "found", "needed for", "what installs it"):
        table.add_column(column, overflow="fold")
    table.add_row("andon", __version__, "", "")
    table.add_row("Python", f"{platform.python_version()}, {platform.platform()}", "", "")
    rows = findings()
    for row in rows:
        found = row.found or "[bold red]missing[/]"
        table.add_row(row.what, found, row.needed_for, "" if row.found else row.remedy)
    console = Console()
    console.print(table)
    if rows[0].found is None:
        console.print("The reference engine serves: slower, same pictures.")
