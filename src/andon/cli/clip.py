"""``andon clip``: a scene over time, as a moving picture or a folder of pictures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.cli.console import note
from andon.cli.film import check_film, frame_moments, write_film
from andon.cli.relight import check_view
from andon.cli.without_photograph import refuse_photograph, white_text
from andon.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from andon.engines.prepared import Prepared
    from andon.pipeline import Renderer
    from andon.scene import Scene
    from andon.scene.camera import Camera

__all__ = ["ClipOptions", "run"]

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
    rate = options.frames_per_second
    rate = scene.scene.frames_per_second if rate is None else rate
    check_film(options.out, rate)
    scene = _scaled(scene, options.scale)
    refuse_photograph(options.out, scene)
    times = _times(options, scene, rate)
    from andon.pipeline import Renderer

    renderer = Renderer(scene, options.engine)  # type: ignore[arg-type]
    film = _Film(renderer, tuple(views) or (options.view or renderer.view_names[0],))
    write_film(options.out, film.picture, times, rate, film.size)
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


def _times(options: ClipOptions, scene: Scene, rate: float) -> list[float]:
    """Session times of the frames."""
    for name, number in (("--from", options.start_seconds), ("--to", options.end_seconds)):
        if number is not None and not np.isfinite(number):
            raise InputError(f"must be finite, got {number}", field=name)
    start = options.start_seconds or 0.0
    end = scene.scene.duration_seconds if options.end_seconds is None else options.end_seconds
    if options.end_seconds is None and scene.scene.duration_seconds == 0:
        return [start]
    return frame_moments(start, end, rate)
