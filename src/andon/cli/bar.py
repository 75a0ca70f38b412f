"""A progress bar on stderr for long work, with the time left."""

from __future__ import annotations

__all__ = ["Bar"]


class Bar:
    """A context manager; `show` says how far the work is. Silent where stderr is no terminal.

    Parameters
    ----------
    first : what is done before anything is counted.
    """

    def __init__(self, first: str) -> None:
        self._first = first

    def __enter__(self) -> Bar:
        from rich.console import Console
        from rich.progress import Progress

        console = Console(stderr=True)
        # Where nobody looks at it, all that is left of a bar is an empty line.
        self._bar = Progress(console=console, transient=True, disable=not console.is_terminal)
        self._bar.start()
        self._task = self._bar.add_task(self._first, total=None)
        return self

    def show(self, done: int, of: int, what: str) -> None:
        """`done` of `of` parts are ready; `what` is the one that is being done, or was last."""
        self._bar.update(self._task, completed=done, total=of, description=what)

    def __exit__(self, *_: object) -> None:
        self._bar.stop()
