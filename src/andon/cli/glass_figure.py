"""``andon glass figure7``: the paper's figure 7 as a contact sheet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.cli.console import note
from andon.cli.examples import example_folder
from andon.errors import InputError, MachineError

if TYPE_CHECKING:
    from andon.engines.prepared import Prepared
    from andon.pipeline import Renderer
    from andon.scene import Scene

__all__ = ["FigureOptions", "run"]

Rgb = NDArray[np.uint8]

LOOKS = ("surface", "background")
# Of the crop around the glass, its own width on each side.
MARGIN = 0.06
# Pixels of a tile: four fit on a screen.
TILE_PX = 480


@dataclass(frozen=True)
class FigureOptions:
    """What was typed."""

    out: Path
    scene: Path | None = None
    samples: int = 64
    engine: str = "auto"


def run(options: FigureOptions) -> None:
    """Draws the sheet, and each of its pictures beside it."""
    from andon.display.false_colour import contact_sheet
    from andon.files.pictures import write_png
    from andon.scene import load_scene

    if options.samples < 1:
        raise InputError(f"must be ≥ 1, got {options.samples}", field="--samples")
    scene = load_scene(options.scene or example_folder("glass", "scene.toml") / "scene.toml")
    _check(scene)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MachineError(f"{options.out}: cannot be made: {error.strerror}") from error
    tiles: list[tuple[str, Rgb]] = []
    for name, title, row in _rows(scene, options):
        for look in LOOKS:
            for eye in ("left", "right"):
                picture = row(eye, look)
                write_png(options.out / f"{name}-{look}-{eye}.png", picture)
                tiles.append((f"{title}: {look}, {eye} eye", _sized(picture)))
    sheet = contact_sheet(tiles, columns=4)
    write_png(options.out / "figure7.png", sheet)
    print(options.out / "figure7.png")


Row = Callable[[str, str], Rgb]


def _check(scene: Scene) -> None:
    if not scene.glass or scene.rig is None or scene.rig.kind != "stereo":
        raise InputError(
            "needs glass and two eyes",
            file=scene.file,
            field="--scene",
            remedy='add [[glass]] and rig.kind = "stereo"',
        )


def _rows(scene: Scene, options: FigureOptions) -> list[tuple[str, str, Row]]:
    """(file name, title, (eye, layer) → picture) of each row of the figure."""
    from andon.glass.environment_map import environment_mapped
    from andon.lamps import PointLamp
    from andon.pipeline import Renderer

    renderers: dict[str, Renderer] = {}
    for look in LOOKS:
        prepared = _prepared(scene, look)
        renderers[look] = Renderer(prepared, options.engine)  # type: ignore[arg-type]
    crop = _crop(renderers["surface"].prepared)

    def ours(eye: str, look: str) -> Rgb:
        return renderers[look].picture(0.0, eye)[crop[eye]]

    plain = renderers["surface"].prepared
    assert plain.glass is not None
    mapped = replace(plain.glass, model=environment_mapped(plain.glass.model))
    without = Renderer(replace(plain, glass=mapped), options.engine)  # type: ignore[arg-type]

    def mapping(eye: str, look: str) -> Rgb:
        return without.picture(0.0, eye)[crop[eye]]

    rows = [
        ("environment-map", "environment map + Fresnel", mapping),
        ("andon", "Andon", ours),
    ]
    traced = _path_traced(renderers, crop, options.samples)
    if traced is None:
        return rows
    others = sum(not isinstance(lamp, PointLamp) for lamp in plain.lamps(0.0))
    if others:
        note(f"path-traced glass is lit by point lamps only; {others} others are left out")
    return [("path-traced", "path traced", traced), *rows]


def _prepared(scene: Scene, look: str) -> Prepared:
    from andon.cli.glass import GlassOptions, overridden
    from andon.engines.prepared import prepare

    looking = overridden(scene, GlassOptions(Path(), Path(), gaze=look))
    assert looking.gaze is not None
    # The camera that takes the path-traced row blurs what is beside the glass, too.
    gaze = looking.gaze.model_copy(update={"defocus": "frame"})
    return prepare(looking.model_copy(update={"gaze": gaze}))


def _crop(prepared: Prepared) -> dict[str, tuple[slice, slice]]:
    """Rows and columns of each eye's picture that show the glass, a little larger."""
    from andon.glass.screen import rectangle_of

    assert prepared.glass is not None
    crops: dict[str, tuple[slice, slice]] = {}
    for name, frame in prepared.frames.items():
        within = rectangle_of(prepared.glass.model.solids, frame.view)
        if within is None:
            raise InputError(f"the {name} eye sees no glass", field="--scene")
        x, y, width, height = within
        more = round(MARGIN * max(width, height))
        crops[name] = (
            slice(max(y - more, 0), min(y + height + more, frame.view.height)),
            slice(max(x - more, 0), min(x + width + more, frame.view.width)),
        )
    return crops


def _path_traced(
    renderers: dict[str, Renderer], crop: dict[str, tuple[slice, slice]], samples: int
) -> Row | None:
    """Real glass, by Mitsuba where it is installed."""
    from andon.verify.registry import NotShown
    from andon.verify.truths.mitsuba_glass import mitsuba

    try:
        mitsuba()
    except NotShown as missing:
        note(f"without the row of path-traced glass: {missing}")
        return None

    def traced(eye: str, look: str) -> Rgb:
        return _encoded(renderers[look].prepared, eye, crop[eye], samples)

    return traced


def _encoded(prepared: Prepared, eye: str, crop: tuple[slice, slice], samples: int) -> Rgb:
    """A path-traced picture at the exposure of the frame."""
    from andon.display.reference import encode
    from andon.lamps import PointLamp
    from andon.verify.truths.mitsuba_pictures import Surroundings, path_traced

    frame, glass = prepared.frames[eye], prepared.glass
    assert glass is not None
    focus = glass.focus(0.0)
    assert focus is not None  # it was asked for
    lamps = [lamp for lamp in prepared.lamps(0.0) if isinstance(lamp, PointLamp)]
    red, green, blue = np.asarray(glass.standing_lux) / np.pi
    luminance = path_traced(
        glass.model.solids,
        _cropped(frame.view, crop),
        Surroundings(lamps, frame.luminance_per_unit, (red, green, blue)),
        pupil_m=glass.model.pupil_m,
        focus_dioptres=focus.dioptres,
        samples=samples,
    )
    return encode(luminance, prepared.exposure, frame.response, frame.luminance_per_unit)


def _cropped(view: Any, crop: tuple[slice, slice]) -> Any:
    rows, columns = crop
    return replace(
        view,
        width=columns.stop - columns.start,
        height=rows.stop - rows.start,
        cx=view.cx - columns.start,
        cy=view.cy - rows.start,
    )


def _sized(picture: Rgb) -> Rgb:
    """A tile of the sheet."""
    import cv2

    height = max(1, round(picture.shape[0] * TILE_PX / picture.shape[1]))
    return np.asarray(
        cv2.resize(picture, (TILE_PX, height), interpolation=cv2.INTER_AREA), np.uint8
    )
