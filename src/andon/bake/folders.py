"""Where bakes write: known to be there, and to take files, before the first hour."""

from __future__ import annotations

from pathlib import Path

from andon.errors import InputError
from andon.files.atomic import write_bytes
from andon.scene import Scene

__all__ = ["WRITABLE", "check_parent", "check_writable"]

# A file that is written and removed to know whether one can be.
WRITABLE = "writable"


def check_parent(scene: Scene, path: Path, field: str, /) -> None:
    """Raises `InputError` unless the folder in which `path` is to lie exists."""
    if not path.parent.is_dir():
        raise InputError(
            f"the folder {str(path.parent)!r} does not exist",
            file=scene.file,
            field=field,
            remedy="make it",
        )


def check_writable(folder: Path, /) -> None:
    """Raises `MachineError` where the disk is full or read-only."""
    write_bytes(folder / WRITABLE, b"writable").unlink(missing_ok=True)
