"""Scene files of Radiance (``.rad``) from strangers: read as Radiance reads them, and bounded.

::

    # a comment                              whole lines, between primitives
    void plastic wood                        modifier, type, identifier
    0                                        strings and how many
    0                                        integers: none, ever
    5 .3 .2 .1 0 0                           numbers and how many
    void alias oak wood                      another name
    !genbox wood table 1 .7 .5               the output of a program

A line that starts a program is code of a stranger, so it is refused. What counts as one was found
by giving `oconv` (6.0a) such lines: ``!`` wherever a primitive may begin, also after white space of
any kind, in the middle of a line, and where a comment breaks off because it is longer than
Radiance's buffer (``#``, 2047 letters, ``!rm -rf``). An octree that an `instance` names starts the
programs that its own header names, when `rtrace` opens it; compiled meshes hide which files they
read. Both are refused as well.

With `trust` programs run once, here, through Radiance's `xform`, and what comes back is plain text:
those who compute with it later start nothing.

Names of files must stay in the folder of the scene file. Their contents are returned with it, under
names of their contents, so that two scene files may both have a ``wood.hdr``.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from andon.errors import InputError, MachineError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.paths import confined, open_bounded
from andon.files.radiance_expand import expanded
from andon.files.radiance_programs import package_folder
from andon.files.radiance_types import COMPILED, FILES, LIGHTS, NUMBERS, TYPES
from andon.files.reader import Reader

__all__ = ["RADIANCE_READERS", "RadianceText", "read_included", "read_radiance"]

# The buffers of Radiance's reader: of a line, and of a word; beyond them it splits what it reads.
MAX_LINE, MAX_WORD = 2046, 127

_SPACE = re.compile(rb"[ \t\n\v\f\r]*")
# Quoted as a whole or not at all: releases of Radiance differ in quotes amid a word.
_WORD = re.compile(rb"\s*(?:\"([^\"]*)\"|'([^']*)'|([^\s\"']+))(?=\s|\Z)")
_INTEGER = re.compile(rb"\d{1,9}")
_NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_COMMAND = re.compile(rb"(?:\\\r?\n|[^\n])*")
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]|\r(?!\n)")
_PLAIN = re.compile(r"[^A-Za-z0-9._-]")


@dataclass(frozen=True)
class RadianceText:
    """What a scene file holds.

    Attributes
    ----------
    text : starts no program; names files as `files` does.
    files : name → contents of the files that it needs, Radiance's own ones apart.
    lights : identifiers of its materials that emit light.
    """

    text: bytes
    files: dict[str, bytes]
    lights: tuple[str, ...]


def read_radiance(
    path: str | Path, *, trust: bool = False, limits: Limits = DEFAULT_LIMITS
) -> RadianceText:
    """A scene file and the files that it names.

    Parameters
    ----------
    path : the file; metres, +Y up. Names in it count from its folder.
    trust : run the programs that it starts, and take compiled octrees and meshes.

    Raises
    ------
    InputError
        if it starts a program without `trust`, leaves its folder, names what is not there, or is
        not what Radiance reads.
    MachineError
        if a program that it starts cannot be run.
    """
    data = open_bounded(path, limits, max_bytes=limits.max_text_bytes)
    scan = _Scan(data, Path(path), trust, limits)
    scan.run()
    if scan.commands:
        scan = _Scan(expanded(data, Path(path), limits), Path(path), trust, limits)
        scan.run()
        if scan.commands:
            raise InputError("must start no programs that write such lines again", file=path)
    return RadianceText(scan.rewritten(), scan.files, tuple(scan.lights))


def read_included(
    paths: Iterable[str | Path], *, trust: bool = False, limits: Limits = DEFAULT_LIMITS
) -> dict[str, bytes]:
    """What stands beside a scene's own things: name → contents; scene texts are those in ``.rad``.

    Nothing of it may emit light, which would count again with each lamp. Other errors are those of
    `read_radiance`.
    """
    found: dict[str, bytes] = {}
    for number, path in enumerate(paths):
        more = read_radiance(path, trust=trust, limits=limits)
        if more.lights:
            raise InputError(
                f"must not emit light, {', '.join(more.lights)[:80]} does",
                file=path,
                remedy="make lamps of it: [[lamp]] in the scene file",
            )
        found |= more.files | {f"include{number}.rad": more.text}
    return found


class _Scan:
    """One pass over a text: checks it, and finds what it names."""

    def __init__(self, data: bytes, path: Path, trust: bool, limits: Limits) -> None:
        self.data, self.path, self.trust, self.limits = data, path, trust, limits
        self.at, self.start = 0, 0
        self.commands = 0
        self.files: dict[str, bytes] = {}
        self.lights: list[str] = []
        self._named: dict[str, str] = {}
        self._new: list[tuple[int, int, bytes]] = []

    def error(self, rule: str, remedy: str | None = None) -> InputError:
        """About the primitive that is being read."""
        line = self.data.count(b"\n", 0, self.start) + 1
        return InputError(rule, file=self.path, field=f"line {line}", remedy=remedy)

    def run(self) -> None:
        """Read all of it."""
        wrong = _CONTROL.search(self.data)
        if wrong:
            self.start = wrong.start()
            raise self.error(f"must be text, has the byte {wrong[0][0]}")
        for first in self._firsts():
            if first == b"#":
                self._comment()
            elif first == b"!":
                self._command()
            else:
                self._primitive()

    def rewritten(self) -> bytes:
        """The text with the names of `files`."""
        parts: list[bytes] = []
        at = 0
        for start, end, name in self._new:
            parts += [self.data[at:start], name]
            at = end
        return b"".join([*parts, self.data[at:]])

    def _firsts(self) -> Iterator[bytes]:
        """The letter with which each thing at the outermost level begins."""
        while True:
            space = _SPACE.match(self.data, self.at)
            self.at = self.start = space.end() if space else self.at
            if self.at >= len(self.data):
                return
            yield self.data[self.at : self.at + 1]

    def _comment(self) -> None:
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        if end - self.at > MAX_LINE:
            raise self.error(
                f"a comment must have at most {MAX_LINE} letters: Radiance reads the rest as scene",
                "break it into lines",
            )
        self.at = end

    def _command(self) -> None:
        found = _COMMAND.match(self.data, self.at)
        assert found is not None  # it matches nothing, too
        shown = found[0].decode("utf-8", "replace").replace("\r", "").split("\n")[0]
        if not self.trust:
            raise self.error(
                f"starts a program: {shown[:60]!r}",
                "--trust runs it, if you know who wrote the file",
            )
        if len(found[0]) > MAX_LINE:
            raise self.error(f"a command must have at most {MAX_LINE} letters")
        self.commands += 1
        self.at = found.end()

    def _primitive(self) -> None:
        self._word("a modifier")
        kind = self._word("a type")
        name = self._word("an identifier")
        if kind == b"alias":
            self._word("the identifier that it stands for")
            return
        if kind not in TYPES:
            raise self.error(
                f"must have a type that Radiance knows, got {_shown(kind)}",
                "each primitive is: modifier type identifier, strings, 0, numbers",
            )
        self._strings(kind)
        if self._count("integers") != 0:
            raise self.error(f"{_text(kind)} must have 0 integers")
        values = self._values(kind)
        if kind in LIGHTS and any(value > 0 for value in values[:3]):
            self.lights.append(_text(name))

    def _strings(self, kind: bytes) -> None:
        if kind in COMPILED and not self.trust:
            raise self.error(
                f"{_text(kind)} names a compiled file, which may start programs and read any file",
                "--trust takes it, if you know who made it",
            )
        count, files = self._count("strings"), FILES.get(kind, ())
        if files and count <= max(files):
            raise self.error(f"{_text(kind)} must have {max(files) + 1} strings or more")
        for number in range(count):
            word = self._word("a string")
            if number in files and word != b".":
                self._file(word)

    def _values(self, kind: bytes) -> list[float]:
        count, allowed = self._count("numbers"), NUMBERS.get(kind)
        if allowed is not None and count not in allowed:
            words = " or ".join(map(str, allowed))
            raise self.error(f"{_text(kind)} must have {words} numbers, got {count}")
        if kind == b"polygon" and (count < 9 or count % 3):
            raise self.error(
                f"polygon must have 3 numbers for each of 3 or more corners, got {count}"
            )
        values: list[float] = []
        for _ in range(count):
            word = self._word("a number")
            value = float(word) if _NUMBER.fullmatch(word) else math.nan
            if not math.isfinite(value):
                raise self.error(f"{_text(kind)} must have {count} numbers, got {_shown(word)}")
            values.append(value)
        return values

    def _word(self, what: str) -> bytes:
        found = _WORD.match(self.data, self.at)
        if found is None:
            ends = not self.data[self.at :].strip()
            got = "the file ends" if ends else "got quotes amid a word or with no end"
            raise self.error(f"must go on with {what}, {got}")
        word = next(group for group in found.groups() if group is not None)
        if len(word) > MAX_WORD:
            raise self.error(f"words must have at most {MAX_WORD} letters, got {_shown(word)}")
        self.at = found.end()
        return word

    def _count(self, what: str) -> int:
        word = self._word(f"the number of {what}")
        count = int(word) if _INTEGER.fullmatch(word) else -1
        # Each takes a letter and a space, so what is claimed is bounded by what is there.
        if not 0 <= count <= (len(self.data) - self.at) // 2 + 1:
            raise self.error(f"must have the number of {what} that follow, got {_shown(word)}")
        return count

    def _file(self, word: bytes) -> None:
        """Takes the file that the word just read names, and gives it the name of its contents."""
        reference = word.decode("utf-8", "surrogateescape")
        end, start = self.at, self.at - len(word)
        if self.data[end - 1 : end] in (b'"', b"'"):
            start -= 2
        name = self._named.get(reference) or self._taken(reference)
        self._named[reference] = name
        if name != reference:
            self._new.append((start, end, name.encode()))

    def _taken(self, reference: str) -> str:
        if any(c.isspace() for c in reference) or "\udc80" <= max(reference) <= "\udcff":
            raise self.error(f"names of files must be text without spaces, got {reference[:40]!a}")
        check_at_most(len(self._named), self.limits.max_references, "other files", self.path)
        try:
            path = confined(reference, self.path.parent, file=self.path)
        except InputError as error:
            raise self.error(error.rule, error.remedy) from error
        if not path.exists():
            if _is_own(reference):
                return reference
            raise self.error(f"names a file that is not there: {reference[:80]!r}")
        contents = open_bounded(path, self.limits)
        total = sum(map(len, self.files.values())) + len(contents)
        check_at_most(total, self.limits.max_file_bytes, "bytes in other files", self.path)
        tail = _PLAIN.sub("_", PurePosixPath(path.name).name)[-40:]
        if tail.lower().endswith(".rad"):
            tail += ".txt"  # read as what it is to the primitive that names it
        name = f"{hashlib.sha256(contents).hexdigest()[:16]}-{tail}"
        self.files[name] = contents
        return name


def _is_own(reference: str) -> bool:
    """Whether a plain name is that of a file of Radiance's library."""
    try:
        library = package_folder() / "lib"
    except MachineError:
        return False
    return "/" not in reference and "\\" not in reference and (library / reference).is_file()


def _text(word: bytes) -> str:
    return word.decode("utf-8", "replace")


def _shown(word: bytes) -> str:
    return repr(_text(word[:40]))


RADIANCE_READERS = (Reader("radiance.rad", (".rad",), read_radiance),)
