"""The few ways in which Andon refuses: every one says what came, which rule, and what to do.

============== ========= =====================================================
exception      exit code whose fault
============== ========= =====================================================
InputError     2         the user's input: a file, a field, a number
MachineError   3         the machine: disk, GPU, a missing program
(anything else) 1        ours: a bug
============== ========= =====================================================
"""

from __future__ import annotations

from pathlib import Path

__all__ = ["AndonError", "InputError", "MachineError", "nearest_name"]


class AndonError(Exception):
    """Base of all refusals; ``exit_code`` is what the command line returns."""

    exit_code: int = 1


class InputError(AndonError):
    """Input that breaks a rule. One line: file, field, rule, remedy.

    Parameters
    ----------
    rule : what was expected and what came ("must be > 0 cd, got -5").
    file : the file at fault, if there is one.
    field : the field, key or place in it ("lamp[0].intensity_cd", "line 12").
    remedy : what the reader can do about it.
    """

    exit_code = 2

    def __init__(
        self,
        rule: str,
        *,
        file: str | Path | None = None,
        field: str | None = None,
        remedy: str | None = None,
    ) -> None:
        self.rule, self.field, self.remedy = rule, field, remedy
        self.file = str(file) if file is not None else None
        place = ": ".join(part for part in (self.file, field) if part)
        line = f"{place}: {rule}" if place else rule
        super().__init__(f"{line}; {remedy}" if remedy else line)


class MachineError(AndonError):
    """The machine cannot do it: disk full, no adapter, a program that is not installed."""

    exit_code = 3

    def __init__(self, what: str, *, remedy: str | None = None) -> None:
        self.what, self.remedy = what, remedy
        super().__init__(f"{what}; {remedy}" if remedy else what)


def nearest_name(name: str, known: list[str]) -> str | None:
    """The known name that `name` was probably meant to be, or None."""
    from difflib import get_close_matches

    found = get_close_matches(name.lower(), known, n=1, cutoff=0.5)
    return found[0] if found else None
