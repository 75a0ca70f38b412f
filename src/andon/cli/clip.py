"""``andon clip``: a scene over time, as a moving picture or a folder of pictures."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.cli.console import Interrupted, note
from andon.cli.relight import check_view
from andon.cli.without_photograph import refuse_photograph, white_text
from andon.errors import InputError, MachineError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from andon.engines.prepared import Prepared
    from andon.pipeline import Renderer
    from andon.scene import Scene
    from andon.scene.camera import Camera

__all__ = ["ClipOptions", "run"]

# Frames of one file are held until all are drawn: this many bytes at most.
MOST_BYTES = 2 << 30
# More is a mistyped time or rate: a day at 60 frames a second has five million.
MOST_FRAMES = 1_000_000
# More pixels than a screen has are a mistyped number.
LARGEST_SCALE = 8.0


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
    scale: float = 1.0


def run(options: ClipOptions) -> None:
    """Draws and writes. Raises `InputError` before anything is drawn."""
    from andon.scene import load_scene

    scene = load_scene(options.scene)
    check_view(scene, options.view)
    draw(scene, options)


def draw(scene: Scene, options: ClipOptions, views: Sequence[str] = ()) -> None:
    """Draws `scene`, which stands in for `options.scene`; several `views` side by side."""
    is_folder = _check_out(options.out)
    from andon.files.pictures.moving import check_moving

    scene = _scaled(scene, options.scale)
    refuse_photograph(options.out, scene)
    rate = options.frames_per_second
    rate = scene.scene.frames_per_second if rate is None else rate
    times = _times(options, scene, rate)
    if not is_folder:
        check_moving(options.out, rate)
    from andon.pipeline import Renderer

    renderer = Renderer(scene, options.engine)  # type: ignore[arg-type]
    film = _Film(renderer, tuple(views) or (options.view or renderer.view_names[0],))
    if is_folder:
        _write_folder(options, film, times)
    else:
        _write_file(options, film, times, rate)
    for line in _notes(options, scene, renderer.prepared):
        note(line)
    print(options.out)


@dataclass(frozen=True)
class _Film:
    """Draws pictures of one moment; those of several views lie side by side."""

    renderer: Renderer
    views: tuple[str, ...]

    def picture(self, time_seconds: float) -> NDArray[np.uint8]:
        """(H, W, 3) uint8."""
        return np.hstack([self.renderer.picture(time_seconds, view) for view in self.views])

    @property
    def size(self) -> int:
        """Bytes of one picture."""
        frames = self.renderer.prepared.frames
        return sum(frames[view].linear.size for view in self.views)


def _notes(options: ClipOptions, scene: Scene, prepared: Prepared) -> list[str]:
    notes: list[str] = []
    if options.end_seconds is None and scene.scene.duration_seconds == 0:
        notes.append("the scene has no scene.duration_seconds: it is a still, of one frame")
    white = white_text(scene, prepared)
    if white is not None:
        notes.append(f"white is {white}")
    notes += prepared.surface.notes
    if prepared.ignored:
        notes.append(f"not drawn: {', '.join(prepared.ignored)} (later versions)")
    return notes


def _scaled(scene: Scene, scale: float) -> Scene:
    """The scene with cameras of that share of their pixels, which see the same."""
    if scale == 1:
        return scene
    if not 0 < scale <= LARGEST_SCALE:
        raise InputError(
            f"must be > 0 and at most {LARGEST_SCALE:g}, got {scale:g}", field="--scale"
        )
    if scene.has_photograph or scene.rig is None:
        raise InputError(
            "needs a scene without a photograph, whose pixels are as many as they are",
            field="--scale",
            remedy="leave it out",
        )
    cameras = {name: _scaled_camera(camera, name, scale) for name, camera in scene.rig.cameras}
    one = scene.rig.camera is not None
    names = {"camera" if one else name: own for name, own in cameras.items()}
    return scene.model_copy(update={"rig": scene.rig.model_copy(update=names)})


def _scaled_camera(camera: Camera, name: str, scale: float) -> Camera:
    if camera.width is None or camera.height is None:
        raise InputError(
            f"needs the width and height of the camera {name}, which its own file has",
            field="--scale",
            remedy="state them in [rig], or leave it out",
        )
    size = {side: max(1, round(getattr(camera, side) * scale)) for side in ("width", "height")}
    shares = {"x": size["width"] / camera.width, "y": size["height"] / camera.height}
    changed: dict[str, float] = dict(size)
    for key in ("fx", "fy", "cx", "cy"):
        value = getattr(camera, key)
        middle = 0.5 if key[0] == "c" else 0.0  # pixel 0 has its middle at 0, its edge at −½
        if value is not None:
            changed[key] = (value + middle) * shares[key[1]] - middle
    return camera.model_copy(update=changed)


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
    if options.end_seconds is None and scene.scene.duration_seconds == 0:
        return [start]
    if end <= start:
        raise InputError(f"must be after --from, {start:g} s, got {end:g}", field="--to")
    # A hair less, so that rounding makes no frame of its own.
    count = max(1, int(np.ceil(min((end - start) * rate, 2.0 * MOST_FRAMES) - 1e-6)))
    if count > MOST_FRAMES:
        raise InputError(f"more than {MOST_FRAMES} frames", field="--to", remedy="check --fps")
    return [start + number / rate for number in range(count)]


def _write_folder(options: ClipOptions, film: _Film, times: list[float]) -> None:
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
            try:
                picture = film.picture(time)
                write_png(out / f"{number:0{digits}d}.png", picture)
            except KeyboardInterrupt:
                kept = f"{number} of {len(times)} frames are in {out}"
                raise Interrupted(f"interrupted; {kept}") from None
            step()


def _write_file(options: ClipOptions, film: _Film, times: list[float], rate: float) -> None:
    """All frames in one file, once they are drawn."""
    from andon.files.pictures.moving import write_moving

    total = len(times) * film.size
    if total > MOST_BYTES:
        raise InputError(
            f"{len(times)} frames take {total / 2**30:.1f} GB, at most {MOST_BYTES >> 30} are held",
            field="--out",
            remedy="name a folder: its frames are written one by one",
        )
    frames: list[Any] = []
    with _progress(len(times)) as step:
        for time in times:
            frames.append(film.picture(time))
            step()
    write_moving(options.out, frames, rate)


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
