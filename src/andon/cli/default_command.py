"""Command groups whose first word may be a file instead of a sub-command."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

from typer.core import TyperGroup

from andon.errors import InputError, nearest_name

__all__ = ["DefaultCommand"]


class DefaultCommand(TyperGroup):
    """Takes what is no sub-command for the arguments of the command `default`.

    `group` is the word before it, `noun` what a file of it is called, for messages.
    """

    default: ClassVar[str]
    group: ClassVar[str]
    noun: ClassVar[str]

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As Click does, with the default command where none is named."""
        known = {*self.commands, *ctx.help_option_names}
        if args and args[0] not in known:
            self._refuse_misspelt(args[0])
            args = [self.default, *args]
        return super().parse_args(ctx, args)

    def _refuse_misspelt(self, word: str) -> None:
        """A word that is no file's name, and nearly that of a sub-command."""
        near = nearest_name(word, list(self.commands))
        if near and not Path(word).suffix and not Path(word).exists():
            raise InputError(
                f"there is no command {word[:40]!r} and no {self.noun} of that name",
                field=self.group,
                remedy=f"perhaps andon {self.group} {near}",
            )
