"""What a reader is, and how one is chosen by the suffix of a file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits

__all__ = ["ReadFunction", "Reader", "choose_reader"]


class ReadFunction(Protocol):
    """``read(path, *, limits=DEFAULT_LIMITS)``; raises `InputError` and nothing else."""

    def __call__(self, path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Any:
        """What the file holds."""
        ...


@dataclass(frozen=True)
class Reader:
    """One file format.

    Attributes
    ----------
    name : ``kind.format``; the kind is ``picture``, ``depth``, ``mesh``, ``camera``, ``response``,
        ``surface-response``, ``photometry``, ``volume``, ``exposures``, ``gaze``, ``gaps``,
        ``harmonics``, or, of baked light, ``maps``, ``geometry``, ``illuminance`` or ``radiance``.
    suffixes : lower case, with the dot.
    read : the function that reads it.
    """

    name: str
    suffixes: tuple[str, ...]
    read: ReadFunction

    @property
    def kind(self) -> str:
        """What it reads: the part of the name before the dot."""
        return self.name.split(".")[0]


def choose_reader(path: str | Path, readers: Iterable[Reader], what: str) -> Reader:
    """The reader whose suffixes include that of `path`; otherwise an error that lists them."""
    candidates = tuple(readers)
    suffix = Path(path).suffix.lower()
    for reader in candidates:
        if suffix in reader.suffixes:
            return reader
    accepted = ", ".join(sorted({s for reader in candidates for s in reader.suffixes}))
    raise InputError(
        f"the suffix of a {what} must be one of {accepted}, got {suffix or 'none'}", file=path
    )
