"""``andon relight``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from andon.cli.console import check_writable, note, print_report
from andon.errors import InputError
from andon.quantities import Illuminance, photometric

__all__ = ["RelightOptions", "run"]

# E0 where nobody states it: a lit living room in the evening (EN 12464-1 asks 300 lx of rooms in
# which people read). The result then is relative, and says so.
ASSUMED_AMBIENT_LUX = 300.0
PICTURES = (".png", ".jpg", ".jpeg")


@dataclass(frozen=True)
class RelightOptions:
    """The options of the command, as typed."""

    photo: Path
    out: Path
    depth: Path | None = None
    camera: Path | None = None
    mesh: Path | None = None
    scene: Path | None = None
    lamps: tuple[str, ...] = ()
    ambient_lux: float | None = None
    dimming: float | None = None
    depth_kind: str | None = None
    depth_scale_to_m: float | None = None
    baseline_m: float | None = None
    doffs_px: float | None = None
    objects: tuple[Path, ...] = ()
    illuminance_maps: tuple[Path, ...] = ()
    view: str | None = None
    time_seconds: float = 0.0
    engine: str = "auto"


def run(options: RelightOptions) -> None:
    """Relights and writes. Raises `InputError` before anything is written."""
    check_writable(options.out, (*PICTURES, ".exr"), "--out")
    for path in options.illuminance_maps:
        check_writable(path, (".exr", ".png"), "--illuminance-map")
    _refuse_overwriting(options)
    from andon.cli.notes import depth_text, notes_on
    from andon.pipeline import Renderer

    scene = scene_of(options)
    _check_view(scene, options.view)
    renderer = Renderer(scene, options.engine)  # type: ignore[arg-type]
    frame = renderer.render(options.time_seconds, options.view)
    if options.scene is None and options.ambient_lux is None:
        note(
            f"E0 is not stated: {ASSUMED_AMBIENT_LUX:g} lx assumed, results are relative "
            "(--ambient-lux states it)"
        )
    _write(options.out, frame.image.rgb, frame.luminance)
    for path in options.illuminance_maps:
        write_illuminance(path, frame.illuminance, frame.surface.valid)
    for line in notes_on(frame, renderer.prepared, options.time_seconds):
        note(line)
    pixels, depth = frame.surface.valid.size, depth_text(frame.surface)
    print_report(frame.report, renderer.setup_seconds, pixels, depth)
    print(options.out)


def _refuse_overwriting(options: RelightOptions) -> None:
    """An output must be no input, and no other output."""
    named = (options.photo, options.depth, options.camera, options.mesh, options.scene)
    taken = {path.resolve() for path in (*named, *options.objects) if path is not None}
    for path in (options.out, *options.illuminance_maps):
        if path.resolve() in taken:
            raise InputError(
                "is also an input or another output, and would be overwritten",
                file=path,
                remedy="give it another name",
            )
        taken.add(path.resolve())


def _check_view(scene: Any, view: str | None) -> None:
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


def scene_of(options: RelightOptions) -> Any:
    """The scene that the options describe; they win over the scene file."""
    from andon.scene import load_scene, scene_from_dict

    tables: dict[str, Any] = {}
    folder, file = Path(), "command line"
    if options.scene is not None:
        loaded = load_scene(options.scene)
        tables = loaded.model_dump(exclude_unset=True)
        folder, file = loaded.folder, loaded.file
    _override(tables, options)
    if options.scene is None:
        _assume(tables, options)
    given = [options.photo, options.depth, options.camera, options.mesh, *options.objects]
    given += _luminaires(options)
    scene = scene_from_dict(tables, folder=folder, file=file)
    return scene.trusting([path for path in given if path is not None])


def _luminaires(options: RelightOptions) -> list[Path]:
    """Photometric files that the user named in --lamp."""
    from andon.lamps import parse_lamp_option

    lamps = [parse_lamp_option(text) for text in options.lamps]
    return [Path(str(lamp["file"])) for lamp in lamps if "file" in lamp]


def _override(tables: dict[str, Any], options: RelightOptions) -> None:
    tables.setdefault("capture", {})["source"] = str(options.photo)
    if options.camera is not None:
        tables["rig"] = {"camera": {"file": str(options.camera)}}
    if options.depth is not None and options.mesh is not None:
        raise InputError("give one of --depth and --mesh", field="--depth")
    depth = {
        "kind": options.depth_kind,
        "scale_to_m": options.depth_scale_to_m,
        "baseline_m": options.baseline_m,
        "doffs_px": options.doffs_px,
    }
    stated = {key: value for key, value in depth.items() if value is not None}
    if options.depth is not None:
        tables["surface"] = {"depth": {"file": str(options.depth), **stated}}
    elif stated:
        raise InputError(f"{', '.join(stated)} without --depth", field="--depth")
    if options.mesh is not None:
        tables["surface"] = {"mesh": str(options.mesh)}
    if options.ambient_lux is not None:
        # E0 was typed in: it replaces the scene's E0, whatever form that had.
        dimmed = {k: v for k, v in tables.get("ambient", {}).items() if k.startswith("dimming")}
        tables["ambient"] = {"illuminance_lux": options.ambient_lux, **dimmed}
    if options.dimming is not None:
        tables.setdefault("ambient", {})["dimming"] = options.dimming
    if options.lamps:
        from andon.lamps import parse_lamp_option

        lamps = [parse_lamp_option(text) for text in options.lamps]
        tables["lamp"] = [*tables.get("lamp", ()), *lamps]
    if options.objects:
        more = [{"name": path.stem, "mesh": str(path)} for path in options.objects]
        tables["object"] = [*tables.get("object", ()), *more]


def _assume(tables: dict[str, Any], options: RelightOptions) -> None:
    """What a scene would state and the command line did not."""
    if options.camera is None:
        raise InputError(
            "is missing: nothing says where the pixels look",
            field="--camera",
            remedy="give a camera file, e.g. with width, height and hfov_degrees",
        )
    if options.depth is None and options.mesh is None:
        raise InputError(
            "is missing: light needs geometry to fall on", field="--depth", remedy="or give --mesh"
        )
    if options.ambient_lux is None:
        tables["scene"] = {"photometry": "relative"}
        tables.setdefault("ambient", {})["illuminance_lux"] = ASSUMED_AMBIENT_LUX


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
