"""A task: a function of files and settings; its result is one file, named by what it depends on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from andon.engines.digest import digest

__all__ = ["Bundle", "Task", "Work", "bundle_digest"]

# Files that belong together, name → contents: what a task reads. Workers get it as a folder.
Bundle = Mapping[str, bytes]

# (input's name → the folder of its bundle, settings) → the contents of the artefact.
Work = Callable[[Mapping[str, Path], Mapping[str, Any]], bytes]


def bundle_digest(bundle: Bundle, /) -> str:
    """The name of a bundle: 64 hexadecimal digits of the names and contents of its files."""
    import hashlib

    sums = {name: hashlib.sha256(contents).hexdigest() for name, contents in bundle.items()}
    return digest("bundle", sums)


@dataclass(frozen=True)
class Task:
    """What a worker is given.

    Attributes
    ----------
    name : for people, in messages and progress: ``lantern, camera 2, 0.5 s``.
    work : ``module:function`` of a `Work`; importable wherever workers run. The same inputs and
        settings give the same bytes, on every machine.
    inputs : name → `bundle_digest` of what it reads.
    settings : what else it depends on: numbers, texts, and lists and tables of them.
    version : of `work`; results of another version are computed again.
    """

    name: str
    work: str
    inputs: Mapping[str, str] = field(default_factory=dict[str, str])
    settings: Mapping[str, Any] = field(default_factory=dict[str, Any])
    version: int = 1

    @property
    def key(self) -> str:
        """The artefact's name: 64 hexadecimal digits of all that it depends on."""
        return digest(self.work, self.version, self.inputs, self.settings)
