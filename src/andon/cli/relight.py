"""``andon relight``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from andon.cli.confidence import check_confidence, notes_on_confidence, write_confidence
from andon.cli.console import check_writable, note, print_report
from andon.cli.options import RelightOptions
from andon.cli.relight_fit import check_fit, fit_inputs, fit_outputs, fitted, print_fit, write_fit
from andon.cli.seen import check_seen, notes_on_seen, write_seen
from andon.cli.typed import ASSUMED_AMBIENT_LUX, named_as_typed, scene_of
from andon.cli.uncovered import check_uncovered, write_uncovered
from andon.cli.without_photograph import refuse_photograph, white_text
from andon.errors import InputError
from andon.quantities import Illuminance, photometric

__all__ = ["check_view", "run"]

PICTURES = (".png", ".jpg", ".jpeg")


def run(options: RelightOptions) -> None:
    """Relights and writes. Raises `InputError` before anything is written."""
    check_writable(options.out, (*PICTURES, ".exr"), "--out")
    for path in options.illuminance_maps or ():
        check_writable(path, (".exr", ".png"), "--illuminance-map")
    check_fit(options)
    _refuse_overwriting(options)
    from andon.cli.notes import depth_text, notes_on, notes_on_time
    from andon.pipeline import Renderer

    scene = scene_of(options)
    check_view(scene, options.view)
    check_seen(options.seen, scene)
    check_uncovered(options.uncovered, scene)
    check_confidence(options.confidence, scene)
    for path in _outputs(options):
        refuse_photograph(path, scene)
    with named_as_typed(options, len(scene.lamp) - len(options.lamps or ()), scene.file):
        fit = None if options.fit_to is None else fitted(options, scene)
        scene = scene if fit is None or fit.scene is None else fit.scene
        renderer = Renderer(scene, options.engine)  # type: ignore[arg-type]
        frame = renderer.render(options.time_seconds, options.view)
    if options.scene is None and options.ambient_lux is None:
        note(
            f"E0 is not stated: {ASSUMED_AMBIENT_LUX:g} lx assumed, results are relative "
            "(--ambient-lux states it)"
        )
    _write(options.out, frame.image.rgb, frame.luminance)
    if options.seen is not None and frame.seen is not None:
        write_seen(options.seen, frame.seen)
    for path in options.illuminance_maps or ():
        write_illuminance(path, frame.illuminance, frame.surface.valid)
    if options.uncovered is not None and frame.baked is not None:
        write_uncovered(options.uncovered, frame.image.rgb, frame.baked)
    if fit is not None:
        write_fit(options, fit)
    about_trust: list[str] = []
    if options.confidence is not None:
        write_confidence(options.confidence, frame.confidence)
        about_trust = notes_on_confidence(frame.confidence)
    lines = notes_on_time(options.time_seconds, scene.scene.duration_seconds)
    about = notes_on(
        frame, renderer.prepared, options.time_seconds, has_photograph=scene.has_photograph
    )
    for line in (*lines, *about, *notes_on_seen(frame.seen), *about_trust):
        note(line)
    depth = depth_text(frame.surface, has_photograph=scene.has_photograph)
    white = white_text(scene, renderer.prepared)
    print_report(
        frame.report, renderer.setup_seconds, frame.surface.valid.size, depth=depth, white=white
    )
    if fit is not None:
        print_fit(fit)
    print(options.out)


def _outputs(options: RelightOptions) -> list[Path]:
    more = (options.seen, options.uncovered, options.confidence)
    named = [path for path in more if path is not None]
    return [options.out, *(options.illuminance_maps or ()), *named, *fit_outputs(options)]


def _refuse_overwriting(options: RelightOptions) -> None:
    """An output must be no input, and no other output."""
    named = (options.photo, options.depth, options.camera, options.mesh, options.scene)
    more = (*named, *(options.objects or ()), *fit_inputs(options))
    taken = {path.resolve() for path in more if path is not None}
    for path in _outputs(options):
        if path.resolve() in taken:
            raise InputError(
                "is also an input or another output, and would be overwritten",
                file=path,
                remedy="give it another name",
            )
        taken.add(path.resolve())


def check_view(scene: Any, view: str | None) -> None:
    """Refuses a view that the rig has not, before any file is read."""
    names = [name for name, _ in scene.rig.cameras] if scene.rig is not None else []
    if view is None or not names or view in names:
        return
    if len(names) == 1:
        remedy = "leave --view out; two eyes need a scene with [rig.left] and [rig.right]"
    else:
        remedy = f"give one of {' and '.join(names)}"
    raise InputError(
        f"there is no view {view!r}, this rig has {' and '.join(names)}",
        field="--view",
        remedy=remedy,
    )


def _write(path: Path, rgb: Any, luminance: Any) -> None:
    from andon.files.pictures import write_exr, write_picture

    if path.suffix.lower() == ".exr":
        values = np.asarray(luminance.cd_m2, np.float32)
        write_exr(path, values, unit="cd/m2", photometry=luminance.photometry)
    else:
        write_picture(path, rgb)


def write_illuminance(path: Path, illuminance: Illuminance, valid: Any) -> None:
    """EXR: three channels in lux; PNG: photometric value in false colours with a scale bar."""
    from andon.display.false_colour import false_colour
    from andon.files.pictures import write_exr, write_picture

    if path.suffix.lower() == ".exr":
        lux = np.asarray(illuminance.lux, np.float32)
        write_exr(path, lux, unit="lx", photometry=illuminance.photometry)
    else:
        unit = "lx" if illuminance.photometry == "absolute" else "lx (relative)"
        write_picture(path, false_colour(photometric(illuminance.lux), unit, valid=valid))
