"""``andon clip``: a scene over time, as a moving picture or a folder of pictures."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from andon.cli.console import note
from andon.cli.relight import check_view
from andon.cli.without_photograph import refuse_photograph, white_text
from andon.errors import InputError, MachineError

if TYPE_CHECKING:
    from collections.abc import Callable

    from andon.pipeline import Renderer
    from andon.scene import Scene

__all__ = ["ClipOptions", "run"]

# Frames of one file are held until all are drawn: this many bytes at most.
MOST_BYTES = 2 << 30
# More is a mistyped time or rate: a day at 60 frames a second has five million.
MOST_FRAMES = 1_000_000


@dataclass(frozen=True)
class ClipOptions:
    """What was typed; None: as the scene says."""

    scene: Path
    out: Path
    start_seconds: float | None
    end_seconds: float | None
    frames_per_second: float | None
    view: str | None
    engine: str


def run(options: ClipOptions) -> None:
    """Draws and writes. Raises `InputError` before anything is drawn."""
    is_folder = _check_out(options.out)
    from andon.files.pictures.moving import check_moving
    from andon.scene import load_scene

    scene = load_scene(options.scene)
    check_view(scene, options.view)
    refuse_photograph(options.out, scene)
    rate = options.frames_per_second
    rate = scene.scene.frames_per_second if rate is None else rate
    times = _times(options, scene, rate)
    if not is_folder:
        check_moving(options.out, rate)
    from andon.pipeline import Renderer

    renderer = Renderer(scene, options.engine)  # type: ignore[arg-type]
    if is_folder:
        _write_folder(options, renderer, times)
    else:
        _write_file(options, renderer, times, rate)
    white = white_text(scene, renderer.prepared)
    if white is not None:
        note(f"white is {white}")
    for line in renderer.prepared.surface.notes:
        note(line)
    if renderer.prepared.ignored:
        note(f"not drawn: {', '.join(renderer.prepared.ignored)} (later versions)")
    print(options.out)


def _check_out(out: Path) -> bool:
    """Whether it is a folder; refuses what cannot be written, before any work is done."""
    from andon.files.pictures.moving import MOVING_SUFFIXES

    suffix = out.suffix.lower()
    if suffix and not out.is_dir():
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
        return False
    if out.exists() and not out.is_dir():
        raise InputError("must be a folder, is a file", file=out, field="--out")
    if out.is_dir() and any(out.iterdir()):
        raise InputError(
            "the folder has something in it, which frames would mix with",
            file=out,
            field="--out",
            remedy="name a new one, or empty it",
        )
    return True


def _times(options: ClipOptions, scene: Scene, rate: float) -> list[float]:
    """Session times of the frames: from the start up to the end, which begins the next round."""
    for name, number in (("--from", options.start_seconds), ("--to", options.end_seconds)):
        if number is not None and not np.isfinite(number):
            raise InputError(f"must be finite, got {number}", field=name)
    if not (np.isfinite(rate) and rate > 0):
        raise InputError(f"must be > 0, got {rate:g}", field="--fps")
    start = options.start_seconds or 0.0
    end = scene.scene.duration_seconds if options.end_seconds is None else options.end_seconds
    if options.end_seconds is None and end == 0:
        raise InputError(
            "is 0: the scene is a still",
            file=scene.file,
            field="scene.duration_seconds",
            remedy="state it, or --to",
        )
    if end <= start:
        raise InputError(f"must be after --from, {start:g} s, got {end:g}", field="--to")
    # A hair less, so that rounding makes no frame of its own.
    count = max(1, int(np.ceil(min((end - start) * rate, 2.0 * MOST_FRAMES) - 1e-6)))
    if count > MOST_FRAMES:
        raise InputError(f"more than {MOST_FRAMES} frames", field="--to", remedy="check --fps")
    return [start + number / rate for number in range(count)]


def _write_folder(options: ClipOptions, renderer: Renderer, times: list[float]) -> None:
    """Each frame as soon as it is drawn: 0000.png, 0001.png, …"""
    from andon.files.pictures import write_png

    out = options.out
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MachineError(f"{out}: cannot be made: {error.strerror}") from error
    digits = max(4, len(str(len(times) - 1)))
    with _progress(len(times)) as step:
        for number, time in enumerate(times):
            picture = renderer.picture(time, options.view)
            write_png(out / f"{number:0{digits}d}.png", picture)
            step()


def _write_file(options: ClipOptions, renderer: Renderer, times: list[float], rate: float) -> None:
    """All frames in one file, once they are drawn."""
    from andon.files.pictures.moving import write_moving

    view = options.view or renderer.view_names[0]
    total = len(times) * renderer.prepared.frames[view].linear.size
    if total > MOST_BYTES:
        raise InputError(
            f"{len(times)} frames take {total / 2**30:.1f} GB, at most {MOST_BYTES >> 30} are held",
            field="--out",
            remedy="name a folder: its frames are written one by one",
        )
    frames: list[Any] = []
    with _progress(len(times)) as step:
        for time in times:
            frames.append(renderer.picture(time, options.view))
            step()
    write_moving(options.out, frames, rate)


@contextmanager
def _progress(count: int) -> Generator[Callable[[], None]]:
    """A bar on stderr with the time that is left; call what it yields after each frame."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    columns = ("frames", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("frames", total=count)
        yield lambda: bar.advance(task)
