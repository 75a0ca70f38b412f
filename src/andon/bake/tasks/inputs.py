"""Bundles as folders on a disk: what works of tasks read."""

from __future__ import annotations

import re
import shutil
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

from andon.bake.tasks.model import Bundle, Task
from andon.errors import MachineError

__all__ = ["Inputs", "inputs_in", "remove_inputs", "write_bundle"]

NAME = "inputs"


class Inputs:
    """digest → ``folder/inputs/<digest>``, whose files are those of the bundle.

    A bundle is written when it is asked for first, and stays until it is dropped: those of a film
    are more than a disk holds.
    """

    def __init__(self, folder: Path, bundles: Mapping[str, Bundle]) -> None:
        self._root, self._bundles = folder / NAME, bundles
        self._there: dict[str, Path] = {}

    def __getitem__(self, digest: str, /) -> Path:
        """The folder of a bundle. Raises `MachineError` where it cannot be written."""
        if digest not in self._there:
            self._there[digest] = _written(self._root / digest, self._bundles[digest])
        return self._there[digest]

    def of(self, task: Task, /) -> dict[str, Path]:
        """The folders of what a task reads, by its own names."""
        return {name: self[digest] for name, digest in task.inputs.items()}

    def drop(self, digest: str, /) -> None:
        """Removes a bundle, if it is there."""
        path = self._there.pop(digest, None)
        if path is not None:
            shutil.rmtree(path, ignore_errors=True)


@contextmanager
def inputs_in(folder: Path, bundles: Mapping[str, Bundle], /) -> Generator[Inputs]:
    """Bundles as folders, while they are needed; all are removed afterwards.

    What a killed bake has left is removed and written again, since nobody knows how far it came.
    """
    remove_inputs(folder)
    try:
        yield Inputs(folder, bundles)
    finally:
        remove_inputs(folder)


def write_bundle(folder: Path, bundle: Bundle, /) -> Path:
    """Writes the files of `bundle` into `folder`, which is made. Raises `OSError`."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, contents in bundle.items():
        place = PurePosixPath(name)
        if place.is_absolute() or ".." in place.parts or not place.parts:
            raise LookupError(f"files of bundles have relative names, got {name!r}")
        path = folder / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(contents)
    return folder


def _written(folder: Path, bundle: Bundle) -> Path:
    try:
        return write_bundle(folder, bundle).resolve()
    except OSError as error:
        size = sum(map(len, bundle.values())) / 1e6
        raise MachineError(
            f"{folder}: cannot be written: {error.strerror or error}",
            remedy=f"free space (these inputs need {size:.1f} MB) or choose a folder that can be "
            "written, and begin again: what is done is kept",
        ) from error


def remove_inputs(folder: Path, /) -> None:
    """Removes bundles that are in `folder`; what else somebody put there stays."""
    root = folder / NAME
    if not root.is_dir():
        return
    for path in root.iterdir():
        if re.fullmatch(r"[0-9a-f]{64}", path.name):
            shutil.rmtree(path, ignore_errors=True)
    with suppress(OSError):
        root.rmdir()
