"""Pictures over time, as one moving picture or a folder of them."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.cli.console import Interrupted
from andon.errors import InputError, MachineError

if TYPE_CHECKING:
    from collections.abc import Callable

    Draw = Callable[[float], NDArray[np.uint8]]

__all__ = ["check_film", "frame_moments", "write_film"]

# Frames of one file are held until all are drawn: this many bytes at most.
MOST_BYTES = 2 << 30
# More is a mistyped time or rate: a day at 60 frames a second has five million.
MOST_FRAMES = 1_000_000


def write_film(
    out: Path,
    draw: Draw,
    times_seconds: list[float],
    frames_per_second: float,
    picture_bytes: int,
) -> None:
    """Writes `draw(time)` (H, W, 3) uint8 of each time; `out` has passed `check_film`.

    `picture_bytes` is what one takes in memory. Raises `InputError` for more than are held.
    """
    if is_folder(out):
        _write_folder(out, draw, times_seconds)
    else:
        _write_file(out, draw, times_seconds, frames_per_second, picture_bytes)


def is_folder(out: Path) -> bool:
    """Whether frames go into a folder: what has no suffix, or is one."""
    return not out.suffix or out.is_dir()


def check_film(out: Path, frames_per_second: float) -> None:
    """Refuses what cannot be written, before any work is done."""
    from andon.files.pictures.moving import MOVING_SUFFIXES, check_moving

    if not (np.isfinite(frames_per_second) and frames_per_second > 0):
        raise InputError(f"must be > 0, got {frames_per_second:g}", field="--fps")
    suffix = out.suffix.lower()
    if not is_folder(out):
        if suffix not in MOVING_SUFFIXES:
            raise InputError(
                f"must end in {', '.join(MOVING_SUFFIXES)}, or be a folder, got {out.name!r}",
                file=out,
                field="--out",
            )
        if not out.parent.is_dir():
            raise InputError(
                f"the folder {str(out.parent)!r} does not exist",
                file=out,
                field="--out",
                remedy="make it",
            )
        check_moving(out, frames_per_second)
        return
    if out.exists() and not out.is_dir():
        raise InputError("must be a folder, is a file", file=out, field="--out")
    if out.is_dir() and any(out.iterdir()):
        raise InputError(
            "the folder has something in it, which frames would mix with",
            file=out,
            field="--out",
            remedy="name a new one, or empty it",
        )


def frame_moments(
    start_seconds: float, end_seconds: float, rate: float, *, end: str = "--to"
) -> list[float]:
    """Times of frames from the start up to the end, which begins the next round.

    `end` is the option that a message names.
    """
    if not end_seconds > start_seconds:
        rule = f"must be after --from, {start_seconds:g} s, got {end_seconds:g}"
        raise InputError(rule, field=end)
    seconds = end_seconds - start_seconds
    # A hair less, so that rounding makes no frame of its own.
    count = max(1, int(np.ceil(min(seconds * rate, 2.0 * MOST_FRAMES) - 1e-6)))
    if count > MOST_FRAMES:
        raise InputError(f"more than {MOST_FRAMES} frames", field=end, remedy="check --fps")
    return [start_seconds + number / rate for number in range(count)]


def _write_folder(out: Path, draw: Draw, times: list[float]) -> None:
    """Each frame as soon as it is drawn: 0000.png, 0001.png, …"""
    from andon.files.pictures import write_png

    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MachineError(f"{out}: cannot be made: {error.strerror}") from error
    digits = max(4, len(str(len(times) - 1)))
    with _progress(len(times)) as step:
        for number, time in enumerate(times):
            try:
                picture = draw(time)
                write_png(out / f"{number:0{digits}d}.png", picture)
            except KeyboardInterrupt:
                kept = f"{number} of {len(times)} frames are in {out}"
                raise Interrupted(f"interrupted; {kept}") from None
            step()


def _write_file(out: Path, draw: Draw, times: list[float], rate: float, size: int) -> None:
    """All frames in one file, once they are drawn."""
    from andon.files.pictures.moving import write_moving

    total = len(times) * size
    if total > MOST_BYTES:
        raise InputError(
            f"{len(times)} frames take {total / 2**30:.1f} GB, at most {MOST_BYTES >> 30} are held",
            field="--out",
            remedy="name a folder: its frames are written one by one",
        )
    frames: list[Any] = []
    with _progress(len(times)) as step:
        for time in times:
            frames.append(draw(time))
            step()
    write_moving(out, frames, rate)


@contextmanager
def _progress(count: int) -> Generator[Callable[[], None]]:
    """A bar on stderr with the time that is left; call what it yields after each frame."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    columns = ("frames", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    # Where nobody looks at it, all that is left of a bar is an empty line.
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("frames", total=count)
        yield lambda: bar.advance(task)
