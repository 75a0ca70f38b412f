"""Writing so that a reader never sees half a file: a temporary name, then a rename.

The temporary file lies in the target's own folder, since a rename is atomic only within one file
system. Whatever was there before stays untouched until the new contents are complete on disk.
"""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Callable
from pathlib import Path
from typing import Any

from andon.errors import InputError, MachineError

__all__ = ["write_atomically", "write_bytes", "write_json"]


def write_bytes(path: str | Path, data: bytes) -> Path:
    """Write `data` to `path` atomically; returns the path."""

    def fill(temporary: Path) -> None:
        temporary.write_bytes(data)

    return write_atomically(path, fill)


def write_json(path: str | Path, value: Any) -> Path:
    """Write `value` as indented JSON with a line's end; returns the path.

    Raises `ValueError` for NaN and infinity, which JSON has not: say None.
    """
    text = json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)
    return write_bytes(path, (text + "\n").encode())


def write_atomically(path: str | Path, fill: Callable[[Path], None]) -> Path:
    """Let `fill` write a temporary file beside `path`, then rename it to `path`.

    Raises
    ------
    InputError
        if the parent folder is missing or `path` is a folder.
    MachineError
        if the folder cannot be written or the disk is full.
    """
    path = Path(path)
    try:
        has_folder, is_folder = path.parent.is_dir(), path.is_dir()
    except OSError as error:
        raise InputError(f"the output must have a possible name: {error.strerror}") from error
    if not has_folder or "\0" in path.name:
        raise InputError(
            "the folder of the output must exist", file=path, remedy=f"create {path.parent}"
        )
    if is_folder:
        raise InputError("the output must be a file, not a folder", file=path)
    temporary = path.with_name(f".{path.stem[:100]}.{secrets.token_hex(6)}.tmp{path.suffix}")
    try:
        fill(temporary)
        _flush_to_disk(temporary)
        temporary.replace(path)
    except OSError as error:
        raise MachineError(
            f"{path}: cannot be written: {error.strerror or error}",
            remedy="free space or choose a folder that can be written",
        ) from error
    finally:
        temporary.unlink(missing_ok=True)
    return path


def _flush_to_disk(path: Path) -> None:
    """Without this a crash of the machine may leave the new name with no contents."""
    handle = os.open(path, os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
