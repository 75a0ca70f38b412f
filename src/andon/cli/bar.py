"""A progress bar on stderr for long work, with the time left."""

from __future__ import annotations

from andon.cli.durations import duration

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
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

        console = Console(stderr=True)
        columns = TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn()
        # Where nobody looks at it, all that is left of a bar is an empty line.
        self._bar = Progress(
            *columns,
            TextColumn("{task.fields[left]}"),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._bar.start()
        self._task = self._bar.add_task(self._first, total=None, left="")
        return self

    def show(self, done: int, of: int, what: str, seconds_left: float | None = None) -> None:
        """`done` of `of` parts are ready; `what` is the one that is being done, or was last."""
        left = "" if seconds_left is None else f"{duration(seconds_left)} left"
        self._bar.update(self._task, completed=done, total=of, description=what, left=left)

    def __exit__(self, *_: object) -> None:
        self._bar.stop()
