"""``andon glass``: glass of a scene as one eye, or both, would see it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from andon.cli.console import check_writable, note, print_report
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.pipeline import Frame
    from andon.scene import Scene

__all__ = ["GlassOptions", "overridden", "refuse_of_figure", "run"]

PICTURES = (".png", ".jpg", ".jpeg", ".exr")
MOVING = (".webp", ".gif", ".apng")
EYES = ("left", "right", "both")
BLURS = ("optical", "gaussian", "paper", "off")
LAYERS = ("surface", "background")


@dataclass(frozen=True)
class GlassOptions:
    """What was typed; None: as the scene says."""

    scene: Path
    out: Path
    gaze: str | None = None
    eye: str | None = None
    blur: str | None = None
    interfaces: int | None = None
    time_seconds: float = 0.0
    layers: Path | None = None
    engine: str = "auto"


def run(options: GlassOptions) -> None:
    """Draws and writes. Raises `InputError` before anything is drawn."""
    check_writable(options.out, (*PICTURES, *MOVING), "--out")
    from andon.scene import load_scene

    scene = overridden(load_scene(options.scene), options)
    names = _eyes(scene, options.eye)
    if options.out.suffix.lower() in MOVING:
        from andon.cli.clip import ClipOptions, draw

        clip = ClipOptions(
            options.scene, options.out, None, _end(scene), None, None, options.engine
        )
        draw(scene, clip, names)
    else:
        _still(scene, options, names)


def refuse_of_figure(samples: int | None, scene: Path | None) -> None:
    """Raises `InputError` for options that only ``andon glass figure7`` has."""
    for name, value in (("--samples", samples), ("--scene", scene)):
        if value is not None:
            raise InputError(
                "belongs to andon glass figure7", field=name, remedy="leave it out, or draw that"
            )


def overridden(scene: Scene, options: GlassOptions) -> Scene:
    """The scene with what was typed in place of what it says."""
    from andon.scene import scene_from_dict

    if not scene.glass:
        raise InputError(
            "has no glass",
            file=scene.file,
            field="glass",
            remedy="add [[glass]] with a shape, or draw it with andon relight --scene",
        )
    tables: dict[str, Any] = scene.model_dump(exclude_unset=True)
    trusted: list[Path] = []
    gaze = dict(tables.get("gaze") or {})
    if options.gaze is not None:
        kept = {key: value for key, value in gaze.items() if key not in ("file", "distance_m")}
        gaze = kept | _gaze(options.gaze, trusted)
    if options.blur is not None:
        if options.blur not in BLURS:
            raise InputError(
                f"must be one of {', '.join(BLURS)}, got {options.blur!r}", field="--blur"
            )
        gaze = {"source": "surface"} | gaze | {"blur": options.blur}
    if gaze:
        tables["gaze"] = gaze
    if options.interfaces is not None:
        if options.interfaces not in (1, 2):
            raise InputError(f"must be 1 or 2, got {options.interfaces}", field="--interfaces")
        tables["glass"] = [row | {"interfaces": options.interfaces} for row in tables["glass"]]
    return scene_from_dict(tables, folder=scene.folder, file=scene.file).trusting(trusted)


def _gaze(typed: str, trusted: list[Path]) -> dict[str, Any]:
    """The [gaze] table of ``--gaze``: a layer, a distance or a recording."""
    if typed in LAYERS:
        return {"source": typed}
    path = Path(typed)
    if path.suffix.lower() == ".csv":
        trusted.append(path)
        return {"source": "file", "file": os.path.abspath(path)}
    try:
        distance_m = float(typed)
    except ValueError:
        distance_m = np.nan
    if not (np.isfinite(distance_m) and distance_m > 0):
        raise InputError(
            f"must be surface, background, a distance in metres or a .csv file, got {typed!r}",
            field="--gaze",
        )
    return {"source": "fixed", "distance_m": distance_m}


def _eyes(scene: Scene, eye: str | None) -> tuple[str, ...]:
    """Views to draw, left to right."""
    names = tuple(name for name, _ in scene.rig.cameras) if scene.rig is not None else ()
    if eye is None:
        return names[:1] if len(names) < 2 else names
    if eye not in EYES:
        raise InputError(f"must be one of {', '.join(EYES)}, got {eye!r}", field="--eye")
    if len(names) < 2:
        raise InputError(
            "needs two eyes, and this rig has one camera",
            field="--eye",
            remedy='leave it out, or state rig.kind = "stereo"',
        )
    return names if eye == "both" else (eye,)


def _end(scene: Scene) -> float | None:
    """Of a clip: the session's end, or without one that of the recorded gaze."""
    if scene.scene.duration_seconds > 0 or scene.gaze is None or scene.gaze.file is None:
        return None
    from andon.files.gaze import read_gaze

    recording = read_gaze(scene.path(scene.gaze.file, "gaze.file"))
    return float(recording.times_seconds[-1])


def _still(scene: Scene, options: GlassOptions, names: tuple[str, ...]) -> None:
    from andon.cli.glass_notes import glass_notes
    from andon.cli.notes import notes_on_time
    from andon.cli.seen import notes_on_seen
    from andon.cli.without_photograph import refuse_photograph, white_text
    from andon.pipeline import Renderer

    refuse_photograph(options.out, scene)
    renderer = Renderer(scene, options.engine)  # type: ignore[arg-type]
    frames = [renderer.render(options.time_seconds, name) for name in names]
    _write(options.out, frames)
    if options.layers is not None:
        from andon.cli.glass_layers import write_layers

        write_layers(options.layers, frames, names)
    notes = [
        *notes_on_time(options.time_seconds, _end(scene) or scene.scene.duration_seconds),
        *renderer.prepared.surface.notes,
        *glass_notes(frames[0].report.glass),
        *notes_on_seen(frames[0].seen),
    ]
    for line in notes:
        note(line)
    pixels = frames[0].surface.valid.size
    white = white_text(scene, renderer.prepared)
    print_report(frames[0].report, renderer.setup_seconds, pixels, white=white)
    print(options.out)


def _write(path: Path, frames: list[Frame]) -> None:
    """One picture, the eyes side by side."""
    from andon.files.pictures import write_exr, write_picture

    if path.suffix.lower() == ".exr":
        values = np.hstack([frame.luminance.cd_m2 for frame in frames]).astype(np.float32)
        write_exr(path, values, unit="cd/m2", photometry=frames[0].luminance.photometry)
    else:
        write_picture(path, np.hstack([frame.image.rgb for frame in frames]))
