"""Where the examples are that commands draw."""

from __future__ import annotations

from pathlib import Path

from andon.errors import MachineError

__all__ = ["example_folder"]


def example_folder(name: str, file: str, /) -> Path:
    """The folder of an example with `file` in it: in the package, or beside its sources.

    Raises `MachineError` where there is none.
    """
    here = Path(__file__).resolve().parents[1]
    for folder in (here / "data" / name, here.parents[1] / "examples" / name):
        if (folder / file).exists():
            return folder
    raise MachineError(
        f"the example {name} is missing", remedy="install Andon again, or name a file of your own"
    )
